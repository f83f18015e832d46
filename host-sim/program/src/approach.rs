//! Before a stretch of contour: the moves that lead to its start end at the corrected start.
//!
//! A straight move is given another end; an arc (a lead-in) is displaced as a whole, so that it stays tangent, and the
//! move before it leads to where it now begins. Moves that stand still follow.

use truepath_ground::diagnostics::Failure;

use super::edit::BlockEdit;
use super::klartext::KlartextLine;
use super::pen::{Pen, place};
use super::survey::{Kind, Move};
use super::writer::Writer;
use crate::codes::P002;

const EXPECTED: &str = "a G0 or G1 move in X and Y to the start of the contour";

impl Writer<'_> {
    /// Leads the moves before the contour to its corrected start, and gives the pen there. `displaced` is a move among
    /// them that begins elsewhere than in the original.
    pub(super) fn approach(
        &mut self,
        before: &[Move],
        first: &Move,
        edit: &BlockEdit,
        displaced: Option<(usize, Pen)>,
    ) -> Result<Pen, Failure> {
        let (Some(from), Some(&to)) = (place(first.from), edit.samples.first()) else {
            return Err(Failure::Internal("the contour has no start".to_owned()));
        };
        let start = Pen::new(from.map(|v| v as f64), &first.modal);
        if start.is_at(to) {
            return Ok(start);
        }
        let mut by = [0, 1].map(|axis| (to[axis] - from[axis]) as f64);
        // Displacements are of whole steps, so that everything carried along keeps its digits.
        let grid = start.grid();
        by = by.map(|v| grid.nm(grid.steps_of(v)));
        for (index, step) in before.iter().enumerate().rev() {
            self.refuse_other_file(step)?;
            if self.original(step.line).klartext().is_some_and(KlartextLine::is_lead) {
                let lead: Vec<Move> = before.iter().filter(|m| m.line == step.line).copied().collect();
                self.write_lead(&lead, by, true);
                let reached = [0, 1].map(|axis| from[axis] as f64 + by[axis]);
                return Ok(Pen::new(reached, &first.modal));
            }
            let block = self.block(step.line);
            let named = [0, 1].map(|axis| block.names_axis(axis));
            match step.kind {
                Kind::Traverse | Kind::Feed if !step.in_cycle() && !block.has_corner() => {}
                // Up to change the cutter: the place in the plane stays.
                Kind::Away([false, false]) => continue,
                Kind::Arc(..) if place(step.from).is_some() => {
                    let pen = Pen::new([0.0; 2], &step.modal);
                    self.carry(pen, step, by);
                    continue;
                }
                _ => {
                    let found = if step.in_cycle() {
                        "the contour begins at a hole of a canned cycle, which must stay where it is"
                    } else {
                        "the move to the start of the contour cannot be changed"
                    };
                    return Err(self.refusal(P002, step.line, [found, EXPECTED, P002.remedy]));
                }
            }
            if named == [false, false] {
                continue;
            }
            let still = step.stands_still();
            let at = match displaced {
                Some((at, pen)) if at == index => pen.at,
                _ => place(step.from).unwrap_or(from).map(|v| v as f64),
            };
            let pen = Pen::new(at, &step.modal);
            let goal = place(step.to).unwrap_or(from);
            let target = pen.nearest([0, 1].map(|axis| (goal[axis] as f64 + by[axis]).round() as i64));
            if step.modal.absolute || !still {
                let values = [0, 1].map(|axis| (named[axis] || !still).then(|| pen.value(axis, target[axis])));
                let text = block.repositioned(values);
                self.replaced.insert(step.line, vec![text]);
            }
            if !still {
                let reached = [0, 1].map(|axis| from[axis] as f64 + target[axis] - goal[axis] as f64);
                return Ok(Pen::new(reached, &first.modal));
            }
        }
        Err(self.refusal(P002, first.line, ["no move leads to the start of the contour", EXPECTED, P002.remedy]))
    }
}
