//! The memory in which an image is made: buffers lent by the caller, and how much of each a contour needs.
//!
//! | per | bytes | what |
//! |---|---:|---|
//! | block of the contour | [`BLOCK_BYTES`] | geometry, feed, line |
//! | sample of the path, run-in and run-out of 2.8 radii each included | [`SAMPLE_BYTES`] | place, stock, feed |
//! | state: sample of the contour, and of half a radius on either side | [`STATE_BYTES`] | elastic loop, cutter position |
//! | node: sample of the contour | [`NODE_BYTES`] | wall profile, update, correction, scratch |
//! | probe point | [`POINT_BYTES`] | reading, contact, observation |
//!
//! Samples are 0.1 mm apart, with cutters below 5 mm a fiftieth of the diameter; a sharp inside corner takes up to 314
//! more. Besides, the parameters of the program take 10 KiB; program, measurement and image lie in memory, and 48 KiB
//! are taken from the stack of a Cortex-M7.

use heapless::Vec;

use super::{Buffer, JobError};
use crate::correct::{Node, Profile, Scratch, Update};
use crate::cut::{Path, Sample, State};
use crate::gcode::{DeviceMemory, Memory};
use crate::geometry::{Block, Contour, Direction, Vector};
use crate::identify::Observation;
use crate::probe::{Contact, Reading};
use crate::units::{Offset, Real};

/// Bytes a block of the contour takes.
pub const BLOCK_BYTES: usize = size_of::<Block>();
/// Bytes a sample of the path takes.
pub const SAMPLE_BYTES: usize = size_of::<Sample>();
/// Bytes a sample takes besides where the elastic loop is solved.
pub const STATE_BYTES: usize = size_of::<(State, Vector)>();
/// Bytes a sample of the contour takes besides.
pub const NODE_BYTES: usize = size_of::<(Profile, Update, Node, Scratch)>();
/// Bytes a probe point takes.
pub const POINT_BYTES: usize = size_of::<(Reading, Contact, Observation)>();

/// How many entries the buffers have, or a job needs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Counts {
    /// Lines and arcs of the contour.
    pub blocks: usize,
    /// Samples of the path, run-in and run-out included.
    pub samples: usize,
    /// Samples where the elastic loop is solved, and one more.
    pub states: usize,
    /// Samples of the contour itself.
    pub nodes: usize,
    /// Readings of the probe.
    pub points: usize,
}

impl Counts {
    /// What a contour sampled as a path and a number of readings need.
    pub fn needed(contour: &Contour, path: &Path, points: usize) -> Self {
        Self {
            blocks: contour.blocks().len(),
            samples: path.samples().len(),
            // Both ends of the stretch around a probed place count.
            states: path.working().len().saturating_add(1),
            nodes: path.count(),
            points,
        }
    }

    /// Bytes of all buffers together.
    pub const fn bytes(&self) -> usize {
        let path = self.samples.saturating_mul(SAMPLE_BYTES).saturating_add(self.states.saturating_mul(STATE_BYTES));
        let rest = self.blocks.saturating_mul(BLOCK_BYTES).saturating_add(self.points.saturating_mul(POINT_BYTES));
        path.saturating_add(self.nodes.saturating_mul(NODE_BYTES)).saturating_add(rest)
    }
}

/// The buffers, lent by the caller. What they hold before does not matter.
#[derive(Debug)]
pub struct Workspace<'a> {
    /// The parameters of the program.
    pub parameters: Memory<'a>,
    /// The contour.
    pub blocks: &'a mut [Block],
    /// The path.
    pub samples: &'a mut [Sample],
    /// The measurement file.
    pub readings: &'a mut [Reading],
    /// What of it is on the wall.
    pub contacts: &'a mut [Contact],
    /// The same for the fit.
    pub observations: &'a mut [Observation],
    /// The elastic loop.
    pub states: &'a mut [State],
    /// Cutter positions at a height; as many as states.
    pub displacements: &'a mut [Vector],
    /// Wall profiles; as many as nodes.
    pub profiles: &'a mut [Profile],
    /// Changes of the correction; as many as nodes.
    pub updates: &'a mut [Update],
    /// The correction.
    pub nodes: &'a mut [Node],
    /// The best correction so far, and what else is needed for a while; as many as nodes.
    pub scratch: &'a mut [Scratch],
}

/// Refuses unless a buffer has the entries needed.
pub(super) fn room(buffer: Buffer, needed: usize, lent: usize) -> Result<(), JobError> {
    if needed <= lent { Ok(()) } else { Err(JobError::full(buffer, needed, lent)) }
}

/// A workspace that owns its buffers, for a board: made empty (all zero but for what is never read), so that a static
/// one takes no room in flash, and filled when it is lent.
#[derive(Debug, Default)]
pub struct Buffers<
    const BLOCKS: usize,
    const SAMPLES: usize,
    const STATES: usize,
    const NODES: usize,
    const POINTS: usize,
> {
    parameters: DeviceMemory,
    blocks: Vec<Block, BLOCKS>,
    samples: Vec<Sample, SAMPLES>,
    readings: Vec<Reading, POINTS>,
    contacts: Vec<Contact, POINTS>,
    observations: Vec<Observation, POINTS>,
    states: Vec<State, STATES>,
    displacements: Vec<Vector, STATES>,
    profiles: Vec<Profile, NODES>,
    updates: Vec<Update, NODES>,
    nodes: Vec<Node, NODES>,
    scratch: Vec<Scratch, NODES>,
}

impl<const BLOCKS: usize, const SAMPLES: usize, const STATES: usize, const NODES: usize, const POINTS: usize>
    Buffers<BLOCKS, SAMPLES, STATES, NODES, POINTS>
{
    /// How many entries there are.
    pub const COUNTS: Counts =
        Counts { blocks: BLOCKS, samples: SAMPLES, states: STATES, nodes: NODES, points: POINTS };

    /// Empty buffers.
    pub const fn new() -> Self {
        Self {
            parameters: DeviceMemory::new(),
            blocks: Vec::new(),
            samples: Vec::new(),
            readings: Vec::new(),
            contacts: Vec::new(),
            observations: Vec::new(),
            states: Vec::new(),
            displacements: Vec::new(),
            profiles: Vec::new(),
            updates: Vec::new(),
            nodes: Vec::new(),
            scratch: Vec::new(),
        }
    }

    /// Lends all of them.
    pub fn workspace(&mut self) -> Workspace<'_> {
        let unseen = Observation::new(Offset::ZERO, Real::ZERO, Offset::ZERO, Offset::ZERO, Direction::X);
        Workspace {
            parameters: self.parameters.lend(),
            blocks: filled(&mut self.blocks, Block::BLANK),
            samples: filled(&mut self.samples, Sample::BLANK),
            readings: filled(&mut self.readings, Reading::default()),
            contacts: filled(&mut self.contacts, Contact::BLANK),
            observations: filled(&mut self.observations, unseen),
            states: filled(&mut self.states, State::REST),
            displacements: filled(&mut self.displacements, Vector::ZERO),
            profiles: filled(&mut self.profiles, Profile::default()),
            updates: filled(&mut self.updates, Update::default()),
            nodes: filled(&mut self.nodes, Node::default()),
            scratch: filled(&mut self.scratch, Scratch::default()),
        }
    }
}

/// A buffer at its full length.
fn filled<T: Clone, const N: usize>(buffer: &mut Vec<T, N>, blank: T) -> &mut [T] {
    // The full length is the capacity: there is always room.
    let _ = buffer.resize(N, blank);
    buffer
}
