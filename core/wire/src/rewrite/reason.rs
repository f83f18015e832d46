//! Why a correction ended or failed.

use core::fmt;

use serde::{Deserialize, Serialize};

/// The reason, with a number that stays the same from version to version: 0 none, 1…15 regular ends, 16… faults.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(into = "u16", try_from = "u16")]
#[repr(u16)]
pub enum Reason {
    /// Nothing happened since the arming.
    #[default]
    None = 0,
    /// The path was followed to its end.
    Completed = 1,
    /// Disarmed by command.
    Disarmed = 2,
    /// The program ended (M2, M30).
    ProgramEnd = 3,
    /// Emergency stop.
    EmergencyStop = 16,
    /// The controller aborted the program.
    Abort = 17,
    /// A tool change began.
    ToolChange = 18,
    /// The drives were disabled.
    DrivesDisabled = 19,
    /// The frame changed after arming.
    FrameChanged = 20,
    /// The image changed after arming.
    ImageChanged = 21,
    /// A setpoint jumped farther than a feed move can.
    Jump = 22,
    /// The setpoint is farther from the path than its tolerance.
    OffPath = 23,
    /// The setpoint went back along the path farther than its tolerance.
    Backwards = 24,
    /// The cutter left the gate without going down to the pass.
    LeftGate = 25,
    /// The cutter rose out of the pass before the end of the path.
    LeftPass = 26,
    /// The cutter went below the pass.
    BelowPass = 27,
    /// The setpoint moved away during a feed hold.
    MovedInHold = 28,
    /// Setpoints were repeated, or more were lost than permitted.
    SequenceBroken = 29,
    /// The corrected position would pass a joint limit.
    JointLimit = 30,
    /// No setpoint came for too long.
    Silence = 31,
    /// Setpoints came faster than the settings say.
    FrameRate = 32,
}

impl Reason {
    /// All of them in the order of their numbers.
    pub const ALL: [Self; 21] = [
        Self::None,
        Self::Completed,
        Self::Disarmed,
        Self::ProgramEnd,
        Self::EmergencyStop,
        Self::Abort,
        Self::ToolChange,
        Self::DrivesDisabled,
        Self::FrameChanged,
        Self::ImageChanged,
        Self::Jump,
        Self::OffPath,
        Self::Backwards,
        Self::LeftGate,
        Self::LeftPass,
        Self::BelowPass,
        Self::MovedInHold,
        Self::SequenceBroken,
        Self::JointLimit,
        Self::Silence,
        Self::FrameRate,
    ];
    /// Number of the first fault; those of the others follow.
    pub const FIRST_FAULT: u16 = 16;
    /// How many faults there are.
    pub const FAULTS: usize = (Self::FrameRate as u16).wrapping_sub(Self::FIRST_FAULT).wrapping_add(1) as usize;
    /// Its number.
    pub const fn code(self) -> u16 {
        self as u16
    }
    /// Whether it is a fault and not a regular end.
    pub const fn is_fault(self) -> bool {
        self as u16 >= Self::FIRST_FAULT
    }
}

impl fmt::Display for Reason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::None => "nothing happened",
            Self::Completed => "the path was followed to its end",
            Self::Disarmed => "disarmed by command",
            Self::ProgramEnd => "the program ended",
            Self::EmergencyStop => "emergency stop",
            Self::Abort => "the program was aborted",
            Self::ToolChange => "a tool change began",
            Self::DrivesDisabled => "the drives were disabled",
            Self::FrameChanged => "the frame changed after arming",
            Self::ImageChanged => "the image changed after arming",
            Self::Jump => "a setpoint jumped farther than a feed move can",
            Self::OffPath => "the setpoint is farther from the path than its tolerance",
            Self::Backwards => "the setpoint went back along the path farther than its tolerance",
            Self::LeftGate => "the cutter left the gate without going down to the pass",
            Self::LeftPass => "the cutter rose out of the pass before the end of the path",
            Self::BelowPass => "the cutter went below the pass",
            Self::MovedInHold => "the setpoint moved away during a feed hold",
            Self::SequenceBroken => "setpoints were repeated, or more were lost than permitted",
            Self::JointLimit => "the corrected position would pass a joint limit",
            Self::Silence => "no setpoint came for too long",
            Self::FrameRate => "setpoints came faster than the settings say",
        })
    }
}

impl From<Reason> for u16 {
    fn from(reason: Reason) -> Self {
        reason.code()
    }
}

impl TryFrom<u16> for Reason {
    type Error = UnknownReason;
    fn try_from(code: u16) -> Result<Self, UnknownReason> {
        Self::ALL.into_iter().find(|reason| reason.code() == code).ok_or(UnknownReason(code))
    }
}

/// A number that stands for no reason in this version.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct UnknownReason(pub u16);

impl fmt::Display for UnknownReason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} is no reason", self.0)
    }
}

impl core::error::Error for UnknownReason {}
