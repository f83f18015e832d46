//! LinuxCNC: G38.3, results through `(LOG, …)` in the format `linuxcnc-log` of `core::probe`.
//!
//! G38.3 stops at a touch and reports none without stopping the program; #5061… is the ball in work coordinates and
//! program units, #5070 whether it touched. Moves that should touch nothing are G38.3 as well; a touch there ends the
//! program. A probe that is on before such a move stops the machine by itself.

use crate::diagnostics::InputError;

use super::plan::Plan;
use super::text::{MoreOffsets, Notation, Page, fixed, work_offset};

pub(super) fn write(plan: &Plan, log: &str) -> Result<String, InputError> {
    let n = Notation::of(plan, 4);
    let count = plan.places.len() * plan.heights.len();
    let s = &plan.settings;
    let (go, fast, slow) = (n.feed(s.feed_move), n.feed(s.feed_fast), n.feed(s.feed_slow));
    let mut page = Page::default();
    page.header(plan, "LinuxCNC", "results go into a log file, format linuxcnc-log");
    page.line(format!("{} G17 G40 G80 G90 G94 G61", n.unit_code()));
    page.line(work_offset(plan, MoreOffsets::Points)?);
    page.line("M5 M9");
    match s.probe_tool {
        Some(tool) => {
            page.line(format!("T{tool} M6"));
            page.line(format!("G43 H{tool}"));
        }
        None => {
            page.line("(MSG,probe in the spindle, its length in force, probe tried by hand?)");
            page.line("M0");
        }
    }
    page.line(format!("G0 Z{}", n.number(plan.safe_z_mm)));
    page.line(format!("(LOGOPEN,{log})"));
    for line in [
        "truepath probe log 1".to_owned(),
        format!("program {:08x}", plan.shop.crc),
        format!("unit {}", n.unit_name()),
        format!("ball {}", n.number(plan.ball_mm)),
        format!("points {count}"),
    ] {
        page.line(format!("(LOG,# {line})"));
    }
    let mut id = 0;
    for place in &plan.places {
        let (stand_off, end) = (n.xy(plan.stand_off(place)), n.xy(plan.search_end(place)));
        page.place(place, id + 1, id + plan.heights.len());
        page.line(format!("G0 {stand_off}"));
        for height in &plan.heights {
            id += 1;
            page.comment(&format!("point {id}, {}", height.why));
            page.line(format!("G38.3 Z{} F{go}", n.number(height.z_mm)));
            page.line(format!("o{id} if [#5070 NE 0]"));
            page.line("  (LOGCLOSE)");
            page.line("  (MSG,touched where nothing should be: program ended)");
            page.line("  M2");
            page.line(format!("o{id} endif"));
            page.line(format!("G38.3 {end} F{fast}"));
            page.line(format!("G1 {stand_off} F{fast}"));
            page.line(format!("G38.3 {end} F{slow}"));
            page.line(format!(
                "(LOG,{id},{},{},{},{},#5061,#5062,#5063,#5070)",
                fixed(place.normal[0], 6),
                fixed(place.normal[1], 6),
                n.number(place.wall[0]),
                n.number(place.wall[1])
            ));
            page.line(format!("G1 {stand_off} F{fast}"));
        }
        page.line(format!("G0 Z{}", n.number(plan.safe_z_mm)));
    }
    page.line(format!("(LOG,# end {count})"));
    page.line("(LOGCLOSE)");
    page.comment(&format!("end of {count}"));
    page.line("M2");
    Ok(page.finish())
}
