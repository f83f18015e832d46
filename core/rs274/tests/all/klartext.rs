//! HEIDENHAIN's conversational language: what each block does, what is refused with its place, and that nothing written
//! in it makes the reader panic. Places are those of the blocks themselves, or follow from tan and √2 computed outside of
//! this crate.

use proptest::prelude::*;
use truepath_rs274::{
    Axes, Canon, CompensationBy, Dialect, GcodeError, HostMemory, Interpreter, Options, Units, WarningKind, Warnings,
};
use truepath_units::{Offset, Position};

/// A move: `T`, `F`, `L` (clockwise) or `R`, its line, its end in micrometres (X, Y, Z), its centre.
type Move = (char, u32, [i64; 3], [i64; 2]);

#[derive(Debug, Default)]
struct Read {
    moves: Vec<Move>,
    rest: Vec<String>,
    warnings: Warnings,
    end: Option<u32>,
}

fn um(place: Option<Position>) -> i64 {
    place.map_or(i64::MAX, |p| (p.nm() + 500 * p.nm().signum()) / 1000)
}

fn run(program: &str, options: Options<'_>) -> Result<Read, GcodeError> {
    let mut read = Read::default();
    let options = Options { dialect: Dialect::Heidenhain, ..options };
    let mut memory = Box::new(HostMemory::new());
    let summary = Interpreter::new(options).run(program.as_bytes(), &mut memory.lend(), &mut |event| {
        let at = |to: Axes| [um(to.x), um(to.y), um(to.z)];
        let line = event.source.line;
        match *event.canon {
            Canon::Traverse { to, .. } => read.moves.push(('T', line, at(to), [0; 2])),
            Canon::Feed { to, .. } => read.moves.push(('F', line, at(to), [0; 2])),
            Canon::Arc { to, centre, counter_clockwise, .. } => {
                let kind = if counter_clockwise { 'R' } else { 'L' };
                read.moves.push((kind, line, at(to), [um(Some(centre.x)), um(Some(centre.y))]));
            }
            Canon::Comment(span) => {
                read.rest.push(format!("{line}: ({})", String::from_utf8_lossy(span.of(event.text))));
            }
            other => read.rest.push(format!("{line}: {other:?}")),
        }
        Ok(())
    })?;
    (read.warnings, read.end) = (summary.warnings, summary.end);
    Ok(read)
}

/// A program of three lines that lead to X0 Y0 Z-5, and then these.
fn program(blocks: &str) -> String {
    format!("BEGIN PGM T MM\nL X+0 Y+0 Z+50 R0 FMAX\nL Z-5 R0 F300\n{blocks}\nEND PGM T MM\n")
}

fn with(blocks: &str, options: Options<'_>) -> Vec<Move> {
    let text = program(blocks);
    let mut read = run(&text, options).unwrap_or_else(|e| panic!("{text}{e}"));
    read.moves.retain(|m| m.1 > 3);
    read.moves
}

fn moves(blocks: &str) -> Vec<Move> {
    with(blocks, Options::default())
}

/// The places of the moves, mm.
fn ends(blocks: &str) -> Vec<(char, [f64; 2])> {
    moves(blocks).iter().map(|m| (m.0, [m.2[0] as f64 / 1e3, m.2[1] as f64 / 1e3])).collect()
}

fn refused(blocks: &str) -> (u32, u32, &'static str) {
    let error = run(&program(blocks), Options::default()).expect_err(blocks);
    (error.line, error.column, error.kind.code())
}

const R5: CompensationBy = CompensationBy::Radius(Offset::from_um(5_000));

#[test]
fn lines_are_absolute_or_incremental_word_by_word_and_fmax_counts_for_its_block() {
    let read = moves("L X+10 IY-2,5 F500\nL IX+1.25\n12 L Y+7 Z+2 R0 F MAX M8\nL X+0 Y+0\nIX+3 F200");
    let expected: [Move; 5] = [
        ('F', 4, [10_000, -2_500, -5_000], [0; 2]),
        ('F', 5, [11_250, -2_500, -5_000], [0; 2]),
        ('T', 6, [11_250, 7_000, 2_000], [0; 2]),
        ('F', 7, [0, 0, 2_000], [0; 2]),
        ('F', 8, [3_000, 0, 2_000], [0; 2]),
    ];
    assert_eq!(read, expected);
}

