//! A bore on a soft, skew machine, touched at three places of one side: the points say little about the other side, and the
//! whole correction would make the part much worse.

use std::path::Path;

use truepath_correction::correct::{CorrectedPass, correct_pass};
use truepath_ground::diagnostics::{Failure, Form, Source};
use truepath_job::job::{JobFile, Route};
use truepath_job::measurement::Measurement;
use truepath_job::pass::Pass;
use truepath_plant::Machine;
use truepath_trial::virtual_mill;

const JOB: &str = include_str!("../data/shrinkage/job.toml");
const PLANT: &str = include_str!("../data/shrinkage/plant.toml");
const PROGRAM: &str = include_str!("../data/shrinkage/program.nc");
const PROBE: &str = include_str!("../data/shrinkage/probe.txt");
/// Left out at either end of the contour, mm.
const TRIM: f64 = 4.0;

fn shown<T>(result: Result<T, Failure>) -> T {
    result.unwrap_or_else(|e| panic!("{}", e.render(Form::Plain)))
}

fn pass() -> Pass {
    let job = JobFile::parse(Source::new("job.toml", JOB.as_bytes().to_vec()), Path::new("")).unwrap();
    shown(Pass::new(job, Source::new("program.nc", PROGRAM.as_bytes().to_vec())))
}

fn corrected(pass: &Pass, probe: &str) -> CorrectedPass {
    let measurement = shown(Measurement::read(pass, &Source::new("probe.txt", probe.as_bytes().to_vec())));
    shown(correct_pass(pass, &measurement, &[], &[Route::Program], &mut |_| ()))
}

/// The largest mean error of the part that is milled with a program, mm.
fn largest(pass: &Pass, program: Option<&[u8]>) -> f64 {
    let machine: Machine = toml::from_str(PLANT).unwrap();
    let commanded = program.map(|text| shown(virtual_mill::commanded(pass, text)));
    let part = shown(virtual_mill::mill(pass, &machine, commanded.as_deref()));
    let judged = part.path.s_mm.iter().map(|s| *s > TRIM && *s < part.path.length_mm - TRIM);
    let errors = part.mean_errors().into_iter().zip(judged).filter(|(e, judged)| *judged && e.is_finite());
    errors.fold(0.0, |most: f64, (e, _)| most.max(e.abs()))
}

#[test]
fn a_bore_touched_on_one_side_is_damped_and_hardly_worse_than_before() {
    let pass = pass();
    let few = corrected(&pass, PROBE);
    let damped = few.summary.damped.expect("the other side is not known");
    assert!(damped.least_share < 0.6 && damped.from_s_mm < damped.to_s_mm, "{damped:?}");
    let said = few.summary.warnings.iter().filter(|w| w.contains("of the correction is applied")).count();
    assert_eq!(said, 1, "{:?}", few.summary.warnings);
    let (before, after) = (largest(&pass, None), largest(&pass, few.program.as_deref()));
    assert!(after < 1.05 * before, "{before} {after}");
}

#[test]
fn the_same_bore_touched_all_around_is_corrected_by_the_whole() {
    let pass = pass();
    let machine: Machine = toml::from_str(PLANT).unwrap();
    let uncorrected = shown(virtual_mill::mill(&pass, &machine, None));
    let length = uncorrected.path.length_mm;
    let places: Vec<f64> = (1..8).map(|k| f64::from(k) * length / 8.0).collect();
    let probe = shown(virtual_mill::probe(&pass, &uncorrected, &places, &[0.1, 0.5, 0.9], 4.0));
    let many = corrected(&pass, &probe);
    assert_eq!(many.summary.damped, None);
    let (before, after) = (largest(&pass, None), largest(&pass, many.program.as_deref()));
    assert!(after * 4.0 < before, "{before} {after}");
}
