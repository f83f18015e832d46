//! Errors of studies.

truepath_ground::codes! {
    Y001 => "the folder holds results of another study"
        / "name another folder, or add --force to drop them and start afresh",
    Y002 => "the folder holds results that cannot be read"
        / "name another folder, or add --force",
    Y003 => "no family of that name"
        / "correct the name",
    Y004 => "more seeds than the set has, or none"
        / "ask for another number",
    Y005 => "the document has no place for the results"
        / "put the two lines where the results belong",
}
