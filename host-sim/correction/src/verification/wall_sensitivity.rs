//! Sensitivity of the corrected wall, which is to become certain.
//!
//! The correction is held and the machine is another one: every unknown is displaced to both sides and the pass cut
//! again, heights and envelope included. The change of the target quantity beside every sample is what the unknown does
//! to the corrected wall; with the covariance of the unknowns it gives its standard deviation there.

use truepath_core::correct::{Design, Node, Profile, profile};
use truepath_core::cut::{Path, State};
use truepath_core::geometry::Vector;
use truepath_core::identify::{COUNT, Parameter, Parameters};
use truepath_core::units::{Offset, Real};
use truepath_ground::units::{float, mm};

use super::covariance::Row;
use super::estimate::{Estimate, of_measurement};
use crate::correction::Identification;
use crate::force_tables::force_table;

/// Step of the difference quotients, in standard deviations of what the job states.
const DIFFERENCE: Real = Real::ratio(1, 8);
/// Between two places of the wall, at least, mm.
const SPACING: f64 = 0.4;

/// The corrected wall along a contour: what the unknowns do to it.
#[derive(Clone, Debug, Default)]
pub struct WallSensitivity {
    /// Place along the contour, mm, and the change of the target quantity per standard deviation of the prior, mm.
    pub(super) rows: Vec<(f64, Row)>,
}

impl WallSensitivity {
    /// Of a correction on a path under the identified wall law. `progress` is told the share done, 0…1.
    pub fn of(
        path: &Path,
        identified: &Identification,
        wanted: &Design,
        nodes: &[Node],
        progress: &mut dyn FnMut(f64),
    ) -> Self {
        let fit = identified.fit();
        let estimate = Estimate { prior: identified.prior(), theta: fit.theta, nodes };
        let samples = &path.samples()[path.first()..path.first() + path.count()];
        let mut kept: Vec<usize> = Vec::new();
        for (k, sample) in samples.iter().enumerate().filter(|(_, s)| s.on_wall && !s.near_corner) {
            if kept.last().is_none_or(|&last| mm(sample.s - samples[last].s) >= SPACING) {
                kept.push(k);
            }
        }
        let mut rows: Vec<(f64, Row)> = kept.iter().map(|&k| (mm(samples[k].s), [0.0; COUNT])).collect();
        for (k, parameter) in Parameter::ALL.into_iter().enumerate() {
            progress(k as f64 / COUNT as f64);
            if of_measurement(parameter) || estimate.prior.sigma[k] == Real::ZERO {
                continue;
            }
            let wall = |by| wall(path, &estimate, &estimate.displaced(k, by), wanted);
            let (above, below) = (wall(DIFFERENCE), wall(-DIFFERENCE));
            for ((_, row), &at) in rows.iter_mut().zip(&kept) {
                row[k] = mm(above[at] - below[at]) / (2.0 * float(DIFFERENCE));
            }
        }
        Self { rows }
    }
}

/// The target quantity beside every sample when a machine of these parameters cuts with the correction.
fn wall(path: &Path, estimate: &Estimate, parameters: &Parameters, wanted: &Design) -> Vec<Offset> {
    let table = force_table(parameters);
    let machine = parameters.machine(path, &table);
    let working = path.working();
    let mut states = vec![State::REST; working.len()];
    machine.run(working.start, &mut states, |i| estimate.commanded(path, i));
    let mut displacements = vec![Vector::ZERO; states.len()];
    let mut profiles = vec![Profile::default(); path.count()];
    profile(&machine, &states, wanted.band, &mut displacements, &mut profiles);
    profiles.iter().map(|p| p.aim(wanted.target, None)).collect()
}
