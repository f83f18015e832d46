//! Where G41 and G42 begin and end on controls with start-up type A, and whose radius counts.

use crate::interpret::interpret;
use truepath_rs274::{Axes, Canon, CompensationBy, DeviceMemory, Dialect, GcodeError, Options};
use truepath_units::{Offset, Position};

const FIVE: CompensationBy = CompensationBy::Radius(Offset::from_um(5_000));
const TYPE_A: [Dialect; 3] = [Dialect::Fanuc, Dialect::Haas, Dialect::Siemens];
const OWN: [Dialect; 2] = [Dialect::Linuxcnc, Dialect::Mach];

/// The moves of the cutter's centre in tenths of a millimetre, without the approach.
fn moves(program: &str, dialect: Dialect, compensation: CompensationBy) -> Result<String, GcodeError> {
    let mut moves = Vec::new();
    let options = Options { start: Axes::ORIGIN, dialect, compensation, ..Options::default() };
    interpret(options, program.as_bytes(), &mut DeviceMemory::new().lend(), &mut |event| {
        let tenths = |p: Option<Position>| p.map_or("?".to_owned(), |p| format!("{}", p.nm() / 100_000));
        let place = |at: Axes| [at.x, at.y, at.z].map(tenths).join(",");
        match *event.canon {
            Canon::Traverse { to, .. } => moves.push(format!("T{}", place(to))),
            Canon::Feed { to, .. } => moves.push(format!("F{}", place(to))),
            Canon::Arc { to, centre, .. } => {
                moves.push(format!("A{} about {},{}", place(to), centre.x.nm() / 100_000, centre.y.nm() / 100_000));
            }
            _ => {}
        }
        Ok(())
    })?;
    moves.remove(0);
    Ok(moves.join(" "))
}

fn is_led(program: &str, expected: &str) {
    for dialect in TYPE_A {
        let program = format!("G21 G90 G17 {program}\nM30");
        match moves(&program, dialect, FIVE) {
            Ok(found) => assert_eq!(found, expected, "{dialect:?} {program}"),
            Err(error) => panic!("{dialect:?} {program}: {error}"),
        }
    }
}

fn is_refused(dialects: &[Dialect], program: &str, code: &str) {
    for &dialect in dialects {
        let found = moves(&format!("G21 G90 G17 {program}\nM30"), dialect, FIVE).map_err(|e| e.kind.code());
        assert_eq!(found, Err(code), "{dialect:?} {program}");
    }
}

#[test]
fn a_lead_line_ends_beside_the_start_of_the_next_move_however_short_it_is() {
    let short = "G0 X-3. Y0.\nG41 D1 G1 X0. F100.\nY20.\nX20.\nG40 Y40.";
    is_led(short, "F-50,0,0 F-50,200,0 A0,250,0 about 0,200 F200,250,0 F200,400,0");
    is_refused(&OWN, short, "G120");
    // On the other side of the corner, and along G0.
    is_led("G0 X-3. Y0.\nG41 D1 X0.\nG1 Y-20. F100.\nG40 X40.", "T50,0,0 F50,-200,0 F400,-200,0");
    is_led("G0 X-3. Y0.\nG42 D1 G1 X0. F100.\nX20.\nG40 Y-40.", "F0,-50,0 F200,-50,0 F200,-400,0");
    // Into an arc, as CAM systems lead in.
    is_led("G0 X0. Y-12.\nG41 D1 G1 Y-8. F100.\nG3 X8. Y0. J8.\nG40 G1 X0.", "F0,-30,0 A30,0,0 about 0,0 F0,0,0");
}

#[test]
fn a_lead_line_into_an_inside_corner_leaves_room_for_the_first_wall() {
    // The first wall is 4 mm long: a path that met it before the corner would have used it up.
    let program = "G0 X-20. Y0.\nG41 D1 G1 X0. F100.\nY4.\nX-9.\nG40 Y30.";
    is_refused(&TYPE_A, program, "G124");
    let outside = "G0 X-20. Y0.\nG41 D1 G1 X0. F100.\nY4.\nX9.\nG40 Y30.";
    is_led(outside, "F-50,0,0 F-50,40,0 A0,90,0 about 0,40 F90,90,0 F90,300,0");
    is_refused(&OWN, outside, "G124");
}

#[test]
fn the_start_up_waits_for_a_move_in_the_plane() {
    let expected = "F-200,0,-20 F-50,0,-20 F-50,200,-20 F-200,200,-20";
    for program in [
        "G0 X-20. Y0.\nG41 D1 G1 Z-2. F100.\nX0.\nY20.\nG40 X-20.",
        "G0 X-20. Y0.\nG41 D1\nG1 Z-2. F100.\nX0.\nY20.\nG40 X-20.",
        "G0 X-20. Y0.\nG1 Z-2. F100.\nG41 D1\nX0.\nG41 D1 Y20.\nG40\nX-20.",
    ] {
        is_led(program, expected);
    }
    is_refused(&OWN, "G0 X-20. Y0.\nG41 D1 G1 Z-2. F100.\nX0.\nY20.\nG40 X-20.", "G120");
}

#[test]
fn the_end_waits_for_a_move_in_the_plane() {
    is_led(
        "G0 X-20. Y0.\nG41 D1 G1 X0. F100.\nY20.\nG40 G0 Z5.\nX-30.",
        "F-50,0,0 F-50,200,0 T-50,200,50 T-300,200,50",
    );
}

#[test]
fn what_the_control_does_not_take_is_refused() {
    is_refused(&TYPE_A, "G0 X0. Y0.\nG41 D1 G3 X8. Y8. J8. F100.\nG1 Y20.", "G135");
    is_refused(&TYPE_A, "G0 X-20. Y0.\nG41 D1 G1 X0. F100.\nY20.\nG40 G3 X-9. Y29. I-9.", "G126");
    is_refused(&TYPE_A, "G0 X-20. Y0.\nG41 D1 G1 X0. F100.\nG42 D1 Y20.", "G129");
    is_refused(&TYPE_A, "G0 X-20. Y0.\nG41 D1 G1 X0. F100.\nG41 D2 Y20.", "G129");
    is_refused(&TYPE_A, "G0 X-20. Y0.\nG41 D1 G1 X0. F100.\nY20.\nG3 X-2. Y22. I-2.\nG1 X-9.", "G122");
}

#[test]
fn the_radius_of_a_tool_is_that_of_no_other() {
    let cut = "G0 X-20. Y0.\nG41 D1 G1 X0. F100.\nY20.\nG40 X-20.\n";
    let program = format!("G21 G90 T1 M6\n{cut}T2 M6\n{cut}M30");
    let radius = Offset::from_um(5_000);
    let led = |tool| moves(&program, Dialect::Haas, CompensationBy::ToolRadius { tool, radius });
    let (centre, beside) = ("F0,0,? F0,200,? F-200,200,?", "F-50,0,? F-50,200,? F-200,200,?");
    assert_eq!(led(2), Ok(format!("{centre} T-200,0,? {beside}")));
    assert_eq!(led(1), Ok(format!("{beside} T-200,0,? {centre}")));
    let without = moves(&format!("G21 G90 {cut}M30"), Dialect::Haas, CompensationBy::ToolRadius { tool: 7, radius });
    assert_eq!(without, Ok(beside.replace('?', "0")));
}
