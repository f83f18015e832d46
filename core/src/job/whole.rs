//! The whole way from job, program and measurement to the bytes of an image.

use serde::{Deserialize, Serialize};

use super::stage::Gauge;
use super::workspace::room;
use super::{
    Buffer, ContourPass, Counts, Identified, Job, JobError, Stage, Workspace, array, correction, identification,
    measure,
};
use crate::correct::{DesignStep, DesignWorkspace, Guarded, InOrder, Node, Profile, Target, guarded_design};
use crate::cut::{ForceTable, Path, WallLaw};
use crate::identify::PredictionWorkspace;
use crate::probe::Contact;
use crate::units::{Offset, Real};

/// An image that was made, and what it says about the machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Made {
    /// Bytes of the image, from the start of the buffer.
    pub bytes: u32,
    /// Its nodes.
    pub nodes: u32,
    /// Its checksum, which also serves as its name.
    pub crc: u32,
    /// Identified stiffness along x, N/mm, with the tangential chip coefficient as stated in the job.
    #[serde(with = "super::wire")]
    pub stiffness_x: Real,
    /// Identified stiffness along y, N/mm.
    #[serde(with = "super::wire")]
    pub stiffness_y: Real,
    /// The wall law, given or found.
    #[serde(with = "super::wire")]
    pub wall_law: WallLaw,
    /// Contacts used.
    pub points: u32,
    /// Of these, points the fit gave little weight.
    pub outlying: u32,
    /// Readings set aside before the fit.
    pub set_aside: u32,
    /// Largest component of the correction at the programmed feed.
    pub largest: Offset,
    /// Largest predicted wall error, of the target quantity, without correction.
    pub error_before: Offset,
    /// Largest predicted wall error with it.
    pub error_after: Offset,
    /// Places where the elastic loop did not settle.
    pub unsettled: u32,
    /// Passes of the cutter that were computed.
    pub passes: u16,
}

