//! On the contour: every line becomes the lines and arcs of its corrected path.

use truepath_core::gcode::{FeedMode, Motion};
use truepath_core::geometry::Curve;
use truepath_core::units::Offset;
use truepath_ground::diagnostics::Failure;

use super::deviation::distance;
use super::edit::BlockEdit;
use super::feed::spans;
use super::fit::{Piece, Samples, Shape, fit};
use super::klartext::KlartextLine;
use super::pen::{Pen, place};
use super::spacing::bulges;
use super::survey::{Kind, Move};
use super::writer::Writer;
use crate::codes::{P006, P008};

/// What was a line becomes lines, unless the correction bends it more than an arc of this radius would: arcs of a metre where
/// nothing bends make a reader doubt the program.
const LARGEST_IN_LINES: Offset = Offset::from_um(100_000);

impl Writer<'_> {
    /// Writes consecutive lines of the contour, from the move `first`; `edits` are in reverse order, with their
    /// tolerances, and lose those that are written. Gives the index of the first move behind the stretch.
    pub(super) fn stretch(
        &mut self,
        pen: &mut Pen,
        moves: &[Move],
        first: usize,
        edits: &mut Vec<(&BlockEdit, f64)>,
    ) -> Result<usize, Failure> {
        self.motion = moves[first].motion_before;
        let (mut at, mut end) = (first, first);
        let mut still: Vec<&Move> = Vec::new();
        while let (Some(step), Some(&(edit, tolerance))) = (moves.get(at), edits.last()) {
            if step.stands_still() {
                // Whether it belongs to the stretch shows only when the contour goes on behind it.
                still.push(step);
                at += 1;
                continue;
            }
            if step.line != edit.line || !step.cuts() {
                break;
            }
            if !still.is_empty() {
                self.restore_feed()?;
            }
            for step in still.drain(..) {
                self.follow(pen.under(&step.modal), step);
                self.state_motion(step);
            }
            self.write_way_to_lead(&moves[..at], step);
            let cuts = &moves[at..];
            let count = cuts.iter().take_while(|m| m.line == edit.line && (m.cuts() || m.stands_still())).count();
            let covered = covered(&cuts[..count], edit, self.manner.klartext);
            self.edit(pen, &cuts[..covered], edit, tolerance)?;
            self.write_way_from_lead(pen, &cuts[covered..count]);
            edits.pop();
            at += count;
            end = at;
        }
        self.restore_feed()?;
        Ok(end)
    }

    /// The way of FMAX to a lead stands in the block of the lead.
    fn write_way_to_lead(&mut self, before: &[Move], step: &Move) {
        if self.replaced.contains_key(&step.line)
            || !self.original(step.line).klartext().is_some_and(KlartextLine::is_lead)
        {
            return;
        }
        let same = before.iter().rev().take_while(|m| (m.line, m.jumps) == (step.line, step.jumps)).count();
        let way = before[before.len() - same..].to_vec();
        if !way.is_empty() {
            self.write_lead(&way, [0.0; 2], true);
        }
    }

    /// The way on from a lead stands in the block of the lead too; it ends where it did.
    fn write_way_from_lead(&mut self, pen: &mut Pen, way: &[Move]) {
        for step in way {
            let Some(to) = place(step.to) else { continue };
            *pen = pen.under(&step.modal);
            let target = pen.nearest(to);
            let drawn = pen.drawn(target, &Shape::Line);
            let text = self.original(step.line).klartext().map(|line| line.further(&drawn, false, None));
            if let (Some(parts), Some(text)) = (self.replaced.get_mut(&step.line), text) {
                parts.extend(text);
            }
        }
    }

    /// Writes one line of the contour.
    fn edit(&mut self, pen: &mut Pen, cuts: &[Move], edit: &BlockEdit, tolerance: f64) -> Result<(), Failure> {
        let (Some(step), Some(last)) = (cuts.first(), cuts.last()) else {
            return Err(Failure::Internal(format!("line {} does not cut", edit.line)));
        };
        self.refuse_what_cannot_be_divided(step)?;
        *pen = pen.under(&step.modal);
        self.notice_feeds_before(step.line);
        let spans = spans(edit);
        let as_programmed = spans.iter().all(|span| span.2 == 100) && self.feed.is_none();
        if !as_programmed {
            self.refuse_several_feeds(cuts)?;
        }
        let curves: Vec<Curve> = cuts.iter().filter_map(Move::curve).collect();
        let (Some(&begin), Some(&end), Some(from), Some(to)) =
            (edit.samples.first(), edit.samples.last(), place(step.from), place(last.to))
        else {
            return Err(Failure::Internal(format!("line {} has no corrected path", edit.line)));
        };
        let gap = [0, 1].map(|axis| (begin[axis] as f64 - pen.at[axis]).abs());
        if gap[0].max(gap[1]) > tolerance.max(200.0) {
            let found = "the correction changes between the moves before this line and the contour";
            let wanted = "a contour that goes on where the line before it has ended";
            return Err(self.refusal(P008, edit.line, [found, wanted, P008.remedy]));
        }
        let beside = |s: &[i64; 2]| curves.iter().map(|c| distance(*s, c)).fold(f64::INFINITY, f64::min);
        let stays = || {
            !self.centre.contains(&step.line)
                && pen.is_at(from)
                && Pen::new(end.map(|v| v as f64), &step.modal).is_at(to)
        };
        // A rounding behind the line turns with the line after it.
        let rounded = block_is_rounded(cuts, self.manner.klartext);
        if as_programmed && !rounded && stays() && edit.samples.iter().all(|s| beside(s) <= 0.5 * tolerance) {
            if self.motion != step.modal.motion && !step.modal.motion.is_some_and(|m| self.block(step.line).names(m)) {
                self.state_motion(step);
            }
            self.motion = step.modal.motion;
            pen.at = to.map(|v| v as f64);
            self.unchanged += 1;
            return Ok(());
        }
        let step_nm = pen.grid().step_nm();
        let within = (tolerance - step_nm).max(0.5 * tolerance);
        let straight = curves.iter().all(|curve| curve.signed_radius().is_none());
        let max_radius =
            if straight { self.options.max_arc_radius.min(LARGEST_IN_LINES) } else { self.options.max_arc_radius };
        let block = self.original(step.line);
        let own_feed = block.has_feed();
        let is_lead = block.klartext().is_some_and(KlartextLine::is_lead);
        let mut text: Vec<Vec<u8>> = self.replaced.get(&step.line).filter(|_| is_lead).cloned().unwrap_or_default();
        let behind_way = !text.is_empty();
        for (k, &(from, to, percent)) in spans.iter().enumerate() {
            let samples = &edit.samples[from..=to];
            let (pieces, points) = pieces(pen, samples, &curves, within, max_radius);
            for (index, (piece, target)) in pieces.iter().zip(&points).enumerate() {
                let motion = match piece.shape {
                    Shape::Line => Motion::Feed,
                    Shape::Arc { counter_clockwise, .. } => Motion::Arc { counter_clockwise },
                };
                let more = k + 1 < spans.len() || index + 1 < pieces.len();
                let first = text.is_empty();
                let feed = if index == 0 { self.feed_word(step, percent, first && own_feed)? } else { None };
                if let Some(line) = block.klartext() {
                    let drawn = pen.drawn(*target, &piece.shape);
                    let feed = feed.as_deref().map(|feed| feed.trim_end_matches('.'));
                    let own = line.feed().filter(|_| behind_way && k == 0 && index == 0);
                    let feed = feed.or(own.as_deref());
                    let centre = self.centre.contains(&step.line);
                    text.extend(match (first, is_lead) {
                        (true, false) => line.moved(&drawn, more, feed),
                        (true, true) => line.lead(&drawn, false, centre, feed),
                        (false, _) => line.further(&drawn, !more && !is_lead, feed),
                    });
                    continue;
                }
                let mut words = pen.draw(*target, &piece.shape);
                text.push(if first {
                    block.moved(motion, self.motion != Some(motion), &words, more, feed.as_deref())
                } else {
                    words += &feed.map_or_else(String::new, |feed| format!(" F{feed}"));
                    block.further(motion, &words, !more)
                });
                self.motion = Some(motion);
            }
        }
        self.rewritten.insert(step.line);
        self.replaced.insert(step.line, text);
        Ok(())
    }

    fn refuse_what_cannot_be_divided(&self, step: &Move) -> Result<(), Failure> {
        let line = step.line;
        if step.modal.feed_mode == FeedMode::InverseTime {
            let found = "the feed of the contour is a time for each whole line (G93), and lines are divided";
            return Err(self.refusal(
                P006,
                line,
                [found, "feed per minute or per revolution", "post the contour with G94"],
            ));
        }
        if self.original(line).has_computed_code() {
            let found =
                "a G word of the contour is a parameter or an expression, and its lines get G words of their own";
            return Err(self.refusal(P006, line, [found, "G words with numbers", "write the G code out on this line"]));
        }
        if matches!(step.kind, Kind::Arc(_, turns) if turns > 0) {
            let found = "an arc of the contour makes more than one turn";
            return Err(self.refusal(
                P006,
                line,
                [found, "arcs of at most one turn", "write the turns on lines of their own"],
            ));
        }
        Ok(())
    }
}

