//! How far the corrected wall may be from where it is predicted, from the covariance of the fit.

use super::design::{Design, DesignWorkspace, walls};
use super::node::{Node, commanded};
use super::profile::Profile;
use super::reader::WallReader;
use super::scratch::Deviation;
use crate::cut::{ForceTable, Loop};
use crate::identify::{Fit, Prior, neighbours};
use truepath_units::{Offset, Real, hypot_nm};

/// Standard deviations of the walls that a correction leaves, beside each sample, from the covariance of the fit: of the
/// error the target aims at and of the deepest height.
///
/// The machine is displaced along each column of a square root of the covariance and cut again with the correction
/// held; the squares add up. `workspace.profiles` must hold the walls of the correction and is overwritten. Every slot
/// of `workspace.scratch` then holds a [`Deviation`].
pub(super) fn deviations(
    machine: &Loop,
    belief: (&Prior, &Fit),
    wanted: &Design,
    nodes: &[Node],
    workspace: &mut DesignWorkspace<'_, impl WallReader>,
) {
    let slots = core::mem::take(&mut workspace.scratch);
    for (slot, wall) in slots.iter_mut().zip(workspace.profiles.iter()) {
        let (aimed, deepest) = (wall.aim(wanted.target, None), wall.deepest());
        *slot = Deviation { aimed, sigma_of_aimed: Offset::ZERO, deepest, sigma_of_deepest: Offset::ZERO }.into();
    }
    spread(machine, belief, wanted, nodes, workspace, &mut |index, wall, share| {
        if let Some(slot) = slots.get_mut(index) {
            let mut known = slot.deviation();
            known.sigma_of_aimed =
                hypot_nm(known.sigma_of_aimed, (wall.aim(wanted.target, None) - known.aimed).scaled(share));
            known.sigma_of_deepest = hypot_nm(known.sigma_of_deepest, (wall.deepest() - known.deepest).scaled(share));
            *slot = known.into();
        }
    });
    workspace.scratch = slots;
}

/// Cuts the corrected contour once on every machine that lies a column of the covariance's square root away, and hands
/// each wall, with its index on the contour and its share, to `take`. The square root of the sum of the squared changes of a quantity, each times its share, is
/// its standard deviation. The walls of the workspace are overwritten.
#[inline(never)]
fn spread(
    machine: &Loop,
    (prior, fit): (&Prior, &Fit),
    wanted: &Design,
    nodes: &[Node],
    workspace: &mut DesignWorkspace<'_, impl WallReader>,
    take: &mut dyn FnMut(usize, &Profile, Real),
) {
    let path = machine.path;
    let mut table = ForceTable::BLANK;
    table.tabulate(machine.table.size_exponent());
    for (parameters, share) in neighbours(prior, fit) {
        // The last columns move nothing but the datum of the part that was probed: the wall stays where it is.
        if parameters.machine(path, &table).cuts_as(machine) {
            continue;
        }
        if parameters.coefficients.size_exponent != table.size_exponent() {
            table.tabulate(parameters.coefficients.size_exponent);
        }
        let displaced = parameters.machine(path, &table);
        let by_nodes = |index| commanded(path, nodes, index);
        workspace.reader.run(&displaced, path.working().start, workspace.states, by_nodes, &mut |_| ());
        walls(&displaced, wanted, workspace);
        workspace.profiles.iter().enumerate().for_each(|(index, wall)| take(index, wall, share));
    }
}
