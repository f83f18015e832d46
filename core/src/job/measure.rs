//! A probe file → contacts on the wall → observations for the fit.

use super::{Buffer, ContourPass, JobError, ZReference};
use crate::geometry::Contour;
use crate::identify::Observation;
use crate::probe::{Contact, Contacts, Reading, Rejected, Setting, read, suspect};
use crate::units::Offset;

/// A reading farther than this from the nominal wall is not of this wall.
pub const REACH: Offset = Offset::from_um(1_000);
/// Feet nearer to each other along the contour are of one place, probed at different heights: they differ by the error
/// of the wall only.
const ONE_PLACE: Offset = Offset::from_um(5);

/// How the readings of a pass are taken and what they touch.
///
/// # Errors
/// A job without probe.
pub fn setting(pass: &ContourPass) -> Result<Setting, JobError> {
    let probe = pass.job.probe.ok_or(JobError::NoProbe)?;
    Ok(Setting {
        ball_radius: Offset::from_nm(probe.ball_diameter.nm() / 2),
        cutter_radius: pass.setup.radius,
        wall: pass.setup.wall,
        tip_z: pass.contour.z,
        alike: pass.job.part.map(|part| part.alike).unwrap_or_default(),
        axial_depth: pass.job.cut.axial_depth,
        z_is_tip: probe.z_reference == ZReference::Tip,
        reach: REACH,
    })
}

/// Reads a probe file into `readings` and its contacts into `contacts`, in the order of the contour, then of height;
/// returns how many there are. `set_aside` is given each reading that is not used and the reason.
///
/// # Errors
/// A job without probe, what is wrong with the file, a buffer too short, and a wrong unit, frame, side or ball, named,
/// when most readings are off the wall or none can be used.
pub fn contacts(
    pass: &ContourPass,
    contour: Contour,
    file: &[u8],
    readings: &mut [Reading],
    contacts: &mut [Contact],
    set_aside: impl FnMut(&Reading, Rejected),
) -> Result<usize, JobError> {
    let count = self::readings(pass, file, readings)?;
    let readings = readings.get(..count).unwrap_or_default();
    let on_wall = on_wall(pass, contour)?;
    if let Some(suspicion) = suspect(&on_wall, readings) {
        let off = readings
            .iter()
            .find(|r| matches!(on_wall.contact(r), Err(Rejected::OffTheWall { .. } | Rejected::Normal { .. })));
        return Err(JobError::OffTheWall { suspicion, line: off.map_or(1, |r| r.line) });
    }
    contacts_among(&on_wall, readings, contacts, set_aside)
}

/// Reads a probe file into `readings`, in the order of the file; returns how many there are.
///
/// # Errors
/// A job without probe, what is wrong with the file, a buffer too short.
pub fn readings(pass: &ContourPass, file: &[u8], readings: &mut [Reading]) -> Result<usize, JobError> {
    let probe = pass.job.probe.ok_or(JobError::NoProbe)?;
    read(file, &pass.probe_given(&probe), readings).map_err(JobError::Measurement)
}

/// What turns readings into contacts on the wall of a pass.
///
/// # Errors
/// A job without probe.
pub fn on_wall<'a>(pass: &ContourPass, contour: Contour<'a>) -> Result<Contacts<'a>, JobError> {
    Ok(Contacts::new(contour, setting(pass)?))
}

/// The contacts of readings that are of one wall, as [`contacts`] gives them; the readings are in the order of the file.
///
/// # Errors
/// A buffer too short, and why the first reading cannot be used when none can.
pub fn contacts_among(
    on_wall: &Contacts,
    readings: &[Reading],
    contacts: &mut [Contact],
    mut set_aside: impl FnMut(&Reading, Rejected),
) -> Result<usize, JobError> {
    let lent = contacts.len();
    let mut used = 0usize;
    let mut first_rejected = None;
    for reading in readings {
        match on_wall.contact(reading) {
            Ok(contact) => {
                *contacts.get_mut(used).ok_or(JobError::full(Buffer::Points, readings.len(), lent))? = contact;
                used = used.saturating_add(1);
            }
            Err(reason) => {
                first_rejected =
                    first_rejected.or(Some(JobError::NoContact { line: reading.line, reason, tip: on_wall.tip_z() }));
                set_aside(reading, reason);
            }
        }
    }
    if let (0, Some(error)) = (used, first_rejected) {
        return Err(error);
    }
    let contacts = contacts.get_mut(..used).unwrap_or_default();
    contacts.sort_unstable_by_key(|c| (c.s, c.height, c.error, c.line));
    Ok(once(contacts, |repeat, of| {
        if let Some(reading) = readings.binary_search_by_key(&repeat, |r| r.line).ok().and_then(|at| readings.get(at)) {
            set_aside(reading, Rejected::Repeat { of });
        }
    }))
}

/// Moves contacts that repeat one before to the end; returns how many are left. `repeated` is given the lines of both.
fn once(contacts: &mut [Contact], mut repeated: impl FnMut(u32, u32)) -> usize {
    let mut kept = 0usize;
    for at in 0..contacts.len() {
        let before = kept.checked_sub(1).and_then(|k| contacts.get(k)).copied();
        let Some(contact) = contacts.get(at).copied() else { break };
        match before.filter(|b| Contact { line: contact.line, ..*b } == contact) {
            Some(before) => repeated(contact.line, before.line),
            None => {
                contacts.swap(kept, at);
                kept = kept.saturating_add(1);
            }
        }
    }
    kept
}

/// The contacts as observations for the fit. Those of one place are taken at their common foot, where the elastic loop
/// is solved once.
///
/// # Errors
/// When `observations` is shorter than `contacts`.
pub fn observations<'o>(
    contacts: &[Contact],
    noise: Offset,
    observations: &'o mut [Observation],
) -> Result<&'o mut [Observation], JobError> {
    let lent = observations.len();
    let used = observations.get_mut(..contacts.len());
    let used = used.ok_or(JobError::full(Buffer::Points, contacts.len(), lent))?;
    let mut place: Option<Offset> = None;
    for (slot, c) in used.iter_mut().zip(contacts) {
        let s = place.filter(|p| same_place(*p, c.s)).unwrap_or(c.s);
        place = Some(s);
        *slot = Observation::new(s, c.height, c.error, noise, c.normal);
    }
    Ok(used)
}

/// Whether two feet on the contour are of one place, probed at different heights.
pub fn same_place(a: Offset, b: Offset) -> bool {
    (b - a).abs() < ONE_PLACE
}
