//! From a move to the locations that are inserted in it, as they will be written.
//!
//! The division itself (how many pieces, where) is [`insert`](crate::insert); here its locations are rounded
//! to the digits of the program, and what the rounded ones do is proved again: the error of a piece is the certified
//! error from its own chord and how far its ends lie from the programmed one. When rounding has used up the tolerance,
//! the move is divided once more with a tighter one.

use truepath_core::gcode::Units;

use super::digits::Digits;
use super::quantity::{Quantity, Scale};
use super::reason::Reason;
use super::state::Place;
use super::step::Move;
use crate::division::Orientation;
use crate::machine::Coordinates;
use crate::singular::{Class, passage};
use crate::{DivisionError, Joints, Machine, Rule, chord_error, insert};

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

/// What the words of a move are measured in.
#[derive(Clone, Copy, Debug)]
pub struct Writing {
    /// What XYZ are.
    pub coordinates: Coordinates,
    /// Their unit.
    pub units: Units,
    /// The most decimals the program writes, of lengths and of angles.
    pub own: [u8; 2],
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
    /// How it stands to the pole.
    pub passage: Class,
    /// Whether the tool axis leaves the great circle too far, and cannot follow it.
    pub cannot_follow: bool,
    /// Why it is not divided although it errs too much.
    pub refused: Option<Reason>,
}

/// Tighter tolerances that are tried when rounding has used up the first.
const TRIES: [f64; 5] = [1.0, 0.97, 0.9, 0.7, 0.4];

