//! Tests of the cutter's path: examples, symmetry to the last bit, and accuracy against floating point.
#![allow(
    clippy::arithmetic_side_effects,
    clippy::float_arithmetic,
    clippy::indexing_slicing,
    clippy::unwrap_used,
    clippy::panic
)]

mod accuracy;
mod examples;
mod symmetry;

use std::vec::Vec;

use super::{CompensationError, Cutter, CutterPath, Piece, Shape, StartUp};
use truepath_units::Offset;
use truepath_units::geometry::{Point, Side};

const MM: i64 = 1_000_000;

/// A point in thousandths of a millimetre.
fn at(x: i64, y: i64) -> Point {
    Point::from_nm(x * 1_000, y * 1_000)
}

fn cutter(side: Side, radius_nm: i64) -> Cutter {
    Cutter { side, radius: Offset::from_nm(radius_nm) }
}

fn line(from: Point, to: Point) -> Piece {
    Piece { from, to, shape: Shape::Line }
}

fn arc(from: Point, to: Point, centre: Point, counter_clockwise: bool) -> Piece {
    Piece { from, to, shape: Shape::Arc { centre, counter_clockwise, turns: 0 } }
}

/// The whole path of the cutter.
fn path(cutter: Cutter, pieces: &[Piece]) -> Result<Vec<Piece>, CompensationError> {
    let mut path = CutterPath::new(cutter, StartUp::Own);
    let mut out = Vec::new();
    for &piece in pieces {
        let step = path.push(piece)?;
        out.extend(step.finished);
        out.extend(step.corner);
    }
    out.extend(path.finish()?);
    for (a, b) in out.iter().zip(out.iter().skip(1)) {
        assert_eq!(a.to, b.from, "the path has no gap");
    }
    Ok(out)
}
