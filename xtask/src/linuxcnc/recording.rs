//! What HAL's samplers wrote: pins of every servo period, lengths as whole nanometres.
//!
//! Two files hold the columns, each with the sequence number of the component in front. Lines are joined by it. A
//! period that is missing between the first and the last is an error: nothing is judged on half a recording.

use std::collections::HashMap;
use std::fs;
use std::path::Path;

use crate::step::Failure;

/// Joints of the sample machine.
pub const JOINTS: usize = 3;

/// The pins of one servo period. Lengths in nm.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Row {
    pub sequence: u32,
    pub state: u32,
    pub flags: u32,
    pub reason: u32,
    /// Revolutions per minute, as printed.
    pub spindle_rpm: String,
    pub motion_type: i64,
    pub line: i64,
    pub inhibit: bool,
    pub correction: [i64; JOINTS],
    /// Position that the program commands.
    pub setpoint: [i64; JOINTS],
    /// The same with homing offset and backlash.
    pub motor_in: [i64; JOINTS],
    /// What goes to the drives.
    pub motor_out: [i64; JOINTS],
    pub feedback_in: [i64; JOINTS],
    /// What goes back to LinuxCNC.
    pub feedback_out: [i64; JOINTS],
    pub following_error: [i64; JOINTS],
    pub drives_on: bool,
    pub faded: bool,
    pub spindle_on: bool,
    /// The enable that goes to the drive of the first joint.
    pub drive_enabled: bool,
    /// Route B: the link is lost, and periods without an answer so far.
    pub link_lost: bool,
    pub link_misses: u32,
    /// Clocks of the processor that the functions took.
    pub command_clocks: i64,
    pub feedback_clocks: i64,
    pub controller_clocks: i64,
}

/// All periods of a session.
#[derive(Clone, Debug, Default)]
pub struct Recording {
    pub rows: Vec<Row>,
}

impl Recording {
    /// Reads the files of a folder.
    ///
    /// # Errors
    /// A file or column is missing, a number is none, or a period is missing.
    pub fn read(folder: &Path) -> Result<Self, Failure> {
        let [first, second] = ["bank-0", "bank-1"].map(|name| {
            let text = |end| {
                let file = folder.join(format!("{name}.{end}"));
                fs::read_to_string(&file).map_err(|e| Failure::found(format!("{}: {e}", file.display())))
            };
            Ok(Bank { columns: text("columns")?, lines: text("txt")? })
        });
        let recording = Self::joined(&first?, &second?);
        recording.map_err(|why| Failure::found(format!("{}: {why}", folder.display())))
    }

    fn joined(first: &Bank, second: &Bank) -> Result<Self, String> {
        let (columns, others) = (first.places(), second.places());
        let mut behind = second.rows()?.into_iter().peekable();
        let mut rows: Vec<Row> = Vec::new();
        for (sequence, fields) in first.rows()? {
            while behind.next_if(|(other, _)| *other < sequence).is_some() {}
            let Some((_, more)) = behind.next_if(|(other, _)| *other == sequence) else {
                if rows.is_empty() {
                    continue;
                }
                // The second file ends a moment earlier or later.
                if behind.peek().is_none() {
                    break;
                }
                return Err(format!("period {sequence} is missing in the second file"));
            };
            if let Some(last) = rows.last()
                && sequence != last.sequence + 1
            {
                return Err(format!("no period between {} and {sequence} was recorded", last.sequence));
            }
            rows.push(row(&Line { columns: &columns, fields }, &Line { columns: &others, fields: more })?);
        }
        Ok(Self { rows })
    }

    /// The periods from one sequence number to before another.
    pub fn between(&self, from: u32, to: u32) -> &[Row] {
        let place = |sequence| self.rows.partition_point(|row| row.sequence < sequence);
        &self.rows[place(from)..place(to).max(place(from))]
    }
}

/// One of the two files.
struct Bank {
    columns: String,
    lines: String,
}

impl Bank {
    fn places(&self) -> HashMap<&str, usize> {
        self.columns.trim().split(',').enumerate().map(|(place, name)| (name, place)).collect()
    }

