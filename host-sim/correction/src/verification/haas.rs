//! Haas NGC with Renishaw Inspection Plus: its own protected moves and touches, results through DPRNT as inspection text.
//!
//! `G65 P9832` switches the probe on, `P9810` moves and stops with an alarm at a touch, `P9811` touches along an axis,
//! `P9821` along a direction (it needs the vector calibration of the probe, O9804), `P9833` switches off. Both touch
//! twice and come back to where they started; a wall not found within Q is an alarm of theirs. Results #185 and #186
//! are points of the surface. No T, S, W or M word stands in a call, so no offset is updated. `G103 P1` keeps the
//! control from reading them ahead of the touch.

use truepath_ground::diagnostics::InputError;

use super::dprnt::{close, digits, nominal, open};
use super::plan::{Place, Plan};
use super::text::{MoreOffsets, Notation, Page, fixed, work_offset};

/// The larger component of a normal from which the touch is along an axis.
const AXIAL: f64 = 0.999_999_9;

pub(super) fn write(plan: &Plan) -> Result<String, InputError> {
    let n = Notation::of(plan, 3);
    let count = plan.count();
    let s = &plan.settings;
    let go = n.feed(s.feed_move);
    let digits = digits(n);
    let mut page = Page::default();
    page.line("%");
    page.line("O07100 (TRUEPATH VERIFICATION)");
    page.header(plan, "Haas NGC with Inspection Plus", "results go out by DPRNT, format dprnt");
    if plan.places.iter().any(|place| axis(place).is_none()) {
        page.comment("needs the vector calibration of the probe, O9804");
    }
    page.line(format!("{} G17 G40 G80 G90 G94", n.unit_code()));
    page.line(work_offset(plan, MoreOffsets::Code("G154"))?);
    page.line("M5");
    page.line("M9");
    match s.probe_tool {
        Some(tool) => {
            page.line(format!("T{tool} M6"));
            page.line(format!("G0 G43 H{tool} Z{}", n.number(plan.safe_z_mm)));
        }
        None => {
            page.line("M0");
            page.line(format!("G0 Z{}", n.number(plan.safe_z_mm)));
        }
    }
    page.line("M19");
    page.line("G103 P1");
    page.line("G65 P9832 (PROBE ON)");
    open(&mut page, plan, n);
    let mut id = 0;
    for place in &plan.places {
        page.place(place, id + 1, id + place.heights.len());
        page.line(format!("G65 P9810 {} F{go}", n.xy(plan.stand_off(place))));
        for height in &place.heights {
            id += 1;
            page.comment(&format!("point {id}, {}", height.why));
            page.line(format!("G65 P9810 Z{} F{go}", n.number(height.z_mm)));
            page.line(touch(plan, n, place));
            page.line(nominal(plan, n, id));
            // A touch along one axis measures that axis; the other coordinate is where the ball was sent.
            let (x, y) = match axis(place) {
                Some('X') => (format!("#185[{digits}]"), n.number(place.wall[1])),
                Some(_) => (n.number(place.wall[0]), format!("#186[{digits}]")),
                None => (format!("#185[{digits}]"), format!("#186[{digits}]")),
            };
            page.line(format!("DPRNT[G801*N{id}*X{x}*Y{y}*Z{}*R0.000]", n.number(height.z_mm)));
        }
        page.line(format!("G65 P9810 Z{} F{go}", n.number(plan.safe_z_mm)));
    }
    close(&mut page, count);
    page.line("G65 P9833 (PROBE OFF)");
    page.line("G103 P0");
    page.line("M30");
    page.line("%");
    Ok(page.finish())
}

/// The axis along which a place is touched, when it is one.
fn axis(place: &Place) -> Option<char> {
    match place.normal {
        [x, _] if x.abs() >= AXIAL => Some('X'),
        [_, y] if y.abs() >= AXIAL => Some('Y'),
        _ => None,
    }
}

/// The call that touches a place from its stand-off.
fn touch(plan: &Plan, n: Notation, place: &Place) -> String {
    let search = n.number(plan.settings.overtravel);
    match axis(place) {
        Some('X') => format!("G65 P9811 X{} Q{search}", n.number(place.wall[0])),
        Some(_) => format!("G65 P9811 Y{} Q{search}", n.number(place.wall[1])),
        None => {
            let angle = (-place.normal[1]).atan2(-place.normal[0]).to_degrees();
            let distance = plan.ball_mm / 2.0 + plan.settings.clearance;
            format!("G65 P9821 A{} D{} Q{search}", fixed(angle, 4), n.number(distance))
        }
    }
}
