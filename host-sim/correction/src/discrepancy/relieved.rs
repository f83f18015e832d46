//! Machine and material beside a discrepancy: the parameters are fitted to the points relieved of it.
//!
//! Parameters and discrepancy that are most probable together are found in turn: the discrepancy of the points, the
//! parameters integrated out ([`Discrepancy`]); the parameters by the fit of the core, which is not linear and knows points
//! of something else; and the discrepancy again about them.

use truepath_core::correct::{Node, commanded};
use truepath_core::cut::{Path, Sample, State, WallLaw};
use truepath_core::geometry::Vector;
use truepath_core::identify::{
    Cut, EarlierPart, Fit, Level, Observation, PredictionWorkspace, join_pairs, predict, speaks_for_mean,
};
use truepath_core::job::{self, LawName};
use truepath_core::units::Offset;
use truepath_ground::units::{float, mm, nm, real};
use truepath_job::pass::Pass;

use super::average::{Along, ByLoad, Discrepancy, ln_probability};
use super::nominal::with_stock;
use super::pairs::Pairs;
use super::points::{CutPoints, Own, Points};
use crate::force_tables::force_table;
use crate::identification::{Found, Points as Asked, found, under_both};
use crate::plausible::is_possible;

/// A discrepancy that is nowhere larger is none: the parameters stay as they are, to the last bit.
const LEAST_MM: f64 = 0.000_5;

/// Share of the allowance by which expected stock changes at most before what it does is looked at again.
const MOST_STEP: f64 = 0.15;

/// Stock that differs by a smaller share of the allowance is linear enough.
const LEAST_STOCK: f64 = 0.05;

/// Times that parameters are fitted to points relieved of a discrepancy that has changed.
const ROUNDS: u32 = 9;

/// Times that kernels are chosen anew: then they stay, because between two of them what follows would go to and fro.
const FREE: u32 = 3;

/// One contour of one part.
#[derive(Clone, Copy, Debug)]
pub struct PartCut<'a> {
    /// Its path.
    pub path: Path<'a>,
    /// Its number among the contours of the part.
    pub contour: usize,
    /// The part, counted from 0; the cuts of a part stand together, in the order of the parts.
    pub part: usize,
    /// How many parts before the next one it was cut: 1 for the newest. There may be more of them than are here.
    pub parts_ago: u32,
    /// The correction it was cut with; empty for none.
    pub nodes: &'a [Node],
    /// Its points.
    pub observations: &'a [Observation],
}

impl<'a> PartCut<'a> {
    /// A contour of the only part, cut without a correction.
    pub const fn uncorrected(path: Path<'a>, contour: usize, observations: &'a [Observation]) -> Self {
        Self { path, contour, part: 0, parts_ago: 1, nodes: &[], observations }
    }
}

/// What parts say of machine, material, and what is beside both.
#[derive(Clone, Debug)]
pub struct Relieved {
    /// Machine and material; the points of the cuts stand one behind the other, with the errors that were measured.
    pub found: Found,
    /// What every part has of its own.
    pub own: Vec<Own>,
    /// What is beside them; `None` where there are no points.
    pub discrepancy: Option<Discrepancy>,
    /// What is beside them at every point, mm.
    pub at_points: Vec<f64>,
    /// Whether any of it is worth a correction.
    is_any: bool,
}

/// By how much another law, or other stock, must be more probable before it is believed, natural logarithm: 20 : 1.
const DECISIVE: f64 = 3.0;

/// Whether a job's parts are fitted with what is beside the model: the other laws are kept to be compared with, as they are printed.
pub fn is_fitted(pass: &Pass) -> bool {
    pass.job.discrepancy && pass.job.numbers.correct.law == LawName::Model
}

