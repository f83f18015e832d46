//! A case of the study of plans: part, machine, what its user believes and the points of the first part.
//!
//! Drawn are what decides the wall over the height (helix, wall height as a multiple of the axial contact ratio of one, cutter, law of
//! bending, bending) and what decides how well it can be known (stiffness, material, edges, noise of the probe, beliefs). Kinds
//! of part and laws of bending go round with the seed, so that every set has its share of each.

use std::f64::consts::{PI, TAU};
use std::path::Path as FilePath;

use truepath_ground::diagnostics::{Failure, Source};
use truepath_ground::units::mm;
use truepath_job::job::JobFile;
use truepath_job::pass::Pass;
use truepath_plant::{
    BendLaw, Felt, Machine, Part as MilledPart, SurfaceScore, Touch, WallLaw, judged_trim_mm, probeopen_text,
};
use truepath_trial::process;

use crate::contour::Contour;
use crate::draw::{Draw, rounded};
use crate::machine::Width;
use crate::part::{Cut, CutRange, Material, Part, anywhere, climb, conventional};
use crate::prior::Mistakes;
use crate::{places, text};

/// Half the tolerance is this share of the error of the part as programmed.
const TOLERANCE_SHARE: f64 = 1.0 / 9.0;
/// No tolerance is narrower, mm: what a usual probe and machine can show.
const LEAST_TOLERANCE_MM: f64 = 0.01;
/// The error aimed at is met to this share, in so many parts at most.
const CLOSE: f64 = 0.15;
const TRIALS: usize = 5;
/// No machine with its cutter yields more than this, mm/N.
const SOFTEST: f64 = 1.0 / 250.0;
/// Standard deviation of the datum shift between cut and probe, in x and in y, mm.
const DATUM_MM: f64 = 0.0015;
/// Heights that are touched, as shares of the wall's.
const LEVELS: [f64; 3] = [0.1, 0.5, 0.9];

/// A case, its first part milled.
#[derive(Clone, Debug)]
pub struct Case {
    /// Its seed.
    pub seed: u64,
    /// What it is, in a word or two.
    pub kind: &'static str,
    /// What is milled.
    pub part: Part,
    /// Program text.
    pub program: String,
    /// Job text.
    pub job: String,
    /// Job and program as read.
    pub pass: Pass,
    /// The machine.
    pub machine: Machine,
    /// Wall height over the depth of an axial contact ratio of one.
    pub contact_ratio: f64,
    /// Half the width of the tolerance at every height, mm.
    pub tolerance_mm: f64,
    /// The wall of the first part.
    pub before: SurfaceScore,
    /// The probe file of the first part.
    pub probe: String,
}

impl Case {
    /// Draws a case and mills its first part.
    ///
    /// # Errors
    /// What job, program or plant refuse.
    pub fn draw(seed: u64) -> Result<Self, Failure> {
        let chance = |what: &str| Draw::new(&format!("plan/{what}"), seed);
        let draw = &mut chance("part");
        let (cut, contact_ratio) = cut(draw);
        let (kind, contour) = contour(draw, seed, cut.radius_mm);
        let part = Part::new(contour, cut);
        let (mut machine, error_mm) = machine(&mut chance("machine"), &part, seed);
        let mistakes = Mistakes::draw(&mut chance("belief"), Width::Usual);

        let program = text::program(&part, "plan");
        let read = |job: &str| {
            let source = |name: &str, text: &str| Source::new(format!("plan/{seed}/{name}"), text.as_bytes().to_vec());
            Pass::new(JobFile::parse(source("job.toml", job), FilePath::new(""))?, source("program.nc", &program))
        };
        let ball_mm = text::ball_diameter_mm(&part);
        let trial = read(&text::job(&part, &mistakes.about(&machine, 1.0), ball_mm))?;
        let (milled, before) = scaled(&trial, &mut machine, error_mm)?;
        let job = text::job(&part, &mistakes.about(&machine, 1.0), ball_mm);
        let pass = read(&job)?;
        let draw = &mut chance("places");
        let places = places::first(draw, &part.contour, judged_trim_mm(part.cut.radius_mm));
        let datum = [draw.normal(DATUM_MM), draw.normal(DATUM_MM)];
        let probe = touched(&milled, &places, ball_mm, datum);
        let tolerance_mm = rounded((before.profile_mm * TOLERANCE_SHARE).max(LEAST_TOLERANCE_MM), 1e-4);
        Ok(Self { seed, kind, part, program, job, pass, machine, contact_ratio, tolerance_mm, before, probe })
    }