/// Makes the image of a job from a program and a measurement of the part that was cut with it. The same inputs give
/// the same bytes on every machine. `progress` is told the stage and the share of it that is done, ‰; a stage may end
/// before 1000.
///
/// # Errors
/// Whatever is wrong with the three, a correction that must not be made, and buffers too short.
pub fn image(
    job: &Job,
    program: &[u8],
    probe: &[u8],
    workspace: &mut Workspace<'_>,
    out: &mut [u8],
    progress: &mut impl FnMut(Stage, u16),
) -> Result<Made, JobError> {
    let mut gauge = Gauge::new(progress);
    gauge.tell(Stage::Reading, 0);
    let pass = ContourPass::read(job, program, &mut workspace.parameters, workspace.blocks)?;
    // Refused now and not after minutes of work.
    pass.binding()?;
    let blocks = workspace.blocks.get(..pass.contour.blocks).unwrap_or_default();
    let contour = ContourPass::path_contour(blocks)?;

    gauge.tell(Stage::Sampling, 0);
    let sampled = pass.sample(&contour, workspace.samples, |_| ())?;
    let (count, working) = (sampled.count(), sampled.working().len());
    let nodes = [workspace.profiles.len(), workspace.updates.len(), workspace.nodes.len(), workspace.scratch.len()];
    room(Buffer::Nodes, count, nodes.into_iter().min().unwrap_or(0))?;
    let needed = Counts::needed(&contour, &sampled, 0);
    room(Buffer::States, needed.states, workspace.states.len().min(workspace.displacements.len()))?;

    gauge.tell(Stage::Contacts, 0);
    let mut set_aside = 0u32;
    let (readings, contacts) = (&mut *workspace.readings, &mut *workspace.contacts);
    let found = measure::contacts(&pass, contour, probe, readings, contacts, |_, _| {
        set_aside = set_aside.saturating_add(1);
    })?;
    let contacts = workspace.contacts.get(..found).unwrap_or_default();
    let noise = pass.job.probe.map_or(Offset::ZERO, |p| p.noise);
    let observations = measure::observations(contacts, noise, workspace.observations)?;

    gauge.tell(Stage::Identification, 0);
    let mut lent = PredictionWorkspace { states: workspace.states, displacements: workspace.displacements };
    let identified = identification::identified(&pass, &sampled, observations, &mut lent, &mut |permille| {
        gauge.tell(Stage::Identification, permille);
    });
    identified.check(observations)?;

    gauge.tell(Stage::Design, 0);
    let path = sampled.with_law(identified.law);
    let nodes = workspace.nodes.get_mut(..count).unwrap_or_default();
    let mut lent = DesignWorkspace {
        states: workspace.states.get_mut(..working).unwrap_or_default(),
        displacements: workspace.displacements.get_mut(..working).unwrap_or_default(),
        profiles: workspace.profiles.get_mut(..count).unwrap_or_default(),
        updates: workspace.updates.get_mut(..count).unwrap_or_default(),
        scratch: workspace.scratch.get_mut(..count).unwrap_or_default(),
        residual: &[],
        beside_sigma: &[],
        reader: InOrder,
    };
    let designed = designed(&pass, &path, &identified, contacts, nodes, &mut lent, &mut |permille| {
        gauge.tell(Stage::Design, permille);
    });
    correction::check_clamp(job, &path, nodes)?;
    let largest = correction::largest(nodes);

    gauge.tell(Stage::Image, 0);
    array::to_nominal_feed(&pass, &identified, &path, blocks, nodes)?;
    let written = array::write_image(&pass, &identified, &path, blocks, nodes, out)?;
    gauge.tell(Stage::Image, 1000);
    let compliance = &identified.fit.parameters.compliance;
    Ok(Made {
        bytes: written.bytes as u32,
        nodes: written.nodes as u32,
        crc: written.crc,
        stiffness_x: Real::from_int(1000) / compliance.xx(),
        stiffness_y: Real::from_int(1000) / compliance.yy(),
        wall_law: identified.law,
        points: found as u32,
        outlying: identified.fit.outliers as u32,
        set_aside,
        largest,
        error_before: designed.error_before,
        error_after: designed.error_after,
        unsettled: designed.unsettled,
        passes: designed.passes,
    })
}

/// What a design came to.
struct Designed {
    error_before: Offset,
    error_after: Offset,
    unsettled: u32,
    passes: u16,
}

/// Designs the correction of an identified pass. On its own, so that its force table and that of the identification do
/// not stand on the stack at the same time.
#[inline(never)]
fn designed(
    pass: &ContourPass,
    path: &Path,
    identified: &Identified,
    contacts: &[Contact],
    nodes: &mut [Node],
    lent: &mut DesignWorkspace,
    tell: &mut dyn FnMut(u16),
) -> Designed {
    let mut table = ForceTable::BLANK;
    table.tabulate(identified.fit.parameters.coefficients.size_exponent);
    let machine = identified.machine(path, &table);
    let wanted = pass.job.design(correction::law(pass, &machine, contacts));
    let (mut error_before, mut passes) = (Offset::ZERO, 0);
    let belief = (&identified.prior, &identified.fit);
    let mut made = Guarded { nodes, unguarded: &mut [], predicted: &mut [], sigma: &mut [], damped: None };
    let passage = guarded_design(&machine, belief, &wanted, &mut made, lent, &mut |step| match step {
        DesignStep::Uncorrected(walls) => error_before = worst(walls, wanted.target),
        DesignStep::Done { passes: done, permille } => {
            passes = done;
            tell(permille);
        }
    });
    let error_after = worst(lent.profiles, wanted.target);
    Designed { error_before, error_after, unsettled: passage.unsettled, passes }
}

/// The largest error of the target quantity.
fn worst(walls: &[Profile], target: Target) -> Offset {
    walls.iter().map(|p| p.aim(target, None).abs()).max().unwrap_or_default()
}
