//! On the contour the written path follows the wanted one, at the feeds, modes and heights of the original.
//!
//! One line of the original stands for one stretch of the wanted path and becomes one or more lines and arcs. What
//! else the line does (comment, feed, coolant, stop) must be there once, before its path is over.

use std::collections::HashMap;
use std::ops::Range;

use truepath_core::gcode::Canon;
use truepath_ground::units::float;

use super::super::{BlockEdit, feed};
use super::along::{Follower, difference};
use super::facts::{Fact, What};
use super::kink::{Kink, Turns, Wanted};
use super::outside::Shift;

/// What was found along the contour.
#[derive(Clone, Debug, Default)]
pub(super) struct Along {
    pub(super) lines: usize,
    pub(super) arcs: usize,
    pub(super) kinks: Vec<Kink>,
    pub(super) deviation_nm: f64,
    pub(super) feeds: usize,
    /// Edits of earlier stretches.
    pub(super) first_edit: usize,
}

/// What everything is compared under.
#[derive(Clone, Copy, Debug)]
pub(super) struct Terms {
    pub(super) tolerance: f64,
    pub(super) slack: f64,
    /// Whether feeds along the contour were to change.
    pub(super) scheduled: bool,
}

/// Compares one stretch of contour. `original` ends with its last cutting step; gives how many of the `written` steps
/// belong to it.
pub(super) fn compare(
    original: &[Fact],
    written: &[Fact],
    edits: &[BlockEdit],
    terms: Terms,
    along: &mut Along,
) -> Result<usize, String> {
    let (mut old, mut new) = (0, 0);
    let mut turns = Turns::default();
    let mut place = edits.first().and_then(|e| e.samples.first().copied()).unwrap_or_default();
    for (index, edit) in edits.iter().enumerate() {
        let fail = |what: &str, fact: Option<&Fact>| {
            let at = fact.map_or(String::new(), |f| format!(" (line {} as written)", f.line));
            format!("{what} of line {} has changed{at}", edit.line)
        };
        let (from, mut cuts) = (old, Vec::new());
        while let Some(fact) = original.get(old) {
            let is_cut = fact.curve().is_some();
            if is_cut && fact.line != edit.line {
                break;
            }
            if is_cut {
                cuts.push(fact);
            }
            old += 1;
            let more = original[old..].iter().find(|f| f.curve().is_some());
            if is_cut && more.is_none_or(|f| f.line != edit.line) {
                break;
            }
        }
        let (Some(first), Some(last)) = (cuts.first(), cuts.last()) else {
            return Err(fail("the path", None));
        };
        turns.original(&first.curve(), &last.curve());
        let bend = curvature(&cuts);
        let begin = new;
        let mut follower = Follower::new(&edit.samples, bend.abs(), terms.tolerance, terms.slack);
        let mut pieces = 0;
        while !follower.is_done(place) {
            let Some(fact) = written.get(new) else { return Err(fail("the end of the path", None)) };
            new += 1;
            let Some(curve) = fact.curve() else { continue };
            let [before, after] = follower.chords();
            let from_sample = follower.reached();
            let wanted = Wanted { chords: [before.or(turns.wanted_end), after], curvature: bend };
            if length(place, [curve.start().x.nm(), curve.start().y.nm()]) > terms.slack || !follower.take(&curve) {
                return Err(fail("the path", Some(fact)));
            }
            let percent = percent(edit, from_sample..follower.reached());
            let percent = percent.ok_or_else(|| fail("the place of a feed", Some(fact)))?;
            same_modes(first, fact, pieces == 0, percent).map_err(|what| fail(what, Some(fact)))?;
            place = [curve.end().x.nm(), curve.end().y.nm()];
            pieces += 1;
            match fact.what {
                What::Arc { .. } => along.arcs += 1,
                _ => along.lines += 1,
            }
            if let Some([degrees, beyond]) = turns.written(&curve, pieces == 1, &wanted) {
                let (edit, at_start) = (along.first_edit + index, pieces == 1);
                along.kinks.push(Kink { degrees, beyond, line: fact.line, edit, at_start });
            }
        }
        if pieces == 0 {
            // A path shorter than the grid has become a move that stands still.
            let here = || written[new..].iter().take_while(|f| f.curve().is_none());
            new += here().position(|f| f.stands_still() && level(f)).map_or(0, |at| at + 1);
        }
        turns.wanted_end = follower.chords()[0].or(turns.wanted_end);
        // What else the original does before its cut is over may stand behind a path that has vanished.
        let feeds = |facts: &[Fact]| facts.iter().filter(|f| feed_word(f)).count();
        let others = |facts: &[Fact]| others(facts, terms.scheduled);
        let expected = others(&original[from..old]);
        while others(&written[begin..new]).len() < expected.len()
            && written.get(new).is_some_and(|f| f.curve().is_none())
        {
            new += 1;
        }
        if expected != others(&written[begin..new]) {
            return Err(fail("a comment, feed or function", written.get(begin)));
        }
        // The feed of the program is put back on a line of its own.
        let put_back = terms.scheduled && new > begin && written[new - 1].modal.feed != last.modal.feed;
        new += usize::from(put_back && written.get(new).is_some_and(feed_word));
        along.feeds += feeds(&written[begin..new]);
        along.deviation_nm = along.deviation_nm.max(follower.deviation);
    }
    along.first_edit += edits.len();
    Ok(new)
}

