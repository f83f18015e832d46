//! A case: what a user would have on the bench, and the machine that nobody knows.
//!
//! Drawing a case uses the plant only. The machine is as soft as it takes for the uncorrected part to come out about as
//! wrong as the family wants, so every case has something to correct.

use std::path::Path as FilePath;

use truepath_correction::learning::History;
use truepath_ground::diagnostics::{Failure, Source};
use truepath_ground::units::mm;
use truepath_job::job::JobFile;
use truepath_job::pass::Pass;
use truepath_plant::{Judged, Machine, Milled, judged_trim_mm};
use truepath_trial::virtual_mill;

use super::draw::Draw;
use super::families::family;
use super::id::{Axis, CaseId, Touches};
use super::machine::{Drawn, Width, machine};
use super::nuisance::Nuisances;
use super::part::Part;
use super::prior::Mistakes;
use super::seeds::Set;
use super::{places, text};

/// The error aimed at is met to this share.
const CLOSE: f64 = 0.15;

/// Parts milled at most to meet it.
const TRIALS: usize = 5;

/// No machine with its cutter yields more than this on the mean of x and y, mm/N.
const SOFTEST: f64 = 1.0 / 250.0;

/// No height of the wall is farther off than this share of the allowance.
const FARTHEST: f64 = 0.5;

/// The cutter is nowhere pushed farther than this by the mean force on the uncorrected part, mm: the jobs state a clamp of
/// 1 mm, which a corrected part, cut to its full depth, then has room in.
const PUSHED_MM: f64 = 0.6;

/// Standard deviation of the datum shift between cut and probe, in x and in y, mm.
const DATUM_MM: f64 = 0.0015;

/// Least wall error worth a case, mm.
const LEAST_MM: f64 = 0.045;

/// Draws at most until a machine within these bounds spoils the part enough; the last is taken as it is.
const DRAWS: usize = 8;

/// A case, its first part milled.
#[derive(Clone, Debug)]
pub struct Case {
    /// Its name.
    pub id: CaseId,
    /// What is milled.
    pub part: Part,
    /// Program text.
    pub program: String,
    /// Job text.
    pub job: String,
    /// Job and program as read.
    pub pass: Pass,
    /// The machine, without what shops add to it.
    pub machine: Machine,
    /// What shops add to it.
    pub nuisances: Option<Nuisances>,
    /// Places of the first probing, mm along the contour.
    pub places_mm: Vec<f64>,
    /// Places added after the first correction.
    pub more_mm: Vec<f64>,
    /// Heights, shares of the depth.
    pub levels: Vec<f64>,
    /// Ball of the probe, mm.
    pub ball_mm: f64,
    /// The first part.
    pub first: Milled,
    /// Its wall.
    pub before: Judged,
}

impl Case {
    /// Draws a case and mills its first part.
    ///
    /// # Errors
    /// What job, program or plant refuse: a family that draws what cannot be milled.
    pub fn draw(id: &CaseId) -> Result<Self, Failure> {
        let family = family(&id.family).ok_or_else(|| Failure::Internal(format!("no family {}", id.family)))?;
        let width = if id.set() == Set::Random { Width::Wild } else { Width::Usual };
        let mut attempt = 0;
        loop {
            attempt += 1;
            let chance = |what: &str| Draw::new(&format!("{}/{what}/{attempt}", family.name), id.seed);
            let part = (family.draw)(&mut chance("part"));
            let drawn = machine(&mut chance("machine"), &part, width);
            let mistakes = Mistakes::draw(&mut chance("belief"), width);
            let case = Self::of(id, part, drawn, &mistakes, &mut chance("places"))?;
            if case.before.score.max_error_mm >= LEAST_MM || attempt == DRAWS {
                return case.with_nuisances(family.name);
            }
        }
    }

    /// Adds the nuisances of its name and mills the first part with them.
    fn with_nuisances(mut self, family: &'static str) -> Result<Self, Failure> {
        let Some(which) = self.id.nuisance else { return Ok(self) };
        let (length_mm, teeth) = (self.first.path.length_mm, self.part.cut.teeth);
        self.nuisances = Some(Nuisances::new(which, (family, self.id.seed), length_mm, teeth));
        self.first = virtual_mill::mill(&self.pass, &self.machine_of(1), None)?;
        self.before = self.first.judge();
        Ok(self)
    }

