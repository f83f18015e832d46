//! Results through DPRNT as inspection text, for Fanuc and Haas: G800 is a nominal place, G801 a measured one.

use super::plan::Plan;
use super::text::{Notation, Page, fixed};

/// Opens the output and says which part, unit and ball the results are of.
pub(super) fn open(page: &mut Page, plan: &Plan, n: Notation) {
    page.line("POPEN");
    page.line("DPRNT[START]");
    page.line(format!("DPRNT[PROGRAM*{:08X}]", plan.program.crc));
    if let Some(correction) = plan.correction {
        page.line(format!("DPRNT[CORRECTION*{correction:08X}]"));
    }
    page.line(format!("DPRNT[UNIT*{}]", n.unit_name().to_uppercase()));
    page.line(format!("DPRNT[BALL*{}]", n.number(plan.ball_mm)));
    page.line(format!("DPRNT[POINTS*{}]", plan.count()));
}

/// Closes the output; a text without END was cut off.
pub(super) fn close(page: &mut Page, count: usize) {
    page.line(format!("DPRNT[END*{count}]"));
    page.line("PCLOS");
    page.comment(&format!("end of {count}"));
}

/// The line of a point's nominal place: X Y Z on the wall, I J K from the wall to the free side.
pub(super) fn nominal(plan: &Plan, n: Notation, id: usize) -> String {
    let touch = plan.touches().nth(id - 1);
    touch.map_or_else(String::new, |touch| {
        let (wall, normal) = (touch.place.wall, touch.place.normal);
        format!(
            "DPRNT[G800*N{id}*X{}*Y{}*Z{}*I{}*J{}*K0.000*O0.000*U0.000*L0.000]",
            n.number(wall[0]),
            n.number(wall[1]),
            n.number(touch.height.z_mm),
            fixed(normal[0], 6),
            fixed(normal[1], 6)
        )
    })
}

/// Digits before and behind the point of a printed variable: eight in all.
pub(super) const fn digits(n: Notation) -> &'static str {
    if n.is_inch() { "35" } else { "44" }
}
