//! One probe file of several walls: each reading belongs to the wall it lies on.
//!
//! | a reading | belongs to |
//! |---|---|
//! | that is a contact of some walls | the one whose nominal place is nearest |
//! | of none | the wall nearest to it, where the reason why it is not used is told |
//! | that touched nothing | the wall of the reading before it |
//!
//! What the unit, the frame or the ball of a file is, is judged by all of its readings together: a wall with two touches,
//! one of them wild, is no reason to doubt the file.

use truepath_core::checksum::crc32;
use truepath_core::job;
use truepath_core::probe::{Contact, Contacts, Outcome, Reading, Rejected, Suspicion, suspect};
use truepath_core::units::Offset;
use truepath_ground::diagnostics::{Failure, Source};

use crate::levels;
use crate::measurement::{Aside, Measurement, numbered};
use crate::pass::Pass;
use crate::probe_format::{LARGEST_FILE, Settled, settled};

/// A depth of one of the walls.
struct Depth<'a> {
    wall: usize,
    pass: &'a Pass,
    on_wall: Contacts<'a>,
}

impl Measurement {
    /// Reads a probe file of several walls of a program: every wall with its readings, at the depth on which most of them
    /// are. A wall that was not touched has no contacts.
    ///
    /// # Errors
    /// What is wrong with the file, and a wrong unit, frame or ball, named, when most readings are off every wall.
    pub fn of_every(walls: Vec<Pass>, file: &Source) -> Result<Vec<(Pass, Self)>, Failure> {
        let first = match <[Pass; 1]>::try_from(walls) {
            Ok([only]) => return Ok(vec![Self::of_any_depth(only, file)?]),
            Err(walls) => walls,
        };
        let Some(any) = first.first() else { return Ok(Vec::new()) };
        let Settled { probe, read_as, text } = settled(&any.job, file)?;
        let (given, file) = (file, &text);
        let mut core = any.core.clone();
        core.job.probe = Some(probe);
        let lines = file.bytes().iter().filter(|b| matches!(b, b'\n' | b'\r')).count() + 1;
        let mut readings = vec![Reading::default(); lines.min(LARGEST_FILE)];
        let count = job::readings(&core, file.bytes(), &mut readings).map_err(|e| any.refused_of(file, &e))?;
        readings.truncate(count);

        let depths = first.iter().map(levels::depths).collect::<Result<Vec<_>, _>>()?;
        let mut places = Vec::new();
        for (wall, (pass, depths)) in first.iter().zip(&depths).enumerate() {
            // The depth that the user names, or all of them.
            let asked = if pass.job.which.pass.is_some() { std::slice::from_ref(pass) } else { depths };
            for pass in asked {
                let on_wall =
                    job::on_wall(&pass.core, pass.path_contour()).map_err(|error| pass.refused_of(file, &error))?;
                places.push(Depth { wall, pass, on_wall });
            }
        }
        let shares = shared(&places, &readings, first.len());
        refuse_strange(&places, &readings, &shares, file)?;
        let crc = crc32(given.bytes());
        let mut all = Vec::new();
        for (wall, (own, depths)) in shares.iter().zip(&depths).enumerate() {
            let count = |depth: &&Depth| own.iter().filter(|r| depth.on_wall.contact(r).is_ok()).count();
            let own_depths = || places.iter().filter(|depth| depth.wall == wall);
            let Some(most) = own_depths().map(|depth| count(&depth)).max() else { continue };
            let Some(depth) = own_depths().find(|depth| count(depth) == most) else { continue };
            let pass = depth.pass;
            let core = levels::with_alike(pass, depths);
            let on_wall = job::on_wall(&core, pass.path_contour()).map_err(|error| pass.refused_of(file, &error))?;
            let mut contacts = vec![Contact::BLANK; own.len()];
            let mut rejected = Vec::new();
            let aside = |reading: &Reading, reason| {
                rejected.push(Aside { line: reading.line, position: reading.position, reason });
            };
            // None that can be used: then nothing is known of this wall.
            let used = job::contacts_among(&on_wall, own, &mut contacts, aside).unwrap_or(0);
            contacts.truncate(used);
            rejected.sort_by_key(|aside| aside.line);
            let measurement = Self {
                contacts,
                rejected,
                readings: own.clone(),
                numbered: numbered(&readings),
                noise: probe.noise,
                unit: pass.unit(),
                taken_as_is: pass.job.force_data,
                source: file.clone(),
                crc,
                file: file.name().to_owned(),
                // Said once, of the first wall.
                read_as: read_as.clone().filter(|_| wall == 0),
                dimensions: None,
            };
            all.push((pass.clone(), measurement));
        }
        if all.iter().all(|(_, measurement)| measurement.contacts.is_empty()) {
            // Why, the first wall says.
            Self::of_any_depth(any.clone(), given)?;
        }
        Ok(all)
    }
}

