//! A measurement file of any format → readings in work coordinates.

use super::error::{ProbeError, ProbeErrorKind};
use super::format::{Format, Given};
use super::reading::{Reading, Sink};
use super::{columns, console, inspection, linuxcnc};

/// Reads a file into `readings`; returns how many there are.
///
/// # Errors
/// [`ProbeError`] with line and column at the first line that does not fit the format, when the file was cut off, is of
/// another program or ball, does not say its unit or work offset, holds no point, and when it holds more than
/// `readings` can take. Nothing is skipped in silence.
pub fn read(file: &[u8], given: &Given, readings: &mut [Reading]) -> Result<usize, ProbeError> {
    let mut sink = Sink::new(readings);
    match given.format {
        Format::Linuxcnc => linuxcnc::probeopen(file, given, &mut sink),
        Format::Columns => columns::read(file, given, &mut sink),
        Format::LinuxcncLog => linuxcnc::log(file, given, &mut sink),
        Format::Grbl => console::read(file, given, &mut sink),
        Format::Inspection | Format::Dprnt => inspection::read(file, given, &mut sink),
    }?;
    match sink.count() {
        0 => Err(ProbeError { kind: ProbeErrorKind::Empty, line: 1, column: 1, start: 0, len: 0 }),
        count => Ok(count),
    }
}
