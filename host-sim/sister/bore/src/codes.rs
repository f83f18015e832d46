//! Errors of bores milled on a circle.

truepath_ground::codes! {
    B001 => "a number out of range"
        / "correct the number",
    B002 => "the cutter does not turn against its path"
        / "check --rpm and --feed",
    B003 => "the passes of the teeth do not meet"
        / "lower the feed, raise the speed, or mill conventionally",
    B004 => "more passes than can be followed"
        / "use fewer laps, or a higher feed: the height of the waviness falls with the square of the feed",
    B005 => "passes of unequal edges take too many steps to compare"
        / "use fewer laps, no runout, or a feed farther from where passes part",
    B006 => "no feed gives the wanted height"
        / "name a smaller height",
}