    /// The machine while the planned part is cut: the same, with another blank.
    pub fn machine_of_next(&self) -> Machine {
        Machine { seed: self.machine.seed.wrapping_add(1), ..self.machine.clone() }
    }
}

/// A cutter and its cut; the depth follows from the axial contact ratio.
fn cut(draw: &mut Draw) -> (Cut, f64) {
    let material = if draw.chance(0.5) { Material::Steel } else { Material::Aluminium };
    let range = CutRange {
        radii_mm: &[4.0, 5.0, 6.0, 8.0, 10.0],
        teeth: &[3, 4, 4, 6],
        helix_deg: (20.0, 45.0),
        allowance: (0.08, 0.25),
        material,
        ..CutRange::default()
    };
    let cut = range.draw(draw);
    let contact = TAU * cut.radius_mm / (cut.teeth as f64 * (cut.helix_deg * PI / 180.0).tan());
    let wanted = draw.between(0.35, 1.7) * contact;
    let depth_mm = rounded(wanted.clamp(0.6 * cut.radius_mm, 2.6 * cut.radius_mm), 0.5);
    (Cut { depth_mm, ..cut }, depth_mm / contact)
}

/// What is milled: an inside corner, an outside corner, a pocket or a wall of two feeds, by turns.
fn contour(draw: &mut Draw, seed: u64, radius: f64) -> (&'static str, Contour) {
    let side = if draw.chance(0.5) { climb } else { conventional }(truepath_plant::Spindle::Clockwise);
    let mut contour = Contour::new(anywhere(draw), draw.between(0.0, 360.0), side);
    let straight = |draw: &mut Draw| draw.round(28.0, 45.0, 1.0);
    let kind = match seed % 4 {
        0 => {
            let first = straight(draw);
            contour.straight(first).inside(draw.round(3.0, 8.0, 0.5), draw.between(60.0, 100.0));
            contour.straight(straight(draw));
            "inside corner"
        }
        1 => {
            let first = straight(draw);
            contour.straight(first).outside(radius + draw.round(2.0, 8.0, 0.5), draw.between(45.0, 95.0));
            contour.straight(straight(draw));
            "outside corner"
        }
        2 => {
            let (width, height, corner) =
                (draw.round(22.0, 40.0, 1.0), draw.round(16.0, 28.0, 1.0), draw.round(3.0, 7.0, 0.5));
            contour.straight(width / 2.0);
            for length in [height, width, height, width / 2.0] {
                contour.inside(corner, 90.0).straight(length);
            }
            "pocket"
        }
        _ => {
            let first = draw.round(32.0, 50.0, 1.0);
            contour.straight(first).feed(draw.round(0.6, 0.9, 0.05)).straight(straight(draw));
            "wall of two feeds"
        }
    };
    (kind, contour)
}

