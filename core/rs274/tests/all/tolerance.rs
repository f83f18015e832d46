//! What posts and machinists write beyond the book: the smallest program of each, how it is read, and its warning.

use crate::interpret::interpret;
use truepath_rs274::{
    ArcCentres, Axes, Canon, ContourOptions, DeviceMemory, Dialect, GcodeError, Machine, Options, Program, Units,
    WarningKind, find_contours, read_contour,
};
use truepath_units::geometry::Block;
use truepath_units::{Offset, Position};

const ALL: [Dialect; 5] = [Dialect::Linuxcnc, Dialect::Fanuc, Dialect::Haas, Dialect::Siemens, Dialect::Mach];
const FANUC: [Dialect; 3] = [Dialect::Fanuc, Dialect::Haas, Dialect::Siemens];

fn options(dialect: Dialect) -> Options<'static> {
    Options { start: Axes::ORIGIN, dialect, ..Options::default() }
}

/// The moves of a program in tenths of a millimetre, and the codes of its warnings without those of its frame and end.
fn read_with(program: &str, options: Options<'_>) -> Result<(String, Vec<&'static str>), GcodeError> {
    let mut moves = Vec::new();
    let tenths = |p: Option<Position>| p.map_or("?".to_owned(), |p| format!("{}", p.nm() / 100_000));
    let place = |at: Axes| [at.x, at.y, at.z].map(tenths).join(",");
    let run = interpret(options, program.as_bytes(), &mut DeviceMemory::new().lend(), &mut |event| {
        match *event.canon {
            Canon::Traverse { to, .. } => moves.push(format!("T{}", place(to))),
            Canon::Feed { to, .. } => moves.push(format!("F{}", place(to))),
            Canon::Arc { to, centre, .. } => {
                moves.push(format!("A{} about {},{}", place(to), centre.x.nm() / 100_000, centre.y.nm() / 100_000));
            }
            Canon::Reference { via, axes, .. } => moves.push(format!("H{} {axes:?}", place(via))),
            Canon::Dwell(time) => moves.push(format!("D{}", time.value())),
            Canon::SpindleSpeed(speed) => moves.push(format!("S{}", speed.bits() >> 32)),
            Canon::ProgramNumber(number) => moves.push(format!("O{number}")),
            _ => {}
        }
        Ok(())
    })?;
    let framed = |kind: &WarningKind| matches!(kind, WarningKind::PercentMissing | WarningKind::EndMissing);
    let warnings = run.warnings.as_slice().iter().map(|w| w.kind).filter(|kind| !framed(kind));
    Ok((moves.join(" "), warnings.map(|kind| kind.code()).filter(|code| !matches!(*code, "W006" | "W014")).collect()))
}

fn read(program: &str, dialect: Dialect) -> Result<(String, Vec<&'static str>), GcodeError> {
    read_with(program, options(dialect))
}

/// Reads a program in some dialects.
fn is_read(dialects: &[Dialect], program: &str, moves: &str, warnings: &[&str]) {
    for &dialect in dialects {
        match read(program, dialect) {
            Ok((found, warned)) => {
                assert_eq!((found.as_str(), &warned[..]), (moves, warnings), "{dialect:?} {program}")
            }
            Err(error) => panic!("{dialect:?} {program}: {error}"),
        }
    }
}

/// Refuses a program as LinuxCNC itself does.
fn is_refused_by_linuxcnc(program: &str, code: &str) {
    let itself = Options { as_linuxcnc: true, ..options(Dialect::Linuxcnc) };
    assert_eq!(read_with(program, itself).map_err(|e| e.kind.code()), Err(code), "{program}");
}

fn is_refused(dialects: &[Dialect], program: &str, code: &str) {
    for &dialect in dialects {
        assert_eq!(read(program, dialect).map_err(|e| e.kind.code()), Err(code), "{dialect:?} {program}");
    }
}