#[test]
fn the_unit_of_the_program_counts_for_places_and_feeds() {
    let text = "BEGIN PGM INCHES INCH\nL X+1 Y+0,5 Z+0 R0 FMAX F10\nEND PGM INCHES INCH\n";
    let read = run(text, Options::default()).unwrap();
    assert_eq!(read.moves, [('T', 2, [25_400, 12_700, 0], [0; 2])]);
    assert!(read.rest.iter().any(|r| r.contains("FeedRate(Real") || r.contains("FeedRate(254")), "{:?}", read.rest);
    assert!(read.rest.iter().any(|r| r.contains(&format!("{:?}", Units::Inches))), "{:?}", read.rest);
    assert_eq!(read.warnings.as_slice(), []);
}

#[test]
fn arcs_go_about_the_pole_by_radius_or_tangent_to_what_comes_before() {
    let read = moves(
        "CC X+10 Y+0\nC X+20 Y+0 DR-\nCR X+30 Y+10 R+10 DR+\nCT X+40 Y+20\nCC IX+5 IY+0\nC DR-\nCR X+40 Y+0 R-12 DR+",
    );
    // The arc by radius ends in direction (0, 1); the arc tangent to it turns about (40, 10).
    assert_eq!(read[0], ('L', 5, [20_000, 0, -5_000], [10_000, 0]));
    assert_eq!(read[1], ('R', 6, [30_000, 10_000, -5_000], [20_000, 10_000]));
    assert_eq!(read[2], ('L', 7, [40_000, 20_000, -5_000], [40_000, 10_000]));
    assert_eq!(read[3], ('L', 9, [40_000, 20_000, -5_000], [45_000, 20_000]));
    // The long way round with a negative radius: √(12² − 10²) = 6.633 beside the chord, on its left.
    assert_eq!(read[4], ('R', 10, [40_000, 0, -5_000], [33_367, 10_000]));
}

#[test]
fn a_tangent_arc_straight_ahead_is_a_line_and_one_without_a_line_before_it_is_refused() {
    assert_eq!(ends("L X+10 F100\nCT X+20"), [('F', [10.0, 0.0]), ('F', [20.0, 0.0])]);
    assert_eq!(refused("CT X+20 Y+3"), (4, 1, "G188"));
    assert_eq!(refused("L X+10 F100\nCT X+5"), (5, 1, "G188"));
}

#[test]
fn polar_blocks_lead_by_distance_and_angle_and_cp_turns_as_often_as_its_angle() {
    let read =
        moves("CC X+0 Y+0\nLP PR+20 PA+90 F100\nLP IPA-90\nCP PA+180 DR+\nCTP PR+30 PA+180\nCP IPA+810 IZ+9 DR+");
    assert_eq!(read[0], ('F', 5, [0, 20_000, -5_000], [0; 2]));
    assert_eq!(read[1], ('F', 6, [20_000, 0, -5_000], [0; 2]));
    assert_eq!(read[2], ('R', 7, [-20_000, 0, -5_000], [0, 0]));
    // It comes along (0, -1): half a circle about the middle.
    assert_eq!(read[3], ('L', 8, [-30_000, 0, -5_000], [-25_000, 0]));
    assert_eq!(read[4], ('R', 9, [0, -30_000, 4_000], [0, 0]));
    assert_eq!(refused("CC X+0 Y+5\nCP IPA-90 DR+"), (5, 4, "G186"));
    assert_eq!(refused("LP PR+5 PA+0"), (4, 1, "G187"));
}

