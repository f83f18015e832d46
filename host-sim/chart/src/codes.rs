//! Errors of pictures.

truepath_ground::codes! {
    Z001 => "a size outside 200 to 8000 px, or too low for what is to be drawn"
        / "give another --width or --height; for a sharper PNG picture raise --scale",
    Z002 => "a stretch that is empty or off the contour"
        / "correct --from and --to",
    Z003 => "a magnification outside 0.01 to 1,000,000"
        / "leave --magnify out to show the largest error as a tenth of the part",
    Z004 => "a title or a name of more than 200 letters"
        / "shorten it",
    Z005 => "a PNG picture of too many pixels, or a scale out of range"
        / "lower --scale, --width or --height",
}
