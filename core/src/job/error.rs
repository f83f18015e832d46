//! Why no image could be made of job, program and measurement.
//!
//! Codes are those of the command line and keep their meaning: `G…` program, `J…` job, `M…` measurement, `I…` image,
//! `W…` workspace. Every sentence is the text shown.

use core::fmt;

use serde::{Deserialize, Serialize};

use crate::gcode::GcodeError;
use crate::geometry::Point;
use crate::image::ImageError;
use crate::probe::{ProbeError, Rejected, Suspicion};
use crate::units::{Offset, Position};

/// A buffer of the [`Workspace`](super::Workspace), or the one the image goes to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Buffer {
    /// Lines and arcs of the contour.
    Blocks,
    /// Samples of the path, run-in and run-out included.
    Samples,
    /// Samples of the contour itself.
    Nodes,
    /// States of the elastic loop.
    States,
    /// Readings of the probe, contacts, observations.
    Points,
    /// Bytes of the image.
    Image,
}

/// Why there is no image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum JobError {
    /// The bytes are not the compact form of a job.
    Compact,
    /// A quantity of the job is outside its range.
    Range {
        /// What is not as it should be.
        sentence: &'static str,
    },
    /// The job does not say how the part was probed.
    NoProbe,
    /// The program is itself a corrected one.
    Corrected,
    /// Something is wrong with the program.
    Program(GcodeError),
    /// A block of the contour has no feed.
    NoFeed {
        /// Its line.
        line: u32,
    },
    /// Job and program name different sides of the wall.
    WallsDiffer,
    /// Neither job nor program names the side of the wall.
    NoWall,
    /// Neither job nor program gives a spindle speed.
    NoSpeed,
    /// Job and program name different tools.
    ToolsDiffer {
        /// Number in the job.
        job: u32,
        /// Number in the program.
        program: u32,
    },
    /// Neither job nor program gives the number of the tool, which an image needs.
    NoTool,
    /// More flutes are in the stock at once than the force is summed over.
    Flutes,
    /// An outside arc is so tight that it leaves no wall.
    Undercut {
        /// Its line.
        line: u32,
    },
    /// Something is wrong with the measurement file.
    Measurement(ProbeError),
    /// Most readings are off the wall.
    OffTheWall {
        /// What would explain it.
        suspicion: Suspicion,
        /// Line of the first one that is.
        line: u32,
    },
    /// No reading can be used.
    NoContact {
        /// Line of the first reading.
        line: u32,
        /// Why that one is set aside.
        reason: Rejected,
        /// Where the cutter's tip was; readings count from here up to the axial depth.
        tip: Position,
    },
    /// Most points fit neither each other nor a machine like the one in the job.
    Unfit {
        /// Points that do not fit.
        outliers: u32,
        /// Points there are.
        points: u32,
        /// Arc length of the one that fits worst.
        s: Offset,
        /// The wall error measured there.
        measured: Offset,
        /// The wall error that would fit.
        fitting: Offset,
    },
    /// The correction reaches beyond the clamp.
    BeyondClamp {
        /// The larger of its components at the worst place.
        reach: Offset,
        /// The clamp.
        clamp: Offset,
        /// The worst place.
        at: Point,
    },
    /// The clamp leaves no room for a feed override of 110 %.
    NoFeedWindow {
        /// The correction at 110 % of the programmed feed.
        reach: Offset,
        /// The clamp.
        clamp: Offset,
    },
    /// The feed per tooth is more than an image can hold, 8 mm.
    FeedPerTooth,
    /// The image would not fit into the coprocessor.
    TooManyNodes {
        /// Nodes of the correction.
        nodes: u32,
        /// Nodes the coprocessor holds.
        limit: u32,
    },
    /// No image can be made of the correction.
    Image(ImageError),
    /// A buffer is full.
    Full {
        /// The buffer.
        buffer: Buffer,
        /// Entries needed; at least these where the need was not counted to its end.
        needed: u32,
        /// Entries lent.
        lent: u32,
    },
}

/// A [`JobError`] as it travels: its code and the line it points at.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Failed {
    /// Four characters; see [`JobError::code`].
    pub code: [u8; 4],
    /// Line of the program (`G…`, `J…`) or of the measurement file (`M…`), 0 for none.
    pub line: u32,
}

impl JobError {
    /// A buffer too short.
    pub(super) fn full(buffer: Buffer, needed: usize, lent: usize) -> Self {
        let count = |n: usize| u32::try_from(n).unwrap_or(u32::MAX);
        Self::Full { buffer, needed: count(needed), lent: count(lent) }
    }