    /// Lines by sequence number.
    fn rows(&self) -> Result<Vec<(u32, Vec<&str>)>, String> {
        let count = self.places().len();
        let mut rows = Vec::new();
        for line in self.lines.lines() {
            let fields: Vec<&str> = line.split_whitespace().collect();
            if line.starts_with("overrun") {
                return Err("the sampler lost periods (overrun)".to_owned());
            }
            // The last line may be cut off where the machine was killed.
            if fields.len() == count
                && let Ok(sequence) = fields[0].parse()
                // Until the link to a board is set up, periods have no number.
                && sequence != 0u32
            {
                rows.push((sequence, fields));
            }
        }
        Ok(rows)
    }
}

/// Fields of one line by column.
struct Line<'a> {
    columns: &'a HashMap<&'a str, usize>,
    fields: Vec<&'a str>,
}

impl Line<'_> {
    fn text(&self, name: &str) -> Result<&str, String> {
        let place = self.columns.get(name).ok_or_else(|| format!("there is no column {name}"))?;
        Ok(self.fields[*place])
    }
    fn whole(&self, name: &str) -> Result<i64, String> {
        let text = self.text(name)?;
        text.parse().map_err(|_| format!("column {name}: {text} is no whole number"))
    }
    fn lengths(&self, name: &str) -> Result<[i64; JOINTS], String> {
        let mut lengths = [0; JOINTS];
        for (joint, nm) in lengths.iter_mut().enumerate() {
            let text = self.text(&format!("{name}-{joint}"))?;
            *nm = nanometres(text).ok_or_else(|| format!("column {name}-{joint}: {text} has no six decimals"))?;
        }
        Ok(lengths)
    }
}

/// Millimetres with six decimals as nanometres.
fn nanometres(text: &str) -> Option<i64> {
    let (whole, fraction) = text.split_once('.')?;
    (fraction.len() == 6).then(|| format!("{whole}{fraction}").parse().ok())?
}

fn row(first: &Line, second: &Line) -> Result<Row, String> {
    let mut correction = [0; JOINTS];
    for (joint, nm) in correction.iter_mut().enumerate() {
        *nm = first.whole(&format!("correction-nm-{joint}"))?;
    }
    let small = |name| Ok::<u32, String>(u32::try_from(first.whole(name)?).unwrap_or(u32::MAX));
    Ok(Row {
        sequence: small("sequence")?,
        state: small("state")?,
        flags: small("flags")?,
        reason: small("reason")?,
        spindle_rpm: first.text("spindle-rpm")?.to_owned(),
        motion_type: first.whole("motion-type")?,
        line: first.whole("line")?,
        inhibit: first.whole("inhibit")? != 0,
        correction,
        setpoint: first.lengths("setpoint")?,
        motor_in: first.lengths("motor-in")?,
        motor_out: first.lengths("motor-out")?,
        feedback_in: second.lengths("feedback-in")?,
        feedback_out: second.lengths("feedback-out")?,
        following_error: second.lengths("following-error")?,
        drives_on: second.whole("drives-on")? != 0,
        faded: second.whole("faded")? != 0,
        spindle_on: second.whole("spindle-on")? != 0,
        drive_enabled: second.whole("drive-enabled")? != 0,
        link_lost: second.whole("link-lost")? != 0,
        link_misses: u32::try_from(second.whole("link-misses")?).unwrap_or(u32::MAX),
        command_clocks: second.whole("time-command")?,
        feedback_clocks: second.whole("time-feedback")?,
        controller_clocks: second.whole("time-controller")?,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_are_whole_nanometres() {
        assert_eq!(nanometres("-0.000001"), Some(-1));
        assert_eq!(nanometres("12.345678"), Some(12_345_678));
        assert_eq!(nanometres("-3.000000"), Some(-3_000_000));
        assert_eq!(nanometres("3.0"), None);
    }

    #[test]
    fn a_period_that_is_missing_is_an_error() {
        let bank = |lines: &str| Bank { columns: "sequence".into(), lines: lines.into() };
        assert!(bank("1\noverrun\n3\n").rows().is_err());
        let missing = Recording::joined(&bank("1\n2\n3\n"), &bank("1\n3\n"));
        assert!(missing.is_err());
    }
}
