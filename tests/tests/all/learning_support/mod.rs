//! A workshop for several parts: milled by the plant, probed, corrected, learned from.

use std::path::Path;

use truepath_correction::correct::{CorrectedPass, correct_pass};
use truepath_correction::learn::{Learned, learn};
use truepath_correction::learning::History;
use truepath_ground::diagnostics::{Failure, Source};
use truepath_job::job::{JobFile, Route};
use truepath_job::measurement::Measurement;
use truepath_job::pass::Pass;
use truepath_plant::{Machine, Milled};
use truepath_trial::virtual_mill;

/// Heights at which every place is touched.
pub const LEVELS: [f64; 3] = [0.1, 0.5, 0.9];

/// A job and the machine it is cut on.
pub struct Shop {
    pub pass: Pass,
    pub machine: Machine,
    ball_mm: f64,
    /// Of all its probing: another one is other noise.
    pub chance: u64,
}

pub fn source(name: &str, text: &str) -> Source {
    Source::new(name, text.as_bytes().to_vec())
}

impl Shop {
    pub fn new(program: &str, job: &str, plant: &str) -> Self {
        let job = JobFile::parse(source("job.toml", job), Path::new("")).unwrap();
        let ball_mm = job.numbers.probe.unwrap().ball_diameter.nm() as f64 / 1e6;
        let pass = Pass::new(job, source("program.nc", program)).unwrap();
        Self { pass, machine: toml::from_str(plant).unwrap(), ball_mm, chance: 0 }
    }

    /// Mills a part, uncorrected or with a correction.
    pub fn mill(&self, corrected: Option<&CorrectedPass>) -> Milled {
        let text = corrected.map(|c| c.program.clone().unwrap());
        let commanded = text.map(|text| virtual_mill::commanded(&self.pass, &text).unwrap());
        virtual_mill::mill(&self.pass, &self.machine, commanded.as_deref()).unwrap()
    }

    /// Largest wall error of a part, mean over height, mm.
    pub fn error(&self, corrected: Option<&CorrectedPass>) -> f64 {
        self.mill(corrected).score().max_error_mm
    }

    /// The probe file of a part; `noise` is the seed of the probe's chance.
    pub fn probe(&self, corrected: Option<&CorrectedPass>, places: &[f64], noise: u64) -> String {
        let mut milled = self.mill(corrected);
        milled.machine.seed = noise + self.chance;
        virtual_mill::probe(&self.pass, &milled, places, &LEVELS, self.ball_mm).unwrap()
    }

    pub fn measured(&self, text: &str) -> Measurement {
        Measurement::read(&self.pass, &source("probe.txt", text)).unwrap()
    }

    /// The first part: measured and corrected.
    pub fn first(&self, places: &[f64]) -> (CorrectedPass, History) {
        let measurement = self.measured(&self.probe(None, places, 11));
        let corrected = correct_pass(&self.pass, &measurement, &[], &[Route::Program], &mut |_| ()).unwrap();
        let history = History::first(&self.pass, &measurement, &corrected).unwrap();
        (corrected, history)
    }

    /// One more part, from a probe file.
    pub fn learn(&self, history: &History, text: &str) -> Result<Learned, Failure> {
        learn(&self.pass, history, &self.measured(text), &[], &[Route::Program], &mut |_| ())
    }

    /// One more part, cut with a correction.
    pub fn next(&self, history: &History, corrected: &CorrectedPass, places: &[f64]) -> Learned {
        let noise = 20 + history.parts.len() as u64;
        self.learn(history, &self.probe(Some(corrected), places, noise)).unwrap()
    }
}

/// A probe file whose points are moved.
pub fn moved(text: &str, motion: impl Fn(f64, f64) -> (f64, f64)) -> String {
    let line = |line: &str| {
        let mut words = line.split(' ');
        let mut next = || words.next().unwrap().parse::<f64>().unwrap();
        let (x, y) = motion(next(), next());
        format!("{x:.6} {y:.6} {}\n", words.collect::<Vec<_>>().join(" "))
    };
    text.lines().map(line).collect()
}
