//! Outside the contour every step of both programs is the same.
//!
//! Only places that hang on an end of the contour differ, by as much as that end: the point a move leads to when the
//! contour begins there, and what stands still or turns on an arc until the next straight move.

use truepath_core::gcode::{Axes, Canon};

use super::facts::{Fact, What};

/// A displacement, nm.
pub(super) type Shift = [f64; 2];

/// What the steps between two stretches of contour are compared under.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bounds {
    /// How far the contour before ends from its place; `None` before the first.
    pub(super) before: Option<Shift>,
    /// How far the contour after begins from its place; `None` after the last.
    pub(super) after: Option<Shift>,
    /// What rounding may do to a place, nm.
    pub(super) slack: f64,
}

/// Compares the steps one by one; gives how many moves were compared.
pub(super) fn compare(original: &[Fact], written: &[Fact], bounds: &Bounds) -> Result<usize, String> {
    if original.len() != written.len() {
        let line = original.first().map_or(0, |f| f.line);
        return Err(format!("{} steps after line {line} have become {}", original.len(), written.len()));
    }
    let ends = hanging_ends(original, bounds);
    let mut from = bounds.before.unwrap_or_default();
    let mut moves = 0;
    for ((old, new), to) in original.iter().zip(written).zip(ends) {
        let fail = |what: &str| format!("{what} of line {} has changed (line {} as written)", old.line, new.line);
        if old.number != new.number || old.block_delete != new.block_delete {
            return Err(fail("the block number or the /"));
        }
        if old.modal != new.modal {
            return Err(fail("a mode"));
        }
        let same = match (&old.what, &new.what) {
            (What::Straight { rapid: a, .. }, What::Straight { rapid: b, .. }) => a == b,
            (What::Arc { curve: a, .. }, What::Arc { curve: b, .. }) => {
                let radius = |c: &truepath_core::geometry::Curve| c.signed_radius().map_or(0, |r| r.nm());
                (radius(a) - radius(b)).abs() as f64 <= 2.0 * bounds.slack
            }
            (
                What::Other(Canon::Reference { second: a, axes: p, via: v }),
                What::Other(Canon::Reference { second: b, axes: q, via: w }),
            ) => {
                let named = |axes: &Axes| Axes {
                    x: axes.x.filter(|_| p[0]),
                    y: axes.y.filter(|_| p[1]),
                    z: axes.z.filter(|_| p[2]),
                };
                a == b
                    && p == q
                    && (displaced(&named(v), &named(w), [0.0; 2], bounds.slack)
                        || displaced(&named(v), &named(w), from, bounds.slack))
            }
            (a, b) => a == b,
        };
        if !same {
            return Err(fail("a step"));
        }
        if let (Some((_, a)), Some((_, b))) = (old.ends(), new.ends()) {
            moves += 1;
            if !displaced(&a, &b, to, bounds.slack) {
                return Err(fail("the end of a move"));
            }
        }
        from = to;
    }
    Ok(moves)
}

/// By how much the end of each step may and must differ.
fn hanging_ends(facts: &[Fact], bounds: &Bounds) -> Vec<Shift> {
    let mut ends = vec![[0.0; 2]; facts.len()];
    let carries = |fact: &Fact| !fact.travels() || matches!(fact.what, What::Arc { .. });
    if let Some(mut shift) = bounds.before {
        for (fact, end) in facts.iter().zip(&mut ends) {
            // An axis that leaves for a place of the machine takes its displacement with it, the other keeps its own.
            match fact.what {
                What::Other(Canon::Reference { axes: [x, y, _], .. }) => clear(&mut shift, [x, y]),
                What::Other(Canon::MachineMove { to, .. }) => clear(&mut shift, [to.x.is_some(), to.y.is_some()]),
                _ if carries(fact) => (),
                _ => break,
            }
            *end = shift;
        }
    }
    if let Some(shift) = bounds.after {
        for (fact, end) in facts.iter().zip(&mut ends).rev() {
            *end = shift;
            if !carries(fact) {
                break;
            }
        }
    }
    ends
}

fn clear(shift: &mut Shift, axes: [bool; 2]) {
    shift.iter_mut().zip(axes).filter(|(_, leaves)| *leaves).for_each(|(shift, _)| *shift = 0.0);
}

/// Whether `b` is `a` moved by `shift` in the plane; Z is the same.
fn displaced(a: &Axes, b: &Axes, shift: Shift, slack: f64) -> bool {
    let near =
        |a: Option<truepath_core::units::Position>, b: Option<truepath_core::units::Position>, by: f64| match (a, b) {
            (Some(a), Some(b)) => ((b.nm() - a.nm()) as f64 - by).abs() <= slack,
            (a, b) => a.is_none() && b.is_none(),
        };
    near(a.x, b.x, shift[0]) && near(a.y, b.y, shift[1]) && a.z == b.z
}
