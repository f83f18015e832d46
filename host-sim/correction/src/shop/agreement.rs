//! Whether the points of a part agree with what the shop expects of it.

use truepath_ground::units::float;
use truepath_job::pass::Pass;

use super::quantities::Quantity;
use crate::discrepancy::{PartCut, ln_evidence, plain};
use crate::identification::asked;

/// How a warning begins that the points are fitted without what other jobs say.
pub const CONTRADICTED: &str = "the points of this part contradict what other jobs of the shop say";

/// How much more probable the points must be without an expectation before it is dropped, natural logarithm, 20 : 1: what other jobs say
/// is of this one in 19 of 20 cases, and of another machine, holder or material, wrongly named, in one.
const DECISIVE: f64 = 3.0;

/// What became of an expectation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Agreement {
    /// How many times as probable the points are with it as without it, natural logarithm.
    pub ln_odds: f64,
    /// What the points contradict most, and how far its value is from the expected one, standard deviations.
    pub farthest: (Quantity, f64),
}

impl Agreement {
    /// Whether the points are fitted with the expectation.
    pub fn is_kept(&self) -> bool {
        self.ln_odds >= -DECISIVE
    }
}

/// Whether the points of cuts agree with what is believed of the machine and material of their pass; `None` where nothing is.
pub(crate) fn agreement(pass: &Pass, cuts: &[PartCut<'_>]) -> Option<Agreement> {
    pass.core.believed?;
    let fit = |pass: &Pass| {
        let found = plain(pass, asked(pass.core.job.force.model), cuts, &mut |_| ());
        ln_evidence(&found, cuts).map(|ln| (ln, found))
    };
    let stated = as_stated(pass);
    let (with, without) = rayon::join(|| fit(pass), || fit(&stated));
    let ((with, found), (without, _)) = (with?, without?);
    let theta = |quantity: Quantity| float(found.core.fit.theta[quantity as usize]).abs();
    let farthest = Quantity::ALL.into_iter().map(|quantity| (quantity, theta(quantity)));
    Some(Agreement { ln_odds: with - without, farthest: farthest.max_by(|a, b| a.1.total_cmp(&b.1))? })
}

/// A pass with what its points leave of what was believed, and a sentence about it.
pub(crate) fn after(pass: &Pass, agreement: Option<Agreement>) -> Pass {
    if pass.core.believed.is_none() {
        return pass.clone();
    }
    match agreement {
        Some(agreement) if agreement.is_kept() => pass.clone(),
        contradicted => {
            let mut pass = as_stated(pass);
            pass.warnings.push(contradicted.map_or_else(
                || "what other jobs of the shop say was not used: it cannot be compared with these points".into(),
                |agreement| agreement.words().into(),
            ));
            pass
        }
    }
}

fn as_stated(pass: &Pass) -> Pass {
    let mut pass = pass.clone();
    pass.core.believed = None;
    pass
}

impl Agreement {
    fn words(&self) -> String {
        let (quantity, sigmas) = self.farthest;
        format!(
            "{CONTRADICTED}, most of all about {} (by {sigmas:.1} standard deviations): the correction follows the points; see that machine, holder, cutter and material in [store] are those of this part",
            quantity.words()
        )
    }
}
