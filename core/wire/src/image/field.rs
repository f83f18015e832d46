//! The values of an image's head, by name, for messages about their ranges.

use core::fmt;

use serde::{Deserialize, Serialize};

/// A value of the head of an image. Its sentence gives name and unit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Field {
    /// Number of nodes.
    Nodes,
    /// Feed per tooth.
    FeedPerTooth,
    /// Teeth of the cutter.
    Teeth,
    /// Size exponent.
    SizeExponent,
    /// Lower end of the feed window.
    RatioLow,
    /// Upper end of the feed window.
    RatioHigh,
    /// Clamp.
    Clamp,
    /// Warn level.
    Warn,
    /// Largest speed of the correction.
    Slew,
    /// Largest acceleration of the correction.
    Acceleration,
    /// Greatest distance from the path.
    Tolerance,
    /// Lower end of the pass.
    PassLow,
    /// Upper end of the pass.
    PassHigh,
    /// Height of the gate.
    Gate,
    /// Distance of the nodes.
    NodeStep,
    /// X of the first node.
    OriginX,
    /// Y of the first node.
    OriginY,
}

impl fmt::Display for Field {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Nodes => "number of nodes",
            Self::FeedPerTooth => "feed per tooth (2^-8 nm)",
            Self::Teeth => "number of teeth",
            Self::SizeExponent => "size exponent (2^-16)",
            Self::RatioLow => "lower feed ratio (2^-16)",
            Self::RatioHigh => "upper feed ratio (2^-16)",
            Self::Clamp => "clamp (nm)",
            Self::Warn => "warn level (nm)",
            Self::Slew => "slew limit (nm/s)",
            Self::Acceleration => "acceleration limit (nm/s^2)",
            Self::Tolerance => "path tolerance (nm)",
            Self::PassLow => "lower end of the pass (nm)",
            Self::PassHigh => "upper end of the pass (nm)",
            Self::Gate => "height of the gate (nm)",
            Self::NodeStep => "node step (nm)",
            Self::OriginX => "x of the origin (nm)",
            Self::OriginY => "y of the origin (nm)",
        })
    }
}