#[test]
fn a_reference_point_is_approached_beside_a_motion_code_as_without() {
    let z = "H0.0.0 [false, false, true]".replace('.', ",");
    is_read(&ALL, "G21 G0 G91 G28 Z0.\nM30", &z, &["W018"]);
    is_read(&ALL, "G21 G91 G28 Z0.\nM30", &z, &[]);
    is_read(&ALL, "G21 G91 G28 X0. Z0.\nG28 Y0.\nM30", "H0,0,0 [true, false, true] H?,0,? [false, true, false]", &[]);
    // Where the machine is known as well.
    let machine = Some(Machine { units: Units::Millimetres, probe_before_end: Offset::ZERO });
    let known = Options { machine, ..options(Dialect::Haas) };
    let read = read_with("G21 G90 G0 X1. Z5.\nG0 G91 G28 Z0.\nM30", known);
    assert_eq!(read.map(|(moves, _)| moves), Ok("T10,0,50 T10,0,50 T10,0,0".to_owned()));
    is_refused(&ALL, "G2 G28 X1. I1.", "G060");
}

#[test]
fn words_without_a_meaning_are_left_out_with_a_warning() {
    is_read(&ALL, "M3 P100 S200\nM30", "S200", &["W019"]);
    is_read(&ALL, "G21 G90 G17 G2 X10. I5. K0. F100.\nM30", "A100,0,0 about 50,0", &["W019"]);
    is_refused(&ALL, "G21 G90 G17 G2 X10. I5. K1. F100.\nM30", "G029");
    is_refused(&ALL, "G21 G1 X1. P100 F100.", "G029");
}

#[test]
fn the_time_of_a_dwell_may_stand_behind_s_and_is_no_speed() {
    is_read(
        &[Dialect::Linuxcnc, Dialect::Fanuc, Dialect::Haas, Dialect::Mach],
        "S500\nG4 S2\nM30",
        "S500 D2",
        &["W020"],
    );
    // Turns of the spindle, and seconds.
    is_read(&[Dialect::Siemens], "S600\nG4 S30\nG4 F1.5\nM30", "S600 D3 D1.5", &[]);
    is_read(&ALL, "G4 P1 S500\nM30", "S500 D1", &[]);
}

#[test]
fn scaling_that_is_never_on_is_switched_off() {
    is_read(&ALL, "G21 G17 G40 G50 G80\nG0 X1.\nM30", "T10,0,0", &[]);
    is_refused(&ALL, "G50 X1.", "G067");
}

#[test]
fn a_comment_inside_another_belongs_to_it() {
    is_read(&ALL, "G21 (a (b) (c)) G0 X1. (d)\nM30", "T10,0,0", &["W016"]);
    is_read(&ALL, "(2D Contour1 (2))\nG21 G0 X1.\nM30", "T10,0,0", &["W016"]);
    // What does not match ends at the first parenthesis, as on a control that does not count.
    is_read(&ALL, "G21 (a (b) G0 X1. (d)\nM30", "T10,0,0", &["W016"]);
    is_refused_by_linuxcnc("G21 (a (b) (c)) G0 X1.", "G005");
    // What stands behind the first `)` is a comment to the matching one, and never a move.
    is_read(&ALL, "G21 (a (b) G0 X5.) G0 X1.\nM30", "T10,0,0", &["W016"]);
    is_refused(&ALL, "G21 a) G0 X1.", "G002");
    is_refused(&ALL, "G21 (a)) G0 X1.", "G005");
}

#[test]
fn behind_the_end_of_a_cycle_the_motion_before_it_goes_on() {
    let program = "G21 G90 G0 X0. Z20.\nG81 X5. Z-1. R2. F100.\nG80\nZ15.\nX1.\nM30";
    let moves = "T0,0,200 T50,0,200 T50,0,20 F50,0,-10 T50,0,200 T50,0,150 T10,0,150";
    is_read(&ALL, program, moves, &["W021"]);
    is_read(
        &ALL,
        "G21 G90 G1 Z2. F9.\nG81 Z-1. R2.\nG80 Z15.\nM30",
        "F0,0,20 T0,0,20 F0,0,-10 T0,0,20 F0,0,150",
        &["W021"],
    );
    is_refused_by_linuxcnc(program, "G042");
    is_refused(&ALL, "G21 G80\nX1.", "G042");
}

