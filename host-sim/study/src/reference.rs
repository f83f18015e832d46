//! The reference goals: the papers' corner on the papers' machine, a noisy probe, a job that is wrong in a stated way.
//!
//! Two touches at mid-height, one on each straight wall, with 2 µm of noise; the same first part is touched again with
//! other noise for every seed. What two straight walls cannot see (Kt and Kr wrong in opposite senses) must stay small, and
//! go when a third touch in the corner sees it.

use std::path::Path as FilePath;

use serde::{Deserialize, Serialize};
use truepath_correction::correct::correct_pass;
use truepath_ground::diagnostics::{Failure, Source};
use truepath_job::job::{JobFile, Route};
use truepath_job::measurement::Measurement;
use truepath_job::pass::Pass;
use truepath_plant::{Machine, Milled};
use truepath_trial::virtual_mill;

use super::parallel;
use super::statistics::quantile;

const PROGRAM: &str = include_str!("../../demo/corner/program.nc");
const PLANT: &str = include_str!("../../demo/corner/plant.toml");

/// First of the noise seeds.
const FIRST_SEED: u64 = 50_000;

/// A way in which the job is wrong, and where the part is touched.
#[derive(Clone, Copy, Debug)]
pub struct Setting {
    /// What is wrong.
    pub title: &'static str,
    /// Kt, Kr of the job as shares of the true ones.
    pub coefficients: [f64; 2],
    /// Stiffness of the job in x and y as shares of the true ones.
    pub stiffness: [f64; 2],
    /// Places, mm along the contour.
    pub places_mm: &'static [f64],
    /// Goals: median and ninth decile, mm, where there is one.
    pub goal_mm: [Option<f64>; 2],
}

/// The goals.
pub const SETTINGS: &[Setting] = &[
    Setting {
        title: "stiffness wrong by 30 %, two straight walls",
        coefficients: [1.0, 1.0],
        stiffness: [1.3, 0.7],
        places_mm: &[30.0, 75.0],
        goal_mm: [Some(0.010), Some(0.018)],
    },
    Setting {
        title: "Kt 20 % high and Kr 20 % low as well, two straight walls",
        coefficients: [1.2, 0.8],
        stiffness: [1.3, 0.7],
        places_mm: &[30.0, 75.0],
        goal_mm: [Some(0.030), None],
    },
    Setting {
        title: "the same with one more touch in the corner",
        coefficients: [1.2, 0.8],
        stiffness: [1.3, 0.7],
        places_mm: &[30.0, 49.0, 75.0],
        goal_mm: [Some(0.010), None],
    },
];

/// How one setting came out.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Reached {
    /// What is wrong in the job.
    pub title: String,
    /// Places, mm along the contour.
    pub places_mm: Vec<f64>,
    /// Noise seeds carried through.
    pub seeds: usize,
    /// Seeds refused.
    pub failures: usize,
    /// Largest wall error without correction, mm.
    pub before_mm: f64,
    /// Median of the largest wall error after, mm.
    pub median_mm: Option<f64>,
    /// Its ninth decile.
    pub p90_mm: Option<f64>,
    /// The worst.
    pub worst_mm: Option<f64>,
    /// Goal of the median.
    pub goal_median_mm: Option<f64>,
    /// Goal of the ninth decile.
    pub goal_p90_mm: Option<f64>,
}

/// Carries all settings through `seeds` noise seeds on `threads` threads; `progress` is told (finished, of).
///
/// # Errors
/// A corner that cannot be milled.
pub fn reference(seeds: u64, threads: usize, progress: &mut dyn FnMut(u64, u64)) -> Result<Vec<Reached>, Failure> {
    let machine: Machine = toml::from_str(PLANT).map_err(|e| Failure::Internal(format!("corner plant: {e}")))?;
    let all = seeds * SETTINGS.len() as u64;
    let mut finished = 0;
    let mut reached = Vec::new();
    for setting in SETTINGS {
        let pass = pass(setting, &machine)?;
        let first = virtual_mill::mill(&pass, &machine, None)?;
        let numbers: Vec<u64> = (FIRST_SEED..FIRST_SEED + seeds).collect();
        let mut after = Vec::new();
        let one = |seed: &u64| left(&pass, &first, setting, *seed);
        parallel::for_each(&numbers, threads, one, |result| -> Result<(), Failure> {
            finished += 1;
            progress(finished, all);
            after.extend(result.ok());
            Ok(())
        })?;
        reached.push(Reached {
            title: setting.title.to_owned(),
            places_mm: setting.places_mm.to_vec(),
            seeds: after.len(),
            failures: numbers.len() - after.len(),
            before_mm: first.score().max_error_mm,
            median_mm: quantile(&after, 0.5),
            p90_mm: quantile(&after, 0.9),
            worst_mm: quantile(&after, 1.0),
            goal_median_mm: setting.goal_mm[0],
            goal_p90_mm: setting.goal_mm[1],
        });
    }
    Ok(reached)
}

