//! What has to come of each scenario, as the safety contract has it (docs/safety.md), read from the recording.

use std::cell::RefCell;

use super::super::notes::Notes;
use super::super::recording::Row;
use super::case::Case;
use super::{ramp, uncorrected};

const BYPASS: u32 = 1;
const ARMED: u32 = 2;
const ACTIVE: u32 = 3;
const HOLD: u32 = 4;
/// Numbers of `rewrite::Reason`.
const COMPLETED: u32 = 1;
const DISARMED: u32 = 2;
const EMERGENCY_STOP: u32 = 16;
const ABORT: u32 = 17;
const DRIVES_DISABLED: u32 = 19;
/// LinuxCNC disables the drives a moment before or after it passes the stop on.
const STOPPED: [u32; 2] = [EMERGENCY_STOP, DRIVES_DISABLED];
/// Less than this is no correction that a test could see, nm.
const VISIBLE: i64 = 10_000;

/// A scenario: what to check in it besides the rules that hold in every period.
pub struct Scenario {
    pub name: &'static str,
    /// Whether a part is armed in it, so that it is compared with `truepath replay`.
    pub replayed: bool,
    check: fn(&Case),
}

/// All scenarios, in the order in which they are run.
pub const ALL: &[Scenario] = &[
    Scenario { name: "corner", replayed: true, check: completed },
    Scenario { name: "pocket", replayed: true, check: completed_and_spent },
    Scenario { name: "repeated", replayed: false, check: uncorrected::repeated },
    Scenario { name: "switched-off", replayed: false, check: uncorrected::switched_off },
    Scenario { name: "dry-run", replayed: true, check: uncorrected::dry_run },
    Scenario { name: "abort", replayed: true, check: |case| ended(case, &[ABORT]) },
    Scenario { name: "emergency-stop", replayed: true, check: |case| ended(case, &STOPPED) },
    Scenario { name: "drives-off", replayed: true, check: |case| ended(case, &[DRIVES_DISABLED]) },
    Scenario { name: "disarm", replayed: false, check: |case| disarmed(case, &[DISARMED]) },
    Scenario { name: "config-stopped", replayed: false, check: after_a_while },
    // Component and truepath-config both see it, within a period or some.
    Scenario { name: "program-changed", replayed: false, check: |case| disarmed(case, &[ABORT, DISARMED]) },
    Scenario { name: "feed-hold", replayed: true, check: feed_hold },
    Scenario { name: "feed-override", replayed: true, check: feed_override },
    Scenario { name: "spindle-override", replayed: true, check: spindle_override },
    Scenario { name: "spindle-stop", replayed: true, check: spindle_stop },
    Scenario { name: "restart", replayed: false, check: uncorrected::restart },
    Scenario { name: "offset", replayed: true, check: offset },
    Scenario { name: "offset-while-armed", replayed: false, check: uncorrected::offset_while_armed },
    Scenario { name: "probe-armed", replayed: false, check: uncorrected::probe_armed },
    Scenario { name: "probe-after", replayed: false, check: uncorrected::probe_after },
    Scenario {
        name: KILLED,
        replayed: true,
        check: |case| case.expect(Case::largest(case.rows) > VISIBLE, "no correction"),
    },
    Scenario { name: SPENT, replayed: false, check: uncorrected::spent },
];
/// LinuxCNC is killed behind it.
pub const KILLED: &str = "killed";
/// In a new run of LinuxCNC.
pub const SPENT: &str = "spent";

impl Scenario {
    /// Checks it; what is wrong is added to the findings.
    pub fn check(&self, notes: &Notes, rows: &[Row], found: &mut Vec<String>) {
        let case = Case { notes, rows, found: RefCell::new(std::mem::take(found)) };
        (self.check)(&case);
        *found = case.found.into_inner();
    }
}

/// The whole contour, corrected to its end.
fn completed(case: &Case) {
    case.expect(Case::largest(case.rows) > VISIBLE, "there was no correction to speak of");
    let end = case.rows.last().map(|row| (row.state, row.reason));
    case.expect(end == Some((BYPASS, COMPLETED)), format!("it ended as {end:?}, not completed"));
    let states: Vec<u32> = case.rows.iter().map(|row| row.state).collect();
    let first = |state| states.iter().position(|&s| s == state).unwrap_or(usize::MAX);
    case.expect(first(ARMED) < first(ACTIVE) && first(ACTIVE) < states.len(), "it was not armed, then active");
    case.expect(!states.iter().any(|&s| s > ACTIVE), "there was a hold or a fault in it");
}

fn completed_and_spent(case: &Case) {
    let whole = case.between("", "again").len();
    completed(&Case { rows: &case.rows[..whole], notes: case.notes, found: case.found.take().into() });
    case.untouched(case.between("again", ""), "after the part was done");
    case.refused("refusal");
}

