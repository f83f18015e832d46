//! Errors of pockets compensated without a probe.

truepath_ground::codes! {
    D001 => "the job has no cutter that can bend: `stickout_mm` and `material` are missing"
        / "add stickout_mm and material = \"HSS\" or \"carbide\" to [tool]; flute_length_mm and shank_diameter_mm are optional",
    D002 => "the deflection is larger than what there is to cut"
        / "shorten the stick-out, take a thicker cutter, or cut less deep or slower; check the force coefficients",
    D003 => "force and deflection do not settle"
        / "shorten the stick-out, take a thicker cutter, or cut less deep; check the force coefficients",
    D004 => "a tolerance out of 0.000001 to 1 mm"
        / "give --tolerance or tolerance_mm in [pocket] as half of the width of the band the wall may lie in",
    D005 => "the path is too long for the memory of the slot"
        / "divide the program, or name a part of it with [[feature]]",
    D006 => "the shift is beyond the clamp of the job"
        / "raise clamp_mm in [correct] if that is right, or use a stiffer cutter",
}
