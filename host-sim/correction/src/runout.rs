//! How far a cutter runs out, where the job does not say: the offset that the points speak for.
//!
//! Every holder is some micrometres off. The tooth that reaches farthest then makes the wall alone, and where the chip is thin the
//! others lift off and lose their edge force: that lowers the error, most where it is largest, and changes its shape over the
//! height. No stiffness says the same; a fit without it makes the cutter smaller than it is. A few offsets are tried, each believed in
//! as far as holders have it, then those between the most probable one and its neighbours: an offset a few micrometres too large is made
//! up for by a machine half as stiff again, which only the belief in the stated stiffness tells from the truth. The most probable is
//! taken as if the job had stated it.

use rayon::prelude::*;
use truepath_core::cut::{Runout, WallLaw};
use truepath_core::units::{Offset, Real};
use truepath_ground::length::Unit;
use truepath_ground::units::mm;
use truepath_job::pass::Pass;

use crate::discrepancy::{PartCut, is_fitted, ln_evidence, plain, plain_from};
use crate::identification::{Found as Fit, asked};
use crate::plausible::is_possible;

/// Offsets that are tried, µm, with what is believed of each (natural logarithm): most holders are good ones.
const TRIED: [(i32, f64); 6] = [(0, -0.7), (2, -1.6), (4, -1.9), (7, -2.5), (11, -3.5), (16, -4.5)];
/// So many of them are tried whatever they say: a cutter that runs out by more is told from one that runs true by the smallest
/// offset already, and a fit with one is dear.
const SMALL: usize = 2;
/// Times that offsets half way to the neighbours of the most probable one are tried.
const HALVINGS: usize = 2;
/// By how much one must be more probable than a cutter that runs true, natural logarithm: 400 : 1, as wear and stock look alike, and
/// 20 : 1 where a cutter that runs true would have a size, or a machine, that cannot be.
const DECISIVE: [f64; 2] = [6.0, 3.0];

/// The cutter of a pass as its points have it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Found {
    /// Radial offset of its axis, towards a tooth.
    pub offset: Offset,
    /// How many times as probable that is as a cutter that runs true, natural logarithm.
    pub ln_odds: f64,
}

impl Found {
    /// In words.
    pub fn words(&self, unit: Unit) -> String {
        format!(
            "the points speak for a cutter that runs out by about {:.3} {} ({}): measure it, and write runout_mm, half of what a dial indicator swings, in [tool]; the correction follows the points",
            unit.of(mm(self.offset)),
            unit.name(),
            odds(self.ln_odds)
        )
    }
}

fn odds(ln: f64) -> String {
    if ln > 7.0 {
        "more than 1000 : 1 against one that runs true".to_owned()
    } else {
        format!("{:.0} : 1 against one that runs true", ln.exp())
    }
}

/// Whether points may say how far a cutter runs out: the job does not, and its parts are fitted with what the model lacks.
pub fn is_open(pass: &Pass) -> bool {
    let stated = ["tool.runout_mm", "tool.runout_from"].iter().any(|key| pass.job.gives(key));
    !stated && is_fitted(pass) && asked(pass.core.job.force.model) != Some(WallLaw::Mean)
}

