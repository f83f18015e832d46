//! Why no image could be made of job, program and measurement.
//!
//! An error of program, measurement or image keeps the code it has there; full buffers are `W101` to `W106`.

use crate::gcode::GcodeError;
use crate::geometry::Point;
use crate::image::ImageError;
use crate::probe::{ProbeError, Rejected, Suspicion};
use crate::units::{Offset, Position, errors};

errors! {
    /// A buffer of the [`Workspace`](super::Workspace), or the one the image goes to.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum Buffer {
        /// Lines and arcs of the contour.
        Blocks = "W101", "lines and arcs of the contour";
        /// Samples of the path, run-in and run-out included.
        Samples = "W102", "samples of the path";
        /// Samples of the contour itself.
        Nodes = "W103", "samples of the contour";
        /// States of the elastic loop.
        States = "W104", "states of the elastic loop";
        /// Readings of the probe, contacts, observations.
        Points = "W105", "probe points";
        /// Bytes of the image.
        Image = "W106", "bytes of the image";
    }
}

errors! {
    /// Why there is no image.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum JobError {
        /// The bytes are not the compact form of a job.
        Compact = "J024", "the bytes are not a job in its compact form";
        /// A quantity of the job is outside its range.
        Range {
            /// What is not as it should be.
            sentence: &'static str,
        } = "J025", "{sentence}";
        /// The job does not say how the part was probed.
        NoProbe = "J026", "the job does not say how the part was probed";
        /// The program is itself a corrected one.
        Corrected = "J011", "the program is already corrected (it carries the mark TRUEPATH CORRECTED)";
        /// A block of the contour has no feed.
        NoFeed {
            /// Its line.
            line: u32,
        } = "J012", "line {line}: the contour has no feed: there is no F before this line";
        /// Job and program name different sides of the wall.
        WallsDiffer = "J014",
            "the job says the wall lies on one side of travel and G41/G42 of the program on the other";
        /// Neither job nor program names the side of the wall.
        NoWall = "J015", "neither job nor program says on which side the wall lies";
        /// Neither job nor program gives a spindle speed.
        NoSpeed = "J016", "neither job nor program gives a spindle speed";
        /// Job and program name different tools.
        ToolsDiffer {
            /// Number in the job.
            job: u32,
            /// Number in the program.
            program: u32,
        } = "J022", "the job names tool {job} and the program changes to tool {program}";
        /// Neither job nor program gives the number of the tool, which an image needs.
        NoTool = "J023", "neither job nor program gives the number of the tool";
        /// More flutes are in the stock at once than the force is summed over.
        Flutes = "J019", "a helix of this angle winds round the cutter too often over the axial depth";
        /// An outside arc is so tight that it leaves no wall.
        Undercut {
            /// Its line.
            line: u32,
        } = "J013",
            "line {line}: this arc turns round the wall more tightly than the cutter: it leaves no wall to correct";
        /// Sharp corners lie so near to each other that no wall stands beside the path.
        Jagged {
            /// The line that is too much.
            line: u32,
        } = "J028",
            "line {line}: the path has more than 32 sharp corners within one diameter of the cutter: no wall stands beside it";
        /// No reading can be used.
        NoContact {
            /// Line of the first reading.
            line: u32,
            /// Why that one is set aside.
            reason: Rejected,
            /// Where the cutter's tip was; readings count from here up to the axial depth.
            tip: Position,
        } = "M015", "line {line}: no reading can be used, this one is the first";
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
        } = "M020", "{outliers} of {points} points fit neither each other nor any machine like the one in the job";
        /// The correction reaches beyond the clamp.
        BeyondClamp {
            /// The larger of its components at the worst place.
            reach: Offset,
            /// The clamp.
            clamp: Offset,
            /// The worst place.
            at: Point,
        } = "J017",
            "the correction reaches {reach} nm, beyond the clamp of {clamp} nm", reach = reach.nm(), clamp = clamp.nm();
        /// The clamp leaves no room for a feed override of 110 %.
        NoFeedWindow {
            /// The correction at 110 % of the programmed feed.
            reach: Offset,
            /// The clamp.
            clamp: Offset,
        } = "J018",
            "at 110 % of the programmed feed the correction reaches {reach} nm, beyond the clamp of {clamp} nm",
                reach = reach.nm(), clamp = clamp.nm();
        /// The feed per tooth is more than an image can hold, 8 mm.
        FeedPerTooth = "J020", "the feed per tooth is beyond 8 mm";
        /// The image would not fit into the coprocessor.
        TooManyNodes {
            /// Nodes of the correction.
            nodes: u32,
            /// Nodes the coprocessor holds.
            limit: u32,
        } = "J021", "the correction has {nodes} nodes; the coprocessor holds {limit}";
    }
    with the code of {
        /// Something is wrong with the program.
        Program(error: GcodeError) = error.kind.code(), "{error}";
        /// Something is wrong with the measurement file.
        Measurement(error: ProbeError) = error.kind.code(), "{error}";
        /// Most readings are off the wall.
        OffTheWall {
            /// What would explain it.
            suspicion: Suspicion,
            /// Line of the first one that is.
            line: u32,
        } = suspicion.code(),
            if matches!(suspicion, Suspicion::Normals) => "line {line}: {suspicion}";
            "line {line}: most readings are off the nominal wall; {suspicion}";
        /// No image can be made of the correction.
        Image(error: ImageError) = error.code(), "no image can be made: {error}";
        /// A buffer is full.
        Full {
            /// The buffer.
            buffer: Buffer,
            /// Entries needed; at least these where the need was not counted to its end.
            needed: u32,
            /// Entries lent.
            lent: u32,
        } = buffer.code(), "{needed} {buffer} are needed, there is room for {lent}";
    }
}

impl JobError {
    /// A buffer too short.
    pub(super) fn full(buffer: Buffer, needed: usize, lent: usize) -> Self {
        let count = |n: usize| u32::try_from(n).unwrap_or(u32::MAX);
        Self::Full { buffer, needed: count(needed), lent: count(lent) }
    }

    /// Line of the program or of the measurement file it points at; `None` when it points at neither.
    pub const fn line(&self) -> Option<u32> {
        match self {
            Self::Program(error) => Some(error.line),
            Self::Measurement(error) => Some(error.line),
            Self::NoFeed { line }
            | Self::Undercut { line }
            | Self::Jagged { line }
            | Self::OffTheWall { line, .. }
            | Self::NoContact { line, .. } => Some(*line),
            _ => None,
        }
    }
}

impl core::error::Error for JobError {}
