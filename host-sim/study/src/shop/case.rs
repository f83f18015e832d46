//! A virtual shop: machines of a few makes, materials, and the jobs that are cut on them.

use std::path::Path as FilePath;

use truepath_correction::shop::Setting;
use truepath_ground::diagnostics::{Failure, Source};
use truepath_ground::units::mm;
use truepath_job::job::JobFile;
use truepath_job::pass::Pass;
use truepath_plant::{BendLaw, Machine, WallLaw, judged_trim_mm};
use truepath_trial::virtual_mill;

use crate::case::Case;
use crate::draw::{Draw, rounded};
use crate::families::FAMILIES;
use crate::id::{CaseId, Touches};
use crate::places;
use crate::prior::Prior;
use crate::text;

/// Makes of machines.
pub const MAKES: u64 = 3;
/// Materials.
pub const MATERIALS: u64 = 5;
/// Jobs of a machine.
pub const JOBS: u64 = 3;
/// Parts drawn for a job at most until one is spoilt by as much as is worth a correction, and no more than the method is made for.
const DRAWS: u64 = 40;
/// Least and largest error of an uncorrected part, mm, and largest as a share of the allowance.
const SPOILT_MM: [f64; 2] = [0.045, 0.6];
const SPOILT_SHARE: f64 = 0.35;
/// Farthest that the cutter is pushed, mm.
const PUSHED_MM: f64 = 0.6;
/// Cutters of the shop; each goes to any machine.
const CUTTERS: u64 = 20;
/// Standard deviation of ln of what differs from cutter to cutter, and from job to job with one of them: wear of the chip force, and of
/// the edges.
const WEAR: [[f64; 2]; 2] = [[0.04, 0.1], [0.045, 0.11]];
/// Standard deviation of what a cutter is smaller by than stated, and of what that differs by from job to job, mm.
const UNDERSIZE_MM: [f64; 2] = [0.01, 0.0015];

/// A material as it is, and as a table has it.
#[derive(Clone, Copy, Debug)]
struct Material {
    coefficients: [f64; 4],
    size_exponent: f64,
    stated: [f64; 4],
}

impl Material {
    fn draw(shop: u64, number: u64) -> Self {
        let draw = &mut Draw::new("shop/material", 1000 * shop + number);
        let ktc = draw.scale(550.0, 2000.0);
        let coefficients = [ktc, ktc * draw.between(0.2, 0.45), draw.between(4.0, 24.0), draw.between(4.0, 30.0)];
        let stated = coefficients.map(|c| three_figures(c * draw.normal(0.26).exp()));
        Self { coefficients, size_exponent: draw.between(0.0, 0.3), stated }
    }
}

/// Compliances of a machine with what is mounted, and the stiffness that its user states.
#[derive(Clone, Copy, Debug)]
struct Yielding {
    /// ln of the mean, difference and cross compliance as shares of it, twist, bending.
    values: [f64; 5],
    stated_n_per_mm: f64,
}

impl Yielding {
    fn draw(shop: u64, number: u64) -> Self {
        let make = &mut Draw::new("shop/make", 1000 * shop + number % MAKES);
        let make = [
            make.scale(1.0 / 7000.0, 1.0 / 1200.0).ln(),
            make.between(-0.25, 0.25),
            make.sign() * make.between(0.0, 0.12),
            0.0,
            make.between(0.05, 0.2),
        ];
        let draw = &mut Draw::new("shop/machine", 1000 * shop + number);
        let mut values = make;
        for (value, sigma) in values.iter_mut().zip([0.25, 0.1, 0.04, 0.01, 0.05]) {
            *value += draw.normal(sigma);
        }
        let stated_n_per_mm = three_figures((-values[0] + draw.normal(0.35)).exp());
        Self { values, stated_n_per_mm }
    }

    /// The same with another tool in the spindle.
    fn mounted(&self, draw: &mut Draw) -> ([[f64; 2]; 2], f64) {
        let [mean, difference, cross, twist, bend] = self.values;
        let mean = (mean + draw.normal(0.1)).exp();
        let (difference, cross) = (difference + draw.normal(0.03), cross + draw.normal(0.015));
        let shares = [[1.0 + difference, cross + twist], [cross - twist, 1.0 - difference]];
        (shares.map(|row| row.map(|c| c * mean)), (bend + draw.normal(0.03)).max(0.0))
    }
}

/// A cutter as it is: its diameter is drawn with the part, what it is smaller by and how far it is worn are its own.
#[derive(Clone, Copy, Debug)]
struct Cutter {
    undersize_mm: f64,
    /// Factors of the chip force and of the edges.
    worn: [f64; 2],
}

impl Cutter {
    fn draw(shop: u64, number: u64) -> Self {
        let draw = &mut Draw::new("shop/cutter", 1000 * shop + number);
        Self { undersize_mm: draw.normal(UNDERSIZE_MM[0]), worn: WEAR[0].map(|sigma| draw.normal(sigma).exp()) }
    }
}

fn three_figures(value: f64) -> f64 {
    let step = 10f64.powf(value.abs().log10().floor() - 2.0);
    rounded(value, step)
}

/// A job of the shop, its first part milled.
#[derive(Clone, Debug)]
pub struct ShopCase {
    /// Machine and material, by the names that the shop has for them.
    pub setting: Setting,
    /// Part, job and machine.
    pub case: Case,
}

/// The name of a job.
pub fn name(machine: u64, job: u64) -> String {
    format!("machine-{}/job-{}", machine + 1, job + 1)
}

