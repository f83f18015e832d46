//! What is asked of the writer: the corrected path line by line, and how the program is written.

use truepath_core::gcode::Options;
use truepath_core::units::Offset;

/// The corrected path of one line of the contour.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BlockEdit {
    /// The line of the original program, counted from 1.
    pub line: u32,
    /// Points of the corrected centre path in program coordinates, nm, from the start of the block to its end and about
    /// 0.1 mm apart. The first one is the last one of the block before.
    pub samples: Vec<[i64; 2]>,
    /// Where along the samples the feed changes, in order and from the first sample on; empty where every feed stays that
    /// of the program.
    pub feeds: Vec<FeedFrom>,
}

/// A feed from a point of a corrected path on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FeedFrom {
    /// Index of the sample.
    pub sample: usize,
    /// Percent of the programmed feed.
    pub percent: u16,
}

impl BlockEdit {
    /// The corrected path of a line at the feed of the program.
    pub const fn new(line: u32, samples: Vec<[i64; 2]>) -> Self {
        Self { line, samples, feeds: Vec::new() }
    }
}

/// What a program is rewritten for; it decides the comment at its head.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Purpose {
    /// It is corrected, and must never be corrected again.
    #[default]
    Correction,
    /// It leaves stock on the wall for a second pass.
    FirstPass {
        /// Stock it leaves.
        left: Offset,
    },
    /// It has arcs where the path had sharp inside corners, and is milled, probed and corrected in the place of the original.
    Fillets {
        /// Their radius on the cutter's path.
        radius: Offset,
    },
}

/// How the corrected program is written.
#[derive(Clone, Debug)]
pub struct RewriteOptions {
    /// How far the written path may leave the samples, 0.1 µm…0.1 mm. The rounding of the coordinates (50 nm) is
    /// taken from it.
    pub tolerance: Offset,
    /// What the program does not say.
    pub program: Options<'static>,
    /// Arcs of a larger radius are written as lines, 1 mm…100 m: controls refuse or distort arcs whose centre is far.
    pub max_arc_radius: Offset,
    /// Kinks larger than this, in places where the original is smooth, are avoided; 0.01…10 degrees.
    pub max_kink_deg: f64,
    /// What the head of the program names beside the original.
    pub origin: Origin,
    /// Remarks for the head of the program, one comment each.
    pub notes: Vec<String>,
    /// What it is written for.
    pub purpose: Purpose,
}

impl Default for RewriteOptions {
    /// 1 µm, arcs up to 1 m, kinks up to 1 degree.
    fn default() -> Self {
        Self {
            tolerance: Offset::from_um(1),
            program: Options::default(),
            max_arc_radius: Offset::from_um(1_000_000),
            max_kink_deg: 1.0,
            origin: Origin::default(),
            notes: Vec::new(),
            purpose: Purpose::default(),
        }
    }
}

/// What a corrected program was made from, as its head names it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Origin {
    /// CRC-32 of the program, where the one that is written is that program with its subprograms and loops written out.
    pub program: Option<u32>,
    /// CRC-32 of the job file.
    pub job: Option<u32>,
    /// CRC-32 of the probe file.
    pub probe: Option<u32>,
}
