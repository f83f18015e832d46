//! Everything that is inserted into one move: against the chord error, and on request against the orientation error.
//!
//! Without an orientation tolerance the rotary words stay linear and locations are inserted on the chord alone; the
//! orientation error stays what it is and is reported. With one ([`Machine::orientation_tolerance`]) a move that exceeds
//! it gets locations on the great circle first, each piece of which is then divided for the chord.

use super::{DivisionError, MOST_PIECES, Rule, Span, divide, divide_known};
use crate::Machine;
use crate::chord::{ChordError, chord_error};
use crate::machine::Joints;
use crate::singular::{Passage, follow, orientation_error, passage};

/// What was done about the orientation of a move.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Orientation {
    /// It is within the tolerance, or there is none.
    Kept,
    /// Locations on the great circle were inserted.
    Followed,
    /// It exceeds the tolerance, and the inverse of the orientation does not lead from one end to the other: reported,
    /// the rotary words stay linear.
    CannotFollow,
}

/// A move with what was inserted into it.
#[derive(Clone, Debug, PartialEq)]
pub struct Insertion {
    /// The inserted locations in order, without the ends of the move.
    pub inserted: Vec<Joints>,
    /// Chord error of the move as it was.
    pub before: ChordError,
    /// Largest chord error of a piece, mm, certified, as in [`Division`](super::Division).
    pub after: f64,
    /// The passage of the move as it was.
    pub passage: Passage,
    /// What was done about the orientation.
    pub orientation: Orientation,
    /// Largest orientation error that is left, rad.
    pub orientation_after: f64,
}

/// Inserts locations into the linear joint move `from` → `to` until no piece leaves its chord by more than
/// `tolerance_mm`, and the orientation keeps to the machine's tolerance where it can.
///
/// # Errors
/// Those of [`divide`].
pub fn insert(
    machine: &Machine,
    from: &Joints,
    to: &Joints,
    tolerance_mm: f64,
    rule: Rule,
) -> Result<Insertion, DivisionError> {
    if !(from.is_finite() && to.is_finite()) {
        return Err(DivisionError::NotFinite);
    }
    let before = chord_error(machine, from, to);
    let passage = passage(machine, from, to);
    let tolerance = machine.orientation_tolerance().filter(|&tolerance| passage.orientation_error > tolerance);
    let guided = tolerance.and_then(|tolerance| follow(machine, from, to, tolerance, MOST_PIECES / 2));
    let orientation = match (tolerance, &guided) {
        (None, _) => Orientation::Kept,
        (Some(_), Some(_)) => Orientation::Followed,
        (Some(_), None) => Orientation::CannotFollow,
    };
    if orientation != Orientation::Followed {
        let division = divide_known(machine, from, to, tolerance_mm, rule, before.bound)?;
        let inserted = division.inserted.into_iter().map(|(_, joints)| joints).collect();
        let orientation_after = passage.orientation_error;
        return Ok(Insertion { inserted, before, after: division.after, passage, orientation, orientation_after });
    }
    let span = Span::new(machine, from, to, tolerance_mm);
    let guides = guided.unwrap_or_default().into_iter().map(|(s, rotary)| span.place(s, rotary));
    let mut inserted = Vec::new();
    let (mut after, mut orientation_after) = (0.0f64, 0.0f64);
    let mut last = *from;
    for guide in guides.chain([*to]) {
        let division = divide(machine, &last, &guide, tolerance_mm, rule)?;
        inserted.extend(division.inserted.iter().map(|(_, joints)| *joints));
        inserted.push(guide);
        if inserted.len() > MOST_PIECES {
            return Err(DivisionError::TooManyPieces);
        }
        after = after.max(division.after);
        orientation_after = orientation_after.max(orientation_error(machine, &last, &guide).0);
        last = guide;
    }
    inserted.pop();
    Ok(Insertion { inserted, before, after, passage, orientation, orientation_after })
}