    /// A code that keeps its meaning: a letter and three digits.
    pub const fn code(&self) -> &'static str {
        match self {
            Self::Compact => "J002",
            Self::Range { .. } => "J006",
            Self::NoProbe => "J004",
            Self::Corrected => "J011",
            Self::Program(error) => error.kind.code(),
            Self::NoFeed { .. } => "J012",
            Self::Undercut { .. } => "J013",
            Self::WallsDiffer => "J014",
            Self::NoWall => "J015",
            Self::NoSpeed => "J016",
            Self::BeyondClamp { .. } => "J017",
            Self::NoFeedWindow { .. } => "J018",
            Self::Flutes => "J019",
            Self::FeedPerTooth => "J020",
            Self::TooManyNodes { .. } => "J021",
            Self::ToolsDiffer { .. } => "J022",
            Self::NoTool => "J023",
            Self::Measurement(error) => error.kind.code(),
            Self::OffTheWall { suspicion, .. } => match suspicion {
                Suspicion::Inches => "M011",
                Suspicion::Millimetres => "M012",
                Suspicion::BallTwice | Suspicion::BallHalf | Suspicion::Surface => "M013",
                Suspicion::Frame | Suspicion::Shifted { .. } => "M014",
                Suspicion::OtherSide => "M016",
                Suspicion::Centre => "M017",
                Suspicion::Swapped => "M018",
                Suspicion::MirroredX | Suspicion::MirroredY => "M019",
                Suspicion::Normals => "M021",
            },
            Self::NoContact { .. } => "M015",
            Self::Unfit { .. } => "M020",
            Self::Image(_) => "I001",
            Self::Full { buffer, .. } => match buffer {
                Buffer::Blocks => "W001",
                Buffer::Samples => "W002",
                Buffer::Nodes => "W003",
                Buffer::States => "W004",
                Buffer::Points => "W005",
                Buffer::Image => "W006",
            },
        }
    }

    /// Line of the program or of the measurement file it points at; `None` when it points at neither.
    pub const fn line(&self) -> Option<u32> {
        match self {
            Self::Program(error) => Some(error.line),
            Self::Measurement(error) => Some(error.line),
            Self::NoFeed { line }
            | Self::Undercut { line }
            | Self::OffTheWall { line, .. }
            | Self::NoContact { line, .. } => Some(*line),
            _ => None,
        }
    }

    /// As it travels.
    pub fn failed(&self) -> Failed {
        let code = self.code().as_bytes().first_chunk().copied().unwrap_or(*b"????");
        Failed { code, line: self.line().unwrap_or(0) }
    }
}

impl fmt::Display for Buffer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Blocks => "lines and arcs of the contour",
            Self::Samples => "samples of the path",
            Self::Nodes => "samples of the contour",
            Self::States => "states of the elastic loop",
            Self::Points => "probe points",
            Self::Image => "bytes of the image",
        })
    }
}

impl fmt::Display for JobError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Compact => f.write_str("the bytes are not a job in its compact form"),
            Self::Range { sentence } => f.write_str(sentence),
            Self::NoProbe => f.write_str("the job does not say how the part was probed"),
            Self::Corrected => f.write_str("the program is already corrected (it carries the mark TRUEPATH CORRECTED)"),
            Self::Program(error) => write!(f, "{error}"),
            Self::NoFeed { line } => write!(f, "line {line}: the contour has no feed: there is no F before this line"),
            Self::WallsDiffer => {
                f.write_str("the job says the wall lies on one side of travel and G41/G42 of the program on the other")
            }
            Self::NoWall => f.write_str("neither job nor program says on which side the wall lies"),
            Self::NoSpeed => f.write_str("neither job nor program gives a spindle speed"),
            Self::ToolsDiffer { job, program } => {
                write!(f, "the job names tool {job} and the program changes to tool {program}")
            }
            Self::NoTool => f.write_str("neither job nor program gives the number of the tool"),
            Self::Flutes => f.write_str("a helix of this angle winds round the cutter too often over the axial depth"),
            Self::Undercut { line } => {
                write!(
                    f,
                    "line {line}: this arc turns round the wall more tightly than the cutter: it leaves no wall to correct"
                )
            }
            Self::Measurement(error) => write!(f, "{error}"),
            Self::OffTheWall { suspicion: Suspicion::Normals, line } => {
                write!(f, "line {line}: {}", Suspicion::Normals.words())
            }
            Self::OffTheWall { suspicion, line } => {
                write!(f, "line {line}: most readings are off the nominal wall; {}", suspicion.words())
            }
            Self::NoContact { line, .. } => write!(f, "line {line}: no reading can be used, this one is the first"),
            Self::Unfit { outliers, points, .. } => {
                write!(
                    f,
                    "{outliers} of {points} points fit neither each other nor any machine like the one in the job"
                )
            }
            Self::BeyondClamp { reach, clamp, .. } => {
                write!(f, "the correction reaches {} nm, beyond the clamp of {} nm", reach.nm(), clamp.nm())
            }
            Self::NoFeedWindow { reach, clamp } => write!(
                f,
                "at 110 % of the programmed feed the correction reaches {} nm, beyond the clamp of {} nm",
                reach.nm(),
                clamp.nm()
            ),
            Self::FeedPerTooth => f.write_str("the feed per tooth is beyond 8 mm"),
            Self::TooManyNodes { nodes, limit } => {
                write!(f, "the correction has {nodes} nodes; the coprocessor holds {limit}")
            }
            Self::Image(error) => write!(f, "no image can be made: {error}"),
            Self::Full { buffer, needed, lent } => write!(f, "{needed} {buffer} are needed, there is room for {lent}"),
        }
    }
}

impl core::error::Error for JobError {}
