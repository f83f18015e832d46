//! LinuxCNC: G38.3, results through `(LOG, …)` in the format `linuxcnc-log` of `core::probe`.
//!
//! G38.3 stops at a touch and reports none without stopping the program; #5061… is the ball in work coordinates and
//! program units, #5070 whether it touched. Moves that should touch nothing are G38.3 as well; a touch there ends the
//! program. A probe that is on before such a move stops the machine by itself.

use truepath_ground::diagnostics::InputError;

use super::plan::{Plan, Touch};
use super::text::{MoreOffsets, Notation, Page, fixed, work_offset};
use super::walk::{Words, walk};

struct LinuxCnc {
    n: Notation,
}

impl Words for LinuxCnc {
    const PROBE: &'static str = "G38.3";

    fn behind_the_way_down(&self, page: &mut Page, touch: &Touch<'_>) {
        page.line(format!("o{} if [#5070 NE 0]", touch.id));
        page.line("  (LOGCLOSE)");
        page.line("  (MSG,touched where nothing should be: program ended)");
        page.line("  M2");
        page.line(format!("o{} endif", touch.id));
    }

    fn behind_the_reading(&self, page: &mut Page, touch: &Touch<'_>) {
        let place = touch.place;
        page.line(format!(
            "(LOG,{},{},{},{},{},#5061,#5062,#5063,#5070)",
            touch.id,
            fixed(place.normal[0], 6),
            fixed(place.normal[1], 6),
            self.n.number(place.wall[0]),
            self.n.number(place.wall[1])
        ));
    }
}

pub(super) fn write(plan: &Plan, log: &str) -> Result<String, InputError> {
    let n = Notation::of(plan, 4);
    let count = plan.count();
    let s = &plan.settings;
    let mut page = Page::default();
    page.header(plan, "LinuxCNC", "results go into a log in the folder of the INI file, format linuxcnc-log");
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
    let correction = plan.correction.map(|crc| format!("correction {crc:08x}"));
    let first = ["truepath probe log 1".to_owned(), format!("program {:08x}", plan.program.crc)];
    let rest =
        [format!("unit {}", n.unit_name()), format!("ball {}", n.number(plan.ball_mm)), format!("points {count}")];
    for line in first.into_iter().chain(correction).chain(rest) {
        page.line(format!("(LOG,# {line})"));
    }
    walk(&mut page, plan, n, &LinuxCnc { n });
    page.line(format!("(LOG,# end {count})"));
    page.line("(LOGCLOSE)");
    page.comment(&format!("end of {count}"));
    if s.probe_tool.is_some() {
        // The length that was called is the probe's; no tool is left with it.
        page.line("G49");
    }
    page.line("M2");
    Ok(page.finish())
}
