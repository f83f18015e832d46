//! LinuxCNC's parameter file (`linuxcnc.var`): a number and a value a line, `5221 12.500000`.
//!
//! It holds reference points (5161, 5181 …), G92 (5210 …), the work offset in force (5220) and the offsets themselves
//! (5221 …), in the unit of the machine. What stands behind the value and lines without a number are remarks, as they
//! are for LinuxCNC.

use truepath_core::gcode::Memory;
use truepath_ground::diagnostics::{InputError, Source};

use crate::codes::T002;

/// Parameters by number.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ParameterFile {
    values: Vec<(u16, f64)>,
}

/// The largest number.
const LARGEST: u16 = 5_602;

impl ParameterFile {
    /// Reads a file.
    ///
    /// # Errors
    /// `T002` for a line that is no parameter with its value.
    pub fn parse(source: &Source) -> Result<Self, InputError> {
        let text = source.bytes();
        let mut values = Vec::new();
        let mut start = 0;
        for line in text.split(|&b| b == b'\n') {
            let end = start + line.len();
            let words = String::from_utf8_lossy(line);
            let mut words = words.split_ascii_whitespace();
            let first = words.next().unwrap_or_default();
            if first.starts_with(|c: char| c.is_ascii_digit()) {
                let refused =
                    |found: &str| T002.error(found, "a parameter number and its value").at(source, start..end);
                let number: Option<u16> = first.parse().ok().filter(|n| (1..=LARGEST).contains(n));
                let number = number.ok_or_else(|| refused(&format!("{first} is no parameter of a machine")))?;
                let value = words.next().ok_or_else(|| refused("this parameter has no value"))?;
                let value: Option<f64> = value.parse().ok().filter(|v: &f64| v.is_finite());
                values.push((number, value.ok_or_else(|| refused("this value is no number"))?));
            }
            start = end + 1;
        }
        Ok(Self { values })
    }

    /// Puts the values into the memory of a program.
    pub(super) fn load(&self, memory: &mut Memory<'_>) {
        for &(number, value) in &self.values {
            // The host's memory has room for every number that `parse` lets through.
            let _ = memory.set(number, value);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(text: &str) -> Result<ParameterFile, InputError> {
        ParameterFile::parse(&Source::new("machine.var", text.as_bytes().to_vec()))
    }

    #[test]
    fn numbers_and_values_are_read_and_remarks_skipped() {
        let read = file("; remark\n5221\t12.5\n\n5222 -1e-3 behind\n").expect("a file");
        assert_eq!(read.values, [(5221, 12.5), (5222, -0.001)]);
    }

    #[test]
    fn a_bad_value_is_an_error_with_its_line() {
        for (text, line) in [("5221 1\n5222 x\n", 2), ("5221\n", 1), ("99999 1\n", 1), ("5221 1\n5222 nan", 2)] {
            let error = file(text).expect_err(text);
            assert_eq!((error.code(), error.line_column()), ("T002", Some((line, 1))), "{text}");
        }
    }
}
