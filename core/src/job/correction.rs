//! What the job wants of a correction, and whether the correction stays inside its clamp.

use super::{ContourPass, Job, JobError, LawName};
use crate::correct::{Band, Design, Law, Node, PaperRatio, PaperTransfer};
use crate::cut::{Loop, Path, State};
use crate::geometry::Vector;
use crate::probe::Contact;
use crate::units::{Offset, Position, Real};

impl Job {
    /// What the job wants of a correction by a law.
    pub fn design(&self, law: Law) -> Design {
        let depth = self.cut.axial_depth;
        let [from, to] = self.correct.band;
        Design {
            law,
            target: self.correct.target,
            band: Band { from: from.over(depth), to: to.over(depth) },
            max_gouge: self.correct.max_gouge,
        }
    }
}

/// The law the job names, with what it needs of the measurement.
pub fn law(pass: &ContourPass, machine: &Loop, contacts: &[Contact]) -> Law {
    match pass.job.correct.law {
        LawName::Model => Law::Model,
        LawName::Mirror => Law::Mirror,
        LawName::Paper => Law::Paper(paper_transfer(pass, machine, contacts)),
    }
}

/// P23 eq. (9) from one probe per wall: for each axis the contact whose normal is nearest to it, at mid-height where
/// there are several.
fn paper_transfer(pass: &ContourPass, machine: &Loop, contacts: &[Contact]) -> PaperTransfer {
    let path = machine.path;
    let ratio = |component: fn(&Contact) -> Real, coordinate: fn(&Contact, Offset) -> (Position, Offset)| {
        let best = contacts.iter().max_by_key(|c| (component(c).abs(), -(c.height - Real::HALF).abs()));
        let Some(contact) = best.filter(|c| component(c).abs() > Real::ratio(1, 100)) else {
            return PaperRatio::default();
        };
        let (position, displacement) = coordinate(contact, pass.setup.radius);
        let mut state = State::REST;
        machine.run(path.index_at(contact.s), core::slice::from_mut(&mut state), |_| Vector::ZERO);
        PaperRatio::new(position - Position::ZERO, displacement, state.engaged)
    };
    PaperTransfer {
        x: ratio(|c| c.normal.x, |c, r| (c.point.x - r.scaled(c.normal.x), -c.error.scaled(c.normal.x))),
        y: ratio(|c| c.normal.y, |c, r| (c.point.y - r.scaled(c.normal.y), -c.error.scaled(c.normal.y))),
    }
}

/// The larger component of a correction.
fn size(node: &Node) -> Offset {
    let total = node.total();
    total.x.abs().max(total.y.abs())
}

/// The larger component of the correction at its worst place, nothing for no nodes.
pub fn largest(nodes: &[Node]) -> Offset {
    nodes.iter().map(size).max().unwrap_or_default()
}

/// A correction cut by the clamp is an error, never silent.
///
/// # Errors
/// [`JobError::BeyondClamp`] with the worst place.
pub fn check_clamp(job: &Job, path: &Path, nodes: &[Node]) -> Result<(), JobError> {
    let clamp = job.correct.clamp;
    let samples = path.samples().iter().skip(path.first());
    match nodes.iter().zip(samples).max_by_key(|(node, _)| size(node)) {
        Some((node, sample)) if size(node) > clamp => {
            Err(JobError::BeyondClamp { reach: size(node), clamp, at: sample.point })
        }
        _ => Ok(()),
    }
}
