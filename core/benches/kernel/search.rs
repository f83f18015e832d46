//! The search for the finishing contours of a program: its words, its moves, and what each run is for.

use super::Work;
use std::fmt::Write;
use std::hint::black_box;
use truepath_core::gcode::{Candidate, ContourOptions, Criteria, Found, HostMemory, Program, search, visit_runs};
use truepath_core::geometry::{Block, Side};
use truepath_core::units::Offset;

const BEGIN: &str = "G21 G90 G17 G40\nT1 M6\nS8000 M3\nG0 X0 Y0 Z5\n";
const END: &str = "G0 Z20\nM30\n";

/// A pocket cleared in a spiral of straight lines, from its middle outwards, and finished in one lap.
pub fn pocketing(lines: usize) -> String {
    let mut text = format!("{BEGIN}G1 Z-5 F300\nF1200\n");
    let laps = lines / 4;
    for lap in 1..=laps {
        let (x, y) = (lap as f64 * 0.004, lap as f64 * 0.002);
        let _ = write!(text, "G1 X{x:.4} Y-{y:.4}\nY{y:.4}\nX-{x:.4}\nY-{y:.4}\n");
    }
    let (x, y) = (laps as f64 * 0.004 + 0.3, laps as f64 * 0.002 + 0.3);
    let _ = write!(text, "G0 Z5\nX0 Y-{y:.4}\nG1 Z-5 F300\nX{x:.4} F900\nY{y:.4}\nX-{x:.4}\nY-{y:.4}\nX0\n");
    text + END
}

/// A profile of 200 short lines, cut again and again, deeper and deeper.
pub fn depths(lines: usize) -> String {
    let profile = polygon([0.0, 0.0], 40.0, 200);
    (1..=lines / 200).fold(BEGIN.to_owned(), |text, depth| text + &lap(&profile, depth as f64 * 0.1))
}

/// A plate of small closed contours of twenty lines each, in rows.
pub fn contours(lines: usize) -> String {
    let place = |k: usize| [(k % 30) as f64 * 12.0, (k / 30) as f64 * 12.0];
    (0..lines / 20).fold(BEGIN.to_owned(), |text, k| text + &lap(&polygon(place(k), 4.0, 20), 3.0))
}

/// Clearing after the manner of adaptive paths: at every one of 10 depths bites of a hundred lines along an arc that move on a
/// little, each joined to the next by a lift.
pub fn adaptive(lines: usize) -> String {
    let bites = lines / 100;
    let bite = |k: usize| {
        let (row, depth) = (k % bites.div_ceil(10), 1 + 10 * k / bites);
        let x = row as f64 * 0.6;
        let at = |j: usize| {
            let turn = std::f64::consts::PI * j as f64 / 100.0;
            [x + 6.0 * turn.sin(), 12.0 - 12.0 * turn.cos() + 0.1 * depth as f64]
        };
        lap(&(0..=100).map(at).collect::<Vec<_>>(), depth as f64)
    };
    (0..bites).fold(BEGIN.to_owned(), |text, k| text + &bite(k))
}

fn polygon(middle: [f64; 2], radius: f64, corners: usize) -> Vec<[f64; 2]> {
    let at = |k: usize| {
        let turn = std::f64::consts::TAU * (k % corners) as f64 / corners as f64;
        [middle[0] + radius * turn.cos(), middle[1] + radius * turn.sin()]
    };
    (0..=corners).map(at).collect()
}

/// Down at the first point, along the others, and up.
fn lap(points: &[[f64; 2]], depth: f64) -> String {
    let mut text = String::new();
    for (k, [x, y]) in points.iter().enumerate() {
        let _ = match k {
            0 => write!(text, "G0 X{x:.3} Y{y:.3}\nG1 Z-{depth:.2} F300\nF900\n"),
            _ => writeln!(text, "X{x:.3} Y{y:.3}"),
        };
    }
    text + "G0 Z5\n"
}

/// A search, with a cutter of 6 mm and the wall on the right.
pub fn work(text: String) -> Work {
    let mut memory = Box::new(HostMemory::new());
    let criteria = Criteria { tool: None, wall: Some(Side::Right), diameter: Offset::from_um(6_000), named: false };
    Box::new(move || {
        let mut blocks: Vec<Block> = Vec::new();
        let mut read: Vec<Candidate> = Vec::new();
        let program = Program::new(black_box(text.as_bytes()));
        let (on_block, on_run) = (|block: &Block| blocks.push(*block), |run: &Candidate| read.push(*run));
        let summary = visit_runs(&program, &mut memory.lend(), &ContourOptions::default(), on_block, on_run);
        assert!(summary.is_ok(), "{summary:?}");
        let mut first = 0;
        let runs = read.into_iter().map(|run| {
            let found = Found::new(run, first);
            first += run.blocks;
            found
        });
        let mut runs: Vec<Found> = runs.collect();
        let contours = search(&mut runs, &blocks, &criteria);
        assert!(contours > 0, "no contour among {} runs", runs.len());
        black_box(contours);
    })
}