#[test]
fn words_of_a_cycle_go_on_to_the_next_one() {
    let program = "G21 G90 G99 G0 Z5.\nG81 X1. Z-1. R2. F100.\nG82 X2. P1\nG80\nM30";
    let moves = "T0,0,50 T10,0,50 T10,0,20 F10,0,-10 T10,0,20 T20,0,20 F20,0,-10 D1 T20,0,20";
    is_read(&FANUC, program, moves, &["W024"]);
    is_refused(&[Dialect::Linuxcnc, Dialect::Mach], program, "G090");
    // G80 forgets them.
    is_refused(&ALL, "G21 G90 G0 Z5.\nG81 X1. Z-1. R2. F100.\nG80\nG81 X2. Z-1.", "G090");
}

#[test]
fn centres_are_found_to_be_absolute_by_the_first_arc_that_tells() {
    let program = "G21 G90 G1 X10. Y0. F100.\nG3 X0. Y10. I0. J0.\nG3 X-10. Y0. I0. J0.\nM30";
    let moves = "F100,0,0 A0,100,0 about 0,0 A-100,0,0 about 0,0";
    is_read(&ALL, program, moves, &["W022"]);
    let with = |program: &str, arc_centres| {
        read_with(program, Options { arc_centres, ..options(Dialect::Mach) }).map_err(|e| e.kind.code())
    };
    assert_eq!(with(program, ArcCentres::Absolute), Ok((moves.to_owned(), vec![])));
    assert_eq!(with(program, ArcCentres::Incremental).map(|_| ()), Err("G057"));
    // The first arc is one with incremental centres only.
    let mixed = "G21 G90 G1 X10. Y0. F100.\nG3 X0. Y10. I-10. J0.\nG3 X-10. Y0. I0. J0.\nM30";
    is_refused(&ALL, mixed, "G057");
    let mixed = "G21 G90 G1 X10. Y0. F100.\nG3 X0. Y10. I-10. J0.\nG3 X-10. Y0. I0. J-1.\nM30";
    is_refused(&ALL, mixed, "G055");
    // A full circle is one about any centre: what comes behind cannot change how it was read.
    let circle = "G21 G90 G1 X10. Y0. F100.\nG3 X10. Y0. I0. J0.1\nG3 X0. Y10. I0. J0.\nM30";
    is_refused(&ALL, circle, "G057");
    is_refused(&ALL, "G21 G90 G1 X1. F100.\nG2 X1. Y0. I0. J0.", "G056");
    // The same place both ways tells nothing; what the program says counts.
    let origin = "G21 G90 G1 X0. Y0. F100.\nG3 X10. Y10. I10. J0.\nG2 X20. Y20. I20. J10.\nM30";
    is_read(&ALL, origin, "F0,0,0 A100,100,0 about 100,0 A200,200,0 about 200,100", &["W022"]);
    is_refused(&ALL, &program.replace("G21", "G21 G91.1"), "G057");
}

#[test]
fn an_arc_may_miss_by_what_its_last_digit_explains() {
    // Radii 50 and 50.07: 0.1 % is 0.05, and two decimals explain 0.0283.
    is_read(&ALL, "G21 G90 G0 X0.\nG2 X100.07 Y0. I50. F100.\nM30", "T0,0,0 A1000,0,0 about 500,0", &["W023"]);
    is_refused(&ALL, "G21 G90 G0 X0.\nG2 X100.09 Y0. I50. F100.\nM30", "G055");
    is_refused(&ALL, "G21 G90 G0 X0.\nG2 X100.070 Y0. I50. F100.\nM30", "G055");
    is_read(&ALL, "G21 G90 G0 X0.\nG2 X100.05 Y0. I50. F100.\nM30", "T0,0,0 A1000,0,0 about 500,0", &[]);
}

