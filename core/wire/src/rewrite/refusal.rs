//! Why a command is refused.

use core::fmt;

use serde::{Deserialize, Serialize};

use super::{Mode, Reason};

/// Why a command had no effect. A mismatch carries both sides.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Refusal {
    /// The command does not belong to the present state.
    State(Mode),
    /// There is no image.
    NoImage,
    /// The drives are still enabled.
    DrivesEnabled,
    /// No setpoints arrive, so nobody says what the drives do.
    NoSetpoints,
    /// An identity number is another one.
    Identity {
        /// What it names.
        what: Identity,
        /// Number in the image.
        image: u32,
        /// Number in the request.
        request: u32,
    },
    /// This pass of this part has been armed before: correcting it again would gouge.
    PartRepeated {
        /// Serial number of the part.
        part_serial: u32,
    },
    /// The frame is damaged.
    FrameDamaged {
        /// CRC-32 that came with it.
        stored: u32,
        /// CRC-32 of its values.
        computed: u32,
    },
    /// Cosine and sine (2⁻³⁰) are not those of one angle.
    FrameNotRigid {
        /// Cosine.
        cosine: i32,
        /// Sine.
        sine: i32,
    },
    /// X, Y and Z are not on three different axes of those that are sent.
    FrameAxes {
        /// Axis of X.
        x: u8,
        /// Axis of Y.
        y: u8,
        /// Axis of Z.
        z: u8,
    },
    /// Setpoints come faster than the settings say, or too few have come to know.
    FrameRate {
        /// Setpoints per second by the settings.
        tick_hz: u32,
        /// Mean interval of the last 32 setpoints, ns; 0 before there were as many.
        interval_ns: u32,
    },
    /// In `Off`: the drives were dropped, and that they are disabled has not been acknowledged since.
    Off {
        /// Why they were dropped: [`Reason::Silence`], [`Reason::ImageChanged`]; [`Reason::None`] at a reset.
        reason: Reason,
    },
}

/// The identity numbers that must agree.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Identity {
    /// CRC-32 of the program.
    Program,
    /// Number of the feature.
    Feature,
    /// Number of the pass.
    Pass,
    /// Tool number.
    Tool,
    /// Number of the tool offset.
    ToolOffset,
    /// Number of the setup.
    Setup,
}

impl Refusal {
    /// A number that stays the same from version to version.
    pub const fn code(self) -> u16 {
        match self {
            Self::State(_) => 1,
            Self::NoImage => 2,
            Self::DrivesEnabled => 3,
            Self::PartRepeated { .. } => 4,
            Self::FrameDamaged { .. } => 5,
            Self::FrameNotRigid { .. } => 6,
            Self::FrameAxes { .. } => 7,
            Self::NoSetpoints => 8,
            Self::FrameRate { .. } => 9,
            Self::Off { .. } => 10,
            Self::Identity { what: Identity::Program, .. } => 16,
            Self::Identity { what: Identity::Feature, .. } => 17,
            Self::Identity { what: Identity::Pass, .. } => 18,
            Self::Identity { what: Identity::Tool, .. } => 19,
            Self::Identity { what: Identity::ToolOffset, .. } => 20,
            Self::Identity { what: Identity::Setup, .. } => 21,
        }
    }
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::State(mode) => write!(f, "not possible in state {mode}"),
            Self::NoImage => f.write_str("there is no image"),
            Self::DrivesEnabled => f.write_str("the drives are still enabled"),
            Self::NoSetpoints => f.write_str("no setpoints arrive"),
            Self::PartRepeated { part_serial } => {
                write!(f, "part {part_serial} has been armed for this pass before; a second correction would gouge")
            }
            Self::FrameDamaged { stored, computed } => {
                write!(f, "the frame is damaged: CRC-32 {computed:08x}, sent {stored:08x}")
            }
            Self::FrameNotRigid { cosine, sine } => {
                write!(f, "cosine {cosine} and sine {sine} (2^-30) are not those of one angle")
            }
            Self::FrameAxes { x, y, z } => {
                write!(f, "axes {x}, {y}, {z} are not three different ones of those that are sent")
            }
            Self::FrameRate { tick_hz, interval_ns: 0 } => {
                write!(f, "too few setpoints have come to tell whether they come at {tick_hz} Hz")
            }
            Self::FrameRate { tick_hz, interval_ns } => {
                write!(f, "a setpoint comes every {interval_ns} ns, faster than the {tick_hz} Hz of the settings")
            }
            Self::Off { reason: Reason::None } => f.write_str(
                "not possible in state Off: nobody has acknowledged since the reset that the drives are disabled",
            ),
            Self::Off { reason } => write!(
                f,
                "not possible in state Off: the drives were dropped ({reason}), and nobody has acknowledged since that they are disabled"
            ),
            Self::Identity { what: Identity::Program, image, request } => {
                write!(f, "the image is for program {image:08x}, the controller runs {request:08x}")
            }
            Self::Identity { what, image, request } => {
                let name = match what {
                    Identity::Feature => "feature",
                    Identity::Pass => "pass",
                    Identity::Tool => "tool",
                    Identity::ToolOffset => "tool offset",
                    Identity::Program | Identity::Setup => "setup",
                };
                write!(f, "the image is for {name} {image}, the controller says {request}")
            }
        }
    }
}

impl core::error::Error for Refusal {}
