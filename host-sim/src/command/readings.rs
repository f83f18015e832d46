//! What was measured of a part: a probe file, a file of dimensions, or both.

use std::path::Path as FilePath;

use truepath_correction::correction::Identification;
use truepath_correction::verification::{unseparated, unseparated_contours};
use truepath_ground::diagnostics::{Failure, InputError, Source};
use truepath_ground::length::Remark;
use truepath_ground::output::OutputFolder;
use truepath_job::dimension::kept;
use truepath_job::measurement::Measurement;
use truepath_job::pass::{Pass, PathBuffer};

/// The files that were given.
#[derive(Clone, Debug)]
pub(super) struct Readings {
    probe: Option<Source>,
    dimensions: Option<Source>,
}

impl Readings {
    /// Reads them.
    pub(super) fn read(probe: Option<&FilePath>, dimensions: Option<&FilePath>) -> Result<Self, InputError> {
        let read = |path: Option<&FilePath>| path.map(Source::read).transpose();
        Ok(Self { probe: read(probe)?, dimensions: read(dimensions)? })
    }

    /// What they say of a program with one wall, or of one of several.
    pub(super) fn of_one(&self, pass: Pass) -> Result<(Pass, Measurement), Failure> {
        Measurement::of_one_with(pass, self.probe.as_ref(), self.dimensions.as_ref())
    }

    /// What they say of the part that was cut with a correction, at the depth of a pass.
    pub(super) fn of_corrected(&self, pass: &Pass) -> Result<Measurement, Failure> {
        match (&self.probe, &self.dimensions) {
            (Some(probe), None) => Measurement::read(pass, probe),
            _ => Ok(self.of_one(pass.clone())?.1),
        }
    }

    /// What they say of a first pass, which is touched with a probe.
    pub(super) fn of_any_depth(&self, first: Pass) -> Result<(Pass, Measurement), Failure> {
        match &self.probe {
            Some(probe) => Measurement::of_any_depth(first, probe),
            None => self.of_one(first),
        }
    }

    /// What they say of every wall of a program.
    pub(super) fn of_every(&self, walls: Vec<Pass>) -> Result<Vec<(Pass, Measurement)>, Failure> {
        Measurement::of_files(walls, self.probe.as_ref(), self.dimensions.as_ref())
    }

    /// The file that an error of all readings names.
    pub(super) fn path(&self) -> &FilePath {
        self.probe.as_ref().or(self.dimensions.as_ref()).map_or(FilePath::new(""), |file| FilePath::new(file.name()))
    }

    /// Writes them to the outputs as they are; dimensions whose values another file has, with these values.
    pub(super) fn keep(&self, folder: &OutputFolder) -> Result<(), InputError> {
        if let Some(probe) = &self.probe {
            folder.write(PROBE, probe.bytes())?;
        }
        if let Some(dimensions) = &self.dimensions {
            folder.write(DIMENSIONS, &kept(dimensions)?)?;
        }
        Ok(())
    }
}

/// What widths leave open of the walls that they were measured between.
pub(super) fn apart(
    pass: &Pass,
    measurement: &Measurement,
    identified: &Identification,
) -> Result<Vec<Remark>, Failure> {
    if measurement.dimensions.is_none() {
        return Ok(Vec::new());
    }
    let mut buffer = PathBuffer::default();
    let path = pass.sample(&mut buffer)?.with_law(identified.law());
    Ok(unseparated(&path, measurement, identified, pass.unit()))
}

/// What widths between two contours leave open of their walls; every wall with what was identified from all.
pub(super) fn contours_apart(
    walls: &[(&Pass, &Measurement)],
    identified: &Identification,
) -> Result<Vec<Remark>, Failure> {
    let mut buffers: Vec<PathBuffer> = walls.iter().map(|_| PathBuffer::default()).collect();
    let mut measured = Vec::new();
    for ((pass, measurement), buffer) in walls.iter().zip(&mut buffers) {
        measured.push((pass.sample(buffer)?.with_law(identified.law()), *measurement));
    }
    let unit = walls.first().map(|(pass, _)| pass.unit()).unwrap_or_default();
    Ok(unseparated_contours(&measured, identified, unit))
}

/// The probe file among the outputs.
pub(super) const PROBE: &str = "probe-raw.txt";
/// The file of dimensions among the outputs.
pub(super) const DIMENSIONS: &str = "dimensions-raw.toml";