/// How many of the moves of a line a corrected path covers: of a conversational lead, those up to where it ends.
fn covered(cuts: &[Move], edit: &BlockEdit, klartext: bool) -> usize {
    let Some(&end) = edit.samples.last().filter(|_| klartext && cuts.len() > 1) else { return cuts.len() };
    let near = |step: &Move| place(step.to).is_some_and(|to| is_near(to, end));
    cuts.iter().rposition(near).map_or(cuts.len(), |last| last + 1)
}

/// Whether two places are as near as a correction leaves them, 2 mm.
pub(super) fn is_near(a: [i64; 2], b: [i64; 2]) -> bool {
    (0..2).all(|axis| (a[axis] - b[axis]).abs() < 2_000_000)
}

/// Whether a conversational line has the moves of a rounding or a chamfer behind its own.
fn block_is_rounded(cuts: &[Move], klartext: bool) -> bool {
    klartext && cuts.iter().filter(|cut| cut.cuts()).count() > 1
}

/// Pieces through the samples from where the pen is, in program coordinates, and the places they end at.
fn pieces(
    pen: &Pen,
    samples: &[[i64; 2]],
    curves: &[Curve],
    tolerance: f64,
    max_radius: Offset,
) -> (Vec<Piece>, Vec<[f64; 2]>) {
    let origin = samples[0];
    let shift = origin.map(|v| v as f64);
    let path: Vec<_> = samples.iter().map(|s| [(s[0] - origin[0]) as f64, (s[1] - origin[1]) as f64]).collect();
    let places: Vec<_> = std::iter::once(pen.at).chain(samples.iter().skip(1).map(|&s| pen.nearest(s))).collect();
    let written: Vec<_> = places.iter().map(|p| [p[0] - shift[0], p[1] - shift[1]]).collect();
    let max_radius = max_radius.nm() as f64;
    let radii = curves.iter().filter_map(Curve::signed_radius);
    let curvature = radii.map(|r| 1.0 / (r.nm().abs() as f64).max(1.0)).fold(0.0, f64::max);
    let bulges = bulges(&path, curvature);
    let mut pieces = fit(Samples { path: &path, written: &written, bulges: &bulges, max_radius }, tolerance);
    if pieces.is_empty() {
        pieces.push(Piece { end: samples.len() - 1, shape: Shape::Line });
    }
    for piece in &mut pieces {
        if let Shape::Arc { centre, .. } = &mut piece.shape {
            *centre = [centre[0] + shift[0], centre[1] + shift[1]];
        }
    }
    let ends = pieces.iter().map(|p| places[p.end]).collect();
    (pieces, ends)
}