#[test]
fn roundings_and_chamfers_cut_the_corner_of_the_lines_around_them_and_belong_to_the_first() {
    assert_eq!(
        moves("L X+50 F100\nRND R10\n; between\nL Y+40"),
        [
            ('F', 4, [40_000, 0, -5_000], [0; 2]),
            ('R', 4, [50_000, 10_000, -5_000], [40_000, 10_000]),
            ('F', 7, [50_000, 40_000, -5_000], [0; 2]),
        ]
    );
    assert_eq!(
        moves("FN 0: Q5 = +4\nL X+50 F100\n; first\n* - second\nCHF Q5\nL Y+40")[..2],
        [('F', 5, [46_000, 0, -5_000], [0; 2]), ('F', 5, [50_000, 4_000, -5_000], [0; 2])]
    );
    let read = run(&program("L X+50 F100\nRND R10 F50\nL Y+40"), Options::default()).unwrap();
    assert_eq!(
        read.warnings.as_slice().iter().map(|w| (w.kind, w.line)).collect::<Vec<_>>(),
        [(WarningKind::FeedOfCorner, 5)]
    );
}

#[test]
fn what_is_no_corner_of_two_lines_is_refused_at_its_own_line() {
    assert_eq!(refused("RND R5\nL X+10 F100"), (4, 5, "G058"));
    assert_eq!(refused("L X+9 F100\nM8\nRND R5\nL Y+10"), (6, 1, "G058"));
    assert_eq!(refused("L X+10 F100\n  RND R5\nCR X+20 Y+10 R+10 DR+"), (5, 7, "G058"));
    assert_eq!(refused("CR X+10 Y+10 R+10 DR+\nRND R5\nL Y+20"), (5, 5, "G058"));
    assert_eq!(refused("L X+4 F100\nRND R5\nL Y+20"), (5, 5, "G059"));
    assert_eq!(refused("L X+4 F100\nRND\nL Y+20"), (5, 1, "G182"));
}

#[test]
fn radius_compensation_begins_and_ends_beside_the_contour() {
    let options = Options { compensation: R5, ..Options::default() };
    let read = with("L X+0 Y+20 RL F100\nL Y+50\nL X+30\nL X+30 Y+80 R0\nL X+0", options);
    let places: Vec<_> = read.iter().map(|m| (m.0, [m.2[0], m.2[1]])).collect();
    assert_eq!(
        places,
        [
            ('F', [-5_000, 20_000]),
            ('F', [-5_000, 50_000]),
            ('L', [0, 55_000]),
            ('F', [30_000, 55_000]),
            ('F', [30_000, 80_000]),
            ('F', [0, 80_000]),
        ]
    );
    // The cutter is larger by DR.
    let larger = with("TOOL CALL 3 Z S2000 DR+0.5\nL Z-5 FMAX\nL X+0 Y+20 RL F100\nL Y+50\nL X+0 Y+80 R0", options);
    assert_eq!(larger[1].2[0], -5_500);
    // And the path of the centre where RL holds wear only.
    assert_eq!(ends("L X+0 Y+20 RL F100\nL Y+50 R0")[0], ('F', [0.0, 20.0]));
}