impl Measurement {
    /// Reads a probe file of one wall that may be of the other walls of its program as well: their readings are no sign that
    /// something is wrong with the file.
    ///
    /// # Errors
    /// As [`Self::of_any_depth`].
    pub fn of_one(pass: Pass, file: &Source) -> Result<(Pass, Self), Failure> {
        let others = pass.siblings();
        if others.is_empty() {
            return Self::of_any_depth(pass, file);
        }
        let own = pass.clone();
        let walls = std::iter::once(pass).chain(others).collect();
        let mut all = Self::of_every(walls, file)?;
        if all.first().is_none_or(|(_, measurement)| measurement.contacts.is_empty()) {
            return Self::of_any_depth(own, file);
        }
        Ok(all.swap_remove(0))
    }
}

/// How far a reading is from a wall, and whether it is a contact of it. A reading beside the wall above or below the depth
/// is of that wall rather than one that is off it.
fn distance(depth: &Depth, reading: &Reading) -> (bool, Offset) {
    match depth.on_wall.contact(reading) {
        Ok(contact) => (false, contact.error.abs()),
        Err(Rejected::OffTheWall { distance }) => (true, distance.abs()),
        Err(_) => (true, Offset::ZERO),
    }
}

/// The readings of every wall.
fn shared(places: &[Depth], readings: &[Reading], walls: usize) -> Vec<Vec<Reading>> {
    let mut shares = vec![Vec::new(); walls];
    let mut last = 0;
    for reading in readings {
        if reading.outcome == Outcome::Touched {
            let nearest = places.iter().map(|depth| (distance(depth, reading), depth.wall)).min();
            last = nearest.map_or(last, |(_, wall)| wall);
        }
        if let Some(share) = shares.get_mut(last) {
            share.push(*reading);
        }
    }
    shares
}

/// Refuses a file most of whose touches are off every wall, or have normals that point into the wall.
fn refuse_strange(
    places: &[Depth],
    readings: &[Reading],
    shares: &[Vec<Reading>],
    file: &Source,
) -> Result<(), Failure> {
    let touched = || readings.iter().filter(|r| r.outcome == Outcome::Touched);
    let off = |reading: &Reading| {
        let off_it = |d: &Depth| matches!(d.on_wall.contact(reading), Err(Rejected::OffTheWall { .. }));
        places.iter().all(off_it)
    };
    let most = shares.iter().enumerate().max_by_key(|(_, share)| share.len()).map_or(0, |(wall, _)| wall);
    let astray = touched().filter(|r| off(r)).count();
    for depth in places.iter() {
        let (judged, line) = if astray > 0 && 2 * astray >= touched().count() {
            // What explains it is looked for where most of them are.
            if depth.wall != most {
                continue;
            }
            (suspect(&depth.on_wall, readings).or(Some(Suspicion::Frame)), readings.iter().find(|r| off(r)))
        } else {
            let own = shares.get(depth.wall).map_or(&[][..], Vec::as_slice);
            let turned = suspect(&depth.on_wall, own).filter(|s| *s == Suspicion::Normals);
            (turned, own.first())
        };
        if let Some(suspicion) = judged {
            let error = job::JobError::OffTheWall { suspicion, line: line.map_or(1, |r| r.line) };
            return Err(depth.pass.refused_of(file, &error));
        }
    }
    Ok(())
}
