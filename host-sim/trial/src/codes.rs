//! Errors of the virtual machine and of recorded setpoints.

truepath_ground::codes! {
    L001 => "a file of the virtual machine is not UTF-8"
        / "save the file as UTF-8",
    L002 => "a file of the virtual machine has a mistake"
        / "see docs/plant.md for the keys of a plant and their units",
    L003 => "the virtual machine cannot mill this contour"
        / "correct the plant or the job; the plant mills contours with real-world dimensions",
    L004 => "a probing program that the virtual machine cannot execute"
        / "give a program as truepath probe writes it; one that drives the ball into the wall must not run on a machine",
    R001 => "settings or rate of a replay out of range"
        / "record the setpoints at the rate of the machine's servo cycle; give settings within their ranges",
    R002 => "the image refuses to be armed for the replay"
        / "make the image again",
    R003 => "frame of the setpoints and options of the placement do not go together"
        / "say where the program lies on the machine exactly when the file holds machine coordinates",
    R004 => "a setting of the rewriter that does not exist, or a value out of range"
        / "give NAME=VALUE with a name and a value that the error lists",
    S001 => "the first line does not name the frame"
        / "say which coordinates the file holds: those of the program or those of the machine",
    S002 => "columns that are missing, unknown or given twice"
        / "name the columns in the second line of the file, the same number in every line",
    S003 => "a field that is no number, or out of range"
        / "correct the field",
    S004 => "times that do not rise evenly"
        / "replay needs every tick of the servo cycle: record without gaps, or cut the file at the gap",
    S005 => "fewer than two rows"
        / "record at least two ticks",
    S006 => "no rows follow the contour at its depth"
        / "record the whole pass; check the frame, --origin-mm and --rotation-deg, and that it is the program of the job",
    S007 => "no row of the pass has the spindle on"
        / "record a pass with the spindle on",
    S008 => "a program that does not go along the wall of the job"
        / "give a program of the same part, in the same coordinates and with the tool of the job",
}
