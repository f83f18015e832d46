//! From a move to the locations that are inserted in it, as they will be written.
//!
//! The division itself (how many pieces, where) is [`divide`](crate::multiaxis::divide); here its locations are rounded
//! to the digits of the program, and what the rounded ones do is proved again: the error of a piece is the certified
//! error from its own chord and how far its ends lie from the programmed one. When rounding has used up the tolerance,
//! the move is divided once more with a tighter one.

use truepath_core::gcode::Units;

use super::digits::Digits;
use super::quantity::{Quantity, Scale};
use super::reason::Reason;
use super::state::Place;
use super::step::Move;
use crate::multiaxis::machine::Coordinates;
use crate::multiaxis::{DivisionError, Joints, Machine, Rule, chord_error, divide};

/// How moves are divided.
#[derive(Clone, Copy, Debug)]
pub struct Splitter<'m> {
    /// The machine.
    pub machine: &'m Machine,
    /// Largest chord error, mm.
    pub tolerance: f64,
    /// Where locations are inserted.
    pub rule: Rule,
    /// Most pieces of one move.
    pub max_pieces: usize,
    /// Decimals the control takes.
    pub digits: Digits,
}

/// What becomes of a move.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// Its chord error, mm.
    pub before: f64,
    /// The inserted locations, program coordinates, as they are written; none when it stays as it is.
    pub inserted: Vec<Place>,
    /// The share of each piece in the move.
    pub shares: Vec<f64>,
    /// The chord error of each piece from the programmed chord, mm.
    pub after: Vec<f64>,
    /// Why it is not divided although it errs too much.
    pub refused: Option<Reason>,
}

/// Tighter tolerances that are tried when rounding has used up the first.
const TRIES: [f64; 5] = [1.0, 0.97, 0.9, 0.7, 0.4];

impl Splitter<'_> {
    /// Whether the digits can keep the tolerance at all.
    pub fn digits_suffice(&self, units: Units, own: [u8; 2]) -> bool {
        4.0 * self.digits.displacement(Scale::of_axis(0, units), own) <= self.tolerance
    }

    /// Plans a move whose XYZ are `coordinates`, written in `units`, in a program whose words have `own` decimals.
    pub fn plan(&self, moved: &Move, coordinates: Coordinates, units: Units, own: [u8; 2]) -> Plan {
        let (from, to) = (self.joints(&moved.start, coordinates), self.joints(&moved.end, coordinates));
        let error = chord_error(self.machine, &from, &to);
        let mut plan = Plan {
            before: error.exact,
            inserted: Vec::new(),
            shares: vec![1.0],
            after: vec![error.exact],
            refused: None,
        };
        if error.bound <= self.tolerance {
            return plan;
        }
        let margin = self.digits.displacement(Scale::of_axis(0, units), own);
        for share in TRIES {
            let division = match divide(self.machine, &from, &to, (self.tolerance - margin) * share, self.rule) {
                Ok(division) => division,
                Err(DivisionError::TooManyPieces) => {
                    plan.refused = Some(Reason::Pieces);
                    return plan;
                }
                Err(_) => break,
            };
            if division.pieces() > self.max_pieces {
                plan.refused = Some(Reason::Pieces);
                return plan;
            }
            let knots: Vec<f64> = division.inserted.iter().map(|&(s, _)| s).collect();
            let Some(written) = self.written(moved, (&from, &to), &knots, coordinates, units, own) else { break };
            if written.1.iter().all(|error| *error <= self.tolerance) {
                let ends = knots.iter().copied().chain([1.0]);
                plan.shares = ends.scan(0.0, |last, s| Some(s - std::mem::replace(last, s))).collect();
                (plan.inserted, plan.after) = written;
                return plan;
            }
        }
        plan.refused = Some(Reason::Digits);
        plan
    }

    /// Whether a move passes a pole of the machine nearer than its file allows.
    pub fn is_singular(&self, moved: &Move, coordinates: Coordinates) -> bool {
        let (from, to) = (self.joints(&moved.start, coordinates), self.joints(&moved.end, coordinates));
        [from, to].iter().any(|j| self.machine.from_pole(self.machine.axis(j.rotary)) < self.machine.pole())
    }

    /// The joints of a place in the frame of the machine file.
    fn joints(&self, frame: &[f64; 6], coordinates: Coordinates) -> Joints {
        let [x, y, z, ..] = *frame;
        let rotary = self.machine.rotary().map(|axis| frame[3 + axis.letter.index()]);
        let joints = Joints::from_degrees([x, y, z], rotary);
        match coordinates {
            Coordinates::Joints => joints,
            Coordinates::Tip => self.machine.inverse([x, y, z], joints.rotary),
        }
    }

    /// The rounded locations at the parameters `knots` of the chord, and the error of each piece.
    fn written(
        &self,
        moved: &Move,
        (from, to): (&Joints, &Joints),
        knots: &[f64],
        coordinates: Coordinates,
        units: Units,
        own: [u8; 2],
    ) -> Option<(Vec<Place>, Vec<f64>)> {
        let chord = [self.machine.counted(from), self.machine.counted(to)];
        let at = |s: f64| std::array::from_fn(|i| chord[0][i] + s * (chord[1][i] - chord[0][i]));
        let (mut places, mut errors) = (Vec::with_capacity(knots.len()), Vec::with_capacity(knots.len() + 1));
        let (mut last, mut last_off) = (*from, 0.0f64);
        for &s in knots {
            let point: [f64; 3] = at(s);
            let mut place = moved.from;
            let mut frame = moved.start;
            for axis in self.machine.rotary() {
                let axis = 3 + axis.letter.index();
                let shift = moved.start[axis] - moved.from[axis]?.value();
                let between = moved.start[axis] + s * (moved.end[axis] - moved.start[axis]) - shift;
                let decimals = self.digits.of(Scale::Degrees, own);
                let angle = Quantity::nearest(between, Scale::Degrees)?.with_decimals(decimals, Scale::Degrees);
                place[axis] = Some(angle);
                frame[axis] = angle.value() + shift;
            }
            let rotary = self.machine.rotary().map(|axis| frame[3 + axis.letter.index()].to_radians());
            let joints = self.machine.inverse_counted(point, rotary);
            let xyz = match coordinates {
                Coordinates::Joints => joints.xyz,
                Coordinates::Tip => self.machine.forward(&joints).tip,
            };
            for axis in 0..3 {
                let shift = moved.start[axis] - moved.from[axis]?.value();
                let scale = Scale::of_axis(axis, units);
                let length = Quantity::nearest(xyz[axis] - shift, scale)?;
                let length = length.with_decimals(self.digits.of(scale, own), scale);
                place[axis] = Some(length);
                frame[axis] = length.value() + shift;
            }
            let joints = self.joints(&frame, coordinates);
            let off = distance(self.machine.counted(&joints), point);
            errors.push(chord_error(self.machine, &last, &joints).bound + last_off.max(off));
            (last, last_off) = (joints, off);
            places.push(place);
        }
        errors.push(chord_error(self.machine, &last, to).bound + last_off);
        Some((places, errors))
    }
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt()
}
