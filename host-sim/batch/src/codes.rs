//! Errors of batches.

truepath_ground::codes! {
    Q011 => "a batch that asks for action"
        / "the error names what: put in a new cutter, or correct for it with truepath learn from the last part; the page shows every part",
    Q012 => "a table of the parts of a batch that says something else"
        / "write part,probe,event in the first line, then one line for each part: 7,part-7.txt,cutter",
}