/// How far a stretch is displaced at its start and at its end.
pub(super) fn shifts(original: &[Fact], edits: &[BlockEdit]) -> Option<[Shift; 2]> {
    let first = original.iter().find_map(Fact::curve)?;
    let last = original.iter().rev().find_map(Fact::curve)?;
    let start = [first.start().x.nm(), first.start().y.nm()];
    let end = [last.end().x.nm(), last.end().y.nm()];
    Some([difference(*edits.first()?.samples.first()?, start), difference(*edits.last()?.samples.last()?, end)])
}

fn length(a: [i64; 2], b: [i64; 2]) -> f64 {
    super::super::vector::length(difference(a, b))
}

fn feed_word(fact: &Fact) -> bool {
    matches!(fact.what, What::Other(Canon::FeedRate(_)))
}

/// The percentage of the programmed feed between two samples; `None` when it changes between them.
fn percent(edit: &BlockEdit, samples: Range<usize>) -> Option<u16> {
    let spans = feed::spans(edit);
    let span = spans.iter().find(|span| span.0 <= samples.start && samples.end <= span.1);
    span.map(|span| span.2)
}

/// The steps that are no moves in the plane, as text to compare: the order within one line is the control's affair.
/// Feeds that were to change show in the modes of the moves.
fn others(facts: &[Fact], scheduled: bool) -> Vec<String> {
    let text = |fact: &Fact| match &fact.what {
        What::Other(Canon::FeedRate(_)) if scheduled => None,
        What::Comment(bytes) => Some(format!("Comment {bytes:?}")),
        What::Other(canon) => Some(format!("{canon:?}")),
        What::Straight { rapid, from, to } if fact.stands_still() && from.z != to.z => {
            Some(format!("Still {rapid} {:?} {:?} {:?}", from.z, to.z, fact.modal.feed))
        }
        What::Straight { .. } | What::Arc { .. } => None,
    };
    let mut texts: Vec<_> = facts.iter().filter_map(text).collect();
    texts.sort_unstable();
    texts
}

/// The curvature of the programmed curves, 1/nm, positive to the left: the largest in size.
fn curvature(cuts: &[&Fact]) -> f64 {
    let radii = cuts.iter().filter_map(|f| f.curve()?.signed_radius()).map(|r| r.nm() as f64);
    radii.filter(|r| r.abs() >= 1.0).map(|r| 1.0 / r).fold(0.0, |a: f64, b| if b.abs() > a.abs() { b } else { a })
}

/// Whether a move keeps its height.
fn level(fact: &Fact) -> bool {
    fact.ends().is_some_and(|(from, to)| from.z == to.z)
}

/// Height, speed, tool and the other modes of a written piece are those of the original line, its feed is `percent` of it,
/// and its block number is that of the line if it is the first.
fn same_modes(old: &Fact, new: &Fact, first: bool, percent: u16) -> Result<(), &'static str> {
    let z = |fact: &Fact| fact.ends().map(|(from, to)| (from.z, to.z));
    if z(old) != z(new) {
        return Err("the height");
    }
    let is_feed = match (percent, old.modal.feed, new.modal.feed) {
        (100, old, new) => old == new,
        (_, Some(programmed), Some(written)) => {
            let wanted = float(programmed) * f64::from(percent) / 100.0;
            (float(written) - wanted).abs() <= feed::rounding(&new.modal)
        }
        _ => false,
    };
    if !is_feed {
        return Err("the feed");
    }
    let mut modal = new.modal;
    modal.feed = old.modal.feed;
    // M5 on a line of the contour stops the spindle when the path of the whole line is over.
    modal.spindle = old.modal.spindle;
    if old.modal != modal {
        return Err("a mode");
    }
    if old.block_delete != new.block_delete {
        return Err("the /");
    }
    if (first && old.number != new.number) || (!first && new.number.is_some()) {
        return Err("the block number");
    }
    Ok(())
}

/// The lines of a contour, each with the edit it is cut by.
#[derive(Clone, Debug, Default)]
pub(super) struct EditLines {
    last: HashMap<u32, usize>,
    /// Edits before this one are cut.
    pub(super) from: usize,
}

impl EditLines {
    pub(super) fn of(edits: &[BlockEdit]) -> Self {
        Self { last: edits.iter().enumerate().map(|(at, edit)| (edit.line, at)).collect(), from: 0 }
    }
    /// Whether a step cuts along the contour.
    pub(super) fn is_cut(&self, fact: &Fact) -> bool {
        fact.curve().is_some() && self.last.get(&fact.line).is_some_and(|&at| at >= self.from)
    }
    /// Whether a step ends a stretch: a move in the plane that is not part of the contour.
    pub(super) fn ends_stretch(&self, fact: &Fact) -> bool {
        (fact.travels() && !self.is_cut(fact)) || matches!(fact.what, What::Other(Canon::End(_)))
    }
}
