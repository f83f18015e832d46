//! Fanuc with a probe on the skip signal: G31, results through DPRNT as inspection text (G800 nominal, G801 measured).
//!
//! G31 stops at the signal; without one it ends at its end point, so a reading there is a miss and is not printed. X and
//! Y are #5061 and #5062 (skip position, work coordinates); Z is the programmed one, because #5063 contains the
//! length offset on most controls. A signal that is on already skips the search at its start: that ends in an alarm.
//! Comparisons leave room for 5 µm. Argument words have decimal points, as G31 without one would be micrometres.

use truepath_ground::diagnostics::InputError;

use super::dprnt::{close, digits, nominal, open};
use super::plan::{Plan, Touch};
use super::text::{MoreOffsets, Notation, Page, work_offset};
use super::walk::{Words, walk};

/// A reading nearer than this to the stand-off was no search, mm.
const NO_SEARCH: f64 = 0.1;
/// A reading nearer than this to the end of the search is a miss, mm.
const AT_END: f64 = 0.005;
/// The block that stops the machine.
const ALARM: u32 = 9000;

struct Fanuc<'p> {
    plan: &'p Plan,
    n: Notation,
}

impl Words for Fanuc<'_> {
    const PROBE: &'static str = "G31";

    fn behind_the_reading(&self, page: &mut Page, touch: &Touch<'_>) {
        let (plan, n, id) = (self.plan, self.n, touch.id);
        let (from, to) = (plan.stand_off(touch.place), plan.search_end(touch.place));
        page.line(format!("IF[{}LT{}]GOTO{ALARM}", away(n, from), n.number(NO_SEARCH)));
        page.line(nominal(plan, n, id));
        page.line(format!("IF[{}LT{}]GOTO{id}", away(n, to), n.number(AT_END)));
        let digits = digits(n);
        page.line(format!(
            "DPRNT[G801*N{id}*X#5061[{digits}]*Y#5062[{digits}]*Z{}*R{}]",
            n.number(touch.height.z_mm),
            n.number(plan.ball_mm / 2.0)
        ));
    }

    fn label(&self, touch: &Touch<'_>) -> String {
        format!("N{} ", touch.id)
    }
}

pub(super) fn write(plan: &Plan) -> Result<String, InputError> {
    let n = Notation::of(plan, 3);
    let count = plan.count();
    let s = &plan.settings;
    let mut page = Page::default();
    page.line("%");
    page.line("O7100 (TRUEPATH VERIFICATION)");
    page.header(plan, "Fanuc G31", "results go out by DPRNT, format dprnt");
    page.line(format!("{} G17 G40 G80 G90 G94", n.unit_code()));
    page.line(work_offset(plan, MoreOffsets::Code("G54.1"))?);
    page.line("M5");
    page.line("M9");
    match s.probe_tool {
        Some(tool) => {
            page.line(format!("T{tool} M6"));
            page.line("M19");
            page.line(format!("G0 G43 H{tool} Z{}", n.number(plan.safe_z_mm)));
        }
        None => {
            page.line("M0");
            page.line(format!("G0 Z{}", n.number(plan.safe_z_mm)));
        }
    }
    open(&mut page, plan, n);
    walk(&mut page, plan, n, &Fanuc { plan, n });
    close(&mut page, count);
    page.line("M30");
    page.line(format!("N{ALARM} PCLOS"));
    page.line("#3000=1(PROBE WAS ON BEFORE THE SEARCH)");
    page.line("%");
    Ok(page.finish())
}

/// Distance of the reading from a place, as the sum of its components.
fn away(n: Notation, p: [f64; 2]) -> String {
    format!("[ABS[#5061-[{}]]+ABS[#5062-[{}]]]", n.number(p[0]), n.number(p[1]))
}
