//! How far the corrected wall may be from where it is predicted, from the covariance of the fit.

use super::design::{Design, DesignWorkspace, Predicted, walls};
use super::node::{Node, commanded};
use super::profile::Profile;
use crate::cut::{ForceTable, Loop};
use crate::identify::{Fit, Prior};
use crate::units::{Offset, Real};

/// Standard deviation of the corrected wall error beside each sample, from the covariance of the fit.
///
/// The machine is displaced along each column of a square root of the covariance and cut again with the correction
/// held; the squares add up. `workspace.profiles` must hold the corrected wall ([`design`](super::design::design) leaves it so) and is
/// overwritten; `sigma` is as long as the contour's own samples.
pub fn uncertainty(
    machine: &Loop,
    belief: (&Prior, &Fit),
    wanted: &Design,
    nodes: &[Node],
    predicted: &[Predicted],
    sigma: &mut [Offset],
    workspace: &mut DesignWorkspace,
) {
    sigma.fill(Offset::ZERO);
    spread(machine, belief, wanted, nodes, workspace, &mut |index, p| {
        if let (Some(s), Some(base)) = (sigma.get_mut(index), predicted.get(index)) {
            let change = p.aim(wanted.target, None) - base.after.aim(wanted.target, None);
            *s = crate::units::hypot_nm(*s, change);
        }
    });
}

/// Cuts the corrected contour once on every machine that lies a column of the covariance's square root away, and hands
/// each wall, with its index on the contour, to `take`. The square root of the sum of the squared changes of a quantity is
/// its standard deviation. The walls of the workspace are overwritten.
#[inline(never)]
pub(super) fn spread(
    machine: &Loop,
    (prior, fit): (&Prior, &Fit),
    wanted: &Design,
    nodes: &[Node],
    workspace: &mut DesignWorkspace,
    take: &mut dyn FnMut(usize, &Profile),
) {
    let path = machine.path;
    let mut table = ForceTable::BLANK;
    table.tabulate(machine.table.size_exponent());
    for column in crate::identify::square_root(&fit.covariance) {
        if column.iter().all(|v| v.abs() < Real::ratio(1, 1000)) {
            continue;
        }
        let mut moved = fit.theta;
        for (t, c) in moved.iter_mut().zip(&column) {
            *t += *c;
        }
        let parameters = prior.at(&moved);
        if parameters.coefficients.size_exponent != table.size_exponent() {
            table.tabulate(parameters.coefficients.size_exponent);
        }
        let displaced = parameters.machine(path, &table);
        displaced.run(path.working().start, workspace.states, |i| commanded(path, nodes, i));
        walls(&displaced, wanted, workspace);
        workspace.profiles.iter().enumerate().for_each(|(index, wall)| take(index, wall));
    }
}
