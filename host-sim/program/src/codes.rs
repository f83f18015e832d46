//! Errors of programs to be corrected, and of the tables of the machine that reads them.

truepath_ground::codes! {
    P001 => "the program is corrected already"
        / "correct the original program; its CRC-32 is in the comment",
    P002 => "no move that can be displaced leads to the start of the contour"
        / "give the contour's start with G0 X Y before it",
    P003 => "the move at the end of the contour cannot be displaced, or the program computes with its present position"
        / "use --route coprocessor, or leave the contour on a straight move or a G17 arc",
    P004 => "a line of the contour is executed several times, or stands in another file"
        / "use --route coprocessor, or post the program without subprograms and loops",
    P005 => "the origin is set at the displaced end of the contour"
        / "set the origin elsewhere, or use --route coprocessor",
    P006 => "a line of the contour cannot be divided or given another feed"
        / "use --route coprocessor, or post the line in a plain form",
    P007 => "the compensation of the control (G41, G42) cannot be taken out"
        / "use --route coprocessor, or post the program with the path of the cutter's centre",
    P008 => "the corrected program is not proved to do what the original does beside the contour"
        / "use --route coprocessor; nothing was written. The program does something the writer does not know: please send it in",
    P009 => "the cut along the contour cannot be written again as several passes"
        / "give the contour a way down of its own, leads and a way up behind it, with nothing else on its lines",
    P010 => "a pass that cannot run against the direction of the program"
        / "let it run as the program does, or give the contour a straight lead-in and a lead-out that ends off the wall",
    P011 => "a change of the cutter that cannot be written as the program writes its own"
        / "post the program with that cutter and plan its job, or write a choice of the program's cutter",
    T001 => "a line of the tool table that cannot be read"
        / "write rows like T1 P1 X0 Z12.98 D3.175 ;comment",
    T002 => "a line of the parameter file that cannot be read"
        / "write rows like 5221 12.500000",
}