#[test]
fn a_program_may_begin_with_the_name_of_its_file() {
    is_read(&ALL, "%O1200(PART)\nG21 G0 X1.\nM30\n%", "O1200 T10,0,0", &[]);
    is_read(&[Dialect::Fanuc, Dialect::Haas], "%\nO<PART_1> (A)\nG21 G0 X1.\nM30\n%", "T10,0,0", &[]);
    is_refused(&[Dialect::Fanuc], "O<PART> call", "G154");
    is_read(&ALL, "$PART-1.MIN%\nO12\nG21 G0 X1.\nM30\n%", "O12 T10,0,0", &[]);
    is_read(&ALL, "%_N_PART_1_MPF\n;$PATH=/_N_WKS_DIR\nG21 G0 X1.\nM30\n", "T10,0,0", &[]);
    is_refused(&ALL, "%G21 G0 X1.", "G010");
    is_refused(&ALL, "G0 X1.\n$A", "G001");
}

#[test]
fn further_work_offsets_of_a_haas_are_those_of_g154() {
    let offset = |code: &str| {
        let mut offset = 0;
        let program = format!("G21 {code}\nG0 X1. Y1.\nM30");
        let run =
            interpret(options(Dialect::Haas), program.as_bytes(), &mut DeviceMemory::new().lend(), &mut |event| {
                offset = event.modal.work_offset;
                Ok(())
            });
        run.map(|_| offset).map_err(|e| e.kind.code())
    };
    assert_eq!(offset("G110"), offset("G154 P1"));
    assert_eq!(offset("G129"), offset("G154 P20"));
    assert_eq!(offset("G130"), Err("G032"));
    is_refused(&[Dialect::Fanuc, Dialect::Linuxcnc], "G110", "G032");
}

#[test]
fn a_call_that_is_made_no_times_is_passed_over() {
    let program = "G21 G0 X1.\nM98 P7 L0\nM30\nO7\nG0 X5.\nM99";
    is_read(&[Dialect::Linuxcnc, Dialect::Mach], program, "T10,0,0", &[]);
    is_read(&FANUC, program, "T10,0,0", &["W027"]);
    is_refused(&ALL, &program.replace("L0", "L-1"), "G062");
}

#[test]
fn the_number_of_a_parameter_that_is_asked_for_may_be_computed() {
    let program = "#1=2\n#3=7000\nG21 G0 X[EXISTS[##1]] Y[EXISTS[#[1+1]]] Z[EXISTS[##3]]\nM30";
    is_read(&[Dialect::Linuxcnc], program, "T10,10,0", &[]);
}

#[test]
fn a_return_inside_a_line_is_a_blank() {
    is_read(&ALL, "G21 G0\rX1.\r\r\nY1.\nM30", "T10,0,0 T10,10,0", &["W017"]);
    is_read(&ALL, "G21 G0 X1.\rY1.\rM30", "T10,0,0 T10,10,0", &[]);
}

#[test]
fn words_of_siemens_own_language_are_read_or_refused_by_name() {
    let siemens = [Dialect::Siemens];
    let others = [Dialect::Linuxcnc, Dialect::Fanuc, Dialect::Haas, Dialect::Mach];
    let arc = "G21 G90 G17 G0 X0. Y0.\nG2 X10. Y0. CR=5. F100.\nM30";
    is_read(&siemens, arc, "T0,0,? A100,0,? about 50,0".replace('?', "0").as_str(), &[]);
    is_read(&siemens, &arc.replace("CR=5.", "CR=[2*2.5]"), "T0,0,0 A100,0,0 about 50,0", &[]);
    is_refused(&others, arc, "G009");
    let home = "G21 G90 G0 X1.\nG0 SUPA Z0. D0\nX2.\nM30";
    is_read(&siemens, home, "T10,0,0 T20,0,?", &[]);
    is_refused(&others, home, "G009");
    let shown = "MSG(\"finish (wall)\")\nCYCLE832(0.01,_FINISH,1)\nG21 G0 X1.\nMSG()\nM30";
    is_read(&siemens, shown, "T10,0,0", &["W016"]);
    is_refused(&others, shown, "G009");
    for word in ["CYCLE81(5,0,1)", "G0 ROT Z30", "AMIRROR X0", "CYCLE800(1,\"T\",0,57)", "G1 X=IC(5)", "REPEAT A B"] {
        is_refused(&ALL, word, "G009");
    }
}