impl Splitter<'_> {
    /// The joints at both ends of a move.
    pub(super) fn ends(&self, moved: &Move, writing: Writing) -> [Joints; 2] {
        [self.joints(&moved.start, writing), self.joints(&moved.end, writing)]
    }

    /// Plans a move.
    pub fn plan(&self, moved: &Move, writing: Writing) -> Plan {
        let [from, to] = self.ends(moved, writing);
        let error = chord_error(self.machine, &from, &to);
        let passage = passage(self.machine, &from, &to);
        let mut plan = Plan {
            before: error.exact,
            inserted: Vec::new(),
            shares: vec![1.0],
            after: vec![error.exact],
            passage: passage.class,
            cannot_follow: false,
            refused: None,
        };
        let follows = self.machine.orientation_tolerance().is_none_or(|most| passage.orientation_error <= most);
        if error.bound <= self.tolerance && follows {
            return plan;
        }
        // Rounded angles turn the ends of a piece, and its great circle with them.
        let guided = self.machine.orientation_tolerance().map(|most| {
            let turned = 2.0 * self.digits.turn(writing.own);
            most - turned.min(most / 2.0)
        });
        let machine = self.machine.clone().with_orientation_tolerance(guided.filter(|_| !follows));
        let margin = self.digits.displacement(Scale::of_axis(0, writing.units), writing.own);
        for share in TRIES {
            let insertion = match insert(&machine, &from, &to, (self.tolerance - margin) * share, self.rule) {
                Ok(insertion) => insertion,
                Err(DivisionError::TooManyPieces) => {
                    plan.refused = Some(Reason::Pieces);
                    return plan;
                }
                Err(_) => break,
            };
            plan.cannot_follow = insertion.orientation == Orientation::CannotFollow;
            if error.bound <= self.tolerance && (plan.cannot_follow || insertion.inserted.is_empty()) {
                return plan;
            }
            if insertion.inserted.len() >= self.max_pieces {
                plan.refused = Some(Reason::Pieces);
                return plan;
            }
            if let Some(beyond) = insertion.inserted.iter().find_map(|joints| self.machine.beyond(joints)) {
                plan.refused = Some(Reason::Travel(beyond.letter));
                return plan;
            }
            let Some((places, errors)) = self.written(moved, (&from, &to), &insertion.inserted, writing) else { break };
            if errors.iter().all(|error| *error <= self.tolerance) {
                plan.shares = self.shares((&from, &to), &insertion.inserted);
                (plan.inserted, plan.after) = (places, errors);
                return plan;
            }
        }
        plan.refused = Some(Reason::Digits);
        plan
    }

    /// The joints of a place in the frame of the machine file.
    fn joints(&self, frame: &[f64; 6], writing: Writing) -> Joints {
        let [x, y, z, ..] = *frame;
        let rotary = self.machine.rotary().map(|axis| frame[3 + axis.letter.index()]);
        let joints = Joints::from_degrees([x, y, z], rotary);
        match writing.coordinates {
            Coordinates::Joints => joints,
            Coordinates::Tip => self.machine.inverse([x, y, z], joints.rotary),
        }
    }

    /// The share of each piece: in the length of the chord, or in the turn when it has none.
    fn shares(&self, (from, to): (&Joints, &Joints), inserted: &[Joints]) -> Vec<f64> {
        let turns = distance(self.machine.counted(from), self.machine.counted(to)) < 1e-6;
        let mut last = from;
        let lengths: Vec<f64> = inserted
            .iter()
            .chain([to])
            .map(|joints| {
                let before = std::mem::replace(&mut last, joints);
                if turns {
                    (joints.rotary[0] - before.rotary[0]).abs() + (joints.rotary[1] - before.rotary[1]).abs()
                } else {
                    distance(self.machine.counted(before), self.machine.counted(joints))
                }
            })
            .collect();
        let whole: f64 = lengths.iter().sum();
        lengths.iter().map(|length| length / whole).collect()
    }

    /// The rounded locations, and the error of each piece.
    fn written(
        &self,
        moved: &Move,
        (from, to): (&Joints, &Joints),
        inserted: &[Joints],
        writing: Writing,
    ) -> Option<(Vec<Place>, Vec<f64>)> {
        let (mut places, mut errors) = (Vec::with_capacity(inserted.len()), Vec::with_capacity(inserted.len() + 1));
        let (mut last, mut last_off) = (*from, 0.0f64);
        for joints in inserted {
            let point = self.machine.counted(joints);
            let (place, frame) = self.rounded(moved, joints, point, writing)?;
            let joints = self.joints(&frame, writing);
            let off = distance(self.machine.counted(&joints), point);
            errors.push(chord_error(self.machine, &last, &joints).bound + last_off.max(off));
            (last, last_off) = (joints, off);
            places.push(place);
        }
        errors.push(chord_error(self.machine, &last, to).bound + last_off);
        Some((places, errors))
    }

    /// A location as it is written, and where that is in the frame of the machine file: the angles are rounded, and the
    /// lengths follow from the rounded angles.
    fn rounded(&self, moved: &Move, joints: &Joints, point: [f64; 3], writing: Writing) -> Option<(Place, [f64; 6])> {
        let (mut place, mut frame) = (moved.from, moved.start);
        let shift = |axis: usize| Some(moved.start[axis] - moved.from[axis]?.value());
        for (axis, angle) in self.machine.rotary().iter().zip(joints.rotary_deg()) {
            let axis = 3 + axis.letter.index();
            let decimals = self.digits.of(Scale::Degrees, writing.own);
            let angle =
                Quantity::nearest(angle - shift(axis)?, Scale::Degrees)?.with_decimals(decimals, Scale::Degrees);
            place[axis] = Some(angle);
            frame[axis] = angle.value() + shift(axis)?;
        }
        let rotary = self.machine.rotary().map(|axis| frame[3 + axis.letter.index()].to_radians());
        let joints = self.machine.inverse_counted(point, rotary);
        let xyz = match writing.coordinates {
            Coordinates::Joints => joints.xyz,
            Coordinates::Tip => self.machine.forward(&joints).tip,
        };
        for axis in 0..3 {
            let scale = Scale::of_axis(axis, writing.units);
            let decimals = self.digits.of(scale, writing.own);
            let length = Quantity::nearest(xyz[axis] - shift(axis)?, scale)?.with_decimals(decimals, scale);
            place[axis] = Some(length);
            frame[axis] = length.value() + shift(axis)?;
        }
        Some((place, frame))
    }
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt()
}
