//! Machine and material beside a discrepancy: the parameters are fitted to the points relieved of it.
//!
//! Parameters and discrepancy that are most probable together are found in turn: the discrepancy of the points, the
//! parameters integrated out ([`Discrepancy`]); the parameters by the fit of the core, which is not linear and knows points
//! of something else; and the discrepancy again about them.

use truepath_core::correct::{Node, commanded};
use truepath_core::cut::{Path, WallLaw};
use truepath_core::geometry::Vector;
use truepath_core::identify::{Cut, EarlierPart, Observation, speaks_for_mean};
use truepath_core::job::{self, LawName};
use truepath_ground::units::{float, mm, nm};
use truepath_job::pass::Pass;

use super::average::{Along, Discrepancy, ln_probability};
use super::points::{CutPoints, Points};
use crate::identification::{Found, Points as Asked, found, under_both};
use crate::plausible::is_possible;

/// A discrepancy that is nowhere larger is none: the parameters stay as they are, to the last bit.
const LEAST_MM: f64 = 0.000_5;

/// Times that parameters are fitted to points relieved of a discrepancy that has changed.
const ROUNDS: u32 = 6;

/// One contour of one part.
#[derive(Clone, Copy, Debug)]
pub struct PartCut<'a> {
    /// Its path.
    pub path: Path<'a>,
    /// Its number among the contours of the part.
    pub contour: usize,
    /// The part, counted from 0; the cuts of a part stand together, in the order of the parts.
    pub part: usize,
    /// The correction it was cut with; empty for none.
    pub nodes: &'a [Node],
    /// Its points.
    pub observations: &'a [Observation],
}

/// What parts say of machine, material, and what is beside both.
#[derive(Clone, Debug)]
pub struct Relieved {
    /// Machine and material; the points of the cuts stand one behind the other, with the errors that were measured.
    pub found: Found,
    /// The datum of every part, prior standard deviations.
    pub datums: Vec<[f64; 2]>,
    /// What is beside them; `None` where there are no points.
    pub discrepancy: Option<Discrepancy>,
    /// Whether any of it is worth a correction.
    is_any: bool,
}

/// By how much the mean law must be more probable than the helical one before it is believed, natural logarithm: 20 : 1.
const DECISIVE: f64 = 3.0;

/// Whether a job's parts are fitted with what is beside the model: the other laws are kept to be compared with, as they are printed.
pub fn is_fitted(pass: &Pass) -> bool {
    pass.job.discrepancy && pass.job.numbers.correct.law == LawName::Model
}