/// A machine whose compliances are still to be scaled, and the error aimed at, mm.
fn machine(draw: &mut Draw, part: &Part, seed: u64) -> (Machine, f64) {
    let (low, high) = if part.material == Material::Aluminium { (550.0, 1000.0) } else { (900.0, 2200.0) };
    let ktc = draw.scale(low, high);
    let (difference, cross) = (draw.between(-0.33, 0.33), draw.between(-0.15, 0.15));
    let runout = draw.between(0.0, 0.003);
    let radius_error = draw.normal(0.002);
    let machine = Machine {
        ktc_n_per_mm2: ktc,
        krc_n_per_mm2: ktc * draw.between(0.2, 0.45),
        kte_n_per_mm: draw.between(4.0, 24.0),
        kre_n_per_mm: draw.between(4.0, 30.0),
        size_exponent: draw.between(0.0, 0.3),
        compliance_mm_per_n: [[1.0 + difference, cross], [cross, 1.0 - difference]].map(|row| row.map(|c| 1e-3 * c)),
        bend: draw.between(0.0, 0.35),
        bend_law: if (seed / 4).is_multiple_of(2) { BendLaw::Alike } else { BendLaw::Maxwell },
        runout_mm: (0..part.cut.teeth).map(|_| radius_error + draw.between(-runout, runout)).collect(),
        edge_wear_per_m: draw.between(0.0, 0.1),
        stock_variation_mm: 0.02 * draw.between(0.0, 1.0) * part.cut.allowance_mm,
        law: WallLaw::Helical,
        probe_noise_mm: draw.between(0.0005, 0.004),
        seed: draw.seed(),
        ..Machine::rigid()
    };
    // From stiff to soft.
    (machine, draw.scale(0.09, 0.6).min(0.3 * part.cut.allowance_mm))
}

/// Makes the machine as soft as it takes, and mills the part as programmed.
fn scaled(pass: &Pass, machine: &mut Machine, error_mm: f64) -> Result<(MilledPart, SurfaceScore), Failure> {
    let trim = judged_trim_mm(mm(pass.core.setup.radius));
    let mut trials = 0;
    loop {
        let milled = process::cut(pass, machine, &pass.program)?;
        let none = || Failure::Internal("a part of which nothing is judged".to_owned());
        let judged = milled.surface().score(trim).ok_or_else(none)?;
        trials += 1;
        let c = &machine.compliance_mm_per_n;
        let softer = SOFTEST / (0.5 * (c[0][0] + c[1][1]));
        let factor = (error_mm / judged.profile_mm.max(1e-6)).min(softer).clamp(0.05, 4.0);
        if trials == TRIALS || (factor - 1.0).abs() < CLOSE {
            return Ok((milled, judged));
        }
        for value in machine.compliance_mm_per_n.iter_mut().flatten() {
            *value = (*value * factor).clamp(-0.05, 0.05);
        }
    }
}

/// Touches a part at places along its contour, at three heights each, and gives the file that the machine would have written.
fn touched(part: &MilledPart, places: &[f64], ball_mm: f64, datum: [f64; 2]) -> String {
    /// The ball comes from so far off the nominal wall, and is searched for as far beyond it, mm.
    const REACH_MM: f64 = 1.5;
    let (path, radius, ball) = (part.path(), part.set_up().radius_mm, 0.5 * ball_mm);
    let [bottom, top] = part.height_mm();
    let mut felt = Felt::of_part(part);
    let mut touches = Vec::new();
    for &s in places {
        let index = path.index_at(s);
        let (centre, wall) = (path.centre[index], path.wall(index, radius));
        let normal = [0, 1].map(|k| (wall[k] - centre[k]) / radius);
        let at = |short_mm: f64| [0, 1].map(|k| wall[k] - normal[k] * (ball + short_mm));
        let (from, to) = (at(REACH_MM), at(-REACH_MM));
        for level in LEVELS {
            let z = bottom + level * (top - bottom);
            let Some(share) = felt.meets(z, from, to, ball) else { continue };
            let at = [0, 1].map(|k| from[k] + normal[k] * share * 2.0 * REACH_MM);
            let along = share * 2.0 * REACH_MM + felt.off_mm([at[0], at[1], z], normal);
            let [x, y] = [0, 1].map(|k| from[k] + normal[k] * along + datum[k]);
            touches.push(Touch { s_mm: s, level, ball_centre: [x, y, z] });
        }
    }
    probeopen_text(&touches)
}
