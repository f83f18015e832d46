//! One scenario with its recording, and the questions that several scenarios ask of it.

use std::cell::RefCell;

use super::super::notes::Notes;
use super::super::recording::Row;

/// States of the component from which a correction can be on.
const ACTIVE: u32 = 3;
/// Number of `rewrite::Refusal::PartRepeated`.
const PART_REPEATED: f64 = 4.0;

/// One scenario of a session with its findings.
pub struct Case<'a> {
    pub notes: &'a Notes,
    pub rows: &'a [Row],
    pub found: RefCell<Vec<String>>,
}

impl Case<'_> {
    pub fn expect(&self, holds: bool, otherwise: impl Into<String>) {
        if !holds {
            self.found.borrow_mut().push(otherwise.into());
        }
    }

    /// The periods between two marks; an empty name is the end of the scenario.
    pub fn between(&self, from: &str, to: &str) -> &[Row] {
        let place = |at| self.rows.partition_point(|row| row.sequence <= at);
        let from = if from.is_empty() { 0 } else { place(self.notes.mark(from)) };
        let to = if to.is_empty() { self.rows.len() } else { place(self.notes.mark(to)) };
        self.expect(from < to, "there are no periods to check: the driver did not come so far");
        &self.rows[from..to.max(from)]
    }

    /// No correction in any of the periods, and no state in which there could be one.
    pub fn untouched(&self, rows: &[Row], when: &str) {
        let wrong = rows.iter().find(|row| row.correction != [0; 3] || row.state >= ACTIVE);
        let told = |row: &Row| format!("{when}: correction {:?} nm, state {}", row.correction, row.state);
        self.expect(wrong.is_none(), wrong.map(told).unwrap_or_default());
    }

    /// The axes went on by more than some millimetres: uncorrected is not the same as standing.
    pub fn moved(&self, rows: &[Row], when: &str) {
        let reach = (0..2).map(|axis| {
            let places = rows.iter().map(|row| row.setpoint[axis]);
            places.clone().max().unwrap_or(0) - places.min().unwrap_or(0)
        });
        self.expect(reach.max() > Some(1_000_000), format!("{when}: the axes did not move"));
    }

    /// The cutter turned: no correction is not for want of a spindle.
    pub fn turning(&self, rows: &[Row]) {
        let turns = rows.iter().any(|row| row.spindle_rpm.parse().is_ok_and(|rpm: f64| rpm > 1000.0));
        self.expect(turns, "the spindle did not turn");
    }

    pub fn largest(rows: &[Row]) -> i64 {
        rows.iter().flat_map(|row| row.correction).map(i64::abs).max().unwrap_or(0)
    }

    pub fn refused(&self, key: &str) {
        let code = self.notes.number(key);
        self.expect(code == Some(PART_REPEATED), format!("{key}: {code:?}, expected {PART_REPEATED}"));
    }
}