/// The pass with the job of a setting.
fn pass(setting: &Setting, machine: &Machine) -> Result<Pass, Failure> {
    let share = |value: f64, share: f64| (value * share * 100.0).round() / 100.0;
    let c = &machine.compliance_mm_per_n;
    let job = format!(
        "version = 1\nprogram = \"program.nc\"\nwall = \"right\"\n[stock]\nallowance_mm = 3.0\n[tool]\ndiameter_mm = 20.0\nteeth = 6\n\
         helix_deg = 30.0\n[cut]\naxial_depth_mm = 10.0\nfeed_mm_per_min = 400.0\n[force]\nktc_n_per_mm2 = {}\nkrc_n_per_mm2 = {}\nkte_n_per_mm = 0\nkre_n_per_mm = 0\nmodel = \"mean\"\n\
         [machine]\nstiffness_x_n_per_mm = {}\nstiffness_y_n_per_mm = {}\n[probe]\nball_diameter_mm = {BALL_MM}\n\
         format = \"linuxcnc\"\nz_reference = \"centre\"\n[correct]\nclamp_mm = 1.0\n",
        share(machine.ktc_n_per_mm2, setting.coefficients[0]),
        share(machine.krc_n_per_mm2, setting.coefficients[1]),
        share(1.0 / c[0][0], setting.stiffness[0]),
        share(1.0 / c[1][1], setting.stiffness[1]),
    );
    let source = |name: &str, text: &str| Source::new(format!("reference/{name}"), text.as_bytes().to_vec());
    Pass::new(JobFile::parse(source("job.toml", &job), FilePath::new(""))?, source("program.nc", PROGRAM))
}

/// Ball of the probe, mm.
const BALL_MM: f64 = 6.0;

/// Largest wall error that a correction leaves when the first part is touched with the noise of a seed, mm.
fn left(pass: &Pass, first: &Milled, setting: &Setting, seed: u64) -> Result<f64, Failure> {
    let mut touched = first.clone();
    touched.machine.seed = seed;
    let probe = virtual_mill::probe(pass, &touched, setting.places_mm, &[0.5], BALL_MM)?;
    let measurement = Measurement::read(pass, &Source::new("reference/probe.txt", probe.into_bytes()))?;
    let corrected = correct_pass(pass, &measurement, &[], &[Route::Program], &mut |_| ())?;
    let commanded = virtual_mill::commanded(pass, &corrected.program.unwrap_or_default())?;
    Ok(virtual_mill::mill(pass, &first.machine, Some(&commanded))?.score().max_error_mm)
}

/// The table in words.
pub fn words(reached: &[Reached]) -> String {
    let mm = |value: Option<f64>| value.map_or_else(|| "-".to_owned(), |v| format!("{v:.4}"));
    let mut out = format!(
        "{:<58} {:>6} {:>8} {:>8} {:>8} {:>8} {:>8}\n",
        "", "seeds", "before", "median", "P90", "worst", "goal"
    );
    for one in reached {
        out += &format!(
            "{:<58} {:>6} {:>8.4} {:>8} {:>8} {:>8} {:>8}{}\n  touched at s = {:?} mm, mid-height; {} refused\n",
            one.title,
            one.seeds,
            one.before_mm,
            mm(one.median_mm),
            mm(one.p90_mm),
            mm(one.worst_mm),
            mm(one.goal_median_mm),
            one.goal_p90_mm.map_or_else(String::new, |goal| format!(", P90 {goal:.4}")),
            one.places_mm,
            one.failures,
        );
    }
    out
}
