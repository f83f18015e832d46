//! Errors of five-axis programs.

truepath_ground::codes! {
    A001 => "a line that is too long"
        / "check that this is a program, and that its lines end",
    A002 => "an axis stands twice in one block"
        / "remove one of them, or write two blocks",
    A003 => "an axis that the machine file does not have"
        / "name the axis in the machine file, or take the file of the machine the program is for",
    A004 => "axis words without a motion"
        / "write the motion that the control has at power-up into the program",
    A005 => "a place beyond the farthest"
        / "correct the number",
    A006 => "a cutting block without F under G93"
        / "add the F, or G94 where the inverse time ends",
    A007 => "blocks on both sides of a %"
        / "remove the text in front of the %, or the % that closes too early",
    A008 => "a file without a block"
        / "check that this is a program of G1 moves",
    A009 => "a move that cannot be brought within the tolerance"
        / "correct it, or add --partial to leave such moves as they are",
    A010 => "a tolerance out of range"
        / "give --tolerance 0.005, or what the part needs",
    A011 => "a program with loops, calls or computed places that is too large, or whose lines cannot be rewritten in place"
        / "divide the program into plain files, add --unroll to have it written out, or --partial to leave it as it is",
    A012 => "a step that cannot be written out as a plain line"
        / "write this part of the program out by hand, or leave it to the control with --partial",
    A014 => "a surface is named and the machine file has no ball end, or its normal has no direction"
        / "add ball_radius_mm to the machine file, give --normal 0,0,1 for a floor, or leave --normal out",
}
