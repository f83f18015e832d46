//! The tool path of a recording, for the plant: machine coordinates, one row a servo period.
//!
//! Commanded is what the program wants and what Truepath adds. Measured is where the drives stood: their positions without
//! homing offset and backlash compensation, both of which LinuxCNC adds behind the setpoint and which move no cutter.

use std::fmt::Write;

use super::super::notes::Notes;
use super::super::recording::{JOINTS, Recording, Row};
use crate::step::Failure;

/// Where the program stood in the machine.
pub struct Placed {
    pub origin_nm: [i64; JOINTS],
    /// Cosine and sine, units of 2⁻³⁰.
    pub turn: [i64; 2],
}

impl Placed {
    /// As the driver of the machine noted it.
    ///
    /// # Errors
    /// It did not.
    pub fn of(notes: &Notes) -> Result<Self, Failure> {
        let pin = |name: &str| {
            let value = notes.number(&format!("truepath.{name}"));
            value.ok_or_else(|| Failure::found(format!("{}: the driver did not note {name}", notes.name)))
        };
        let nm = |name| Ok((pin(name)? * 1e6).round() as i64);
        Ok(Self {
            origin_nm: [nm("offset-x")?, nm("offset-y")?, nm("offset-z")?],
            turn: [pin("frame-cosine")? as i64, pin("frame-sine")? as i64],
        })
    }

    /// As `truepath simulate` takes it.
    pub fn arguments(&self) -> [String; 3] {
        let [x, y, z] = self.origin_nm.map(millimetres);
        let [cosine, sine] = self.turn;
        [format!("--origin-mm={x},{y},{z}"), format!("--cosine={cosine}"), format!("--sine={sine}")]
    }
}

/// What was commanded.
pub fn commanded(recording: &Recording) -> String {
    setpoints(&recording.rows, |row, joint| row.setpoint[joint] + row.correction[joint])
}

/// Where the drives stood at the end of each period.
pub fn measured(recording: &Recording) -> String {
    setpoints(&recording.rows, |row, joint| row.feedback_in[joint] - (row.motor_in[joint] - row.setpoint[joint]))
}

fn setpoints(rows: &[Row], position: impl Fn(&Row, usize) -> i64) -> String {
    let mut text = String::from("# frame = machine\nt_s,x_mm,y_mm,z_mm,spindle_rpm\n");
    for (index, row) in rows.iter().enumerate() {
        let [x, y, z] = [0, 1, 2].map(|joint| millimetres(position(row, joint)));
        let (seconds, thousandths) = (index / 1000, index % 1000);
        let _ = writeln!(text, "{seconds}.{thousandths:03},{x},{y},{z},{}", row.spindle_rpm);
    }
    text
}

fn millimetres(nm: i64) -> String {
    let sign = if nm < 0 { "-" } else { "" };
    format!("{sign}{}.{:06}", nm.unsigned_abs() / 1_000_000, nm.unsigned_abs() % 1_000_000)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn offset_and_backlash_of_the_motor_are_no_way_of_the_cutter() {
        let row = Row {
            setpoint: [10_000_000, 0, -1],
            motor_in: [11_742_000, 8_000, -1],
            feedback_in: [11_741_000, 8_000, -1],
            correction: [500, 0, 0],
            spindle_rpm: "1500.0".to_owned(),
            ..Row::default()
        };
        let recording = Recording { rows: vec![row] };
        assert!(measured(&recording).ends_with("\n0.000,9.999000,0.000000,-0.000001,1500.0\n"));
        assert!(commanded(&recording).ends_with("\n0.000,10.000500,0.000000,-0.000001,1500.0\n"));
    }
}
