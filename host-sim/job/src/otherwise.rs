//! A probe file that cannot be read as the job says: as what else it could be.
//!
//! Every other format is tried. What brings most of the readings to the wall is named.

use truepath_core::job::{self, JobError, Probe};
use truepath_core::probe::{Contact, Format, Outcome, ProbeErrorKind, Reading};
use truepath_ground::diagnostics::{InputError, Source};

use crate::codes::M042;
use crate::job::FORMATS;
use crate::pass::Pass;

/// Files longer than this are not tried, bytes.
const LONGEST: usize = 1 << 20;
/// Fewer readings on the wall may be chance.
const LEAST: usize = 3;

/// What the file is instead, after it was refused with an error; `None` where nothing fits better.
pub(crate) fn otherwise(pass: &Pass, file: &Source, error: &JobError) -> Option<InputError> {
    let bytes = file.bytes();
    let unread = match error {
        JobError::Measurement(error) => !is_of_another_part(&error.kind),
        JobError::OffTheWall { .. } | JobError::NoContact { .. } => true,
        _ => false,
    };
    if !unread || bytes.len() > LONGEST {
        return None;
    }
    let stated = pass.job.numbers.probe?;
    let (name, _) = format_of(pass, &stated, bytes).filter(|(_, format)| !is_alike(*format, stated.format))?;
    let said = FORMATS.iter().find(|(_, format)| *format == stated.format).map_or("", |(name, _)| name);
    let found =
        format!("the file cannot be used as format = \"{said}\", and read as \"{name}\" its points lie on the wall");
    let help = format!("write format = \"{name}\" in [probe] of the job, or give --format {name}");
    Some(InputError::new(M042, found, format!("a file of format \"{said}\""), help).at(file, 0..0))
}

/// Whether one reader takes the lines of the other: what it makes of a damaged file says nothing.
fn is_alike(a: Format, b: Format) -> bool {
    let of_dprnt = |format| matches!(format, Format::Inspection | Format::Dprnt);
    a == b || (of_dprnt(a) && of_dprnt(b))
}

/// Errors of files that are read and belong to something else.
const fn is_of_another_part(kind: &ProbeErrorKind) -> bool {
    matches!(kind.code().as_bytes(), b"M009" | b"M010" | b"M038" | b"M039")
}

/// The format, first the stated one, in which most readings of a text lie on the wall.
fn format_of(pass: &Pass, stated: &Probe, bytes: &[u8]) -> Option<(&'static str, Format)> {
    let fits = |format: Format| {
        let layout = stated.layout.filter(|_| format == Format::Columns);
        let mut core = pass.core.clone();
        core.job.probe = Some(Probe { format, layout, ..*stated });
        let most = bytes.iter().filter(|b| matches!(b, b'\n' | b'\r')).count() + 1;
        let (mut readings, mut contacts) = (vec![Reading::default(); most], vec![Contact::BLANK; most]);
        let used = job::contacts(&core, pass.path_contour(), bytes, &mut readings, &mut contacts, |_, _| ()).ok()?;
        let touched = readings.iter().filter(|r| r.line > 0 && r.outcome == Outcome::Touched).count();
        (used >= LEAST && 2 * used > touched).then_some(())
    };
    let mut order: Vec<_> = FORMATS.to_vec();
    order.sort_by_key(|(_, format)| *format != stated.format);
    order.into_iter().find(|(_, format)| fits(*format).is_some())
}
