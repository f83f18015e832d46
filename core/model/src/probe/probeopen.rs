//! LinuxCNC's `(PROBEOPEN file)`: nine numbers X Y Z A B C U V W in each line, no header.
//!
//! Work coordinates, unit of the program, ball centre (observed on LinuxCNC 2.9). Probe moves that touched nothing are
//! written as well, at the end of the move, and cannot be told from touches.

use super::error::ProbeError;
use super::format::Given;
use super::number::Signs;
use super::reading::{Outcome, Reading, Sink};
use super::row::{Row, is_empty, position};
use truepath_rs274::Lines;

pub(super) fn read(file: &[u8], given: &Given, sink: &mut Sink) -> Result<(), ProbeError> {
    for line in Lines::new(file).filter(|line| !is_empty(line)) {
        let row = Row { line, separator: None, signs: Signs { point: true, comma: true } };
        let [x, y, z, ..] = row.exactly::<9>()?;
        let position = position([x, y, z], given.program_unit, &line)?;
        let radius = given.ball_radius();
        let reading = Reading { position, radius, outcome: Outcome::Touched, normal: None, line: line.number };
        sink.push(reading, &line)?;
    }
    Ok(())
}
