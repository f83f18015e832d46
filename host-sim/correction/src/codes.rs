//! Errors of corrections, of learning from parts and of verification programs.

truepath_ground::codes! {
    K003 => "the two passes of `truepath split` do not belong together"
        / "give the first-pass.toml that truepath split wrote for this job",
    K007 => "a planned process of a cutter of another diameter, or of another cutter for the coprocessor"
        / "post the program with that cutter and plan its job, or write a choice of the program's cutter; --tolerance and [plan] decide which there are",
    P020 => "an inside corner that the path of the first pass would have to cut across"
        / "give the path an arc there (truepath fillet; a lead too meets the wall along it), or leave less stock before this pass",
    P021 => "another cut of the tool comes nearer to the finishing path than half of the allowance"
        / "let one feature hold all passes along the wall; otherwise correct allowance_mm",
    P022 => "passes of a plan that the coprocessor cannot be armed for one after the other"
        / "write the program route (--route program), or say dialect = \"linuxcnc\" in the job if that is the control",
    P023 => "no sharp inside corner that an arc has room in"
        / "nothing has to be done here: correct the job as it is; a smaller --corner-radius needs less room",
    Q001 => "no history of corrections, or one of another version"
        / "name the folder that truepath correct or truepath learn wrote the correction of this part into",
    Q002 => "the history belongs to another job, program or contour"
        / "correct again with truepath correct, and learn from there",
    Q003 => "the points are those of a part that was learned from already"
        / "touch the part that was cut with the correction of --from and give that file",
    Q004 => "the program or the image of the history is missing or was changed"
        / "the part must be cut with the correction of this folder, unchanged; put the file back, or correct again",
    Q005 => "the next correction would replace the one that it is learned from"
        / "name another folder with -o: the correction of each part is kept",
    Q006 => "a job that cannot learn: another law, or feeds of its own"
        / "set law = \"model\" and leave [feed] out, or correct the next part anew",
    Q007 => "the part was cut without the correction"
        / "touch the part that the corrected program has cut; if this is that part, the control ran the original program, or the coprocessor was not armed",
    Q008 => "the part was cut with a correction already"
        / "learn from it with truepath learn and name the folder of its correction with --from; if the program itself has cut this part, give another folder with -o",
    Q009 => "the points do not fit the job"
        / "the error names what was tried and what explains them; correct that line of the job, or touch again",
    Q010 => "the probe file says nothing of a contour that was cut with a correction"
        / "touch every contour that is corrected; truepath probe writes one program for all of them",
    V001 => "an option of the verification program is out of range"
        / "give the option a value in the range that the error names",
    V002 => "the ball has no room in the engaged depth"
        / "use a smaller ball, or a smaller --floor-clearance where there is no floor near the wall",
    V003 => "the space in front of the wall is too narrow for the ball"
        / "use a smaller ball or a smaller --clearance, or say with --free-width how much is free before the wall",
    V004 => "no place of the contour can be touched"
        / "use a smaller ball or a smaller --clearance, or probe by hand",
    V005 => "the control cannot do what the verification program needs"
        / "use another --dialect, or cut and probe in one of G54 to G59",
    V006 => "G52 or G92 has shifted the origin when the contour is cut"
        / "put the shift into the work offset",
    V007 => "no dimension of the cut can be taken by hand"
        / "name an instrument that reaches farther (--instrument, --reach), touch the wall with a probe, or measure from a face: kind = \"distance\" in a file of your own (docs/dimensions.md)",
}