#[test]
fn approach_and_departure_lead_tangent_along_the_path_of_the_centre() {
    let options = Options { compensation: R5, ..Options::default() };
    let of = |approach: &str, departure: &str| {
        let text = format!("L X-30 Y-20 R0 FMAX\n{approach}\nL Y+50\nL X+40\n{departure}\nL Z+50 R0 FMAX");
        let read = with(&text, options);
        let places: Vec<_> = read.iter().map(|m| (m.0, m.1, [m.2[0], m.2[1]])).collect();
        (places[1..3].to_vec(), places[places.len() - 3..places.len() - 1].to_vec())
    };
    // The contour begins at (0, 0) along +Y, the cutter stands at (-5, 0); it ends at (40, 50) along +X: (40, 55).
    let (begin, end) = of("APPR LT X+0 Y+0 LEN12 RL F200", "DEP LT LEN8");
    assert_eq!(begin, [('T', 5, [-5_000, -12_000]), ('F', 5, [-5_000, 0])]);
    assert_eq!(end, [('F', 7, [40_000, 55_000]), ('F', 8, [48_000, 55_000])]);
    let (begin, end) = of("APPR LN X+0 Y+0 LEN+12 RL F200", "DEP LN LEN+8");
    assert_eq!(begin, [('T', 5, [-17_000, 0]), ('F', 5, [-5_000, 0])]);
    assert_eq!(end[1], ('F', 8, [40_000, 63_000]));
    let (begin, end) = of("APPR CT X+0 Y+0 CCA90 R+10 RL F200", "DEP CT CCA180 R+4");
    assert_eq!(begin, [('T', 5, [-15_000, -10_000]), ('R', 5, [-5_000, 0])]);
    assert_eq!(end[1], ('R', 8, [40_000, 63_000]));
    // From (-30, -20), the tangent to the circle of 10 about (-15, 0) touches it at (-10.385, -8.871).
    let (begin, end) = of("APPR LCT X+0 Y+0 R10 RL F200", "DEP LCT X+60 Y+65 R10");
    assert_eq!((begin[0].0, begin[0].1, begin[1]), ('T', 5, ('R', 5, [-5_000, 0])));
    let [x, y] = begin[0].2.map(|v| v as f64 / 1e3);
    assert!(((x + 15.0).hypot(y) - 10.0).abs() < 2e-3, "{x} {y}");
    assert!(((x + 15.0) * (x + 30.0) + y * (y + 20.0)).abs() < 0.05, "tangent {x} {y}");
    assert!(x > -15.0 && y < 0.0);
    // About (40, 65): straight up from (50, 65) is not the way; the line is tangent and ends at (60, 65).
    assert_eq!(end[1], ('F', 8, [60_000, 65_000]));
    let [x, y] = end[0].2.map(|v| v as f64 / 1e3);
    assert!(((x - 40.0).hypot(y - 65.0) - 10.0).abs() < 2e-3 && x > 40.0 && y < 65.0, "{x} {y}");
}

#[test]
fn leads_that_cannot_be_reached_or_lead_to_nothing_are_refused() {
    assert_eq!(refused("APPR LCT X+8 Y+0 R10 RL F100\nL Y+50"), (4, 1, "G190"));
    assert_eq!(refused("APPR CT X+8 Y+0 R10 RL F100\nL Y+50"), (4, 1, "G190"));
    assert_eq!(refused("APPR XT X+8 Y+0 R10 RL F100\nL Y+50"), (4, 1, "G191"));
    assert_eq!(refused("APPR LT X+8 Y+0 LEN5 RL F100\nL Z+50 FMAX"), (5, 1, "G189"));
    assert_eq!(refused("DEP LT LEN5"), (4, 1, "G188"));
}

#[test]
fn labels_are_called_and_parts_are_repeated() {
    let read = moves(
        "CALL LBL 7\nLBL 1\nL IX+1 F100\nCALL LBL 1 REP 2/2\nL Y+9\nM30\nLBL 7\nL IY+2 F50\nCALL LBL \"in\"\nLBL 0\nLBL \"in\"\nL IY+1\nLBL 0",
    );
    let lines: Vec<_> = read.iter().map(|m| (m.1, m.2[0], m.2[1])).collect();
    assert_eq!(
        lines,
        [(11, 0, 2_000), (15, 0, 3_000), (6, 1_000, 3_000), (6, 2_000, 3_000), (6, 3_000, 3_000), (8, 3_000, 9_000)]
    );
    // A repetition inside another begins anew each time.
    let inner = "LBL 1\nL IY+1 F100\nLBL 2\nL IX+1\nCALL LBL 2 REP 1\nCALL LBL 1 REP 2";
    let last = *moves(inner).last().unwrap();
    assert_eq!((moves(inner).len(), last.2), (9, [6_000, 3_000, -5_000]));
    assert_eq!(refused("CALL LBL 9"), (4, 10, "G195"));
    assert_eq!(refused("CALL LBL"), (4, 1, "G196"));
    assert_eq!(refused("LBL 1\nCALL LBL 1"), (5, 1, "G149"));
}