/// Fits machine and material to the points of the cuts, without any discrepancy; without a law under the one they speak for.
/// `progress` is told the share done.
pub fn plain(pass: &Pass, law: Option<WallLaw>, cuts: &[PartCut<'_>], progress: &mut dyn FnMut(f64)) -> Found {
    let measured: Vec<Observation> = cuts.iter().flat_map(|cut| cut.observations).copied().collect();
    if let Some(law) = law {
        return fitted(&pass.core, law, cuts, &measured, progress);
    }
    let by_program = |cut: usize, sample: usize| by_program(cuts, cut, sample);
    let (mean, helical) = asked(cuts, &measured, |points| under_both(&pass.core, points, by_program, progress));
    let is_mean = speaks_for_mean(&mean.core.fit, &helical.core.fit)
        // Points that other stock or another size would explain under the helical law are no reason by themselves.
        && (!is_fitted(pass)
            || (is_possible(&mean.core) || !is_possible(&helical.core))
                && ln_evidence(&mean, cuts) > ln_evidence(&helical, cuts).map(|ln| ln + DECISIVE));
    if is_mean { mean } else { helical }
}

/// As [`plain()`], under a law, to observations in place of those of the cuts.
fn fitted(
    pass: &job::ContourPass,
    law: WallLaw,
    cuts: &[PartCut<'_>],
    observations: &[Observation],
    progress: &mut dyn FnMut(f64),
) -> Found {
    let by_program = |cut: usize, sample: usize| by_program(cuts, cut, sample);
    asked(cuts, observations, |points| found(pass, Some(law), points, by_program, progress))
}

/// The displacement that the program commanded at a sample of a cut.
fn by_program(cuts: &[PartCut<'_>], cut: usize, sample: usize) -> Vector {
    cuts.get(cut).map_or(Vector::ZERO, |cut| commanded(&cut.path, cut.nodes, sample))
}

/// Observations of cuts as a fit takes them.
fn asked<T>(parts: &[PartCut<'_>], observations: &[Observation], fit: impl FnOnce(Asked<'_>) -> T) -> T {
    let cuts: Vec<Cut> =
        parts.iter().map(|cut| Cut { path: cut.path, points: cut.observations.len(), part: cut.part }).collect();
    let count = |part: usize| parts.iter().filter(|cut| cut.part == part).map(|cut| cut.observations.len()).sum();
    let earlier: Vec<EarlierPart> = (0..last_part(parts)).map(|part| EarlierPart::new(count(part))).collect();
    fit(Asked { cuts: &cuts, earlier: &earlier, observations })
}

/// What the parts show beside machine and material, which are fitted again to the points relieved of it; `found` is their
/// [`plain()`] fit. `progress` is told the share done.
pub fn relieved(
    pass: &job::ContourPass,
    mut found: Found,
    cuts: &[PartCut<'_>],
    progress: &mut dyn FnMut(f64),
) -> Relieved {
    let last = last_part(cuts);
    let measured: Vec<Observation> = cuts.iter().flat_map(|cut| cut.observations).copied().collect();
    let mut discrepancy = Discrepancy::of(points(cuts, &found, last));
    let alone = (found.clone(), discrepancy.clone());
    let mut is_any = false;
    let mut before: Vec<f64> = vec![0.0; measured.len()];
    let mut moved_before = f64::INFINITY;
    for round in 0..ROUNDS {
        let beside = discrepancy.as_ref().map(Discrepancy::at_points).unwrap_or_default();
        let moved = beside.iter().zip(&before).map(|(now, before)| (now - before).abs()).fold(0.0, f64::max);
        if moved < LEAST_MM {
            break;
        }
        // What does not settle explains nothing: points of another part, or of another datum.
        if moved > moved_before {
            (found, discrepancy) = alone;
            is_any = false;
            break;
        }
        moved_before = moved;
        is_any = true;
        let mut relieved = measured.clone();
        for (o, mm) in relieved.iter_mut().zip(&beside) {
            o.error -= nm(*mm);
        }
        let share = |share: f64| (f64::from(round) + share) / f64::from(ROUNDS);
        let law = found.core.law;
        // From the prior again: from the last fit it may stay with points of something else.
        found = fitted(pass, law, cuts, &relieved, &mut |done| progress(share(done)));
        for (o, measured) in found.observations.iter_mut().zip(&measured) {
            o.error = measured.error;
        }
        before = beside;
        discrepancy = Discrepancy::of(points(cuts, &found, last));
    }
    progress(1.0);
    Relieved { datums: datums(&found, last + 1), found, discrepancy, is_any }
}

impl Relieved {
    /// What is beside a contour, for the next part.
    pub fn along(&self, path: &Path, contour: usize) -> Along {
        let along = self.discrepancy.as_ref().map(|d| d.along(path, contour, &self.found.core)).unwrap_or_default();
        if self.is_any { along } else { Along { mean: Vec::new(), ..along } }
    }
}

/// The last part of some cuts.
fn last_part(cuts: &[PartCut<'_>]) -> usize {
    cuts.last().map_or(0, |cut| cut.part)
}

/// How probable the points of a part are that a job has cut, whatever the machine and what is beside it: natural logarithm, comparable
/// with that under another job; `found` is their [`plain()`] fit under the job.
pub fn ln_evidence(found: &Found, cuts: &[PartCut<'_>]) -> Option<f64> {
    ln_probability(&points(cuts, found, last_part(cuts)))
}

/// The points as the discrepancy takes them.
fn points(parts: &[PartCut<'_>], found: &Found, last: usize) -> Points {
    let datums = datums(found, last + 1);
    let mut rest = &found.observations[..];
    let cuts: Vec<CutPoints> = parts
        .iter()
        .map(|cut| {
            let (own, others) = rest.split_at(cut.observations.len().min(rest.len()));
            rest = others;
            let datum = datums.get(cut.part).copied().unwrap_or_default();
            let parts_ago = last + 1 - cut.part;
            CutPoints { path: &cut.path, contour: cut.contour, parts_ago, nodes: cut.nodes, observations: own, datum }
        })
        .collect();
    Points::of(&cuts, &found.core)
}

/// The datum of every part, prior standard deviations.
pub fn datums(found: &Found, parts: usize) -> Vec<[f64; 2]> {
    let job::Identified { prior, fit, .. } = &found.core;
    let [.., sigma_x, sigma_y] = prior.sigma.map(float);
    let shares = |d: Vector| [mm(d.x) / sigma_x.max(1e-9), mm(d.y) / sigma_y.max(1e-9)];
    let last = [fit.parameters.datum];
    found.earlier.iter().map(|part| part.datum(prior)).chain(last).take(parts).map(shares).collect()
}
