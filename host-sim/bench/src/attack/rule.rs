//! The rules of the contract, by name and number, and the alarm when one is broken.

use std::fmt;

/// The rules, with the numbers of `docs/safety.md`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[repr(u8)]
pub enum Rule {
    /// Nothing is answered but a frame that arrived whole.
    Damaged = 1,
    /// No frame is followed twice, and none that is older than the last one followed.
    Old = 2,
    /// No answer is given later than the deadline.
    Late = 3,
    /// What goes out is the setpoint and the correction that is told, to the nanometre.
    Sum = 4,
    /// In `Off`, `Bypass` and `Armed` the output is the input.
    Plain = 5,
    /// In `Off` nothing is forwarded and the drive enable is dropped; in every other state it is not.
    Enable = 6,
    /// `Off` is left by an acknowledgement only, with setpoints that say that the drives are disabled.
    Acknowledge = 7,
    /// Without setpoints for the time of silence the drives are dropped.
    Silence = 8,
    /// Nothing is corrected without an arming of its own.
    Unarmed = 9,
    /// Arming needs `Bypass`, the image, its numbers and a sound frame on axes that are sent.
    Arming = 10,
    /// A pass of a part that was armed is never armed again.
    Spent = 11,
    /// A correction begins only in the gate over the start.
    Begin = 12,
    /// The correction is on the axes of the frame that was armed.
    Axis = 13,
    /// The correction is within its clamp.
    Clamp = 14,
    /// The correction changes no faster than its limit.
    Speed = 15,
    /// The speed of the correction changes no faster than its limit.
    Acceleration = 16,
    /// No correction carries an axis over a joint limit.
    Joint = 17,
    /// A gap beyond the limit, or so many answers withheld, ends what is armed or on.
    Gap = 18,
    /// Stop flags, disabled drives, another frame and a disarming end what is on.
    Stopped = 19,
    /// Another image, or none, ends what is armed or on.
    ImageChanged = 20,
    /// Too fast a pace, or an unknown one, lets nothing be armed, and ends what is armed or on.
    Pace = 21,
    /// A setpoint that jumps ends what is on.
    Jump = 22,
    /// A setpoint off the path ends what is on.
    OffPath = 23,
    /// A way back beyond the tolerance ends what is on.
    Backwards = 24,
    /// Above the pass nothing is on but over the start, before the first cut.
    AbovePass = 25,
    /// Below the pass nothing is on.
    BelowPass = 26,
    /// A setpoint that moves away in a feed hold ends what is on.
    MovedInHold = 27,
    /// A cutter that does not turn has no correction once it has faded.
    Fade = 28,
    /// A correction goes out by its ramp, to nothing.
    RampCut = 29,
    /// A ramp ends within its time.
    RampLong = 30,
}

impl Rule {
    /// All of them in the order of their numbers.
    pub const ALL: [Self; 30] = [
        Self::Damaged,
        Self::Old,
        Self::Late,
        Self::Sum,
        Self::Plain,
        Self::Enable,
        Self::Acknowledge,
        Self::Silence,
        Self::Unarmed,
        Self::Arming,
        Self::Spent,
        Self::Begin,
        Self::Axis,
        Self::Clamp,
        Self::Speed,
        Self::Acceleration,
        Self::Joint,
        Self::Gap,
        Self::Stopped,
        Self::ImageChanged,
        Self::Pace,
        Self::Jump,
        Self::OffPath,
        Self::Backwards,
        Self::AbovePass,
        Self::BelowPass,
        Self::MovedInHold,
        Self::Fade,
        Self::RampCut,
        Self::RampLong,
    ];
    /// Its number.
    pub const fn number(self) -> u8 {
        self as u8
    }
    /// What must hold.
    pub const fn sentence(self) -> &'static str {
        match self {
            Self::Damaged => "nothing is answered but a frame that arrived whole",
            Self::Old => "no frame is followed twice, and none that is older than the last one followed",
            Self::Late => "no answer is given later than the deadline",
            Self::Sum => "what goes out is the setpoint and the correction that is told, to the nanometre",
            Self::Plain => "in Off, Bypass and Armed the output is the input",
            Self::Enable => {
                "in Off nothing is forwarded and the drive enable is dropped, in every other state it is not"
            }
            Self::Acknowledge => {
                "Off is left by an acknowledgement only, with setpoints that say that the drives are disabled"
            }
            Self::Silence => "without setpoints for the time of silence the drives are dropped",
            Self::Unarmed => "nothing is corrected without an arming of its own",
            Self::Arming => "arming needs Bypass, the image, its numbers and a sound frame on axes that are sent",
            Self::Spent => "a pass of a part that was armed is never armed again",
            Self::Begin => "a correction begins only in the gate over the start",
            Self::Axis => "the correction is on the axes of the frame that was armed",
            Self::Clamp => "the correction is within its clamp",
            Self::Speed => "the correction changes no faster than its limit",
            Self::Acceleration => "the speed of the correction changes no faster than its limit",
            Self::Joint => "no correction carries an axis over a joint limit",
            Self::Gap => "a gap beyond the limit, or so many answers withheld, ends what is armed or on",
            Self::Stopped => "stop flags, disabled drives, another frame and a disarming end what is on",
            Self::ImageChanged => "another image, or none, ends what is armed or on",
            Self::Pace => "too fast a pace, or an unknown one, lets nothing be armed, and ends what is armed or on",
            Self::Jump => "a setpoint that jumps ends what is on",
            Self::OffPath => "a setpoint off the path ends what is on",
            Self::Backwards => "a way back beyond the tolerance ends what is on",
            Self::AbovePass => "above the pass nothing is on but over the start, before the first cut",
            Self::BelowPass => "below the pass nothing is on",
            Self::MovedInHold => "a setpoint that moves away in a feed hold ends what is on",
            Self::Fade => "a cutter that does not turn has no correction once it has faded",
            Self::RampCut => "a correction goes out by its ramp, to nothing",
            Self::RampLong => "a ramp ends within its time",
        }
    }
}

impl fmt::Display for Rule {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "SR-{:02}: {}", self.number(), self.sentence())
    }
}

/// A rule that was broken.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{rule}; {found} (session {session}, setpoint {setpoint} of it)")]
pub struct Alarm {
    /// The rule.
    pub rule: Rule,
    /// What was found.
    pub found: String,
    /// Number of the session.
    pub session: u64,
    /// Number of the setpoint in the session.
    pub setpoint: u64,
}

/// Situations in which a stricter rule than the contract would raise an alarm, by the words of that rule.
pub const SETTLED: [&str; 5] = [
    "correction on another axis",
    "on, but",
    "a damaged frame was followed",
    "on above the pass away from the start",
    "began",
];