#[test]
fn q_parameters_are_computed_and_compared() {
    for (formula, value) in [
        ("FN 0: Q1 = +5", 5.0),
        ("FN 0:Q1=-Q2", -3.0),
        ("FN 1: Q1 = -Q2 + -5", -8.0),
        ("FN 2: Q1 = +10 - +Q2", 7.0),
        ("FN 3: Q1 = +Q2 * +2", 6.0),
        ("FN 4: Q1 = +9 DIV +Q2", 3.0),
        ("FN 5: Q1 = SQRT 4", 2.0),
        ("FN 6: Q1 = SIN +30", 0.5),
        ("FN 8: Q1 = +Q2 LEN +4", 5.0),
        ("FN 13: Q1 = +1 ANG -1", 135.0),
        ("Q1 = Q2 * (1 + 2) - 4 / 2", 7.0),
        ("Q1 = -Q2 ^ 2", 9.0),
        ("Q1 = 2 + 3 * 2 ^ 2", 14.0),
        ("Q1 = SQ 3 + ABS ( - 2 )", 11.0),
        ("Q1 = INT 2.7 + FRAC 0.5 - NEG 1 - SGN -4", 4.5),
        ("Q1 = 10 * SIN 90 + ATAN 1 / 45", 11.0),
        ("QL1 = 4  ; kept apart from Q1\nQR1 = QL1 / 8\nQ1 = QL1 + QR1", 4.5),
    ] {
        let blocks = format!("Q2 = 3\n{formula}\nL X+Q1 Y-Q1 F100");
        let read = moves(&blocks);
        let expected = (value * 1e3) as i64;
        assert_eq!([read[0].2[0], read[0].2[1]], [expected, -expected], "{formula}");
    }
    let looped = "Q1 = 0\nLBL 3\nQ1 = Q1 + 2\nL X+Q1 F100\nFN 12: IF +Q1 LT +6 GOTO LBL 3\nFN 9: IF +Q1 EQU +6 GOTO LBL \"out\"\nL Y+1\nLBL \"out\"";
    assert_eq!(moves(looped).iter().map(|m| m.2[0]).collect::<Vec<_>>(), [2_000, 4_000, 6_000]);
    for (blocks, code) in [
        ("Q1 = 1 / 0", "G171"),
        ("Q1 = (1 + 2", "G194"),
        ("Q1 = FOO 3", "G193"),
        ("Q5000 = 1", "G192"),
        ("FN 18: SYSREAD Q1 = ID50", "G211"),
        ("Q1 = 1 2", "G143"),
    ] {
        assert_eq!(refused(blocks).2, code, "{blocks}");
    }
}

#[test]
fn tools_feeds_and_functions_are_those_of_every_dialect() {
    let text = "0 BEGIN PGM A MM\n1 BLK FORM 0.1 Z X+0 Y+0 Z-20\n2 BLK FORM 0.2 X+9 Y+9 Z+0\n3 TOOL DEF 5 L+0 R+5\n\
        4 ;T5 D=10\n5 * - Finish\n6 TOOL CALL 5 Z S8000 F650 DL+0,1 DR-0,02\n7 L X+0 Y+0 R0 FMAX M13\n8 L Z+2 FMAX\n\
        9 L Z-1 F AUTO\n10 L X+9 FU0.1 M126\n11 STOP M9\n12 L Z+0 R0 FMAX M91 M5\n13 L M30\n14 END PGM A MM\n";
    let read = run(text, Options::default()).unwrap_or_else(|e| panic!("{e}"));
    let rest = read.rest.join("\n");
    for part in [
        "5: (T5 D=10)",
        "6: ( - Finish)",
        "7: SelectTool(5)",
        "7: ChangeTool(Some(5))",
        "8: Spindle(Clockwise)",
        "8: Coolant(Flood)",
        "11: FeedMode(PerRevolution)",
        "11: OtherM(126)",
        "12: Stop",
        "13: MachineMove",
        "14: End(30)",
    ] {
        assert!(rest.contains(part), "{part} in\n{rest}");
    }
    assert_eq!((read.end, read.warnings.as_slice()), (Some(30), &[][..]));
    // A call without a tool changes the speed alone.
    let read = run(&program("TOOL CALL S3000\nTOOL CALL \"MILL 10\" Z S100"), Options::default()).unwrap();
    assert_eq!(read.rest.iter().filter(|r| r.contains("ChangeTool")).collect::<Vec<_>>(), ["5: ChangeTool(None)"]);
}