#[test]
fn the_tools_origins_and_dynamics_of_siemens_own_language_are_read() {
    let siemens = [Dialect::Siemens];
    let others = [Dialect::Linuxcnc, Dialect::Fanuc, Dialect::Haas, Dialect::Mach];
    let programs = [
        ("T=\"MILL D10\" D1\nM6\nG21 G0 X1. D2\nM30", "T10,0,?"),
        ("T3\nM6\nT=\"B\" M6\nG21 G0 X1.\nM30", "T10,0,?"),
        ("FFWON\nSOFT\nG601 G642\nG60\nG450 CFTCP\nG21 G0 X1. STOPRE\nM30", "T10,0,0"),
        ("WORKPIECE(,\"\",,\"BOX\",112,0,-20)\nCYCLE800()\nG21 G0 X1.\nM30", "T10,0,0"),
        ("G21 G0 X=1. Y=-2.5\nS=500\nM30", "T10,-25,0 S500"),
        // The place where the machine stands gets other names; TRANS sets what it does not name to 0.
        (
            "G21 G0 X1.\nTRANS X5. Y2.\nX1.\nATRANS Y1.\nX2.\nTRANS Z1.\nX0.\nTRANS\nX1.\nM30",
            "T10,0,0 T10,-20,0 T20,-30,0 T0,0,-10 T10,0,0",
        ),
    ];
    for (program, moves) in programs {
        is_read(&siemens, program, moves, &[]);
    }
    for word in ["TRANS X10", "ATRANS Z1", "T=\"MILL_10\" M6", "G0 FFWON"] {
        is_refused(&others, word, "G009");
    }
    let corner = "G21 G17 G1 X10. F100. RND=2.\nY10. CHR=1\nX0.\nM30";
    let rounded = "F80,0,0 A100,20,0 about 80,20 F100,90,0 F90,100,0 F0,100,0";
    is_read(&siemens, corner, rounded, &[]);
    is_refused(&others, corner, "G009");
    is_refused(&others, "G21 G0 X=1.", "G006");
    is_refused(&others, "G601", "G032");
    // G700 and G710 are units for feeds as well, G153 is G53.
    is_read(&siemens, "G710 G90 G0 X1.\nG0 G153 Z0 D0\nG700\nX1.\nM30", "T10,0,0 T254,0,?", &[]);
    is_refused(&others, "G21 G0 G153 Z0", "G032");
    // The tool that has no number is not the one before it.
    let mut tools = Vec::new();
    let run = interpret(
        options(Dialect::Siemens),
        b"T3 M6\nT=\"B\" M6\nM30",
        &mut DeviceMemory::new().lend(),
        &mut |event| {
            if let Canon::ChangeTool(tool) = *event.canon {
                tools.push((tool, event.modal.tool));
            }
            Ok(())
        },
    );
    assert_eq!((run.is_ok(), tools), (true, vec![(Some(3), Some(3)), (None, None)]));
}

#[test]
fn the_second_tool_beside_m6_is_the_next_one() {
    let mut tools = Vec::new();
    let run =
        interpret(options(Dialect::Fanuc), b"T07 T11 M06\nM6\nM30", &mut DeviceMemory::new().lend(), &mut |event| {
            if let Canon::ChangeTool(tool) = *event.canon {
                tools.push(tool);
            }
            Ok(())
        });
    assert_eq!((run.is_ok(), tools), (true, vec![Some(7), Some(11)]));
    is_refused(&ALL, "T7 T11", "G022");
    is_refused(&[Dialect::Linuxcnc, Dialect::Haas], "T7 T11 M6", "G022");
}

