//! Cutter radius compensation against the motion that LinuxCNC's interpreter gave for the same programs.
//!
//! `data/compensation/NAME.nc` are the programs, `NAME.motion` what was recorded of them: one line a move, in the unit
//! of the program (`feed`, `traverse`: end X Y Z; `arc`: first and second end, first and second centre, turns with
//! their sense, end of the third axis), or `error LINE` where it stopped.
#![allow(clippy::unwrap_used, clippy::arithmetic_side_effects, clippy::indexing_slicing, clippy::panic)]

use crate::interpret::interpret;
use std::path::{Path, PathBuf};

use truepath_rs274::{Axes, Canon, CompensationBy, DeviceMemory, GcodeError, Options, Plane, Tool, Units};
use truepath_units::geometry::Point;
use truepath_units::{Offset, Position};

/// What the recorded digits allow, and a little for the reference's own rounding, in its unit.
const TOLERANCE: f64 = 1e-4;

const fn tool(number: u32, diameter_mm: i64) -> Tool {
    Tool { number, diameter: Offset::from_nm(diameter_mm * 1_000_000), ..Tool::NONE }
}

/// The tools in the table when the motion was recorded.
const TOOLS: [Tool; 5] = [tool(1, 10), tool(2, 0), tool(3, -10), tool(4, 4), tool(5, 20)];

#[derive(Clone, Debug)]
struct Move {
    kind: &'static str,
    numbers: Vec<f64>,
}

fn programs() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/compensation");
    let files = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let mut programs: Vec<PathBuf> = files.filter(|path| path.extension().is_some_and(|e| e == "nc")).collect();
    programs.sort();
    programs
}

fn run(program: &[u8]) -> (Vec<Move>, Option<GcodeError>) {
    let mut moves = Vec::new();
    let options =
        Options { start: Axes::ORIGIN, compensation: CompensationBy::Table, tools: &TOOLS, ..Options::default() };
    let answer = interpret(options, program, &mut DeviceMemory::new().lend(), &mut |event| {
        let unit = if event.modal.units == Units::Inches { 25.4e6 } else { 1e6 };
        let number = |p: Position| p.nm() as f64 / unit;
        let place = |at: Axes| [at.x, at.y, at.z].map(|p| p.map_or(f64::NAN, number)).to_vec();
        let mut arc = |plane: Plane, to: Axes, centre: Point, ccw: bool, turns: u32| {
            let [first, second, third] = plane.axes().map(|axis| number(to.get(axis).unwrap()));
            let rotation = f64::from(turns + 1) * if ccw { 1.0 } else { -1.0 };
            let numbers = vec![first, second, number(centre.x), number(centre.y), rotation, third];
            moves.push(Move { kind: "arc", numbers });
        };
        match *event.canon {
            Canon::Arc { to, centre, counter_clockwise, turns, .. } => {
                arc(Plane::Xy, to, centre, counter_clockwise, turns);
            }
            Canon::PlaneArc { plane, to, centre, counter_clockwise, turns, .. } => {
                arc(plane, to, centre, counter_clockwise, turns);
            }
            Canon::Feed { to, .. } => moves.push(Move { kind: "feed", numbers: place(to) }),
            Canon::Traverse { to, .. } => moves.push(Move { kind: "traverse", numbers: place(to) }),
            _ => {}
        }
        Ok(())
    });
    (moves, answer.err())
}

/// What differs between a program's motion and the recorded one.
fn difference(program: &Path) -> Option<String> {
    let recorded = std::fs::read_to_string(program.with_extension("motion")).unwrap();
    let (moves, error) = run(&std::fs::read(program).unwrap());
    let mut moves = moves.iter();
    for line in recorded.lines() {
        let (kind, numbers) = line.split_once(' ').unwrap();
        if kind == "error" {
            let found = error.map(|e| e.line);
            return (found != Some(numbers.parse().unwrap())).then(|| format!("{line}: stopped at {error:?}"));
        }
        let numbers: Vec<f64> = numbers.split(' ').map(|n| n.parse().unwrap()).collect();
        let same =
            |m: &&Move| m.kind == kind && m.numbers.iter().zip(&numbers).all(|(a, b)| (a - b).abs() <= TOLERANCE);
        let found = moves.next();
        if found.filter(same).is_none() {
            return Some(format!("{line}: found {found:?} {error:?}"));
        }
    }
    match (moves.next(), error) {
        (None, None) => None,
        more => Some(format!("after the last move: {more:?}")),
    }
}

#[test]
fn every_program_moves_as_the_reference_recorded_or_stops_at_its_line() {
    let programs = programs();
    assert!(programs.len() >= 114, "{} programs", programs.len());
    let differences: Vec<String> = programs
        .iter()
        .filter_map(|program| Some(format!("{}: {}", program.file_stem()?.to_string_lossy(), difference(program)?)))
        .collect();
    assert!(differences.is_empty(), "\n{}", differences.join("\n"));
}
