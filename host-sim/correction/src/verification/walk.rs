//! The walk over places and heights, for controls that touch with probing moves of their own: one order of moves for
//! all of them, safe because there is only one.
//!
//! At the safe height to the stand-off, down with a probing move, first touch, back, second touch, back; the next height;
//! up. What a control says in between, and in which words, is its [`Words`].

use super::plan::{Place, Plan, Touch};
use super::text::{Notation, Page};

/// A control's own words along the walk.
pub(super) trait Words {
    /// The probing move.
    const PROBE: &'static str;

    /// Behind the way down of a touch, where nothing should have been touched.
    fn behind_the_way_down(&self, _page: &mut Page, _touch: &Touch<'_>) {}
    /// Before the second touch, which counts.
    fn before_the_reading(&self, _page: &mut Page, _touch: &Touch<'_>) {}
    /// Behind the second touch.
    fn behind_the_reading(&self, _page: &mut Page, _touch: &Touch<'_>) {}
    /// What stands on the line of the way back from the second touch, before its move.
    fn label(&self, _touch: &Touch<'_>) -> String {
        String::new()
    }
}

/// Writes the touches of a plan.
pub(super) fn walk<W: Words>(page: &mut Page, plan: &Plan, n: Notation, words: &W) {
    let probe = W::PROBE;
    let s = &plan.settings;
    let (go, fast, slow) = (n.feed(s.feed_move), n.feed(s.feed_fast), n.feed(s.feed_slow));
    let touches: Vec<Touch<'_>> = plan.touches().collect();
    for at_place in touches.chunk_by(|a, b| std::ptr::eq(a.place, b.place)) {
        let (Some(first), Some(last)) = (at_place.first(), at_place.last()) else { continue };
        let place: &Place = first.place;
        let (stand_off, end) = (n.xy(plan.stand_off(place)), n.xy(plan.search_end(place)));
        page.place(place, first.id, last.id);
        page.line(format!("G0 {stand_off}"));
        for touch in at_place {
            page.comment(&format!("point {}, {}", touch.id, touch.height.why));
            page.line(format!("{probe} Z{} F{go}", n.number(touch.height.z_mm)));
            words.behind_the_way_down(page, touch);
            page.line(format!("{probe} {end} F{fast}"));
            page.line(format!("G1 {stand_off} F{fast}"));
            words.before_the_reading(page, touch);
            page.line(format!("{probe} {end} F{slow}"));
            words.behind_the_reading(page, touch);
            page.line(format!("{}G1 {stand_off} F{fast}", words.label(touch)));
        }
        page.line(format!("G0 Z{}", n.number(plan.safe_z_mm)));
    }
}
