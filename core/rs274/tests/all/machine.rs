//! Moves of a machine whose offsets and tools are known, against what LinuxCNC's interpreter printed for the same blocks.

use crate::interpret::interpret;
use truepath_rs274::{Axes, Canon, DeviceMemory, Machine, Modal, Options, Tool, Units};
use truepath_units::Offset;

const INCH: i64 = 25_400_000;

const TOOLS: &[Tool] = &[
    Tool { number: 1, pocket: 1, diameter: Offset::from_nm(10 * INCH), offset: [0, 0, 50 * INCH, 0, 0, 0, 0, 0, 0] },
    Tool {
        number: 2,
        pocket: 2,
        diameter: Offset::from_nm(6 * INCH),
        offset: [INCH, 2 * INCH, 20 * INCH, 0, 0, 0, 0, 0, 0],
    },
];

fn moves(program: &str) -> Result<Vec<String>, String> {
    let machine = Machine { units: Units::Inches, probe_before_end: Offset::from_nm(254_000) };
    let options = Options { start: Axes::ORIGIN, tools: TOOLS, machine: Some(machine), ..Options::default() };
    let mut memory = DeviceMemory::new();
    let mut text = Vec::new();
    let place = |to: Axes, modal: &Modal| {
        let unit = modal.units.nanometres() as f64;
        let [x, y, z] =
            [to.x, to.y, to.z].map(|p| format!("{:.4}", p.map_or(f64::NAN, |p| p.nm() as f64 / unit) + 0.0));
        format!("{x} {y} {z}").replace("-0.0000", "0.0000")
    };
    let run = interpret(options, program.as_bytes(), &mut memory.lend(), &mut |event| {
        let (kind, to) = match *event.canon {
            Canon::Traverse { to, .. } => ("T", to),
            Canon::Feed { to, .. } => ("F", to),
            Canon::Arc { to, .. } | Canon::PlaneArc { to, .. } => ("A", to),
            Canon::Probe { to, .. } => ("P", to),
            _ => return Ok(()),
        };
        text.push(format!("{kind} {}", place(to, event.modal)));
        Ok(())
    });
    run.map_err(|error| error.to_string())?;
    Ok(text)
}

#[track_caller]
fn expect(program: &str, expected: &[&str]) {
    assert_eq!(moves(program).unwrap_or_else(|e| panic!("{program}: {e}")), expected, "{program}");
}

#[test]
fn shifts_of_the_origin_rename_the_place() {
    expect(
        "g54 g0 x1 y1 z1\ng10 l2 p1 x10 y20\ng0 x2\ng10 l20 p1 x0\ng0 x3\ng92 x0 y0\ng0 x1 y1\ng92.2\ng0 x1\ng92.3\ng0 x2\ng92.1\ng0 x3\nm2",
        &[
            "T 1.0000 1.0000 1.0000",
            "T 2.0000 -19.0000 1.0000",
            "T 3.0000 -19.0000 1.0000",
            "T 1.0000 1.0000 1.0000",
            "T 1.0000 -18.0000 1.0000",
            "T 2.0000 1.0000 1.0000",
            "T 3.0000 -18.0000 1.0000",
        ],
    );
    expect("g55\ng0x1\ng10 l20 p1 x5 y6\ng54\ng0 z1\nm2", &["T 1.0000 0.0000 0.0000", "T 5.0000 6.0000 1.0000"]);
}

#[test]
fn a_rotated_offset_turns_machine_moves() {
    expect(
        "g10 l2 p2 x1 y1 r45\ng55\ng0 x1 y0\ng53 g0 x1\ng28\nm2",
        &["T 1.0000 0.0000 0.0000", "T 0.5000 0.5000 0.0000", "T 0.5000 0.5000 0.0000", "T -1.4142 0.0000 0.0000"],
    );
}

#[test]
fn reference_points_are_reached_by_way_of_the_words() {
    expect(
        "g0 x5 y5 z5\ng28 x1\ng28\ng28.1\ng0 x9\ng30 z0\ng53 g0 x1\nm2",
        &[
            "T 5.0000 5.0000 5.0000",
            "T 1.0000 5.0000 5.0000",
            "T 0.0000 5.0000 5.0000",
            "T 0.0000 5.0000 5.0000",
            "T 0.0000 0.0000 0.0000",
            "T 9.0000 0.0000 0.0000",
            "T 9.0000 0.0000 0.0000",
            "T 9.0000 0.0000 0.0000",
            "T 1.0000 0.0000 0.0000",
        ],
    );
}

