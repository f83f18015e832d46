//! The columns of a file of setpoints, and the fields of one line.
//!
//! `t_s,x_mm,y_mm,z_mm` come first. Any of these may follow, in any order:
//!
//! | column | meaning | without it |
//! |---|---|---|
//! | `spindle_rpm` | spindle speed, 0 … 200 000 rev/min | the image's nominal speed |
//! | `flags` | bits of [`Flags`], 0 … 127 | drives enabled, spindle loaded |
//! | `frame_crc` | checksum of the frame in force | the frame that was armed |
//! | `disarm` | 1: disarmed by command before this tick | 0 |

use std::ops::Range;
use std::str::FromStr;

use truepath_core::rewrite::Flags;
use truepath_core::units::{Offset, Real};
use truepath_ground::decimal::Decimal;
use truepath_ground::diagnostics::{InputError, Source};

use crate::codes::{S002, S003};

/// In every file, in this order.
const FIRST: [&str; 4] = ["t_s", "x_mm", "y_mm", "z_mm"];
/// May follow.
const OPTIONAL: [&str; 4] = ["spindle_rpm", "flags", "frame_crc", "disarm"];
/// The farthest coordinate: 4 m.
const FARTHEST: Offset = Offset::from_um(4_000_000);
/// The fastest spindle, rev/min.
const FASTEST: Real = Real::from_int(200_000);
/// All flags there are.
const ALL_FLAGS: u16 = 0x7f;

/// One tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Row {
    /// X, Y, Z, nm.
    pub position_nm: [i64; 3],
    /// Spindle speed, rev/min; `None` when the file has no such column.
    pub spindle_rpm: Option<Real>,
    /// What the controller said with it; drives enabled and spindle loaded when the file has no such column.
    pub flags: Flags,
    /// Checksum of the frame in force; `None` when the file has no such column: the frame that was armed.
    pub frame_crc: Option<u32>,
    /// Whether the arming was ended by command before this tick.
    pub disarm: bool,
}

/// Which columns a file has.
#[derive(Debug)]
pub(super) struct Columns {
    count: usize,
    /// Where each of [`OPTIONAL`] stands.
    optional: [Option<usize>; 4],
}

impl Columns {
    /// Reads the line with the names.
    pub(super) fn read(fields: &Fields) -> Result<Self, InputError> {
        let names: Vec<String> = fields.record.iter().map(|f| String::from_utf8_lossy(f).trim().to_owned()).collect();
        let mut optional = [None; 4];
        for index in 0..names.len().max(FIRST.len()) {
            let name = names.get(index).map(String::as_str);
            if let Some(expected) = FIRST.get(index) {
                if name != Some(expected) {
                    return Err(fields.wrong_name(index, name, names.len()));
                }
                continue;
            }
            match OPTIONAL.iter().position(|&o| name == Some(o)).map(|which| &mut optional[which]) {
                Some(place @ None) => *place = Some(index),
                _ => return Err(fields.wrong_name(index, name, names.len())),
            }
        }
        Ok(Self { count: names.len(), optional })
    }

    /// Time, ns, and the rest of a line.
    pub(super) fn row(&self, fields: &Fields) -> Result<(i64, Row), InputError> {
        if fields.record.len() != self.count {
            let found = format!("this line has {} fields", fields.record.len());
            let expected = format!("{}, as in the line with the names", self.count);
            let help = "a line that was cut off? remove it or record again";
            return Err(InputError::new(S002, found, expected, help).at(fields.source, fields.span(usize::MAX)));
        }
        let time_ns = fields.number(0, FIRST[0])?.as_billionths();
        let mut position_nm = [0; 3];
        for (index, nm) in (1..).zip(&mut position_nm) {
            let length = fields.number(index, FIRST[index])?.as_mm();
            if length.abs() > FARTHEST {
                return Err(fields.refused(index, FIRST[index], "-4000 to 4000 mm"));
            }
            *nm = length.nm();
        }
        let [rpm, flags, frame, disarm] = self.optional;
        let usual = Flags::DRIVES_ENABLED.with(Flags::SPINDLE_LOADED);
        let row = Row {
            position_nm,
            spindle_rpm: rpm.map(|at| fields.speed(at)).transpose()?,
            flags: flags.map_or(Ok(usual), |at| fields.whole(at, "flags", ALL_FLAGS).map(Flags))?,
            frame_crc: frame.map(|at| fields.whole(at, "frame_crc", u32::MAX)).transpose()?,
            disarm: disarm.map_or(Ok(0), |at| fields.whole(at, "disarm", 1u8))? == 1,
        };
        Ok((time_ns, row))
    }
}

/// The fields of one line.
pub(super) struct Fields<'a> {
    pub source: &'a Source,
    pub record: &'a csv::ByteRecord,
    /// Where the line begins.
    pub start: usize,
}

impl Fields<'_> {
    /// Where a field stands; the whole line for one that is missing.
    pub(super) fn span(&self, index: usize) -> Range<usize> {
        let before: usize = self.record.iter().take(index).map(|f| f.len() + 1).sum();
        match self.record.get(index) {
            Some(field) => self.start + before..self.start + before + field.len(),
            None => self.start..self.start + self.record.as_slice().len() + self.record.len().saturating_sub(1),
        }
    }

    fn wrong_name(&self, index: usize, name: Option<&str>, count: usize) -> InputError {
        let found = match name {
            Some(name) => format!("column {} is \"{name}\"", index + 1),
            None => format!("there are {count} columns"),
        };
        let expected = format!("{}, then any of {}, each once", FIRST.join(","), OPTIONAL.join(", "));
        let help = "name the columns in the second line of the file";
        InputError::new(S002, found, expected, help).at(self.source, self.span(index))
    }

    fn text(&self, index: usize) -> Option<&str> {
        self.record.get(index).and_then(|f| std::str::from_utf8(f).ok()).map(str::trim)
    }

    fn number(&self, index: usize, name: &str) -> Result<Decimal, InputError> {
        self.text(index).and_then(Decimal::parse).ok_or_else(|| self.refused(index, name, "a decimal number"))
    }

    fn speed(&self, index: usize) -> Result<Real, InputError> {
        let rpm = self.number(index, OPTIONAL[0])?.as_real();
        if rpm < 0 || rpm > FASTEST {
            return Err(self.refused(index, OPTIONAL[0], "0 to 200000 rev/min"));
        }
        Ok(rpm)
    }

    fn whole<T: FromStr + PartialOrd + std::fmt::Display>(
        &self,
        index: usize,
        name: &str,
        most: T,
    ) -> Result<T, InputError> {
        let value = self.text(index).and_then(|t| t.parse().ok()).filter(|v| *v <= most);
        value.ok_or_else(|| self.refused(index, name, &format!("a whole number, 0 to {most}")))
    }

    fn refused(&self, index: usize, name: &str, expected: &str) -> InputError {
        let span = self.span(index);
        let found = format!("{name} is \"{}\"", self.source.excerpt(span.clone()));
        S003.error(found, expected).at(self.source, span)
    }
}