/// Fits machine and material to the points of the cuts, without any discrepancy; without a law under the one they speak for. All parts
/// begin at one level of force where a discrepancy is to find it, which knows how levels move from part to part; else every part has
/// its own. `progress` is told the share done.
pub fn plain(pass: &Pass, law: Option<WallLaw>, cuts: &[PartCut<'_>], progress: &mut dyn FnMut(f64)) -> Found {
    let measured: Vec<Observation> = cuts.iter().flat_map(|cut| cut.observations).copied().collect();
    let levels = even_levels(pass, cuts);
    if let Some(law) = law {
        return fitted(&pass.core, law, cuts, (&measured, None), &levels, progress);
    }
    let by_program = |cut: usize, sample: usize| by_program(cuts, cut, sample);
    let (mean, helical) =
        asked(cuts, &measured, &levels, |points| under_both(&pass.core, points, by_program, progress));
    let is_mean = speaks_for_mean(&mean.core.fit, &helical.core.fit)
        // Points that other stock or another size would explain under the helical law are no reason by themselves.
        && (!is_fitted(pass)
            || (is_possible(&mean.core) || !is_possible(&helical.core))
                && ln_evidence(&mean, cuts) > ln_evidence(&helical, cuts).map(|ln| ln + DECISIVE));
    if is_mean { mean } else { helical }
}

/// As [`plain()`], from where that of the same points has ended whose cutter differs a little, and under its law.
pub fn plain_from(pass: &Pass, other: &Found, cuts: &[PartCut<'_>]) -> Found {
    let begin = (other.observations.as_slice(), Some(&other.core.fit));
    fitted(&pass.core, other.core.law, cuts, begin, &even_levels(pass, cuts), &mut |_| ())
}

/// The levels of force at which the parts begin.
fn even_levels(pass: &Pass, cuts: &[PartCut<'_>]) -> Vec<f64> {
    if is_fitted(pass) { vec![0.0; last_part(cuts)] } else { Vec::new() }
}

/// As [`plain()`], under a law, to observations in place of those of the cuts, at known levels of force of the parts; they may be those that
/// another fit has left, to go on from there.
fn fitted(
    pass: &job::ContourPass,
    law: WallLaw,
    cuts: &[PartCut<'_>],
    (observations, begin): (&[Observation], Option<&Fit>),
    levels: &[f64],
    progress: &mut dyn FnMut(f64),
) -> Found {
    let by_program = |cut: usize, sample: usize| by_program(cuts, cut, sample);
    asked(cuts, observations, levels, |points| found(pass, Some(law), Asked { begin, ..points }, by_program, progress))
}

/// The displacement that the program commanded at a sample of a cut.
fn by_program(cuts: &[PartCut<'_>], cut: usize, sample: usize) -> Vector {
    cuts.get(cut).map_or(Vector::ZERO, |cut| commanded(&cut.path, cut.nodes, sample))
}

/// Observations of cuts as a fit takes them, at known levels of force of the parts; a part without one may have any.
fn asked<T>(
    parts: &[PartCut<'_>],
    observations: &[Observation],
    levels: &[f64],
    fit: impl FnOnce(Asked<'_>) -> T,
) -> T {
    let cuts: Vec<Cut> =
        parts.iter().map(|cut| Cut { path: cut.path, points: cut.observations.len(), part: cut.part }).collect();
    let count = |part: usize| parts.iter().filter(|cut| cut.part == part).map(|cut| cut.observations.len()).sum();
    let level = |part: usize| levels.get(part).map_or(Level::ANY, |level| Level::known(real(*level)));
    let earlier: Vec<EarlierPart> =
        (0..last_part(parts)).map(|part| EarlierPart::new(count(part), level(part))).collect();
    fit(Asked { cuts: &cuts, earlier: &earlier, observations, begin: None })
}

/// What the parts show beside machine and material, which are fitted again to the points relieved of it; `found` is their
/// [`plain()`] fit. `progress` is told the share done.
///
/// A level of force of an earlier part is not linear either: the fit is about that which is expected.
/// Where stock differs, other teeth cut at other times, which is not linear. Machine and material are therefore fitted a second
/// time, about the stock that is expected, and believed where the points are clearly more probable so.
pub fn relieved(
    pass: &job::ContourPass,
    found: Found,
    cuts: &[PartCut<'_>],
    progress: &mut dyn FnMut(f64),
) -> Relieved {
    let task = Task { pass, law: found.core.law, cuts };
    let nothing = Beside::none(cuts, &found);
    let first = About::of(found, cuts, nothing, None);
    let even = task.even(first.clone(), &mut |share| progress(0.5 * share));
    let is_stock = |about: &About| about.shown(cuts) > LEAST_STOCK;
    let stocked = is_stock(&even)
        .then(|| task.stocked(first, &mut |share| progress(0.5 + 0.5 * share)))
        .filter(|stocked| is_stock(stocked) && stocked.ln_probability() > even.ln_probability() + DECISIVE);
    progress(1.0);
    let About { found, discrepancy, beside } = stocked.unwrap_or_else(|| even.in_even_stock());
    beside.relieved(found, discrepancy, cuts)
}

/// Cuts to be explained.
#[derive(Clone, Copy, Debug)]
struct Task<'t, 'a> {
    pass: &'t job::ContourPass,
    law: WallLaw,
    cuts: &'t [PartCut<'a>],
}

impl Task<'_, '_> {
    /// Machine and material about even stock, and what is beside them, in turn until neither moves.
    fn even(self, first: About, progress: &mut dyn FnMut(f64)) -> About {
        let (now, settled) = self.in_turn(first.clone(), 0.0, progress);
        // What does not settle explains nothing: points of another part, or of another datum.
        if settled { now } else { first }
    }

    /// The same about the stock that is expected.
    fn stocked(self, first: About, progress: &mut dyn FnMut(f64)) -> About {
        self.in_turn(first, MOST_STEP, progress).0
    }

    /// What is beside machine and material, and both, in turn; stock comes by at most `stock_step` of the allowance a time. And whether they
    /// came to rest, or half of the way at least.
    fn in_turn(self, first: About, stock_step: f64, progress: &mut dyn FnMut(f64)) -> (About, bool) {
        let mut now = first;
        let (mut moved_first, mut moved_before, mut step) = (f64::INFINITY, f64::INFINITY, 1.0);
        for round in 0..ROUNDS {
            let mut next = now.next(self.cuts, stock_step);
            let moved = next.moved(&now.beside);
            if moved < LEAST_MM {
                return (now, true);
            }
            if round == 0 {
                moved_first = moved;
            }
            // It goes to and fro: less than the whole way.
            if moved > 0.7 * moved_before {
                step *= 0.7;
            }
            moved_before = moved;
            next.come(&now.beside, step);
            let kernels = now.discrepancy.take().filter(|_| round + 1 >= FREE);
            let share = |share: f64| (f64::from(round) + share) / f64::from(ROUNDS);
            now = self.about(next, kernels.as_ref(), &mut |done| progress(share(done)));
        }
        (now, moved_before < 0.5 * moved_first)
    }

    /// Machine and material from the points relieved of what is beside them, and the discrepancy about both.
    fn about(self, beside: Beside, kernels: Option<&Discrepancy>, progress: &mut dyn FnMut(f64)) -> About {
        let found = beside.fitted(self.pass, self.law, self.cuts, progress);
        About::of(found, self.cuts, beside, kernels)
    }
}

/// Machine and material about what is beside them, and the discrepancy about both.
#[derive(Clone, Debug)]
struct About {
    found: Found,
    discrepancy: Option<Discrepancy>,
    beside: Beside,
}

impl About {
    /// By the kernels of another discrepancy, or by those that are most probable.
    fn of(found: Found, cuts: &[PartCut<'_>], beside: Beside, kernels: Option<&Discrepancy>) -> Self {
        let points = beside.stocked(cuts, |cuts| points(cuts, &found, &beside.more));
        let discrepancy = match kernels {
            Some(other) => other.again(points),
            None => Discrepancy::of(points),
        };
        Self { found, discrepancy, beside }
    }

    /// The same with all stock among what is beside the cut.
    fn in_even_stock(self) -> Self {
        Self { discrepancy: self.discrepancy.map(Discrepancy::in_even_stock), ..self }
    }

    /// How probable the points are, natural logarithm up to a constant.
    fn ln_probability(&self) -> f64 {
        self.discrepancy.as_ref().map_or(f64::NEG_INFINITY, Discrepancy::ln_probability)
    }

    /// The largest share of the allowance by which stock is expected to differ at a point.
    fn shown(&self, cuts: &[PartCut<'_>]) -> f64 {
        let Some(discrepancy) = &self.discrepancy else { return 0.0 };
        let of_cut = |cut: &PartCut<'_>| {
            let most = cut.observations.iter().map(|o| discrepancy.more_stock(cut.contour, mm(o.s)).abs());
            most.fold(0.0, f64::max) / mm(cut.path.setup().allowance).max(1e-6)
        };
        cuts.iter().map(of_cut).fold(0.0, f64::max)
    }

    /// What the discrepancy says is beside machine and material.
    fn next(&self, cuts: &[PartCut<'_>], stock_step: f64) -> Beside {
        let Some(discrepancy) = &self.discrepancy else { return Beside::none(cuts, &self.found) };
        let stock: Vec<Vec<f64>> = cuts
            .iter()
            .zip(&self.beside.stock)
            .map(|(cut, before)| {
                let most = stock_step * mm(cut.path.setup().allowance);
                let at = |(sample, before): (&Sample, &f64)| {
                    before + (discrepancy.more_stock(cut.contour, mm(sample.s)) - before).clamp(-most, most)
                };
                cut.path.samples().iter().zip(before).map(at).collect()
            })
            .collect();
        let at_points = |(cut, stock): (&PartCut<'_>, &Vec<f64>)| {
            let at = |s| stock.get(cut.path.index_at(s)).copied().unwrap_or_default();
            let of = |o: &Observation| o.across().map_or(at(o.s), |across| 0.5 * (at(o.s) + at(across)));
            cut.observations.iter().map(of).collect::<Vec<f64>>()
        };
        let mut more: Vec<f64> = cuts.iter().zip(&stock).flat_map(at_points).collect();
        Pairs::of(cuts.iter().flat_map(|cut| cut.observations)).join(&mut more);
        let earlier = cuts.chunk_by(|a, b| a.part == b.part).take(last_part(cuts));
        let levels: Vec<f64> = earlier.map(|part| discrepancy.level(part[0].parts_ago)).collect();
        let level = at_every_point(cuts, &levels);
        let (mut rest, mut by_stock, mut by_level) = (Vec::new(), Vec::new(), Vec::new());
        for ((at, more), level) in discrepancy.at_points().iter().zip(&more).zip(&level) {
            rest.push(at.all - at.per_stock * more - at.per_level * level);
            by_stock.push(at.per_stock);
            by_level.push(at.per_level);
        }
        Beside { stock, more, by_stock, levels, level, by_level, rest, is_any: true }
    }
}

/// What is beside machine and material.
#[derive(Clone, Debug)]
struct Beside {
    /// By how much the allowance is larger than the job says, for every cut at every sample of its path, mm.
    stock: Vec<Vec<f64>>,
    /// The same at every point, mm.
    more: Vec<f64>,
    /// What a millimetre more does to every point, mm.
    by_stock: Vec<f64>,
    /// The level of force of every part before the last over that of the last, natural logarithm.
    levels: Vec<f64>,
    /// That of its part at every point, 0 on the last part.
    level: Vec<f64>,
    /// What it does to every point, mm per unit.
    by_level: Vec<f64>,
    /// What is at every point beside both, mm.
    rest: Vec<f64>,
    /// Whether it was found: points were relieved of it.
    is_any: bool,
}

impl Beside {
    /// Nothing beside a fit.
    fn none(cuts: &[PartCut<'_>], found: &Found) -> Self {
        let points = vec![0.0; cuts.iter().map(|cut| cut.observations.len()).sum()];
        let stock = cuts.iter().map(|cut| vec![0.0; cut.path.samples().len()]).collect();
        let levels: Vec<f64> = found.earlier.iter().map(|part| float(part.level())).collect();
        Self {
            stock,
            more: points.clone(),
            by_stock: points.clone(),
            level: at_every_point(cuts, &levels),
            levels,
            by_level: points.clone(),
            rest: points,
            is_any: false,
        }
    }

    /// How far it moves a point at most from where it was, mm.
    fn moved(&self, before: &Self) -> f64 {
        let each = 0..self.rest.len();
        let by = |k: usize| {
            let stock = self.by_stock[k] * (self.more[k] - before.more[k]);
            let level = self.by_level[k] * (self.level[k] - before.level[k]);
            self.rest[k] - before.rest[k] + stock + level
        };
        each.map(|k| by(k).abs()).fold(0.0, f64::max)
    }

    /// Comes a share of the way from where it was.
    fn come(&mut self, before: &Self, share: f64) {
        let come = |now: &mut Vec<f64>, before: &Vec<f64>| {
            now.iter_mut().zip(before).for_each(|(now, before)| *now = before + share * (*now - before));
        };
        self.stock.iter_mut().zip(&before.stock).for_each(|(now, before)| come(now, before));
        come(&mut self.more, &before.more);
        come(&mut self.levels, &before.levels);
        come(&mut self.level, &before.level);
        come(&mut self.rest, &before.rest);
    }

    /// Does something with the cuts in this stock.
    fn stocked<T>(&self, cuts: &[PartCut<'_>], with: impl FnOnce(&[PartCut<'_>]) -> T) -> T {
        let is_even = |more: &Vec<f64>| more.iter().all(|more| *more == 0.0);
        let mut buffers = vec![Vec::new(); cuts.len()];
        let stocked: Vec<PartCut<'_>> = cuts
            .iter()
            .zip(&mut buffers)
            .zip(&self.stock)
            .map(|((cut, buffer), more)| {
                let shifts = more.iter().map(|more| -nm(*more));
                let path = if is_even(more) { cut.path } else { with_stock(&cut.path, shifts, buffer) };
                PartCut { path, ..*cut }
            })
            .collect();
        with(&stocked)
    }

    /// Machine and material from the points relieved of it.
    fn fitted(
        &self,
        pass: &job::ContourPass,
        law: WallLaw,
        cuts: &[PartCut<'_>],
        progress: &mut dyn FnMut(f64),
    ) -> Found {
        let measured = || cuts.iter().flat_map(|cut| cut.observations);
        let mut relieved: Vec<Observation> = measured().copied().collect();
        for (o, rest) in relieved.iter_mut().zip(&self.rest) {
            o.error -= nm(*rest);
        }
        // From the prior again: from the last fit it may stay with points of something else.
        let mut found = self.stocked(cuts, |cuts| fitted(pass, law, cuts, (&relieved, None), &self.levels, progress));
        for (o, measured) in found.observations.iter_mut().zip(measured()) {
            o.error = measured.error;
        }
        found
    }

    /// What the parts say, the predictions of their points those of even stock.
    fn relieved(self, mut found: Found, discrepancy: Option<Discrepancy>, cuts: &[PartCut<'_>]) -> Relieved {
        let mut at_points: Vec<f64> = match &discrepancy {
            Some(discrepancy) => discrepancy
                .at_points()
                .iter()
                .zip(&self.level)
                .map(|(at, level)| at.all - at.per_level * level)
                .collect(),
            None => vec![0.0; self.rest.len()],
        };
        let in_stock = self.stocked(cuts, |cuts| predictions(&found, cuts));
        let in_even = predictions(&found, cuts);
        let more = self.more.iter().zip(&self.by_stock);
        for ((o, beside), ((stock, even), (more, by_stock))) in
            found.observations.iter_mut().zip(&mut at_points).zip(in_stock.iter().zip(&in_even).zip(more))
        {
            let by_its_stock = *stock - *even;
            o.predicted -= by_its_stock;
            *beside += mm(by_its_stock) - more * by_stock;
        }
        let own = own(&found, last_part(cuts) + 1);
        Relieved { found, own, discrepancy, at_points, is_any: self.is_any }
    }
}

/// A value of every part before the last at every point of the cuts, 0 at those of the last.
fn at_every_point(cuts: &[PartCut<'_>], values: &[f64]) -> Vec<f64> {
    let of = |cut: &PartCut<'_>| values.get(cut.part).copied().unwrap_or_default();
    cuts.iter().flat_map(|cut| std::iter::repeat_n(of(cut), cut.observations.len())).collect()
}

/// What the machine leaves at the points of the cuts, all in the datum and at the level of force of the last part.
fn predictions(found: &Found, cuts: &[PartCut<'_>]) -> Vec<Offset> {
    let core = &found.core;
    let of_cut = |cut: &PartCut<'_>| {
        let path = cut.path.with_law(core.law);
        let room = path.working().len() + 1;
        let (mut states, mut displacements) = (vec![State::REST; room], vec![Vector::ZERO; room]);
        let mut workspace = PredictionWorkspace { states: &mut states, displacements: &mut displacements };
        let mut points = cut.observations.to_vec();
        let asked = |i: usize| commanded(&path, cut.nodes, i);
        predict(&path, &force_table(&core.fit.parameters), &core.fit.parameters, asked, &mut points, &mut workspace);
        points
    };
    let mut points: Vec<Observation> = cuts.iter().flat_map(of_cut).collect();
    join_pairs(&mut points);
    points.into_iter().map(|o| o.predicted).collect()
}

impl Relieved {
    /// What is beside a contour, for the next part.
    pub fn along(&self, path: &Path, contour: usize) -> Along {
        let along = self.discrepancy.as_ref().map(|d| d.along(path, contour, &self.found.core)).unwrap_or_default();
        if self.is_any {
            return along;
        }
        let by_load = ByLoad { mean: Vec::new(), ..along.by_load };
        Along { sigma: along.sigma, repeat: along.repeat, by_load, ..Along::NONE }
    }
}

/// The last part of some cuts.
fn last_part(cuts: &[PartCut<'_>]) -> usize {
    cuts.last().map_or(0, |cut| cut.part)
}

/// How probable the points of a part are that a job has cut, whatever the machine and what is beside it: natural logarithm, comparable
/// with that under another job; `found` is their [`plain()`] fit under the job.
pub fn ln_evidence(found: &Found, cuts: &[PartCut<'_>]) -> Option<f64> {
    ln_probability(&points(cuts, found, &[]))
}

/// The points as the discrepancy takes them; the allowance is `more` than the job says at each.
fn points(parts: &[PartCut<'_>], found: &Found, more: &[f64]) -> Points {
    let last = last_part(parts);
    let every_own = own(found, last + 1);
    let (mut rest, mut more) = (&found.observations[..], more);
    let cuts: Vec<CutPoints> = parts
        .iter()
        .map(|cut| {
            let count = cut.observations.len();
            let (observations, others) = rest.split_at(count.min(rest.len()));
            let (more_here, more_there) = more.split_at(count.min(more.len()));
            (rest, more) = (others, more_there);
            let own = every_own.get(cut.part).copied().unwrap_or_default();
            let (path, contour, nodes, parts_ago) = (&cut.path, cut.contour, cut.nodes, cut.parts_ago);
            CutPoints { path, contour, parts_ago, nodes, observations, more: more_here, own }
        })
        .collect();
    Points::of(&cuts, &found.core)
}

/// What every part of a fit has of its own.
pub fn own(found: &Found, parts: usize) -> Vec<Own> {
    let job::Identified { prior, fit, .. } = &found.core;
    let [.., sigma_x, sigma_y] = prior.sigma.map(float);
    let shares = |d: Vector| [mm(d.x) / sigma_x.max(1e-9), mm(d.y) / sigma_y.max(1e-9)];
    let last = Own { datum: shares(fit.parameters.datum), level: 0.0 };
    let earlier = found.earlier.iter().map(|part| Own { datum: shares(part.datum(prior)), level: float(part.level()) });
    earlier.chain([last]).take(parts).collect()
}