    fn of(id: &CaseId, part: Part, mut drawn: Drawn, mistakes: &Mistakes, chance: &mut Draw) -> Result<Self, Failure> {
        let program = text::program(&part, &id.family);
        let read = |job: &str| {
            let source = |name: &str, text: &str| Source::new(format!("{id}/{name}"), text.as_bytes().to_vec());
            Pass::new(JobFile::parse(source("job.toml", job), FilePath::new(""))?, source("program.nc", &program))
        };
        let mut ball_mm = text::ball_diameter_mm(&part);
        let trial = read(&text::job(&part, &mistakes.about(&drawn.machine, 1.0), ball_mm))?;
        let (mut first, before) = scaled(&trial, &mut drawn)?;

        let changed = |axis: Axis| id.cell.filter(|cell| cell.axis == axis).map(|cell| cell.value);
        let believed = mistakes.about(&drawn.machine, changed(Axis::Prior).unwrap_or(1.0));
        let mut job = text::job(&part, &believed, ball_mm);
        let mut pass = read(&job)?;
        if let Some(noise) = changed(Axis::Noise) {
            drawn.machine.probe_noise_mm = noise * 1e-3;
            first.machine.probe_noise_mm = noise * 1e-3;
        }
        let trim = judged_trim_mm(part.cut.radius_mm);
        let mut levels = part.levels.to_vec();
        let mut places_mm = part.places_mm.clone();
        if places_mm.is_empty() {
            places_mm = places::first(chance, &part.contour, trim);
        }
        if let Some(points) = changed(Axis::Points) {
            (places_mm, levels) = touches(&part, trim, points as usize);
        }
        let mut more_mm = places::more(&part.contour, trim);
        if id.touches != Touches::Family {
            let (with_ball, smaller, chosen) =
                places::chosen_with_ball(pass, id.touches == Touches::Advised, |ball_mm| {
                    job = text::job(&part, &believed, ball_mm);
                    read(&job)
                })?;
            (pass, ball_mm) = (with_ball, smaller.unwrap_or(ball_mm));
            (places_mm, levels) = (chosen.places_mm, chosen.levels);
            more_mm = Vec::new(); // those of `probe --next`
        }
        Ok(Self {
            id: id.clone(),
            part,
            program,
            job,
            pass,
            machine: drawn.machine,
            nuisances: None,
            places_mm,
            more_mm,
            levels,
            ball_mm,
            first,
            before,
        })
    }

    /// Places at which the part cut with a correction is touched, mm along the contour: where the first part was and a few more, or
    /// where `truepath probe --next` would have it touched.
    ///
    /// # Errors
    /// What planning the touches refuses.
    pub fn next_places(&self, history: &History) -> Result<Vec<f64>, Failure> {
        match self.id.touches {
            Touches::Family => Ok(places::together(&self.places_mm, &self.more_mm)),
            Touches::Chosen | Touches::Advised => places::chosen_next(&self.pass, history),
        }
    }

    /// The machine while part `number` (1, 2, …) is cut: the same, with another blank and other noise of the probe, and with
    /// the nuisances as that part has them.
    pub fn machine_of(&self, number: u64) -> Machine {
        self.machine_touched(number, self.places_mm.len())
    }

    /// The same of a part that is touched at so many places.
    pub fn machine_touched(&self, number: u64, places: usize) -> Machine {
        let machine = Machine { seed: self.machine.seed.wrapping_add(number - 1), ..self.machine.clone() };
        match &self.nuisances {
            Some(nuisances) => nuisances.on(&machine, number, places * self.levels.len()),
            None => machine,
        }
    }

    /// Touches part `number`. Every part is clamped and its datum taken anew, so the datum shift is another one.
    ///
    /// # Errors
    /// Places without a wall.
    pub fn probe(&self, number: u64, milled: &Milled, places_mm: &[f64]) -> Result<String, Failure> {
        let mut chance = Draw::new(&format!("{}/datum/{number}", self.id.family), self.id.seed);
        let datum_mm = [chance.normal(DATUM_MM), chance.normal(DATUM_MM)];
        virtual_mill::probe_shifted(&self.pass, milled, places_mm, &self.levels, self.ball_mm, datum_mm)
    }
}

/// So many touches: three heights a place where that comes out even, else mid-height only.
fn touches(part: &Part, trim: f64, count: usize) -> (Vec<f64>, Vec<f64>) {
    if count >= 6 && count.is_multiple_of(3) {
        (places::spread(&part.contour, trim, count / 3), vec![0.1, 0.5, 0.9])
    } else {
        (places::spread(&part.contour, trim, count), vec![0.5])
    }
}

/// Makes the machine as soft as the case wants and mills the first part.
fn scaled(pass: &Pass, drawn: &mut Drawn) -> Result<(Milled, Judged), Failure> {
    let allowance = mm(pass.core.setup.allowance);
    let mut trials = 0;
    loop {
        let milled = virtual_mill::mill(pass, &drawn.machine, None)?;
        let judged = milled.judge();
        trials += 1;
        let ratio = drawn.error_mm / judged.score.max_error_mm.max(1e-6);
        let c = &drawn.machine.compliance_mm_per_n;
        let softer = SOFTEST / (0.5 * (c[0][0] + c[1][1]));
        let farther = FARTHEST * allowance / judged.score.worst_height_mm.max(1e-6);
        let pushed = milled.samples.iter().map(|s| (s.actual[0] - s.commanded[0]).hypot(s.actual[1] - s.commanded[1]));
        let pushed = PUSHED_MM / pushed.fold(1e-6, f64::max);
        // A softer machine also cuts less, so the error grows more slowly than the compliance.
        let factor = ratio.min(softer).min(farther).min(pushed).clamp(0.05, 4.0);
        if trials == TRIALS || (factor - 1.0).abs() < CLOSE {
            return Ok((milled, judged));
        }
        for value in drawn.machine.compliance_mm_per_n.iter_mut().flatten() {
            *value = (*value * factor).clamp(-0.05, 0.05);
        }
    }
}
