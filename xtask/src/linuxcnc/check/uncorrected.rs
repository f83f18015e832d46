//! Scenarios in which there must be no correction: it is not permitted, spent, in another place, or probing.

use super::super::recording::Row;
use super::case::Case;

const BYPASS: u32 = 1;
const ARMED: u32 = 2;
const ACTIVE: u32 = 3;
/// Number of `rewrite::Reason::FrameChanged`.
const FRAME_CHANGED: u32 = 20;
/// `motion.motion-type` of a G38 move.
const PROBING: i64 = 5;
/// So far a probing move may get before it is held back, nm.
const HELD_BACK: i64 = 2_000;

/// The program once more, with nothing confirmed.
pub fn repeated(case: &Case) {
    case.untouched(case.rows, "program repeated");
    case.expect(!case.rows.iter().any(|row| row.state >= ARMED), "it was armed again");
}

/// The contour without an arming.
pub fn switched_off(case: &Case) {
    case.untouched(case.rows, "corrections switched off");
    case.expect(!case.rows.iter().any(|row| row.state >= ARMED), "it was armed");
    case.moved(case.rows, "corrections switched off");
    case.turning(case.rows);
}

/// Armed and in the contour, but nothing on: the spindle does not turn.
pub fn dry_run(case: &Case) {
    let largest = Case::largest(case.rows);
    case.expect(largest == 0, format!("correction up to {largest} nm without a spindle"));
    case.expect(case.rows.iter().any(|row| row.state == ACTIVE), "the contour was not entered");
    let active: Vec<Row> = case.rows.iter().filter(|row| row.state == ACTIVE).cloned().collect();
    case.moved(&active, "in the contour");
    case.expect(active.iter().all(|row| row.faded), "the component did not say that the correction is faded");
}

/// Armed, begun behind the gate: no correction, armed until it is ended.
pub fn restart(case: &Case) {
    case.expect(case.notes.number("refusal") == Some(0.0), "it could not be armed");
    case.untouched(case.rows, "restart in the middle");
    let run = case.between("run", "leave");
    case.moved(run, "restart in the middle");
    case.turning(run);
    case.expect(case.rows.last().is_some_and(|row| row.state == BYPASS), "it did not end in bypass");
}

pub fn offset_while_armed(case: &Case) {
    case.expect(case.notes.number("refusal") == Some(0.0), "it could not be armed");
    let after = case.between("event", "");
    case.untouched(case.rows, "offset changed while armed");
    let reasons: Vec<u32> = after.iter().filter(|row| row.state == BYPASS).map(|row| row.reason).collect();
    case.expect(reasons.first() == Some(&FRAME_CHANGED), format!("the reason is {:?}", reasons.first()));
    case.moved(after, "offset changed while armed");
    case.turning(after);
}

/// A probing move takes the gate and the contour: there is never a correction in it.
pub fn probe_armed(case: &Case) {
    case.expect(case.notes.number("refusal") == Some(0.0), "it could not be armed");
    case.untouched(case.rows, "probing while armed");
    let probing: Vec<Row> = case.rows.iter().filter(|row| row.motion_type == PROBING).cloned().collect();
    case.moved(&probing, "probing while armed");
    case.turning(case.rows);
}

/// A probing move waits until nothing is left of the correction.
pub fn probe_after(case: &Case) {
    let rows = case.between("probe", "leave");
    let waiting = rows.iter().filter(|row| row.inhibit).count();
    case.expect(waiting > 100, format!("the probing move waited only {waiting} periods"));
    // LinuxCNC needs a few periods to hold the move back that it has just begun.
    let early = rows.iter().filter(|row| row.motion_type == PROBING && row.correction != [0; 3]);
    let places: Vec<[i64; 3]> = early.map(|row| row.setpoint).collect();
    let way =
        (0..3).filter_map(|a| Some(places.iter().map(|p| p[a]).max()? - places.iter().map(|p| p[a]).min()?)).max();
    case.expect(way.unwrap_or(0) <= HELD_BACK, format!("probing went on by {way:?} nm while a correction was on"));
    let probing: Vec<Row> = rows.iter().filter(|row| row.motion_type == PROBING).cloned().collect();
    case.moved(&probing, "the probing move");
}

/// What was armed before LinuxCNC was killed stays spent; the next part is not.
pub fn spent(case: &Case) {
    case.refused("refusal");
    case.expect(case.notes.number("next-refusal") == Some(0.0), "the next part could not be armed");
    case.expect(case.notes.number("next-state") == Some(f64::from(ARMED)), "the next part was not armed");
    case.untouched(case.rows, "after the new start");
}
