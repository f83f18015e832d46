//! grbl and grblHAL: G38.3; the results are the `[PRB:…]` lines in the console log.
//!
//! Every probing move prints such a line: the move down (which should say `:0`), the first and the second touch. A
//! `;VERIFY` comment stands before each touch that counts, for senders that log what they send. A touch on the way down
//! leaves the probe on, and grbl then refuses the next probing move with alarm 4: the machine stands.

use truepath_ground::diagnostics::InputError;

use super::plan::{Plan, Touch};
use super::text::{MoreOffsets, Notation, Page, fixed, work_offset};
use super::walk::{Words, walk};
use crate::codes::V005;

struct Grbl {
    n: Notation,
}

impl Words for Grbl {
    const PROBE: &'static str = "G38.3";

    fn before_the_reading(&self, page: &mut Page, touch: &Touch<'_>) {
        let place = touch.place;
        page.line(format!(
            ";VERIFY {} {} {} {} {}",
            touch.id,
            fixed(place.normal[0], 6),
            fixed(place.normal[1], 6),
            self.n.number(place.wall[0]),
            self.n.number(place.wall[1])
        ));
    }
}

pub(super) fn write(plan: &Plan) -> Result<String, InputError> {
    let n = Notation::of(plan, 3);
    let count = plan.count();
    let s = &plan.settings;
    if let Some(tool) = s.probe_tool {
        return Err(InputError::new(
            V005,
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
    page.line(format!(";VERIFY PROGRAM {:08x}", plan.program.crc));
    if let Some(correction) = plan.correction {
        page.line(format!(";VERIFY CORRECTION {correction:08x}"));
    }
    page.line(format!(";VERIFY POINTS {count}"));
    walk(&mut page, plan, n, &Grbl { n });
    page.line(format!(";VERIFY END {count}"));
    page.line("M2");
    Ok(page.finish())
}
