//! How fast five-axis moves are measured, proved and divided, and how fast `truepath multiaxis` works through a program.
//!
//! The moves are those of a finishing pass on a trunnion AC: 1 mm of chord and up to 2° of turn each, 120 mm from the
//! pivot, always the same; at 5 µm about half of them are divided. Every figure is the best of five runs on one core. The
//! command (named by the environment variable `TRUEPATH`) reads the same moves as a program and writes it anew; its
//! start counts. Printed: one line a kernel, moves a second.

use std::f64::consts::PI;
use std::fmt::Write as _;
use std::hint::black_box;
use std::process::{Command, Stdio};
use std::time::Instant;

use truepath_multiaxis::machine::{Letter, Machine, Rotary, Sense, Side, Tool};
use truepath_multiaxis::{Joints, Rule, chord_error, chord_estimate, divide, insert};

/// Moves of the pass.
const MOVES: usize = 20_000;
/// Largest chord error, mm.
const TOLERANCE: f64 = 0.005;
/// How often each kernel runs.
const REPEATS: usize = 5;

fn machine() -> Machine {
    let axis =
        |letter| Rotary { letter, side: Side::Table, point_mm: [0.0; 3], sense: Sense::RightHand, limits_deg: None };
    Machine::new([axis(Letter::A), axis(Letter::C)], Tool::default()).expect("two letters")
}

/// Tips on a spiral over a dome, the tool leaning after the surface in waves.
fn joints(machine: &Machine) -> Vec<Joints> {
    let place = |i: usize| {
        let s = i as f64 * 1.0;
        let (around, lean) = (s / 60.0, 25.0 + 15.0 * (s / 40.0).sin());
        let tip = [60.0 * around.cos(), 60.0 * around.sin(), 100.0 + 5.0 * (s / 90.0).sin()];
        machine.inverse(tip, [lean.to_radians(), around + 0.3 * (s / 25.0).cos() + PI / 8.0])
    };
    (0..=MOVES).map(place).collect()
}

/// Moves a second of the best of several runs.
fn best(moves: usize, mut run: impl FnMut()) -> f64 {
    let mut least = f64::INFINITY;
    for _ in 0..REPEATS {
        let start = Instant::now();
        run();
        least = least.min(start.elapsed().as_secs_f64());
    }
    moves as f64 / least
}

/// Moves a second of a kernel.
fn over<T>(joints: &[Joints], mut work: impl FnMut(&Joints, &Joints) -> T) -> f64 {
    best(joints.len() - 1, || {
        for pair in joints.windows(2) {
            black_box(work(&pair[0], &pair[1]));
        }
    })
}

/// The whole command over the same moves as a program; `None` when it is not there.
fn command(joints: &[Joints]) -> Option<f64> {
    let binary = std::env::var_os("TRUEPATH")?;
    let folder = tempfile::tempdir().ok()?;
    let file = |name: &str| folder.path().join(name);
    let machine = "version = 1\nkind = \"table-table\"\n[[rotary]]\naxis = \"A\"\n[[rotary]]\naxis = \"C\"\n";
    std::fs::write(file("m.toml"), machine).ok()?;
    let mut text = String::from("G21 G90 G94\nF1500\n");
    for (i, joints) in joints.iter().enumerate() {
        let ([x, y, z], [a, c]) = (joints.xyz, joints.rotary_deg());
        // The control is taken to the start first.
        let code = if i == 0 { "G0" } else { "G1" };
        writeln!(text, "{code} X{x:.4} Y{y:.4} Z{z:.4} A{a:.4} C{c:.4}").ok()?;
    }
    text.push_str("M2\n");
    std::fs::write(file("in.ngc"), text).ok()?;
    let mut command = Command::new(binary);
    command.arg("multiaxis").arg(file("in.ngc")).arg("--machine").arg(file("m.toml"));
    command.args(["--tolerance", &TOLERANCE.to_string(), "--force", "-o"]).arg(file("out.ngc"));
    command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    if !command.status().is_ok_and(|status| status.success()) {
        return None;
    }
    Some(best(joints.len() - 1, || {
        black_box(command.status().expect("it was started before"));
    }))
}

fn main() {
    let machine = machine();
    let joints = joints(&machine);
    let divided = |rule| over(&joints, |a, b| divide(&machine, a, b, TOLERANCE, rule).expect("a division"));
    let mut rows = vec![
        ("closed form", over(&joints, |a, b| chord_estimate(&machine, a, b))),
        ("certified maximum", over(&joints, |a, b| chord_error(&machine, a, b))),
        ("equal division", divided(Rule::Equal)),
        ("midpoint halving", divided(Rule::Midpoint)),
        ("fewest pieces", divided(Rule::Fewest)),
        (
            "fewest pieces, and the passage of the pole",
            over(&joints, |a, b| insert(&machine, a, b, TOLERANCE, Rule::Fewest).expect("an insertion")),
        ),
    ];
    rows.extend(command(&joints).map(|rate| ("`truepath multiaxis`, program to program", rate)));
    for (name, rate) in rows {
        println!("{name}\t{rate:.0}");
    }
    let pieces = |rule| -> usize {
        joints.windows(2).map(|p| divide(&machine, &p[0], &p[1], TOLERANCE, rule).map_or(0, |d| d.pieces())).sum()
    };
    let made = [Rule::Midpoint, Rule::Equal, Rule::Fewest].map(pieces);
    eprintln!("{MOVES} moves; pieces by halving {}, equal {}, fewest {}", made[0], made[1], made[2]);
}
