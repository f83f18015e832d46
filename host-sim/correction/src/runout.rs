//! How far a cutter runs out, where the job does not say: the offset that the points speak for.
//!
//! Every holder is some micrometres off. The tooth that reaches farthest then makes the wall alone, and where the chip is thin the
//! others lift off and lose their edge force: that lowers the error, most where it is largest, and changes its shape over the
//! height. No stiffness says the same; a fit without it makes the cutter smaller than it is. A few offsets are tried, each believed in
//! as far as holders have it, and the most probable is taken as if the job had stated it.

use rayon::prelude::*;
use truepath_core::cut::{Runout, WallLaw};
use truepath_core::units::{Offset, Real};
use truepath_ground::units::mm;
use truepath_job::pass::Pass;

use crate::discrepancy::{PartCut, is_fitted, ln_evidence, plain};
use crate::identification::asked;
use crate::plausible::is_possible;

/// Offsets that are tried, µm, with what is believed of each (natural logarithm): most holders are good ones.
const TRIED: [(i32, f64); 6] = [(0, -0.7), (2, -1.6), (4, -1.9), (7, -2.5), (11, -3.5), (16, -4.5)];
/// So many of them are tried at once.
const SMALL: usize = 3;
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
    pub fn words(&self) -> String {
        format!(
            "the points speak for a cutter that runs out by about {:.3} mm ({}): measure it, and write runout_mm, half of what a dial indicator swings, in [tool]; the correction follows the points",
            mm(self.offset),
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
/// belong together. `None` where they do not speak for any.
pub fn found(groups: &[(&Pass, Vec<PartCut<'_>>)]) -> Option<Found> {
    if groups.is_empty() || !groups.iter().all(|(pass, _)| is_open(pass)) {
        return None;
    }
    let probable = |(um, belief): &(i32, f64)| {
        let offset = Offset::from_um(i64::from(*um));
        let each = groups.iter().map(|(pass, cuts)| ln_probability(pass, cuts, offset));
        let all: Option<Vec<(f64, bool)>> = each.collect();
        all.map(|all| Tried {
            offset,
            ln: belief + all.iter().map(|(ln, _)| ln).sum::<f64>(),
            is_possible: all.iter().all(|(_, is_possible)| *is_possible),
        })
    };
    let (small, large) = TRIED.split_at(SMALL);
    let mut tried: Vec<Tried> = small.par_iter().filter_map(probable).collect();
    let runs_true = *tried.iter().find(|one| one.offset == Offset::ZERO)?;
    let best = |tried: &[Tried]| tried.iter().copied().max_by(|a, b| a.ln.total_cmp(&b.ln));
    // A larger one only where the largest so far is the most probable.
    for larger in large {
        if best(&tried)?.offset != tried.last()?.offset {
            break;
        }
        tried.push(probable(larger)?);
    }
    let best = best(&tried)?;
    let ln_odds = best.ln - runs_true.ln;
    let decisive = DECISIVE[usize::from(!runs_true.is_possible)];
    (best.offset != Offset::ZERO && ln_odds > decisive).then_some(Found { offset: best.offset, ln_odds })
}

/// An offset that was tried.
#[derive(Clone, Copy, Debug)]
struct Tried {
    offset: Offset,
    /// How probable the points are with it, and it by itself, natural logarithm.
    ln: f64,
    /// Whether cutter and machine that the points then have can be.
    is_possible: bool,
}

/// The passes of walls with the cutter that their points speak for; as they are where these do not.
pub fn passes(walls: &[&Pass], groups: &[(&Pass, Vec<PartCut<'_>>)]) -> Vec<Pass> {
    let found = found(groups);
    let with =
        |pass: &&Pass| found.map_or_else(|| (*pass).clone(), |found| pass.running_out(found.offset, found.words()));
    walls.iter().map(with).collect()
}

fn ln_probability(pass: &Pass, cuts: &[PartCut<'_>], offset: Offset) -> Option<(f64, bool)> {
    let runout = Runout { offset, behind: Real::ZERO };
    let cuts: Vec<PartCut<'_>> =
        cuts.iter().map(|cut| PartCut { path: cut.path.with_runout(runout), ..*cut }).collect();
    // The mean law knows no tooth: one that runs out is of the helical law.
    let law = if offset == Offset::ZERO { asked(pass.core.job.force.model) } else { Some(WallLaw::Helical) };
    let found = plain(pass, law, &cuts, &mut |_| ());
    Some((ln_evidence(&found, &cuts)?, is_possible(&found.core)))
}
