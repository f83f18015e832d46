//! The two files that LinuxCNC writes: `(PROBEOPEN file)` and the `(LOG, …)` of a verification program.

use super::error::{ProbeError, ProbeErrorKind};
use super::format::Given;
use super::heading::Heading;
use super::number::Signs;
use super::reading::{Outcome, Reading, Sink, unit_normal};
use super::row::{Row, is_empty, position};
use truepath_rs274::Lines;

/// What the last line begins with.
const END: &str = "`# end`";

/// PROBEOPEN: nine numbers X Y Z A B C U V W in each line, no header.
///
/// Work coordinates, unit of the program, ball centre (observed on LinuxCNC 2.9). Probe moves that touched nothing are
/// written as well, at the end of the move, and cannot be told from touches.
pub(super) fn probeopen(file: &[u8], given: &Given, sink: &mut Sink) -> Result<(), ProbeError> {
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

/// A log: `id,nx,ny,xn,yn,xs,ys,zs,hit` in each line.
///
/// Work coordinates, ball centre. Lines that begin with `#` are comments, of which `# program`, `# unit`, `# ball`,
/// `# points` and `# end` mean something (see [`Heading`]). The last line is `# end COUNT`, so that a file that was
/// cut off is noticed. A log may follow another one in the same file.
pub(super) fn log(file: &[u8], given: &Given, sink: &mut Sink) -> Result<(), ProbeError> {
    let mut heading = Heading::new(given);
    let mut open_at = None;
    for line in Lines::new(file).filter(|line| !is_empty(line)) {
        if let Some(comment) = line.text.trim_ascii_start().strip_prefix(b"#") {
            if heading.note(comment, &line)? {
                open_at = None;
            }
            continue;
        }
        let row = Row { line, separator: Some(b','), signs: Signs::POINT };
        let [_, nx, ny, _, _, x, y, z, hit] = row.exactly::<9>()?;
        let normal = unit_normal(nx.real(), ny.real());
        let normal = Some(normal.ok_or_else(|| ProbeError::of_line(ProbeErrorKind::NoNormal, &line))?);
        let outcome = match hit.whole() {
            Some(1) => Outcome::Touched,
            Some(0) => Outcome::Missed,
            _ => return Err(ProbeError::of_line(ProbeErrorKind::Malformed { expected: "hit 1 or 0" }, &line)),
        };
        let position = position([x, y, z], heading.unit(), &line)?;
        sink.push(Reading { position, radius: given.ball_radius(), outcome, normal, line: line.number }, &line)?;
        heading.count();
        open_at = Some(line);
    }
    match open_at {
        Some(line) => Err(ProbeError::of_line(ProbeErrorKind::CutOff { expected: END }, &line)),
        None => Ok(()),
    }
}
