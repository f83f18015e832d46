//! After a stretch of contour: back to the places of the program, from the displaced end.
//!
//! What stands still follows the pen, an arc (a lead-out) is displaced as a whole, and the first straight move goes to
//! its own place again: an axis that it does not name is added where it is displaced. A hole of a canned cycle is
//! drilled where it was; where its line cannot say so, it is refused.

use truepath_core::gcode::Plane;
use truepath_ground::diagnostics::Failure;

use super::klartext::KlartextLine;
use super::pen::{Pen, place};
use super::survey::{Kind, Move};
use super::writer::Writer;
use crate::codes::{P003, P005};

impl Writer<'_> {
    /// Makes up for the displaced end of the contour. Gives the move that begins displaced and returns, with its place
    /// in `after`, if there is one.
    pub(super) fn depart(&mut self, end: Pen, last: &Move, after: &[Move]) -> Result<Option<(usize, Pen)>, Failure> {
        let Some(nominal) = place(last.to) else { return Ok(None) };
        let grid = end.grid();
        // Less than a step is no displacement.
        let mut by = [0, 1].map(|axis| grid.nm(grid.steps_of(end.at[axis] - nominal[axis] as f64)));
        if let Some(next) = after.iter().find(|m| !matches!(m.kind, Kind::Away(_) | Kind::Origin)) {
            self.state_motion(next);
        }
        let mut led = false;
        for (index, step) in after.iter().enumerate() {
            if by == [0.0; 2] {
                return Ok(None);
            }
            self.refuse_other_file(step)?;
            if let Kind::Away(axes) = step.kind {
                by = [0, 1].map(|axis| if axes[axis] { 0.0 } else { by[axis] });
                continue;
            }
            if matches!(step.kind, Kind::Origin) {
                return Err(self.refusal(
                    P005,
                    step.line,
                    [
                        "the origin is set while the cutter stands at the displaced end of the contour",
                        "a move away from the contour first",
                        "put a G0 or G1 move in X and Y between the contour and this line",
                    ],
                ));
            }
            let from = [step.from.x, step.from.y];
            let pen = Pen::new([0, 1].map(|axis| from[axis].map_or(0.0, |p| p.nm() as f64) + by[axis]), &step.modal);
            if self.original(step.line).klartext().is_some_and(KlartextLine::is_lead) {
                let same = |m: &&Move| (m.line, m.jumps) == (step.line, step.jumps);
                let lead: Vec<Move> = after.iter().skip(index).take_while(same).copied().collect();
                // Its first move has written it.
                if !led {
                    self.write_lead(&lead, by, false);
                    led = true;
                }
                match lead.first() {
                    Some(m) if m.is_straight() && !m.stands_still() => return Ok(Some((index, pen))),
                    _ => continue,
                }
            }
            match step.kind {
                _ if step.in_cycle() => {
                    let hole = after.iter().skip(index).take_while(|m| (m.line, m.jumps) == (step.line, step.jumps));
                    let found = self.what_keeps_a_hole(step, &hole.collect::<Vec<_>>());
                    if let Some(found) = found {
                        let help = "put a G0 move in X and Y between the contour and this line";
                        return Err(self.refusal(P003, step.line, [found, "a move away from the contour first", help]));
                    }
                    // It is raised where it stands before it goes to the hole.
                    if !step.stands_still() {
                        self.go_home(pen, step, by);
                        return Ok(Some((index, pen)));
                    }
                }
                _ if step.stands_still() => self.follow(pen, step),
                _ if self.block(step.line).has_corner() => {
                    let found = "the control cuts the corner behind this move, which begins displaced";
                    let help = "put a short G1 move between the contour and this line";
                    return Err(self.refusal(P003, step.line, [found, "a move without ,R or ,C", help]));
                }
                Kind::Arc(..) => {
                    self.carry(pen, step, by);
                }
                Kind::Traverse | Kind::Feed => {
                    self.go_home(pen, step, by);
                    return Ok(Some((index, pen)));
                }
                _ => {
                    let found = "this move begins where the corrected contour ends, and cannot begin elsewhere";
                    let help = "put a short G1 move between the contour and this line";
                    return Err(self.refusal(P003, step.line, [found, "a straight move or a G17 arc", help]));
                }
            }
        }
        Ok(None)
    }

    /// Why a hole cannot be drilled at its own place from the displaced end of the contour, by the words of its line.
    fn what_keeps_a_hole(&self, step: &Move, moves: &[&Move]) -> Option<&'static str> {
        let block = self.block(step.line);
        if moves.iter().all(|m| m.stands_still()) {
            Some("the first hole of this cycle is at the end of the contour, which is displaced")
        } else if step.modal.plane != Plane::Xy {
            Some("this cycle drills along another axis than Z from the displaced end of the contour")
        } else if !step.modal.absolute
            && block.word(b'L').is_some_and(|w| w.value.and_then(|v| v.exactly_times(1)) != Some(1))
        {
            Some(
                "the holes of this cycle are counted in steps (G91 with repetitions) from the displaced end of the contour",
            )
        } else {
            None
        }
    }

    /// Gives the straight move from the displaced place its own end.
    fn go_home(&mut self, pen: Pen, step: &Move, by: [f64; 2]) {
        let block = self.block(step.line);
        let to = [step.to.x, step.to.y];
        let value = |axis: usize| {
            let to = to[axis]?.nm() as f64;
            let named = block.names_axis(axis) && !block.klartext().is_some_and(|line| line.steps(axis));
            let needed = if step.modal.absolute { !named && by[axis] != 0.0 } else { named || by[axis] != 0.0 };
            needed.then(|| pen.value(axis, to))
        };
        let values = [value(0), value(1)];
        if values.iter().any(Option::is_some) {
            let text = block.repositioned(values);
            self.replaced.insert(step.line, vec![text]);
        }
    }
}
