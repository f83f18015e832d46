//! grbl and grblHAL: G38.3; the results are the `[PRB:…]` lines in the console log.
//!
//! Every probing move prints such a line: the move down (which should say `:0`), the first and the second touch. A
//! `;VERIFY` comment stands before each touch that counts, for senders that log what they send. A touch on the way down
//! leaves the probe on, and grbl then refuses the next probing move with alarm 4: the machine stands.

use crate::diagnostics::InputError;

use super::plan::Plan;
use super::text::{MoreOffsets, Notation, Page, fixed, work_offset};

pub(super) fn write(plan: &Plan) -> Result<String, InputError> {
    let n = Notation::of(plan, 3);
    let count = plan.places.len() * plan.heights.len();
    let s = &plan.settings;
    let (go, fast, slow) = (n.feed(s.feed_move), n.feed(s.feed_fast), n.feed(s.feed_slow));
    if let Some(tool) = s.probe_tool {
        return Err(InputError::new(
            "V005",
            format!("--probe-tool {tool}, and grbl changes no tools"),
            "a program without a tool call",
            "leave --probe-tool out and put the probe in by hand",
        ));
    }
    let mut page = Page::default();
    page.header(
        plan,
        "grbl",
        "results are the PRB lines of the console log; ask for the offsets after the end, as the document says",
    );
    page.line(format!("{} G17 G40 G90 G94", n.unit_code()));
    page.line(work_offset(plan, MoreOffsets::Nothing)?);
    page.line("M5");
    page.line("M9");
    page.line("M0");
    page.line(format!("G0 Z{}", n.number(plan.safe_z_mm)));
    page.line(format!(";VERIFY PROGRAM {:08x}", plan.shop.crc));
    page.line(format!(";VERIFY POINTS {count}"));
    let mut id = 0;
    for place in &plan.places {
        let (stand_off, end) = (n.xy(plan.stand_off(place)), n.xy(plan.search_end(place)));
        page.place(place, id + 1, id + plan.heights.len());
        page.line(format!("G0 {stand_off}"));
        for height in &plan.heights {
            id += 1;
            page.comment(&format!("point {id}, {}", height.why));
            page.line(format!("G38.3 Z{} F{go}", n.number(height.z_mm)));
            page.line(format!("G38.3 {end} F{fast}"));
            page.line(format!("G1 {stand_off} F{fast}"));
            page.line(format!(
                ";VERIFY {id} {} {} {} {}",
                fixed(place.normal[0], 6),
                fixed(place.normal[1], 6),
                n.number(place.wall[0]),
                n.number(place.wall[1])
            ));
            page.line(format!("G38.3 {end} F{slow}"));
            page.line(format!("G1 {stand_off} F{fast}"));
        }
        page.line(format!("G0 Z{}", n.number(plan.safe_z_mm)));
    }
    page.line(format!(";VERIFY END {count}"));
    page.line("M2");
    Ok(page.finish())
}
