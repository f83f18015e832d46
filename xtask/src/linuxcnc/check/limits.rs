//! What holds in every servo period of every scenario: limits of the joints, exact bookkeeping, following error.
//!
//! Positions are recorded in whole nanometres, each rounded by at most half of one. A difference of two is then off by
//! at most 1 nm, a second difference by at most 2 nm, and so much is granted; at 1 kHz that is 0.001 mm/s and 2 mm/s².
//! Speed and acceleration are those of setpoint + correction. Homing offset and backlash, which LinuxCNC adds to the
//! command and the component passes on, have no part in it: `motor-pos-cmd` is checked against them by subtraction.

use super::super::machine::sample::number;
use super::super::recording::{JOINTS, Row};

const NM_PER_MM: f64 = 1e6;
/// The simulated drives: part of the way to the command made in a period (`drive.N.gain`).
const GAIN: f64 = 0.3;
/// Rounding of recorded positions and of the model of the drive, nm.
const ROUNDING: f64 = 4.0;

/// Limits of a joint, nm and periods.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Joint {
    least: i64,
    greatest: i64,
    velocity: i64,
    acceleration: i64,
    following_error: i64,
}

/// Greatest values that were met, for the table. Units of mm and s.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Extremes {
    pub correction_mm: f64,
    /// As parts of the limits of the joints.
    pub velocity: f64,
    pub acceleration: f64,
    pub following_error_mm: f64,
    /// By how much the correction changed the following error that LinuxCNC sees.
    pub following_change_mm: f64,
}

impl Joint {
    /// From the INI file; `hz` servo periods a second.
    pub fn read(ini: &str, joint: usize, hz: f64) -> Option<Self> {
        let section = format!("JOINT_{joint}");
        let mm = |key, per: f64| Some((number(ini, &section, key)? * NM_PER_MM / per) as i64);
        Some(Self {
            least: mm("MIN_LIMIT", 1.0)?,
            greatest: mm("MAX_LIMIT", 1.0)?,
            velocity: mm("MAX_VELOCITY", hz)?,
            acceleration: mm("MAX_ACCELERATION", hz * hz)?,
            following_error: mm("FERROR", 1.0)?,
        })
    }
}

/// Checks the periods of a scenario; gives what was found wrong, at most once for each rule and joint.
pub fn check(rows: &[Row], joints: &[Joint; JOINTS], found: &mut Vec<String>) -> Extremes {
    let mut extremes = Extremes::default();
    for (index, joint) in joints.iter().enumerate() {
        let mut track = Track { index, joint, found: Vec::new(), extremes: &mut extremes };
        track.bookkeeping(rows);
        track.motion(rows);
        track.following(rows);
        found.append(&mut track.found);
    }
    extremes
}

/// One joint through the periods.
struct Track<'a> {
    index: usize,
    joint: &'a Joint,
    found: Vec<String>,
    extremes: &'a mut Extremes,
}

