//! What the points of a part say of machine and material, before a correction is made from it.

use std::collections::BTreeMap;

use truepath_correction::correct::{MeasuredWall, identify_every};
use truepath_correction::summary::{Parameter, parameters, wall_law_name};
use truepath_correction::warnings::misread;
use truepath_ground::diagnostics::Failure;
use truepath_ground::length::Remark;
use truepath_ground::units::{float, mm};
use truepath_job::pass::Pass;

use super::super::correction_files::contour_name;
use super::super::readings::Readings;
use super::Options;

/// A point on the wall beside what the identified machine would have left there.
#[derive(Clone, Debug, serde::Serialize)]
pub struct Point {
    /// The contour it is on, where there are several.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub contour: Option<String>,
    /// Line of the probe file.
    pub line: u32,
    /// Place along the contour, mm.
    pub s_mm: f64,
    /// Height above the cutter's tip, mm.
    pub height_mm: f64,
    /// Measured wall error, mm: positive, material left.
    pub measured_mm: f64,
    /// The error by the identified machine, mm.
    pub predicted_mm: f64,
    /// Measured less predicted, mm.
    pub residual_mm: f64,
    /// Weight in the fit, 0…1.
    pub weight: f64,
}

/// One machine and material, from the points of all walls.
#[derive(Clone, Debug, serde::Serialize)]
pub struct Identified {
    /// Values with what was believed before, as in the summary of a correction.
    pub identified: BTreeMap<&'static str, Parameter>,
    /// Law of the wall: `mean` or `helical`.
    pub wall_law: &'static str,
    /// The points that were used, in the order of the contours.
    pub points: Vec<Point>,
    /// What is doubtful.
    pub warnings: Vec<Remark>,
}

/// Identifies machine and material from the same options as a correction, and as it does; nothing is written.
///
/// # Errors
/// As those of [`run`](super::run) before its outputs; points of a first pass are not taken.
pub fn identify(options: &Options, progress: &mut dyn FnMut(f64)) -> Result<Identified, Failure> {
    let job = options.said.read(&options.job)?;
    let readings = Readings::read(options.probe.as_deref(), options.dimensions.as_deref())?;
    let walls = options.begin.passes(Pass::every(job)?);
    let several = walls.len() > 1;
    let mut measured = match <[Pass; 1]>::try_from(walls) {
        Ok([only]) => vec![readings.of_one(only)?],
        Err(walls) => readings.of_every(walls)?,
    };
    // Of several, those that were not touched say nothing.
    measured.retain(|(_, measurement)| !several || !measurement.contacts.is_empty());
    let walls: Vec<MeasuredWall> =
        measured.iter().map(|(pass, measurement)| MeasuredWall { pass, measurement, remarks: &[] }).collect();
    let found = identify_every(&walls, progress)?;
    let (mut points, mut warnings) = (Vec::new(), Vec::new());
    for ((pass, measurement), found) in measured.iter().zip(&found) {
        let said = [pass.warnings.clone(), measurement.remarks(&measurement.source)].concat();
        warnings.extend(said.into_iter().chain(misread(pass, false, &measurement.contacts)));
        let depth = mm(pass.job.numbers.cut.axial_depth);
        let name = several.then(|| contour_name(pass));
        points.extend(measurement.contacts.iter().zip(&found.observations).map(|(contact, point)| Point {
            contour: name.clone(),
            line: contact.line,
            s_mm: mm(point.s),
            height_mm: float(point.height) * depth,
            measured_mm: mm(point.error),
            predicted_mm: mm(point.predicted),
            residual_mm: mm(point.error - point.predicted),
            weight: float(point.weight),
        }));
    }
    let mut told = std::collections::BTreeSet::new();
    warnings.retain(|warning| told.insert(warning.to_string()));
    let one = found.first().ok_or_else(|| Failure::Internal("no wall was identified".to_owned()))?;
    Ok(Identified { identified: parameters(one), wall_law: wall_law_name(one.law()), points, warnings })
}