#[test]
fn holes_go_down_and_back_and_other_cycles_are_refused_where_they_run() {
    let cycle = "CYCL DEF 200 DRILLING ~\n  Q200=+2 ;SET-UP CLEARANCE ~\n  Q201=-15 ;DEPTH ~\n  Q203=+1 ;SURFACE ~\n  Q204=+20 ;2ND CLEARANCE";
    let read =
        moves(&format!("{cycle}\nL X+10 R0 FMAX M99\nL X+20 FMAX\nCYCL CALL M8\nL X+30 FMAX M89\nL X+40 FMAX M99"));
    let heights: Vec<_> = read.iter().map(|m| (m.0, m.1, m.2[0] / 1000, m.2[2] / 1000)).collect();
    assert_eq!(heights[..4], [('T', 9, 10, -5), ('T', 9, 10, 3), ('F', 9, 10, -14), ('T', 9, 10, 21)]);
    assert_eq!(
        heights.iter().filter(|h| h.0 == 'F').map(|h| (h.1, h.2)).collect::<Vec<_>>(),
        [(9, 10), (11, 20), (12, 30), (13, 40)]
    );
    assert_eq!(moves("CYCL DEF 251 RECTANGULAR POCKET ~\nQ215=+0 ;OPERATION\nL X+10 F100").len(), 1);
    assert_eq!(refused("CYCL DEF 251 RECTANGULAR POCKET\nL X+10 FMAX M99"), (5, 1, "G199"));
    assert_eq!(refused("CYCL CALL"), (4, 1, "G200"));
}