impl ShopCase {
    /// Draws job `job` (0…[`JOBS`]) of a machine and mills its first part. Parts are drawn until one is spoilt by what is worth a
    /// correction: a stiff machine gets deeper cuts.
    ///
    /// # Errors
    /// What job, program or plant refuse; a machine for which no part was found.
    pub fn draw(shop: u64, [machine, job]: [u64; 2], touches: Touches) -> Result<Self, Failure> {
        let yielding = Yielding::draw(shop, machine);
        let seed = 10_000 * shop + 10 * machine + job;
        let draw = &mut Draw::new("shop/job", seed);
        let of_material = (draw.between(0.0, MATERIALS as f64) as u64).min(MATERIALS - 1);
        let material = Material::draw(shop, of_material);
        let number = (draw.between(0.0, CUTTERS as f64) as u64).min(CUTTERS - 1);
        let cutter = Cutter::draw(shop, number);
        let worn: [f64; 2] = std::array::from_fn(|k| cutter.worn[k] * draw.normal(WEAR[1][k]).exp());
        let mounting = &mut Draw::new("shop/mounting", 10_000 * shop + CUTTERS * machine + number);
        let (compliance_mm_per_n, bend) = yielding.mounted(mounting);
        let setting = Setting {
            make: format!("make {}", machine % MAKES),
            machine: format!("machine {machine}"),
            mounting: format!("cutter {number}"),
            material: format!("material {of_material}"),
            lot: String::new(),
            cutter: format!("cutter {number}"),
        };
        for attempt in 0..DRAWS {
            let draw = &mut Draw::new(&format!("shop/part/{attempt}"), seed);
            let family = draw.one_of(FAMILIES);
            let part = (family.draw)(draw);
            if part.plain || part.law == WallLaw::Mean {
                continue;
            }
            let radius_error = draw.normal(UNDERSIZE_MM[1]) - cutter.undersize_mm;
            let runout = draw.between(0.0, 0.006);
            let [ktc, krc, kte, kre] = material.coefficients;
            let machine = Machine {
                ktc_n_per_mm2: ktc * worn[0],
                krc_n_per_mm2: krc * worn[0],
                kte_n_per_mm: kte * worn[1],
                kre_n_per_mm: kre * worn[1],
                size_exponent: material.size_exponent,
                compliance_mm_per_n,
                bend,
                bend_law: BendLaw::Alike,
                runout_mm: (0..part.cut.teeth).map(|_| radius_error + draw.between(-runout, runout)).collect(),
                edge_wear_per_m: draw.between(0.0, 0.2),
                stock_variation_mm: draw.between(0.0, 0.05) * (part.cut.allowance_mm / 2.0).min(1.0),
                stock_wavelength_mm: draw.between(25.0, 80.0),
                law: part.law,
                probe_noise_mm: draw.between(0.001, 0.005),
                seed: draw.seed(),
                ..Machine::rigid()
            };
            let stated = Prior { coefficients: material.stated, stiffness_n_per_mm: yielding.stated_n_per_mm };
            let id = CaseId { family: family.name.to_owned(), seed, nuisance: None, touches, cell: None };
            let mut ball_mm = text::ball_diameter_mm(&part);
            let (program, mut job) = (text::program(&part, "shop"), text::job(&part, &stated, ball_mm));
            let source = |name: &str, text: &str| Source::new(format!("{seed}/{name}"), text.as_bytes().to_vec());
            let read = |job: &str| {
                let file = JobFile::parse(source("job.toml", job), FilePath::new(""))?;
                Pass::new(file, source("program.nc", &program))
            };
            let mut pass = read(&job)?;
            let first = virtual_mill::mill(&pass, &machine, None)?;
            let before = first.judge();
            let spoilt = before.score.max_error_mm;
            let pushed =
                first.samples.iter().map(|s| (s.actual[0] - s.commanded[0]).hypot(s.actual[1] - s.commanded[1]));
            let most = SPOILT_MM[1].min(SPOILT_SHARE * mm(pass.core.setup.allowance));
            if !(SPOILT_MM[0]..most).contains(&spoilt) || pushed.fold(0.0, f64::max) > PUSHED_MM {
                continue;
            }
            let (places_mm, levels) = match touches {
                Touches::Chosen | Touches::Advised => {
                    let (with_ball, smaller, chosen) =
                        places::chosen_with_ball(pass, touches == Touches::Advised, |ball_mm| {
                            job = text::job(&part, &stated, ball_mm);
                            read(&job)
                        })?;
                    (pass, ball_mm) = (with_ball, smaller.unwrap_or(ball_mm));
                    (chosen.places_mm, chosen.levels)
                }
                Touches::Family => {
                    (places::first(draw, &part.contour, judged_trim_mm(part.cut.radius_mm)), part.levels.to_vec())
                }
            };
            let case = Case {
                id,
                part,
                program,
                job,
                pass,
                machine,
                nuisances: None,
                places_mm,
                more_mm: Vec::new(),
                levels,
                ball_mm,
                first,
                before,
            };
            // A place beside an outside corner may have no wall.
            if case.probe(1, &case.first, &case.places_mm).is_ok() {
                return Ok(Self { setting, case });
            }
        }
        Err(Failure::Internal(format!(
            "no part of {DRAWS} is spoilt by as much as is worth a correction, and can be touched"
        )))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn machines_of_a_make_are_more_alike_than_others() {
        let level = |number| Yielding::draw(1, number).values[0];
        let spread = |numbers: &[u64]| {
            let all: Vec<f64> = numbers.iter().map(|n| level(*n)).collect();
            let mean = all.iter().sum::<f64>() / all.len() as f64;
            (all.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / all.len() as f64).sqrt()
        };
        let one_make: Vec<u64> = (0..10).map(|k| MAKES * k).collect();
        assert!(spread(&one_make) < 0.35 && spread(&(0..30).collect::<Vec<_>>()) > spread(&one_make));
    }
}
