//! The component against `truepath replay`: the recorded setpoints through the program, the same corrections to the last
//! nanometre, in the same states.
//!
//! What is replayed begins with the period in which the component was armed. Setpoints, spindle speed and flags are the
//! recorded ones, so an abort or a hold is replayed like the rest.

use std::fmt::Write;
use std::fs;
use std::path::Path;

use super::super::recording::Row;
use crate::repository::{program, read};
use crate::step::Failure;

const STATES: [&str; 6] = ["Off", "Bypass", "Armed", "Active", "Hold", "Fault"];
const ARMED: u32 = 2;

/// What is needed besides the recording.
#[derive(Clone, Copy, Debug)]
pub struct Replay<'a> {
    pub truepath: &'a Path,
    pub image: &'a Path,
    /// Folder for the files of both directions.
    pub folder: &'a Path,
    /// Length of a servo period.
    pub period_us: u64,
    /// Machine coordinates of the program's origin, nm.
    pub origin: [i64; 3],
    /// Cosine and sine of the program's turn, units of 2⁻³⁰.
    pub turn: [i64; 2],
    /// Settings of the component, as `--setting` takes them.
    pub settings: &'a [String],
}

/// What was compared.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Equality {
    pub periods: usize,
    /// Periods with a correction.
    pub corrected: usize,
}

/// Compares a part from its arming to the end of the rows.
///
/// # Errors
/// Nothing was armed, the replay fails, or a period differs: the first is told.
pub fn compare(rows: &[Row], name: &str, serial: u32, replay: &Replay) -> Result<Equality, Failure> {
    let armed = rows.iter().position(|row| row.state >= ARMED);
    let rows = &rows[armed.ok_or_else(|| Failure::found("nothing was armed"))?..];
    let [input, output] = ["setpoints", "replayed"].map(|end| replay.folder.join(format!("{name}-{end}.csv")));
    fs::write(&input, setpoints(rows, replay.period_us))
        .map_err(|e| Failure::found(format!("{}: {e}", input.display())))?;
    let [x, y, z] = replay.origin.map(millimetres);
    let mut command = program(replay.truepath);
    command.arg("replay").arg(replay.image).arg("--setpoints").arg(&input).arg("-o").arg(&output).arg("--force");
    command
        .arg(format!("--origin-mm={x},{y},{z}"))
        .arg(format!("--cosine={}", replay.turn[0]))
        .arg(format!("--sine={}", replay.turn[1]));
    command.args(["--part", &serial.to_string()]);
    for setting in replay.settings {
        command.args(["--setting", setting]);
    }
    read(&mut command)?;
    let text = fs::read_to_string(&output).map_err(|e| Failure::found(format!("{}: {e}", output.display())))?;
    equal(rows, &text).map_err(Failure::Found)
}

/// The recorded setpoints as the program reads them.
fn setpoints(rows: &[Row], period_us: u64) -> String {
    let mut text = String::from("# frame = machine\nt_s,x_mm,y_mm,z_mm,spindle_rpm,flags\n");
    for (index, row) in rows.iter().enumerate() {
        let [x, y, z] = row.setpoint.map(millimetres);
        // A spindle that is switched off counts as standing from then on.
        let rpm = if row.spindle_on { row.spindle_rpm.as_str() } else { "0" };
        let us = index as u64 * period_us;
        let (seconds, millionths) = (us / 1_000_000, us % 1_000_000);
        let _ = writeln!(text, "{seconds}.{millionths:06},{x},{y},{z},{rpm},{}", row.flags);
    }
    text
}

fn millimetres(nm: i64) -> String {
    let sign = if nm < 0 { "-" } else { "" };
    format!("{sign}{}.{:06}", nm.unsigned_abs() / 1_000_000, nm.unsigned_abs() % 1_000_000)
}

fn equal(rows: &[Row], replayed: &str) -> Result<Equality, String> {
    let mut lines = replayed.lines().filter(|line| !line.starts_with('#'));
    let names: Vec<&str> = lines.next().unwrap_or_default().split(',').collect();
    let place = |name: &str| names.iter().position(|n| *n == name).ok_or_else(|| format!("no column {name}"));
    let places = [place("x_mm")?, place("y_mm")?, place("dx_mm")?, place("dy_mm")?, place("state")?];
    let mut equality = Equality::default();
    for row in rows {
        let fields: Vec<&str> = lines.next().unwrap_or_default().split(',').collect();
        let theirs = places.map(|place| fields.get(place).copied().unwrap_or_default());
        let corrected = [0, 1].map(|axis| millimetres(row.setpoint[axis] + row.correction[axis]));
        let added = [0, 1].map(|axis| millimetres(row.correction[axis]));
        let state = STATES.get(row.state as usize).copied().unwrap_or("?");
        let ours = [&corrected[0], &corrected[1], &added[0], &added[1], state];
        if ours != theirs {
            return Err(format!("period {}: the component has {ours:?}, replay {theirs:?}", row.sequence));
        }
        equality.periods += 1;
        equality.corrected += usize::from(row.correction != [0; 3]);
    }
    Ok(equality)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_nanometre_is_a_difference() {
        let row = |nm| Row { state: 3, setpoint: [1_000_000, -5, 0], correction: [nm, 0, 0], ..Row::default() };
        let replayed = "# frame = machine\nt_s,x_mm,y_mm,z_mm,dx_mm,dy_mm,state,reason,status,node\n\
                        0.0,1.000007,-0.000005,0,0.000007,0.000000,Active,0,0,1\n";
        assert_eq!(equal(&[row(7)], replayed), Ok(Equality { periods: 1, corrected: 1 }));
        assert!(equal(&[row(8)], replayed).is_err());
        assert!(equal(&[row(7), row(7)], replayed).is_err());
    }
}
