//! Inserted locations: a move is divided until every piece keeps to its chord.
//!
//! **Where.** An inserted location lies on the programmed chord: at the parameter s the counted point is
//! `p₀ + s(p₁ − p₀)`, the rotary words are `θ₀ + s(θ₁ − θ₀)`, and the linear words follow from the inverse kinematics. Each
//! piece then is a linear joint move of its own, with its own chord, a part of the programmed one.
//!
//! **How many.** [`Rule::Midpoint`] halves every piece that errs too much (the paper). [`Rule::Equal`] makes
//! ⌈√(ε/tolerance)⌉ equal pieces, since the error falls with the square of their length, and one more while any of them
//! still errs. [`Rule::Longest`] makes each piece as long as the tolerance lets it, which is fewer where the error is
//! uneven along the move. [`Rule::Fewest`] takes the smallest of the three, so never more than midpoint halving.
//!
//! **Proof.** Every piece of every division has passed [`within`](super::chord::within): its largest distance from its
//! chord is proved, not sampled.
//!
//! Limits: at most [`MOST_PIECES`] pieces a move; tolerances the rounding of `f64` cannot resolve are an error.

mod insert;
mod rules;
mod span;

use span::Span;

use super::Machine;
use super::chord::chord_error;
use super::machine::Joints;

pub use insert::{Insertion, Orientation, insert};
pub use rules::{DivisionError, MOST_PIECES, Rule};

/// A divided move.
#[derive(Clone, Debug, PartialEq)]
pub struct Division {
    /// The rule that made it; never [`Rule::Fewest`].
    pub rule: Rule,
    /// The inserted locations, in order: parameter of the chord, strictly between 0 and 1, and joints.
    pub inserted: Vec<(f64, Joints)>,
    /// Largest chord error of the undivided move, mm, certified.
    pub before: f64,
    /// Largest chord error of a piece, mm, certified: [`ChordError::bound`](super::chord::ChordError::bound), which may be
    /// above a tolerance that the piece is proved to keep, by its slack.
    pub after: f64,
}

impl Division {
    /// Number of pieces.
    pub fn pieces(&self) -> usize {
        self.inserted.len() + 1
    }
}

/// Divides the linear joint move `from` → `to` so that no piece leaves its chord by more than `tolerance_mm`.
///
/// # Errors
/// [`DivisionError`]: not finite, tolerance not above zero or below rounding, more than [`MOST_PIECES`] pieces.
pub fn divide(
    machine: &Machine,
    from: &Joints,
    to: &Joints,
    tolerance_mm: f64,
    rule: Rule,
) -> Result<Division, DivisionError> {
    if !(from.is_finite() && to.is_finite()) {
        return Err(DivisionError::NotFinite);
    }
    divide_known(machine, from, to, tolerance_mm, rule, chord_error(machine, from, to).bound)
}

/// The same for a move whose certified error is known.
fn divide_known(
    machine: &Machine,
    from: &Joints,
    to: &Joints,
    tolerance_mm: f64,
    rule: Rule,
    before: f64,
) -> Result<Division, DivisionError> {
    if !(tolerance_mm > 0.0 && tolerance_mm.is_finite()) {
        return Err(DivisionError::Tolerance(tolerance_mm));
    }
    let span = Span::new(machine, from, to, tolerance_mm);
    if before <= tolerance_mm {
        let rule = if rule == Rule::Fewest { Rule::Equal } else { rule };
        return Ok(Division { rule, inserted: Vec::new(), before, after: before });
    }
    let (rule, knots) = match rule {
        Rule::Equal => (rule, rules::equal(&span, before)?),
        Rule::Midpoint => (rule, rules::midpoint(&span)?),
        Rule::Longest => (rule, rules::longest(&span, MOST_PIECES)?),
        Rule::Fewest => rules::fewest(&span, before)?,
    };
    let mut after = 0.0f64;
    let mut last = 0.0;
    for &knot in knots.iter().chain([&1.0]) {
        after = after.max(span.error(last, knot));
        last = knot;
    }
    let inserted = knots.into_iter().map(|s| (s, span.joints(s))).collect();
    Ok(Division { rule, inserted, before, after })
}
