//! The second of two passes: machine and material are identified from the first, and its correction is made over the
//! surface the first left (see `truepath split`).
//!
//! That surface is the identified model's wall of the first pass, plus what the probe found beside the model: between
//! the probed places the difference is interpolated, beyond them it is kept. The correction thus knows the stock
//! everywhere, not only where it was touched.

use truepath_core::correct::{Band, Profile, profile};
use truepath_core::cut::{Path, Sample, State};
use truepath_core::gcode::program_crc;
use truepath_core::geometry::Vector;
use truepath_core::job::{self, LawName};
use truepath_ground::diagnostics::{Failure, InputError};
use truepath_ground::length::Remark;
use truepath_ground::units::{float, mm};
use truepath_job::job::Route;
use truepath_job::measurement::Measurement;
use truepath_job::pass::{Pass, PathBuffer};
use truepath_job::surface::Surface;
use truepath_program::first_pass_of;

use crate::codes::K003;
use crate::correct::{CorrectedPass, IdentifiedWall, correct_identified, only};
use crate::correction::{DesignRequest, Identification, identify};
use crate::remarks::{MeasuredPart, Remarks};

/// Corrects the second pass from a measurement of the first, in memory; gives the surface it is made over as well.
///
/// # Errors
/// Jobs that are not of one part, what is wrong with the measurement, and a correction beyond the clamp.
pub fn correct_second_pass(
    second: &Pass,
    first: &Pass,
    measurement: &Measurement,
    remarks: &[Remark],
    routes: &[Route],
    progress: &mut dyn FnMut(f64),
) -> Result<(CorrectedPass, Surface), Failure> {
    agree(second, first)?;
    let mut buffer = PathBuffer::default();
    let sampled = first.sample(&mut buffer)?;
    let known = identify(first, &sampled, measurement, |share| progress(0.2 * share))?;
    let surface = left_by(&sampled, &known);
    let second = second.clone().over(surface.clone())?;
    let mut buffer = PathBuffer::default();
    let sampled = second.sample(&mut buffer)?;
    let remarks = Remarks::of(measurement, remarks, MeasuredPart::FirstPass);
    let path = sampled.with_law(known.law());
    let table = known.table();
    let law = job::law(&second.core, &known.machine(&path, &table), &[]);
    let request = DesignRequest::of(law);
    let wall = IdentifiedWall { pass: &second, path: &sampled, identified: known, request, remarks };
    let done = only(correct_identified(vec![wall], routes, progress)?)?;
    Ok((done, surface))
}

/// The wall of a pass as it stands: the identified model's, with the measured difference.
fn left_by(sampled: &Path, known: &Identification) -> Surface {
    let path = sampled.with_law(known.law());
    let table = known.table();
    let machine = known.machine(&path, &table);
    let mut states = vec![State::REST; path.working().len()];
    machine.run(path.working().start, &mut states, |_| Vector::ZERO);
    let mut displacements = vec![Vector::ZERO; states.len()];
    let mut walls = vec![Profile::default(); path.count()];
    profile(&machine, &states, Band::WHOLE, &mut displacements, &mut walls);
    let samples = &path.samples()[path.first()..path.first() + path.count()];
    let differences = differences(known);
    let wall = |(sample, wall): (&Sample, &Profile)| {
        let error = mm(wall.mean) + between(&differences, mm(sample.s));
        let reach = mm(path.setup().radius) - error;
        let [x, y] = [sample.point.x, sample.point.y].map(|p| p.nm() as f64 / 1e6);
        [x + reach * float(sample.normal.x), y + reach * float(sample.normal.y)]
    };
    let points: Vec<_> = samples.iter().zip(&walls).filter(|(_, w)| w.on_wall).map(wall).collect();
    Surface::new(points).unwrap_or_else(|| unreachable!("a contour has two samples at least"))
}

/// Measured less predicted wall error at every probed place, mean over its heights, in the order of the contour, mm.
fn differences(known: &Identification) -> Vec<(f64, f64)> {
    let mut places: Vec<(f64, f64, f64)> = Vec::new();
    for o in known.observations.iter().filter(|o| float(o.weight) > 0.3) {
        let (s, d) = (mm(o.s), mm(o.error - o.predicted));
        match places.last_mut().filter(|(at, _, _)| (*at - s).abs() < 1e-3) {
            Some((_, sum, n)) => (*sum, *n) = (*sum + d, *n + 1.0),
            None => places.push((s, d, 1.0)),
        }
    }
    places.into_iter().map(|(s, sum, n)| (s, sum / n)).collect()
}

/// Linear between the places, constant beyond them, zero without any.
fn between(places: &[(f64, f64)], s: f64) -> f64 {
    let after = places.partition_point(|(at, _)| *at < s);
    match (after.checked_sub(1).and_then(|k| places.get(k)), places.get(after)) {
        (Some((a, from)), Some((b, to))) => from + (to - from) * (s - a) / (b - a),
        (Some((_, d)), None) | (None, Some((_, d))) => *d,
        (None, None) => 0.0,
    }
}

/// Refuses two jobs that are not two passes of one part.
fn agree(second: &Pass, first: &Pass) -> Result<(), Failure> {
    let (a, b) = (&second.job.numbers, &first.job.numbers);
    let differs = [
        ("tool", a.tool != b.tool),
        ("cut", a.cut != b.cut),
        ("force", a.force != b.force),
        ("machine", a.machine != b.machine),
        ("wall", second.core.setup.wall != first.core.setup.wall),
    ];
    if let Some((table, _)) = differs.into_iter().find(|(_, differs)| *differs) {
        let found = format!("[{table}] is not the same in the jobs of the two passes");
        let help = "use the first-pass.toml that truepath split wrote for this job";
        let error = InputError::new(K003, found, "two passes of one part", help);
        return Err(error.at(first.job.source(), first.job.span(table)).into());
    }
    let original = program_crc(second.program.bytes());
    if let Some((named, place)) = first_pass_of(first.program.bytes()).filter(|(named, _)| *named != original) {
        let found = format!("this is the first pass of a program with CRC-32 {named:08X}");
        let expected = format!("that of {}, {original:08X}", second.program.name());
        let help =
            "give the first-pass.toml that truepath split wrote for this job; split again if the program was changed";
        return Err(InputError::new(K003, found, expected, help).at(&first.program, place).into());
    }
    if a.correct.law == LawName::Paper {
        let help = "set law = \"model\" or \"mirror\"";
        let error = InputError::new(
            K003,
            "correct.law is \"paper\" for a second pass",
            "a law that knows the first pass from the second",
            help,
        );
        return Err(error.at(second.job.source(), second.job.span("correct.law")).into());
    }
    Ok(())
}