#[test]
fn datum_shifts_move_the_origin_and_what_turns_it_is_refused() {
    let shift = "CYCL DEF 7.0 DATUM SHIFT\nCYCL DEF 7.1  X+10\nCYCL DEF 7.2 Y-5\nL X+1 Y+1 F100\nCYCL DEF 7.0\nCYCL DEF 7.1 IX+2\nL X+1\nCYCL DEF 7.1 X+0\nCYCL DEF 7.2 Y+0\nL X+1 Y+1";
    let text = program(shift);
    let mut shifts = Vec::new();
    let mut memory = Box::new(HostMemory::new());
    let options = Options { dialect: Dialect::Heidenhain, ..Options::default() };
    Interpreter::new(options)
        .run(text.as_bytes(), &mut memory.lend(), &mut |event| {
            if matches!(event.canon, Canon::Feed { .. }) {
                shifts.push([0, 1].map(|axis| event.modal.shifts.local[axis] / 1_000_000));
            }
            Ok(())
        })
        .unwrap();
    assert_eq!(shifts[1..], [[10, -5], [12, -5], [0, 0]]);
    for (blocks, code) in [
        ("CYCL DEF 7.0\nCYCL DEF 7.1 #3", "G216"),
        ("CYCL DEF 10.0 ROTATION\nCYCL DEF 10.1 ROT+35", "G216"),
        ("CYCL DEF 8.0 MIRROR\nCYCL DEF 8.1 X", "G216"),
        ("CYCL DEF 11.0\nCYCL DEF 11.1 SCL 0.99", "G216"),
        ("PLANE SPATIAL SPA+0 SPB+45 SPC+0 STAY", "G201"),
        ("FUNCTION TCPM F TCP AXIS POS", "G202"),
        ("L X+1 M128", "G203"),
        ("FL X+5 AN+0", "G204"),
        ("LN X+1 Y+2 Z+3 NX+0 NY+0 NZ+1", "G205"),
        ("SPL X+1", "G206"),
        ("TCH PROBE 412 DATUM", "G207"),
        ("CYCL CALL PAT", "G208"),
        ("CALL PGM OTHER.H", "G210"),
        ("G1 X5", "G214"),
        ("L X+5 FZ0.1", "G215"),
        ("TOOL CALL 4 X S100", "G197"),
        ("HELLO", "G180"),
        ("L X+5 K3", "G181"),
        ("L X F100", "G182"),
        ("L X+1234567890123456789", "G183"),
        ("TOOL CALL \"MILL Z", "G184"),
        ("BEGIN PGM TWICE", "G185"),
        ("CC X+0 Y+0\nC X+5 Y+0", "G186"),
    ] {
        assert_eq!(refused(blocks).2, code, "{blocks}");
    }
    for blocks in [
        "CYCL DEF 10.0 ROTATION\nCYCL DEF 10.1 ROT+0",
        "CYCL DEF 8.0\nCYCL DEF 8.1",
        "CYCL DEF 11.1 SCL 1",
        "CYCL DEF 19.0\nCYCL DEF 19.1 A+0 B+0 C+0 ABST50",
        "CYCL DEF 32.0 TOLERANCE\nCYCL DEF 32.1 T0.05\nCYCL DEF 32.2 HSC-MODE:1",
        "PLANE RESET STAY",
        "FUNCTION MODE MILL",
        "FN 16: F-PRINT TNC:\\MASK.A / TNC:\\OUT.TXT",
        "L Z+100 R0 FMAX M140 MB MAX",
        "L X+1 F100 M103 F20",
        "/L X+5 F100",
    ] {
        assert!(run(&program(blocks), Options::default()).is_ok(), "{blocks}");
    }
}

#[test]
fn errors_name_line_and_column_behind_block_numbers_and_tabs() {
    assert_eq!(refused("17\tL X+10 F500 KX"), (4, 16, "G181"));
    assert_eq!(refused("17 L X+10 F500\r\n18   C X+20 Y+5"), (5, 6, "G186"));
}

/// The manual's own example of the leads, whose arc of 5 mm is smaller than its cutter's radius of 10 mm.
#[test]
fn the_examples_of_the_manual_are_read() {
    let circular = "BEGIN PGM CIRCULAR MM\nBLK FORM 0.1 Z X+0 Y+0 Z-20\nBLK FORM 0.2 X+100 Y+100 Z+0\nTOOL CALL 1 Z S4000\n\
        L Z+250 R0 FMAX\nL X-10 Y-10 R0 FMAX\nL Z-5 R0 F1000 M3\nAPPR LCT X+5 Y+5 R5 RL F300\nL X+5 Y+85\nRND R10 F150\nL X+30 Y+85\n\
        CR X+70 Y+95 R+30 DR-\nL X+95\nL X+95 Y+40\nCT X+40 Y+5\nL X+5\nDEP LCT X-20 Y-20 R5 F1000\nL Z+250 R0 FMAX M2\nEND PGM CIRCULAR MM";
    for radius in [0, 5_000, 10_000] {
        let compensation = CompensationBy::Radius(Offset::from_um(radius));
        let read = run(circular, Options { compensation, ..Options::default() });
        let read = read.unwrap_or_else(|e| panic!("{radius}: {e}"));
        assert_eq!(read.end, Some(2));
        assert!(read.moves.iter().all(|m| m.1 < 6 || m.2[0] != i64::MAX));
    }
    let helix = "BEGIN PGM HELIX MM\nTOOL CALL 1 Z S1400\nL Z+250 R0 FMAX\nL X+50 Y+50 R0 FMAX\nCC\nL Z-12.75 R0 F1000 M3\n\
        APPR PCT PR+32 PA-182 CCA180 R+2 RL F100\nCP IPA+3240 IZ+13.5 DR+ F200\nDEP CT CCA180 R+2\nL Z+250 R0 FMAX M2\nEND PGM HELIX MM";
    let read = run(helix, Options::default()).unwrap_or_else(|e| panic!("{e}"));
    assert!(read.moves.iter().any(|m| m.0 == 'R' && m.1 == 8 && m.2[2] == 750), "{:?}", read.moves);
}

