//! What the probe points say about machine and material.

use super::{ContourPass, ForceModel, JobError};
use crate::cut::{ForceTable, Loop, Path, WallLaw};
use crate::geometry::Vector;
use crate::identify::{Cut, Fit, Observation, PredictionWorkspace, Prior, identify, identify_law};

/// Machine and material of a pass.
#[derive(Clone, Copy, Debug)]
pub struct Identified {
    /// The wall law, given or found.
    pub law: WallLaw,
    /// What was believed before.
    pub prior: Prior,
    /// What is known now.
    pub fit: Fit,
}

/// Fits machine and material to the measurement of an uncorrected part. On return the observations hold predictions and
/// weights. `observe` is told the share of the longest possible fit that is done, ‰.
pub fn identified(
    pass: &ContourPass,
    path: &Path,
    observations: &mut [Observation],
    workspace: &mut PredictionWorkspace,
    observe: &mut dyn FnMut(u16),
) -> Identified {
    let uncorrected = |_, _| Vector::ZERO;
    let law = match pass.job.force.model {
        ForceModel::Auto => {
            let around = |law| pass.prior(law);
            let (law, prior, fit) = identify_law(path, around, observations, uncorrected, workspace, observe);
            return Identified { law, prior, fit };
        }
        ForceModel::Mean => WallLaw::Mean,
        ForceModel::Helical => WallLaw::Helical,
    };
    let prior = pass.prior(law);
    let cuts = [Cut { path: path.with_law(law), points: observations.len(), part: 0 }];
    let fit = identify(&cuts, (&prior, None), &mut [], observations, uncorrected, workspace, observe);
    Identified { law, prior, fit }
}

impl Identified {
    /// Points most of which contradict each other or the job are no basis for a correction.
    ///
    /// # Errors
    /// [`JobError::Unfit`] when more than half of the points do not fit.
    pub fn check(&self, observations: &[Observation]) -> Result<(), JobError> {
        let points = observations.len();
        match observations.iter().max_by_key(|o| o.residual().abs()) {
            Some(worst) if self.fit.outliers.saturating_mul(2) > points => Err(JobError::Unfit {
                outliers: self.fit.outliers as u32,
                points: points as u32,
                s: worst.s,
                measured: worst.error,
                fitting: worst.predicted,
            }),
            _ => Ok(()),
        }
    }

    /// The identified machine on a path.
    pub const fn machine<'a>(&self, path: &'a Path<'a>, table: &'a ForceTable) -> Loop<'a> {
        self.fit.parameters.machine(path, table)
    }
}