/// What the points of cuts say of the runout of their cutter, by groups of cuts that are fitted each by themselves: of all that
/// belong together. `None` where they do not speak for any. `fits` are left the [`plain()`] fits of a cutter that runs true, where it is
/// asked for.
pub fn found(groups: &[(&Pass, Vec<PartCut<'_>>)], fits: &mut Vec<Fit>) -> Option<Found> {
    if groups.is_empty() || !groups.iter().all(|(pass, _)| is_open(pass)) {
        return None;
    }
    let mut ascending = TRIED.iter().map(|(um, belief)| (Offset::from_um(i64::from(*um)), *belief));
    let runs_true = Tried::of(ascending.next()?, groups, None)?;
    fits.clone_from(&runs_true.fits);
    let mut tried = vec![runs_true.clone()];
    // A larger one only where the largest so far is the most probable; the smallest is tried whatever the points say.
    for larger in ascending {
        let last = tried.last()?;
        if tried.len() >= SMALL && best(&tried)?.offset != last.offset {
            break;
        }
        let next = Tried::of(larger, groups, Some(last))?;
        tried.push(next);
    }
    let decisive = DECISIVE[usize::from(!runs_true.is_possible)];
    let is_told = |best: &&Tried| best.offset != Offset::ZERO && best.ln - runs_true.ln > decisive;
    best(&tried).filter(is_told)?;
    for _ in 0..HALVINGS {
        let near = best(&tried)?;
        let probable = |at: &(Offset, f64)| Tried::of(*at, groups, Some(near));
        let between: Vec<Tried> = beside_best(&tried)?.par_iter().filter_map(probable).collect();
        tried.extend(between);
        tried.sort_by_key(|one| one.offset);
    }
    let best = best(&tried)?;
    Some(Found { offset: best.offset, ln_odds: best.ln - runs_true.ln })
}

fn best(tried: &[Tried]) -> Option<&Tried> {
    tried.iter().max_by(|a, b| a.ln.total_cmp(&b.ln))
}

/// Half way from the most probable of some offsets, which ascend, to its neighbours, and what is believed there.
fn beside_best(tried: &[Tried]) -> Option<Vec<(Offset, f64)>> {
    let best = best(tried)?;
    let at = tried.iter().position(|one| one.offset == best.offset)?;
    let neighbours = [at.checked_sub(1), Some(at + 1)].into_iter().flatten().filter_map(|at| tried.get(at));
    let half_way = |other: &Tried| {
        let offset = Offset::from_nm((best.offset.nm() + other.offset.nm()) / 2);
        (offset, 0.5 * (best.belief + other.belief))
    };
    Some(neighbours.map(half_way).collect())
}

/// An offset that was tried.
#[derive(Clone, Debug)]
struct Tried {
    offset: Offset,
    /// What is believed of it, natural logarithm.
    belief: f64,
    /// How probable the points are with it, and it by itself, natural logarithm.
    ln: f64,
    /// Whether cutter and machine that the points then have can be.
    is_possible: bool,
    /// The fits of the groups.
    fits: Vec<Fit>,
}

impl Tried {
    /// An offset, and what is believed of it, by groups of cuts; from another that was tried it is not far.
    fn of((offset, belief): (Offset, f64), groups: &[(&Pass, Vec<PartCut<'_>>)], near: Option<&Self>) -> Option<Self> {
        let fit = |(at, (pass, cuts)): (usize, &(&Pass, Vec<PartCut<'_>>))| {
            with_offset(pass, cuts, offset, near.and_then(|near| near.fits.get(at)))
        };
        let each = groups.iter().enumerate().map(fit);
        let (lns, fits): (Vec<f64>, Vec<Fit>) = each.collect::<Option<Vec<_>>>()?.into_iter().unzip();
        let ln = belief + lns.iter().sum::<f64>();
        let is_possible = fits.iter().all(|fit| is_possible(&fit.core));
        Some(Self { offset, belief, ln, is_possible, fits })
    }
}

/// The passes of walls with the cutter that their points speak for; as they are where these do not, with the [`plain()`] fits of their
/// groups where these were made.
pub fn passes(walls: &[&Pass], groups: &[(&Pass, Vec<PartCut<'_>>)]) -> (Vec<Pass>, Vec<Fit>) {
    let mut fits = Vec::new();
    match found(groups, &mut fits) {
        Some(found) => {
            let said = |pass: &Pass| pass.unit().remark(|unit| found.words(unit));
            (walls.iter().map(|pass| pass.running_out(found.offset, said(pass))).collect(), Vec::new())
        }
        None => (walls.iter().map(|pass| (*pass).clone()).collect(), fits),
    }
}

/// How probable the points are with an offset, natural logarithm, and their fit, which goes on from one with another offset if that is
/// of the same law.
fn with_offset(pass: &Pass, cuts: &[PartCut<'_>], offset: Offset, near: Option<&Fit>) -> Option<(f64, Fit)> {
    let runout = Runout { offset, behind: Real::ZERO };
    let cuts: Vec<PartCut<'_>> =
        cuts.iter().map(|cut| PartCut { path: cut.path.with_runout(runout), ..*cut }).collect();
    // The mean law knows no tooth: one that runs out is of the helical law.
    let law = if offset == Offset::ZERO { asked(pass.core.job.force.model) } else { Some(WallLaw::Helical) };
    let found = match near.filter(|near| law == Some(near.core.law)) {
        Some(near) => plain_from(pass, near, &cuts),
        None => plain(pass, law, &cuts, &mut |_| ()),
    };
    Some((ln_evidence(&found, &cuts)?, found))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn between_the_most_probable_offset_and_its_neighbours_is_looked_half_way() {
        let tried =
            |um, belief, ln| Tried { offset: Offset::from_um(um), belief, ln, is_possible: true, fits: Vec::new() };
        let nanometres = |tried: &[Tried]| {
            beside_best(tried).map(|all| all.iter().map(|(offset, _)| offset.nm()).collect::<Vec<i64>>())
        };
        let mut all = vec![tried(0, -0.7, 1.0), tried(4, -1.9, 5.0), tried(7, -2.5, 9.0), tried(11, -3.5, 8.0)];
        assert_eq!(beside_best(&all).map(|all| all[0].1), Some(-2.2));
        assert_eq!(nanometres(&all), Some(vec![5500, 9000]));
        all.pop();
        assert_eq!(nanometres(&all), Some(vec![5500]), "nothing is tried beyond the largest");
        assert_eq!(nanometres(&[]), None);
    }
}
