//! Dimensions as points of a measurement, beside the touches of a probe or in their place.

use truepath_core::checksum::crc32;
use truepath_core::units::Offset;
use truepath_ground::diagnostics::{Failure, Source};
use truepath_ground::length::Unit;
use truepath_ground::units::{mm, nm};

use crate::dimension::{Axis, Dimension, Dimensions, Level, Placed, Walls, kept, placed, read};
use crate::levels;
use crate::measurement::Measurement;
use crate::pass::Pass;

impl Measurement {
    /// What was measured of the walls of a program: the touches of a probe file, dimensions, or both. Every wall comes
    /// with its readings, at the depth on which most of them are; one of which nothing was measured has no contacts.
    ///
    /// # Errors
    /// What is wrong with a file: as [`Self::of_every`], and a dimension that cannot be one of these walls.
    pub fn of_files(
        walls: Vec<Pass>,
        probe: Option<&Source>,
        dimensions: Option<&Source>,
    ) -> Result<Vec<(Pass, Self)>, Failure> {
        let Some(file) = dimensions else {
            let Some(probe) = probe else { return Err(Failure::Internal("nothing measured".to_owned())) };
            return Self::of_every(walls, probe);
        };
        let dimensions = read(file)?;
        let mut measured = match probe {
            Some(probe) => Self::of_every(walls, probe)?,
            None => {
                let at_depth = |pass: Pass| {
                    let unit = pass.unit();
                    Ok((at_depth(pass, &dimensions)?, Self::of_nothing(file, unit)))
                };
                walls.into_iter().map(at_depth).collect::<Result<Vec<_>, Failure>>()?
            }
        };
        let text = measured.first().filter(|_| probe.is_some()).map(|(_, measurement)| measurement.source.bytes());
        let lines = text.map_or(0, |text| text.split(|b| *b == b'\n').count());
        let lines = u32::try_from(lines).unwrap_or(u32::MAX);
        let mut shares: Vec<Vec<Placed>> = vec![Vec::new(); measured.len()];
        {
            let walls = measured.iter().map(|(pass, _)| Walls::of(pass)).collect::<Result<Vec<_>, _>>()?;
            let unit = measured.first().map_or_else(Unit::default, |(pass, _)| pass.unit());
            for (number, dimension) in (1..).zip(&dimensions) {
                for (wall, placed) in placed((file, unit), &walls, dimension, lines, number)? {
                    if let Some(share) = shares.get_mut(wall) {
                        share.push(placed);
                    }
                }
            }
        }
        // Of what is kept of them: what is made again from that is the same.
        let crc = crc32(&kept(file)?);
        for ((pass, measurement), mut own) in measured.iter_mut().zip(shares) {
            share_faces(&mut own);
            measurement.taken_as_is = pass.job.force_data;
            measurement.take(Dimensions { source: file.clone(), placed: own }, crc);
        }
        Ok(measured)
    }

    /// The same of a program with one wall, or of the first of several.
    ///
    /// # Errors
    /// As [`Self::of_files`].
    pub fn of_one_with(
        pass: Pass,
        probe: Option<&Source>,
        dimensions: Option<&Source>,
    ) -> Result<(Pass, Self), Failure> {
        if let (Some(probe), None) = (probe, dimensions) {
            return Self::of_one(pass, probe);
        }
        let mut all = Self::of_files(vec![pass], probe, dimensions)?;
        all.pop().ok_or_else(|| Failure::Internal("a wall without its readings".to_owned()))
    }

    /// No reading yet.
    fn of_nothing(file: &Source, unit: Unit) -> Self {
        Self {
            contacts: Vec::new(),
            rejected: Vec::new(),
            readings: Vec::new(),
            numbered: Vec::new(),
            noise: Offset::ZERO,
            unit,
            taken_as_is: false,
            source: file.clone(),
            crc: 0,
            file: file.name().to_owned(),
            read_as: None,
            dimensions: None,
        }
    }

    /// Takes dimensions beside the readings there are.
    fn take(&mut self, dimensions: Dimensions, crc: u32) {
        let placed = &dimensions.placed;
        self.crc ^= crc;
        if placed.is_empty() {
            return;
        }
        if self.contacts.is_empty() {
            // As large as a reading of its walls is on the whole.
            let squares: f64 = placed.iter().map(|placed| mm(placed.noise).powi(2)).sum();
            self.noise = nm((squares / placed.len() as f64).sqrt());
        }
        self.contacts.extend(placed.iter().map(|placed| placed.contact));
        self.contacts.sort_by_key(|c| (c.s, c.height, c.error, c.line));
        self.readings.extend(placed.iter().map(|placed| placed.reading));
        self.dimensions = Some(dimensions);
    }
}

/// The depth of a feature on which most of the dimensions are, where the user names none.
fn at_depth(pass: Pass, dimensions: &[Dimension]) -> Result<Pass, Failure> {
    if pass.job.which.pass.is_some() {
        return Ok(pass);
    }
    let depths = levels::depths(&pass)?;
    let count = |depth: &Pass| {
        let (tip, engaged) = (depth.core.contour.z, depth.core.job.cut.axial_depth);
        let on = |dimension: &&Dimension| match dimension.level {
            Level::Z(z) => z >= tip && z - tip <= engaged,
            Level::AboveTip(above) => above <= engaged,
        };
        dimensions.iter().filter(on).count()
    };
    // Of equals the first.
    let best = depths.into_iter().rev().max_by_key(count);
    Ok(best.unwrap_or(pass))
}

/// What a face is off is the same in every dimension from it: each of them carries as much of it that together they say no
/// more than the face allows.
fn share_faces(placed: &mut [Placed]) {
    let key = |placed: &Placed| {
        let of = |axis: Axis| axis == placed.dimension.along;
        placed.dimension.face.map(|face| (of(Axis::X), face.to_bits()))
    };
    let keys: Vec<_> = placed.iter().map(key).collect();
    for (placed, own) in placed.iter_mut().zip(&keys) {
        let Some(own) = own else { continue };
        let alike = keys.iter().flatten().filter(|other| *other == own).count() as f64;
        let (reading, face) = (0.5 * mm(placed.dimension.uncertainty), 0.5 * mm(placed.dimension.face_uncertainty));
        placed.noise = nm(reading.hypot(face * alike.sqrt()));
    }
}