#[test]
fn a_helix_without_a_feed_is_read_and_warned_of() {
    let read = run("CC X+5 Y+5\nCP IPA-7200 DR- IZ-1", Options { start: Axes::ORIGIN, ..Options::default() });
    let read = read.unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(read.moves.len(), 1);
    assert!(read.warnings.as_slice().iter().any(|w| (w.kind, w.line) == (WarningKind::FeedMissing, 2)));
}

proptest! {
    /// Whatever stands in the blocks, there is an answer, and an error lies inside the program.
    #[test]
    fn no_program_panics(
        blocks in prop::collection::vec(
            prop::sample::select(vec![
                "L X+10 Y-5 RL F100", "L IX+3 IY+Q1", "L Y+40 RR", "L X+0 Y+0 R0 FMAX", "CC X+5 Y+5", "CC", "C X+5 Y+0 DR-",
                "C IX+1 IY+1 DR+", "CR X+30 Y+1 R-9 DR-", "CT X+4 Y+9", "CTP PR+5 PA+30", "LP PR+5 PA+9", "LP IPR+1 IPA+400",
                "CP IPA-7200 DR- IZ-1", "RND R2", "CHF 3", "APPR LCT X+9 Y+9 R3 RL", "APPR CT X+0 Y+9 CCA400 R-3 RR F9",
                "APPR LN X+1 Y+1 LEN+5 RL", "DEP LCT X+90 Y+9 R4", "DEP CT CCA90 R4", "DEP LT LEN5", "LBL 1", "LBL 0",
                "CALL LBL 1", "CALL LBL 1 REP 3", "FN 9: IF +Q1 NE +3 GOTO LBL 1", "Q1 = Q1 + 1", "Q1 = SQRT ( Q1 - 3 )",
                "TOOL CALL 3 Z S100 DR+9", "TOOL CALL \"", "CYCL DEF 200 A", "CYCL CALL", "CYCL DEF 7.1 IX+5", "CYCL DEF 247",
                "M99", "M89", "STOP", "M128", "END PGM A MM", "BEGIN PGM A INCH", "; a", "* b", "~", "12", "/ 3 L X", "L Z-Q1 M140 MB",
            ]),
            0..24,
        ),
        radius in 0i64..20_000,
    ) {
        let text = blocks.join("\n");
        for compensation in [CompensationBy::Nothing, CompensationBy::Radius(Offset::from_um(radius))] {
            let options = Options { compensation, block_limit: 300, start: Axes::ORIGIN, ..Options::default() };
            if let Err(error) = run(&text, options) {
                prop_assert!(error.start <= text.len() && error.line >= 1, "{error}");
            }
        }
    }

    /// The same with bytes of any kind around words of the language.
    #[test]
    fn no_bytes_panic(
        parts in prop::collection::vec(prop_oneof![
            "[ -~\t\r\n]{0,6}",
            prop::sample::select(vec!["L ", "X", "Q", "FN ", "=", "(", "SIN", "CYCL DEF ", "TOOL CALL", "RND", "APPR LCT", "\n", "-", "^"])
                .prop_map(str::to_owned),
        ], 0..30),
    ) {
        let text = parts.concat();
        let options = Options { block_limit: 300, ..Options::default() };
        if let Err(error) = run(&text, options) {
            prop_assert!(error.start <= text.len(), "{error}");
        }
    }
}