/// The contour is broken off: the correction ramps to zero, and never comes back.
fn ended(case: &Case, reasons: &[u32]) {
    let after = case.between("event", "");
    case.expect(Case::largest(case.between("", "event")) > VISIBLE, "there was no correction before it");
    if let Err(wrong) = ramp::to_zero(after) {
        case.expect(false, wrong);
    }
    let last = after.last();
    case.expect(last.is_some_and(|row| row.state == BYPASS), "it did not end in bypass");
    let reason = last.map_or(0, |row| row.reason);
    case.expect(reasons.contains(&reason), format!("the reason is {reason}, expected {reasons:?}"));
    case.untouched(case.between("again", ""), "after it");
    case.refused("refusal");
}

fn disarmed(case: &Case, reasons: &[u32]) {
    let after = case.between("event", "");
    if let Err(wrong) = ramp::to_zero(after) {
        case.expect(false, wrong);
    }
    case.moved(after, "after disarming");
    let reason = after.last().map_or(0, |row| row.reason);
    case.expect(reasons.contains(&reason), format!("the reason is {reason}, expected one of {reasons:?}"));
}

/// Ended by the watchdog, which waits a second: the correction goes on until then.
fn after_a_while(case: &Case) {
    let after = case.between("event", "");
    let out = after.iter().position(|row| row.correction == [0; 3]);
    let told = out.map_or("never".to_owned(), |periods| format!("{periods} periods later"));
    case.expect(out.is_some_and(|periods| (500..5_000).contains(&periods)), format!("the correction was out {told}"));
    let rest = out.map_or(&[][..], |periods| &after[periods..]);
    case.expect(rest.iter().all(|row| row.correction == [0; 3]), "it came back");
    case.moved(rest, "after the end");
    let reason = after.last().map_or(0, |row| row.reason);
    case.expect(reason == DISARMED, format!("the reason is {reason}, expected {DISARMED}"));
}

/// The correction stays to the nanometre while the axes stand, and goes on with them.
fn feed_hold(case: &Case) {
    let standing = case.between("standing", "resume");
    if let Some(first) = standing.first() {
        case.expect(first.correction != [0; 3], "there was no correction to be held");
        let wrong = standing
            .iter()
            .find(|row| (row.correction, row.setpoint, row.state) != (first.correction, first.setpoint, HOLD));
        let told = |row: &Row| {
            format!("in hold: correction {:?}, at first {:?}, state {}", row.correction, first.correction, row.state)
        };
        case.expect(wrong.is_none(), wrong.map(told).unwrap_or_default());
    }
    let after = case.between("resume", "leave");
    case.expect(after.last().is_some_and(|row| row.state == ACTIVE), "it did not become active again");
    case.expect(!after.iter().any(|row| row.state > HOLD), "there was a fault after it");
    case.moved(after, "after the hold");
}

fn feed_override(case: &Case) {
    let stays = case.between("50 %", "leave");
    case.expect(stays.iter().all(|row| row.state == ACTIVE), "it did not stay active");
    let slow = speed(case.between("50 %", "120 %"));
    let fast = speed(case.between("120 %", "100 %"));
    case.expect(
        fast > 2.2 * slow && fast < 2.6 * slow,
        format!("the feeds are {slow:.0} and {fast:.0} nm in a period"),
    );
    case.expect(Case::largest(stays) > VISIBLE, "there was no correction to speak of");
}

/// The feed, as the median of the way in a period, nm.
fn speed(rows: &[Row]) -> f64 {
    let mut ways: Vec<f64> = rows.windows(2).map(|pair| way(&pair[0], &pair[1])).collect();
    ways.sort_by(f64::total_cmp);
    ways.get(ways.len() / 2).copied().unwrap_or(0.0)
}

fn way(a: &Row, b: &Row) -> f64 {
    ((b.setpoint[0] - a.setpoint[0]) as f64).hypot((b.setpoint[1] - a.setpoint[1]) as f64)
}

fn spindle_override(case: &Case) {
    let stays = case.between("80 %", "leave");
    case.expect(stays.iter().all(|row| row.state == ACTIVE), "it did not stay active");
    let rpm = |rows: &[Row]| rows.last().and_then(|row| row.spindle_rpm.parse::<f64>().ok()).unwrap_or(0.0);
    let (slow, fast) = (rpm(case.between("80 %", "110 %")), rpm(case.between("110 %", "100 %")));
    case.expect((fast / slow - 1.375).abs() < 0.02, format!("the spindle turned {slow} and {fast} rev/min"));
}

/// Faded to nothing while the spindle stands, back when it turns; armed all the time.
fn spindle_stop(case: &Case) {
    let stopped = case.between("stop", "go");
    case.expect(stopped.last().is_some_and(|row| row.correction == [0; 3]), "the correction did not fade to zero");
    case.expect(stopped.iter().all(|row| row.state == ACTIVE), "it did not stay active");
    let after = case.between("go", "leave");
    case.expect(after.last().is_some_and(|row| row.correction != [0; 3]), "the correction did not come back");
}

fn offset(case: &Case) {
    case.expect(Case::largest(case.rows) > VISIBLE, "there was no correction in the other place");
    case.expect(case.notes.number("truepath.frame-sine").is_some_and(|s| s > 1e8), "the turn was not told");
}
