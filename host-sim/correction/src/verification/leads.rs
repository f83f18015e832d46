//! Leads of a contour that closes, and the stretch that is milled twice.
//!
//! A program round a pocket leads in, goes round, passes its entry again and leads out. Such a path meets itself: what
//! comes before the first meeting and behind the last is a lead, beside which stands no wall; what lies between the
//! meetings at either end is milled twice, so its wall is not that of one pass.
//!
//! Limit: the leads of an open contour look like contour; give it lines of its own in the job.

use std::collections::HashMap;

use truepath_core::cut::Sample;
use truepath_core::units::Offset;

use super::approach::Xy;

/// Two samples nearer than this are of one place, mm: half a step of the path and more than rounding makes.
const MEETING: f64 = 0.08;

/// The arc lengths from which and up to which a path is milled once, between its leads; the whole path when it does not
/// meet itself. `apart` is how far along the path two samples must lie for a meeting.
pub(super) fn milled_once(samples: &[Sample], apart: Offset) -> (Offset, Offset) {
    let point = |s: &Sample| -> Xy { [s.point.x.nm() as f64 / 1e6, s.point.y.nm() as f64 / 1e6] };
    let cell = |p: Xy| ((p[0] / MEETING).floor() as i64, (p[1] / MEETING).floor() as i64);
    let mut cells: HashMap<(i64, i64), Vec<&Sample>> = HashMap::new();
    let ends = (samples.first().map_or(Offset::ZERO, |s| s.s), samples.last().map_or(Offset::ZERO, |s| s.s));
    let half = Offset::from_nm(i64::midpoint(ends.0.nm(), ends.1.nm()));
    for late in samples.iter().filter(|s| s.s > half) {
        cells.entry(cell(point(late))).or_default().push(late);
    }
    let meets = |early: &&Sample| {
        let p = point(early);
        let (x, y) = cell(p);
        let around = (-1..=1).flat_map(|i| (-1..=1).map(move |j| (x + i, y + j)));
        let near = |late: &&&Sample| {
            let q = point(late);
            late.s - early.s > apart && (p[0] - q[0]).hypot(p[1] - q[1]) < MEETING
        };
        around.filter_map(|c| cells.get(&c)).flatten().filter(near).map(|late| late.s).min()
    };
    // From the last early place that is passed again, up to where the late pass first comes to such a place.
    let early = samples.iter().filter(|s| s.s <= half);
    let meetings: Vec<(Offset, Offset)> = early.filter_map(|s| Some((s.s, meets(&s)?))).collect();
    let from = meetings.iter().map(|m| m.0).max().unwrap_or(ends.0);
    let to = meetings.iter().map(|m| m.1).min().unwrap_or(ends.1);
    (from, to)
}
