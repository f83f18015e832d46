//! Wrong programs with the exact message each must give.

use std::collections::BTreeSet;

use truepath_rs274::{ContourOptions, DeviceMemory, Program, read_contour};
use truepath_units::geometry::{Block, Curve, Point};
use truepath_units::{Offset, Real};

fn message(program: &[u8]) -> String {
    let curve = Curve::line(Point::from_nm(0, 0), Point::from_nm(1, 0)).expect("a line of 1 nm");
    let mut buffer = [Block { curve, s: Offset::ZERO, feed: Real::ZERO, line: 0 }; 4];
    match read_contour(&Program::new(program), &mut DeviceMemory::new().lend(), &mut buffer, &ContourOptions::default())
    {
        Ok(_) => panic!("accepted: {}", String::from_utf8_lossy(program)),
        Err(error) => error.to_string(),
    }
}

/// Program, message. `S` stands for a start that is in order: units, distances and a known place on line 1.
const TABLE: &[(&[u8], &str)] = &[
    (b"S\nG1 X1 ?", "line 2, column 7: G001: `?` is not part of a G-code block; remove it or put it in a comment"),
    (b"S\nG1 X1.2.3", "line 2, column 8: G001: `.` is not part of a G-code block; remove it or put it in a comment"),
    (
        b"S\nG1 X1\n\xe9",
        "line 3, column 1: G001: byte 0xE9 is not part of a G-code block; remove it or put it in a comment",
    ),
    (
        b"\xff\xfeG\x001",
        "line 1, column 1: G001: byte 0xFF is not part of a G-code block; remove it or put it in a comment",
    ),
    (b"S\nG1 X Y2", "line 2, column 4: G002: X has no number; write one directly after it"),
    (b"S\nG1 X--1", "line 2, column 4: G002: X has no number; write one directly after it"),
    (
        b"S\nG1 X1234567890123456789",
        "line 2, column 4: G003: the number of X has more than 18 digits before its point; is a point missing?",
    ),
    (b"S\nG1 X1 (to the wall", "line 2, column 7: G004: the comment opened by `(` is not closed in this line; add `)`"),
    (
        b"S\nG1 X1 (a) )",
        "line 2, column 11: G005: `)` without `(`; remove it, or the inner parentheses of a comment: LinuxCNC ends a comment at the first `)`",
    ),
    (
        b"S\n#1",
        "line 2, column 1: G006: `#` does not belong here; a parameter is set with `#1=…`, and an expression stands in [ ] behind a letter",
    ),
    (
        b"R1=5",
        "line 1, column 3: G006: `=` does not belong here; a parameter is set with `#1=…`, and an expression stands in [ ] behind a letter",
    ),
    (b"S\nG1 X#<width>", "line 2, column 5: G084: this parameter has no value yet; set it before it is used"),
    (b"S\n#6000=1", "line 2, column 1: G082: a parameter number lies between 1 and 5601; correct the number"),
    (b"S\n#[1.5]=1", "line 2, column 1: G083: a parameter number has no decimals; round it"),
    (b"S\nG1 X[1+2", "line 2, column 8: G163: the bracket opened by `[` is not closed in this line; add `]`"),
    (b"S\nG1 X[1+]", "line 2, column 8: G160: a number, a parameter, a function or `[` must stand here; write one"),
    (b"S\nG1 X[1 ? 2]", "line 2, column 8: G162: an operator or `]` must stand here, not `?`; correct the expression"),
    (
        b"S\nG1 X[SINUS[3]]",
        "line 2, column 6: G161: this is no function; ABS ACOS ASIN ATAN COS EXISTS EXP FIX FUP LN ROUND SIN SQRT TAN are, with their argument in [ ]",
    ),
    (b"S\nG1 X[4/[2-2]]", "line 2, column 7: G171: this divides by zero; correct the divisor"),
    (b"S\n#1=SQRT[1-2]", "line 2, column 4: G175: SQRT takes no negative numbers; correct the argument"),
    (b"S\n#1=ATAN[1]", "line 2, column 4: G169: ATAN takes two numbers; write ATAN[y]/[x]"),
    (
        b"S\no<finish> call",
        "line 2, column 1: G144: this subprogram is neither in the program nor in a file beside it; add it, or correct its name",
    ),
    (
        b"O100 sub",
        "line 1, column 1: G146: the end of this part of the program is missing; add the line that closes it",
    ),
    (
        b"S\no1 endif",
        "line 2, column 1: G147: nothing that this line could belong to is open here; add its beginning or remove the line",
    ),
    (b"S\no1 if 1", "line 2, column 1: G142: a condition or a number of repetitions stands in brackets; put it in [ ]"),
    (
        b"o1 sub\no1 call\no1 endsub\no1 call",
        "line 2, column 1: G149: more than 10 calls inside each other; does a subprogram call itself?",
    ),
    (
        b"S\nGOTO 10",
        "line 2, column 1: G154: this statement belongs to the macro language of another control; name the control's dialect, or write it in the language of this one",
    ),
    (
        b"G0 FASTER X1",
        "line 1, column 4: G008: text outside a comment; put it in ( ) if it is a remark, or post the program in plain G-code",
    ),
    (
        b"CYCLE800()",
        "line 1, column 1: G009: this is a word of Siemens' own language, of which some are read in dialect siemens; name that dialect, or write origins by G54 to G59 and cycles as moves, or post the program for ISO mode",
    ),
    (
        b"0 BEGIN PGM CORNER MM\n1 L X+0",
        "line 1, column 1: G009: this is a HEIDENHAIN conversational program (BEGIN PGM); name dialect heidenhain. Where that is named the firmware of a board says so, which does not read it: use the PC",
    ),
    (
        b"S\nG1 X1 E0.4",
        "line 2, column 7: G009: an E word: this is a 3D printer's program, or a number with an exponent; post it for a milling machine, with plain numbers",
    ),
    (
        b"S\nG1 X1e3",
        "line 2, column 6: G009: an E word: this is a 3D printer's program, or a number with an exponent; post it for a milling machine, with plain numbers",
    ),
    (b"%N_CORNER_MPF\nG1 X1", "line 1, column 2: G010: text after `%`; only a comment may follow it on its line"),
    (b"S\nG1 X1 X2", "line 2, column 7: G022: X is given twice in this block; keep one"),
    (b"N1 N2 G0", "line 1, column 4: G022: N is given twice in this block; keep one"),
    (
        b"S\nG1 N10 X1",
        "line 2, column 4: G023: `N` must stand at the start of its block, before the other words; move it there",
    ),
    (
        b"S\nG1 X1 /Y2",
        "line 2, column 7: G023: `/` must stand at the start of its block, before the other words; move it there",
    ),
    (b"G90 O0001", "line 1, column 5: G023: a program number stands alone at the start of its line; move it there"),
    (
        b"S\nG0 G1 X1",
        "line 2, column 4: G024: G0 and G1 exclude each other in one block; write them in two blocks or keep one",
    ),
    (b"S\nG90 G90", "line 2, column 5: G024: G90 is given twice in this block; keep one"),
    (
        b"S\nM3 M5",
        "line 2, column 4: G025: M3 and M5 exclude each other in one block; write them in two blocks or keep one",
    ),
    (b"S\nM30 M30", "line 2, column 5: G025: M30 is given twice in this block; keep one"),
    (
        b"S\nM7 M9",
        "line 2, column 4: G025: M7 and M9 exclude each other in one block; write them in two blocks or keep one",
    ),
    (
        b"S\nM10 M11 M12 M13 M14 M15 M16 M17 M18",
        "line 2, column 33: G026: more than 8 M codes in one block; write them in several blocks",
    ),
    (b"T1.5 M6", "line 1, column 1: G027: the number of T must be whole; remove its decimals"),
    (b"T-1", "line 1, column 1: G028: the number of T must not be negative; remove its sign"),
    (b"S\nG1 X1 F-100", "line 2, column 7: G028: the number of F must not be negative; remove its sign"),
    (b"S\nS-1", "line 2, column 1: G028: the number of S must not be negative; remove its sign"),
    (b"S\nG1 X1 R5", "line 2, column 7: G029: no code of this block uses R; remove it or add the code it belongs to"),
    (
        b"S\nG3 X10 Y0 I5 K1",
        "line 2, column 14: G029: no code of this block uses K; remove it or add the code it belongs to",
    ),
    (b"S\nG1 X1 P2", "line 2, column 7: G029: no code of this block uses P; remove it or add the code it belongs to"),
    (
        b"S\nG1 X34000000",
        "line 2, column 4: G030: X leads farther than 100 m from the origin; is a point missing, or the unit wrong?",
    ),
    (b"S\nG1 X1 F2500000000", "line 2, column 7: G030: the number of F is above 1000000000; is a point missing?"),
    (b"T99999999999", "line 1, column 1: G030: the number of T is too large; the limit is 4294967295"),
    (
        b"O1\nG21\nO2\nM30",
        "line 3, column 1: G031: program O2 begins before O1 has ended with M2 or M30; put each program in a file of its own",
    ),
    (
        b"S\nG48 X1",
        "line 2, column 1: G032: G48 is not known here, so what it does to the path cannot be told; remove it or post without it",
    ),
    (
        b"G65 P9810 X1",
        "line 1, column 1: G144: this subprogram is neither in the program nor in a file beside it; add it, or correct its name",
    ),
    (
        b"M98 P1000",
        "line 1, column 1: G144: this subprogram is neither in the program nor in a file beside it; add it, or correct its name",
    ),
    (
        b"G1.25 X1",
        "line 1, column 1: G041: no G code has this number; G codes go from G0 to G999 with at most one decimal",
    ),
    (
        b"G-1 X1",
        "line 1, column 1: G041: no G code has this number; G codes go from G0 to G999 with at most one decimal",
    ),
    (
        b"G21 X10",
        "line 1, column 5: G042: axis words, but no motion is active; write G0, G1, G2 or G3 in this block or before it",
    ),
    (
        b"G21 G90\nG80 X10",
        "line 2, column 5: G042: axis words, but no motion is active; write G0, G1, G2 or G3 in this block or before it",
    ),
    (
        b"S\nG2 G53 X1 I1",
        "line 2, column 4: G043: a move in machine coordinates (G53) must be G0 or G1, not an arc; write G0 or G1",
    ),
    (b"G4", "line 1, column 1: G044: G4 has no time; add P or X"),
    (
        b"G21 G91 G1 X1 F10",
        "line 1, column 12: G045: the position of X is not known here (start of the program, G28, G53, or a new work or tool offset); give it once with G90 first",
    ),
    (
        b"S\nG28 X0 Y0\nG91 G0 X1",
        "line 3, column 8: G045: the position of X is not known here (start of the program, G28, G53, or a new work or tool offset); give it once with G90 first",
    ),
    (
        b"S\nG28\nG2 X1 Y1 I1",
        "line 3, column 1: G045: the position of X is not known here (start of the program, G28, G53, or a new work or tool offset); give it once with G90 first",
    ),
    (
        b"S\nG2 X10 Y0",
        "line 2, column 1: G050: this arc has no centre; add I and J, or R (or write G1 if it should be a line)",
    ),
    (b"S\nG2 X10 Y0 I5 R5", "line 2, column 14: G051: this arc has R as well as I or J; keep one of the two"),
    (b"S\nG90.1 G2 X10 Y0 I5", "line 2, column 1: G052: the absolute centre (G90.1) has no J; add it"),
    (
        b"S\nG2 R5",
        "line 2, column 4: G053: an arc with R cannot be a full circle: its end is its start; give the centre with I and J",
    ),
    (
        b"S\nG2 X0 Y0 R5",
        "line 2, column 10: G053: an arc with R cannot be a full circle: its end is its start; give the centre with I and J",
    ),
    (
        b"S\nG2 X10 Y0 R4.9",
        "line 2, column 11: G054: radius 4.9 mm cannot reach an end 10 mm away; it must be at least half of that",
    ),
    (
        b"S\nG2 X10 Y0 I5.5",
        "line 2, column 1: G055: the start of this arc is 5.5 mm from its centre but the end 4.5 mm; correct the end, I or J, or check G90.1/G91.1",
    ),
    (
        b"S\nG2 X10 Y0 I0 J0",
        "line 2, column 1: G056: the centre of this arc coincides with its start or end; correct I and J",
    ),
    (
        b"",
        "line 1, column 1: G070: no cutting move (G1, G2, G3) in X or Y at constant Z found; there is no contour to correct",
    ),
    (
        b"S\nG0 X10\nM30",
        "line 1, column 1: G070: no cutting move (G1, G2, G3) in X or Y at constant Z found; there is no contour to correct",
    ),
    (
        b"S\nG1 X1\nG0 Z1\nG1 X2\nY2\nG0 X0\nG1 Y5\nM2",
        "line 4, column 1: G071: 3 contours found, the first two on line 2 and lines 4-5; give a program that holds the finishing contour alone",
    ),
    (
        b"S\nG1 X1\nX2\nX3\nX4\nX5\nM2",
        "line 6, column 1: G072: the contour has more than 4 blocks, which is what the buffer holds; choose fewer lines, or split the program",
    ),
    (
        b"G21 G90 G1 X5 Y5 F100",
        "line 1, column 1: G073: this cutting move starts at an unknown X; give it with G0 and G90 before (after G28, G53 or a new offset as well)",
    ),
    (
        b"G21 G0 X0 Y0\nG1 X5 F100\nM2",
        "line 2, column 1: G074: the Z of this contour is not known; give it with G90 before the contour, after any tool change, G43, G28 or G53",
    ),
    (
        b"S\nG0 Z5\nG43 H1\nG1 X5\nM2",
        "line 4, column 1: G074: the Z of this contour is not known; give it with G90 before the contour, after any tool change, G43, G28 or G53",
    ),
    (
        b"S\nG41 G1 X5\nG42 X10\nM2",
        "line 2, column 1: G075: the contour is cut with G41 in one part and G42 in another; a wall has one side",
    ),
    (
        b"S\nG17.1",
        "line 2, column 1: G034: G17.1 selects a plane of the axes U, V, W, whose arcs are not computed; select G17, G18 or G19",
    ),
    (b"S\nG51 X1 P2", "line 2, column 1: G033: G51 is not computed; post the program without it"),
    (b"S\nG92", "line 2, column 1: G061: G92 has no axis word; add the axes it is meant for"),
    (b"S\nG52 G90", "line 2, column 1: G061: G52 has no axis word; add the axes it is meant for"),
    (
        b"S\nG92 X1 G1 Y1",
        "line 2, column 8: G060: G92 and G1 both use the axis words of this block; write them in two blocks",
    ),
    (b"S\nG10 L2 P10 X1", "line 2, column 8: G062: P must be a whole number from 0 to 9 here; correct it"),
    (b"S\nG10 P1 X1", "line 2, column 1: G090: G10 has no L; add it to this block"),
    (b"S\nG10 L20 X1", "line 2, column 1: G090: G10 has no P; add it to this block"),
    (b"S\nG10 L3 P1", "line 2, column 5: G062: L must be a whole number from 0 to 20 here; correct it"),
    (b"S\nG81 X1 Z-5", "line 2, column 1: G090: G81 has no R; add it to this block"),
    (b"S\nG81 X1 R1", "line 2, column 1: G090: G81 has no Z; add it to this block"),
    (b"S\nG82 X1 Z-5 R1", "line 2, column 1: G090: G82 has no P; add it to this block"),
    (b"S\nG83 X1 Z-5 R1", "line 2, column 1: G090: G83 has no Q; add it to this block"),
    (
        b"S\nG83 X1 Z-5 R1 Q0.00001",
        "line 2, column 1: G094: Q asks for more than 100000 pecks in one hole; is it too small?",
    ),
    (
        b"S\nG81 X1 Z5 R1",
        "line 2, column 1: G091: R at 1 mm is below the bottom of the hole at 5 mm; correct R or the depth",
    ),
    (b"S\nG81 X1 Z-5 R1 L0", "line 2, column 15: G093: L0 repeats the cycle no times; remove L or give at least 1"),
    (b"S\nG81", "line 2, column 1: G061: G81 has no axis word; add the axes it is meant for"),
    (
        b"S\nG87 X1 Z-5 R1 I1 J1 K3",
        "line 2, column 1: G092: K leads to 3 mm, which is not between the bottom at -5 mm and R at 1 mm; correct K",
    ),
    (b"S\nG87 X1 Z-5 R1 I1 K0", "line 2, column 1: G090: G87 has no J; add it to this block"),
    (
        b"S\nG76 P1 Z-5 I-1 J1 K2",
        "line 2, column 1: G067: G76 belongs to a lathe, whose moves are not computed; post the program for a mill",
    ),
    (
        b"S\nG33 Z1 K1",
        "line 2, column 1: G067: G33 belongs to a lathe, whose moves are not computed; post the program for a mill",
    ),
    (
        b"S\nG7",
        "line 2, column 1: G067: G7 belongs to a lathe, whose moves are not computed; post the program for a mill",
    ),
    (
        b"S\nG70",
        "line 2, column 1: G067: G70 is a cycle in this dialect, and cycles of a lathe and rows of holes are not computed; where it stands for inches or millimetres, name the dialect (fanuc, siemens or mach), or write G20 or G21",
    ),
    (b"S\nG33.1 Z-5", "line 2, column 1: G090: G33.1 has no K; add it to this block"),
    (b"S\nG38.2", "line 2, column 1: G061: G38.2 has no axis word; add the axes it is meant for"),
    (
        b"S\nG38.2 X0",
        "line 2, column 1: G101: the probing move has no length; give a target away from the present place",
    ),
    (b"S\nG5 X1 I1 J1", "line 2, column 1: G090: G5 has no P; add it to this block"),
    (b"S\nG5 X1 P1 Q1", "line 2, column 1: G090: G5 has no I; add it to this block"),
    (b"S\nG5.1 X1", "line 2, column 1: G090: G5.1 has no I; add it to this block"),
    (
        b"S\nG18 G5.1 X1 I1 J1",
        "line 2, column 1: G096: G5.1 is a spline in X and Y only; select G17 and remove the words of other axes",
    ),
    (
        b"S\nG5.1 X1 Z1 I1 J1",
        "line 2, column 1: G096: G5.1 is a spline in X and Y only; select G17 and remove the words of other axes",
    ),
    (b"S\nG5.3", "line 2, column 1: G097: G5.3 ends a spline, but G5.2 has not begun one; add G5.2 before it"),
    (
        b"S\nG5.2 X1 Y1 P1\nG1 X2",
        "line 3, column 1: G098: the spline begun by G5.2 is not ended; write G5.3 before this block",
    ),
    (
        b"S\nG5.2 X1 Y1 P1\nG5.3",
        "line 3, column 1: G099: the spline has 2 control points with its start, but L3 needs at least 3; add points or give a lower L (2 to 8)",
    ),
    (b"S\nG5.2 X1 Y1", "line 2, column 1: G090: G5.2 has no P; add it to this block"),
    (b"S\nG5.2 X1 P1", "line 2, column 1: G090: G5.2 has no Y; add it to this block"),
    (b"S\nM62", "line 2, column 1: G063: M62 has no P; add it to this block"),
    (b"S\nM66 L0", "line 2, column 1: G063: M66 has no P; add it to this block"),
    (b"S\nM66 P0 L3", "line 2, column 1: G066: M66 waits for an input without a time; add Q"),
    (b"S\nM67 Q1", "line 2, column 1: G063: M67 has no E; add it to this block"),
    (b"S\nM61", "line 2, column 1: G063: M61 has no Q; add it to this block"),
    (b"M98 L2", "line 1, column 1: G063: M98 has no P; add it to this block"),
    (b"S\nM72", "line 2, column 1: G048: M72 restores modes, but M70 or M73 has not saved any here; add M70 before it"),
    (
        b"S\nG95 G1 X1 F0.1",
        "line 2, column 1: G068: feed per revolution (G95) without a spindle speed; give S before it",
    ),
    (b"S\nG96", "line 2, column 1: G090: G96 has no S; add it to this block"),
    (
        b"S\nG93 G94 G1 X1",
        "line 2, column 5: G024: G93 and G94 exclude each other in one block; write them in two blocks or keep one",
    ),
    (b"S\nG2 X10 Y0 I5 P0", "line 2, column 14: G062: P must be a whole number from 1 to 10000 here; correct it"),
    (
        b"S\nG18 G2 X10 J5",
        "line 2, column 1: G050: this arc has no centre; add I and J, or R (or write G1 if it should be a line)",
    ),
    (b"S\nG54.1", "line 2, column 1: G090: G54.1 has no P; add it to this block"),
    (b"S\nG43.2", "line 2, column 1: G090: G43.2 has no H; add it to this block"),
    (b"S\nG1 X1 A90 A91", "line 2, column 11: G022: A is given twice in this block; keep one"),
];

fn with_start(program: &[u8]) -> Vec<u8> {
    match program.strip_prefix(b"S\n") {
        Some(rest) => [b"G21 G90 G17 G0 X0 Y0 Z0 F100\n", rest].concat(),
        None => program.to_vec(),
    }
}

#[test]
fn every_wrong_program_gives_its_message() {
    for (program, expected) in TABLE {
        assert_eq!(message(&with_start(program)), *expected, "for {}", String::from_utf8_lossy(program));
    }
}

#[test]
fn every_kind_of_error_is_in_the_table() {
    let codes: BTreeSet<&str> = TABLE.iter().filter_map(|(_, text)| text.split(": ").nth(1)).collect();
    assert_eq!(codes.len(), 74, "{codes:?}");
}