#[test]
fn tool_offsets_rename_the_place_and_a_tool_outside_the_table_is_refused() {
    expect("g43 h2\ng0 x0\ng49\ng0 z1\nm2", &["T 0.0000 -50.8000 -508.0000", "T 25.4000 0.0000 1.0000"]);
    expect("t2 m6\ng43\ng10 l10 p2 z5\ng0 z0\ng43\ng0 z0\nm2", &["T -25.4000 -50.8000 0.0000"; 2]);
    let refused = moves("g43 h9\nm2").expect_err("refused");
    assert!(refused.starts_with("line 1, column 1: G064: tool 9"), "{refused}");
}

#[test]
fn cycles_are_the_moves_linuxcnc_makes_of_them() {
    expect(
        "f100 g0 z10\ng99 g83 x1 y1 z-5 r2 q4\ng91 g98 g81 x1 z-2 r-1 l2\nm2",
        &[
            "T 0.0000 0.0000 10.0000",
            "T 1.0000 1.0000 10.0000",
            "T 1.0000 1.0000 2.0000",
            "F 1.0000 1.0000 -2.0000",
            "T 1.0000 1.0000 2.0000",
            "T 1.0000 1.0000 -1.7460",
            "F 1.0000 1.0000 -5.0000",
            "T 1.0000 1.0000 2.0000",
            "T 2.0000 1.0000 10.0000",
            "T 2.0000 1.0000 9.0000",
            "F 2.0000 1.0000 7.0000",
            "T 2.0000 1.0000 10.0000",
            "T 3.0000 1.0000 10.0000",
            "T 3.0000 1.0000 9.0000",
            "F 3.0000 1.0000 7.0000",
            "T 3.0000 1.0000 10.0000",
        ],
    );
}

#[test]
fn a_probe_is_taken_to_answer_a_hundredth_of_an_inch_before_the_end() {
    expect(
        "f100\ng38.2 z-5\ng38.3 x1\ng1 y1\nm2",
        &["P 0.0000 0.0000 -5.0000", "P 1.0000 0.0000 -4.7460", "F 0.7460 1.0000 -4.7460"],
    );
}

#[test]
fn polar_words_name_places_about_the_origin() {
    expect(
        "f100 g0 x1 y1\n@5 ^30\ng91 @1 ^15\ng90 ^0\ng1 @3\nm2",
        &[
            "T 1.0000 1.0000 0.0000",
            "T 4.3301 2.5000 0.0000",
            "T 4.2426 4.2426 0.0000",
            "T 6.0000 0.0000 0.0000",
            "F 3.0000 0.0000 0.0000",
        ],
    );
}

#[test]
fn saved_modes_come_back_when_the_subroutine_returns() {
    expect("f100\no1 sub\nm73\ng91\no1 endsub\no1 call\ng1 x1\nx1\nm2", &["F 1.0000 0.0000 0.0000"; 2]);
}

#[test]
fn a_tool_change_after_compensation_names_the_place_where_the_cutter_was_left() {
    expect(
        "g20 f10\ng0 x0 y0 z0\ng1 y-10\ng41.1 d2 g1 x0 y0\nx10\ng40\nt1 m6\ng0 z20\nm2",
        &[
            "T 0.0000 0.0000 0.0000",
            "F 0.0000 -10.0000 0.0000",
            "F -1.0000 0.0000 0.0000",
            "A 0.0000 1.0000 0.0000",
            "F 10.0000 1.0000 0.0000",
            "T 10.0000 1.0000 20.0000",
        ],
    );
}

#[test]
fn machine_coordinates_are_parameters() {
    expect(
        "g20\ng0 x0 y0 z0\ng10 l2 p1 x5 y6 z7\ng0 x1 y2 z3\ng0 x#<_abs_x> y#<_abs_y> z#<_abs_z>\nm2",
        &["T 0.0000 0.0000 0.0000", "T 1.0000 2.0000 3.0000", "T 6.0000 8.0000 10.0000"],
    );
}