impl Track<'_> {
    /// Says a rule is broken, the first time.
    fn broken(&mut self, rule: &str, row: &Row, detail: String) {
        let head = format!("joint {}: {rule}", self.index);
        if !self.found.iter().any(|f| f.starts_with(&head)) {
            self.found.push(format!("{head}: {detail} (period {}, line {})", row.sequence, row.line));
        }
    }

    /// What goes to the drive is the command with the correction; what goes back is without the last one.
    fn bookkeeping(&mut self, rows: &[Row]) {
        let j = self.index;
        for row in rows {
            let (added, correction) = (row.motor_out[j] - row.motor_in[j], row.correction[j]);
            // Untouched, to the digit, without a correction.
            let granted = i64::from(correction != 0);
            if (added - correction).abs() > granted {
                self.broken("command", row, format!("{added} nm were added, the correction is {correction} nm"));
            }
            let reach = &mut self.extremes.correction_mm;
            *reach = reach.max(correction.unsigned_abs() as f64 / NM_PER_MM);
        }
        for pair in rows.windows(2) {
            // The drives move at the end of a period, and are read in the next.
            let (removed, correction) = (pair[0].feedback_in[j] - pair[1].feedback_out[j], pair[0].correction[j]);
            if (removed - correction).abs() > i64::from(correction != 0) {
                let detail = format!("{removed} nm were removed, the correction before was {correction} nm");
                self.broken("feedback", &pair[1], detail);
            }
        }
    }

    /// Position, speed and acceleration of the corrected command while the drives are on. When they are switched off,
    /// LinuxCNC sets the command to where the axes stand.
    fn motion(&mut self, rows: &[Row]) {
        let (j, joint) = (self.index, *self.joint);
        let at = |row: &Row| row.setpoint[j] + row.correction[j];
        for row in rows {
            if at(row) < joint.least || at(row) > joint.greatest {
                self.broken("soft limit", row, format!("commanded to {} nm", at(row)));
            }
        }
        for pair in rows.windows(2).filter(|rows| rows.iter().all(|row| row.drives_on)) {
            let step = at(&pair[1]) - at(&pair[0]);
            self.extremes.velocity = self.extremes.velocity.max(step.abs() as f64 / joint.velocity as f64);
            if step.abs() > joint.velocity + 1 {
                self.broken("velocity", &pair[1], format!("{step} nm in a period, permitted {}", joint.velocity));
            }
        }
        for three in rows.windows(3).filter(|rows| rows.iter().all(|row| row.drives_on)) {
            let change = at(&three[2]) - 2 * at(&three[1]) + at(&three[0]);
            let part = change.abs() as f64 / joint.acceleration as f64;
            self.extremes.acceleration = self.extremes.acceleration.max(part);
            if change.abs() > joint.acceleration + 2 {
                let detail = format!("{change} nm in a period squared, permitted {}", joint.acceleration);
                self.broken("acceleration", &three[2], detail);
            }
        }
    }

    /// The drive is modelled once more, without the correction. What LinuxCNC sees as following error may differ from
    /// the model's by what the drive lags behind the correction, and by nothing else.
    fn following(&mut self, rows: &[Row]) {
        let j = self.index;
        let Some(first) = rows.first() else { return };
        // The drive follows the command and the correction, each by itself: it is linear.
        let mut plain = first.feedback_in[j] as f64;
        let mut lagging = first.correction[j] as f64;
        for pair in rows.windows(2) {
            let [before, row] = pair else { continue };
            let error = row.following_error[j];
            let limit = self.joint.following_error;
            self.extremes.following_error_mm = self.extremes.following_error_mm.max(error.abs() as f64 / NM_PER_MM);
            if row.drives_on && error.abs() > limit {
                self.broken("following error", row, format!("{error} nm, permitted {limit}"));
            }
            // Output of the drive that LinuxCNC reads in this period.
            let seen = row.feedback_out[j] as f64;
            let change = seen - plain;
            let explained = lagging - before.correction[j] as f64;
            if row.drives_on && before.drives_on {
                self.extremes.following_change_mm = self.extremes.following_change_mm.max(change.abs() / NM_PER_MM);
                if (change - explained).abs() > ROUNDING {
                    let detail =
                        format!("{change:.0} nm from that without correction, the drive's lag explains {explained:.0}");
                    self.broken("feedback seen by LinuxCNC", row, detail);
                }
            }
            let moved = |state: f64, to: f64| state + GAIN * (to - state);
            if row.drives_on {
                plain = moved(plain, row.motor_in[j] as f64);
                lagging = moved(lagging, row.correction[j] as f64);
            } else {
                plain = seen;
                lagging = 0.0;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const JOINT: Joint =
        Joint { least: -1000, greatest: 1_000_000, velocity: 1000, acceleration: 100, following_error: 10_000 };

    /// A joint in steady motion with a correction that rises by a nanometre a period.
    fn run() -> Vec<Row> {
        let (mut drive, mut correction_before) = (0.0_f64, 0);
        let mut rows = Vec::new();
        for sequence in 0..200_u32 {
            let (position, correction) = (i64::from(sequence) * 10, i64::from(sequence));
            let mut row = Row { sequence, drives_on: true, ..Row::default() };
            row.setpoint[0] = position;
            row.motor_in[0] = position;
            row.correction[0] = correction;
            row.motor_out[0] = position + correction;
            row.feedback_out[0] = drive.round() as i64 - correction_before;
            drive += GAIN * ((position + correction) as f64 - drive);
            row.feedback_in[0] = drive.round() as i64;
            correction_before = correction;
            rows.push(row);
        }
        rows
    }

    fn findings(rows: &[Row]) -> Vec<String> {
        let mut found = Vec::new();
        check(rows, &[JOINT; JOINTS], &mut found);
        found
    }

    #[test]
    fn a_regular_run_passes() {
        assert_eq!(findings(&run()), Vec::<String>::new());
    }

    #[test]
    fn each_rule_finds_what_breaks_it() {
        type Damage = fn(&mut Row);
        let damages: [(&str, Damage); 5] = [
            ("command", |row| row.motor_out[0] += 2),
            ("feedback", |row| row.feedback_out[0] += 2),
            ("velocity", |row| row.setpoint[0] += 1000),
            ("acceleration", |row| row.setpoint[0] += 60),
            ("soft limit", |row| row.setpoint[0] = 1_000_001),
        ];
        for (rule, damage) in damages {
            let mut rows = run();
            damage(&mut rows[100]);
            let found = findings(&rows);
            assert!(found.iter().any(|f| f.starts_with(&format!("joint 0: {rule}"))), "{rule}: {found:?}");
        }
    }

    #[test]
    fn a_correction_that_linuxcnc_sees_is_found() {
        let mut rows = run();
        for row in &mut rows[50..] {
            row.feedback_in[0] += 40;
            row.feedback_out[0] += 40;
        }
        assert!(findings(&rows).iter().any(|f| f.contains("seen by LinuxCNC")));
    }
}