#[test]
fn units_by_g70_and_g71_are_those_of_the_dialect() {
    let program = "N10 G40 G17 G90 G70\nG0 X1.\nG71\nX1.\nM30";
    is_read(&[Dialect::Siemens, Dialect::Mach], program, "T254,0,0 T10,0,0", &[]);
    is_read(&[Dialect::Mach], "N110G71G91.1\nG0X1.\nM30", "T10,0,0", &[]);
    // Posts for mills; each code is told once.
    is_read(&[Dialect::Fanuc], program, "T254,0,0 T10,0,0", &["W025", "W025"]);
    // A cycle of a lathe, or a row of holes.
    for cycle in ["G71 U2. R1.", "G71 P10 Q20 U.5 W.1 F.2", "G70 P10 Q20", "G70 I10. J0 L4", "G70 X1."] {
        is_refused(&[Dialect::Fanuc], cycle, "G067");
    }
    is_refused(&[Dialect::Linuxcnc, Dialect::Haas], "G71", "G067");
}

#[test]
fn codes_that_cancel_or_only_say_how_the_path_is_followed_change_nothing() {
    is_read(&ALL, "G00 G49 G40.1 G17 G80 G50 G90 G98\nG21 G64\nG0 X1.\nM30", "T10,0,?", &[]);
    is_read(&ALL, "G21 G15 G50 G69\nG0 X1.\nM30", "T10,0,0", &[]);
    is_refused(&ALL, "G69 G50 X1.", "G067");
    let fast = "G21 G05.1 Q1 R3\nG08 P1\nG05 P10000\nG09 G0 X1.\nG05.1 Q0\nM30";
    is_read(&[Dialect::Fanuc, Dialect::Haas], fast, "T10,0,0", &[]);
    is_read(&[Dialect::Fanuc], "G21 G13.1 G15 G69\nG25\nG62\nG10 L12 P1 R5.\nG0 X1.\nM30", "T10,0,0", &[]);
    is_read(&[Dialect::Haas], "G103 P1\nG21 G0 X1.\nG103\nM30", "T10,0,0", &[]);
    is_refused(&[Dialect::Linuxcnc], "G21 G09 G0 X1.", "G032");
}

#[test]
fn a_cutting_move_from_an_unknown_place_leads_to_the_part_and_is_no_contour() {
    let unknown = Options { start: Axes::UNKNOWN, dialect: Dialect::Haas, ..Options::default() };
    let program = "G21 G90 G54\nG1 X5. Y0. F5000.\nZ-1. F100.\nX20.\nY10.\nM30";
    let moves = "F50,0,? F50,0,-10 F200,0,-10 F200,100,-10";
    assert_eq!(read_with(program, unknown).map_err(|e| e.kind.code()), Ok((moves.to_owned(), vec!["W026"])));
    let mut runs = Vec::new();
    let contour = |text: &str, runs: &mut Vec<(u32, u32)>| {
        let options = ContourOptions { program: unknown, ..ContourOptions::default() };
        let program = Program::new(text.as_bytes());
        let listed = find_contours(&program, &mut DeviceMemory::new().lend(), &options, |run| {
            runs.push((run.lines.first, run.lines.last));
        });
        let mut buffer = [Block::BLANK; 8];
        let read = read_contour(&program, &mut DeviceMemory::new().lend(), &mut buffer, &options);
        (
            listed.map(|_| ()).map_err(|e| e.kind.code()),
            read.map(|c| c.lines.first).map_err(|e| (e.kind.code(), e.line)),
        )
    };
    assert_eq!(contour(program, &mut runs), (Ok(()), Ok(4)));
    assert_eq!(runs, [(4, 5)]);
    // G28 on the way: what follows begins behind the place that is named again.
    let program = "G21 G90 G0 X0 Y0 Z0\nG1 X9. F100.\nG28 X0.\nG1 X3. Y3.\nY6.\nM30";
    runs.clear();
    assert_eq!(contour(program, &mut runs).0, Ok(()));
    assert_eq!(runs, [(2, 2), (5, 5)]);
    // A place that stays unknown, and a program that has nothing else.
    let program = "G21 G90 G1 X5. F100.\nY10.\nX20.\nM30";
    assert_eq!(contour(program, &mut Vec::new()), (Err("G073"), Err(("G073", 1))));
    assert_eq!(contour("G21\nG90 G1 X5. Y1. F100.\nM30", &mut Vec::new()), (Ok(()), Err(("G073", 2))));
}
