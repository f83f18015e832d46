//! A five-axis machine as a chain of joints: three linear axes and two rotary axes on table or head.
//!
//! **Frame.** Everything is in the program's frame: right-handed, fixed in the part, and parallel to the machine's axes
//! when both rotary words are zero. Lengths in mm, angles in radians (degrees in files and programs).
//!
//! **Chain.** With a rotary axis as the turn about a line, `T(θ)p = c + R(θ)(p − c)`, and X the three linear words, the
//! tool tip in the part's frame is
//!
//! `p_w = (T_table1 ∘ T_table2)⁻¹ ( X + (T_head1 ∘ T_head2)(0) )`,
//!
//! each product over the axes that are there, the axis that carries the other first. For a table this is
//! `X = T_table1 T_table2 p_w`, the form `x = Rx(A) Rz(C) p` of a trunnion; for a head X is the place the tip would have
//! with both rotary words at zero, as a control with a tool length but without tool centre point control takes it.
//!
//! **Points of the axes.** A table axis passes through `point_mm` in the program's frame at rotary zero. A head axis
//! passes through `point_mm` measured from the spindle's gauge point at rotary zero; the tip is `tool_length_mm` below
//! that point, so that the pivot length is `point_mm[2] + tool_length_mm`.
//!
//! **Sense.** [`Sense::RightHand`]: a positive word turns the table (with the part) or the head (with the tool)
//! right-handed about the positive axis; the papers' and LinuxCNC's trunnions do. ISO 841 describes the motion of the
//! tool against the part, so its table axes (A′, B′, C′) are [`Sense::LeftHand`].
//!
//! Limits: ideal geometry (axes parallel to X, Y, Z; no 45° nutating heads), two rotary axes about different letters.

mod read;

use super::vector::Vector;

/// Which side the rotary axes are on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Both turn the part.
    TableTable,
    /// One turns the part, one the tool.
    TableHead,
    /// Both turn the tool.
    HeadHead,
}

/// The letter of a rotary axis: A turns about X, B about Y, C about Z.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Letter {
    /// About X.
    A,
    /// About Y.
    B,
    /// About Z.
    C,
}

impl Letter {
    /// 0, 1, 2 for A, B, C: the coordinate it leaves alone.
    pub const fn index(self) -> usize {
        self as usize
    }
    /// The unit vector it turns about.
    pub const fn direction(self) -> Vector {
        match self {
            Self::A => [1.0, 0.0, 0.0],
            Self::B => [0.0, 1.0, 0.0],
            Self::C => [0.0, 0.0, 1.0],
        }
    }
    /// The letter itself.
    pub const fn name(self) -> char {
        match self {
            Self::A => 'A',
            Self::B => 'B',
            Self::C => 'C',
        }
    }
}

/// What a rotary axis carries.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// The part.
    Table,
    /// The tool.
    Head,
}

/// Which way a positive word turns what the axis carries.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sense {
    /// Right-handed about the positive axis.
    RightHand,
    /// Left-handed.
    LeftHand,
}

impl Sense {
    /// +1 or −1.
    pub const fn sign(self) -> f64 {
        match self {
            Self::RightHand => 1.0,
            Self::LeftHand => -1.0,
        }
    }
}

/// A rotary axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rotary {
    /// Its letter in the program.
    pub letter: Letter,
    /// What it carries.
    pub side: Side,
    /// A point of its line at rotary zero, mm; see the module for the two frames. ±100,000.
    pub point_mm: Vector,
    /// Which way it turns.
    pub sense: Sense,
    /// Travel in the program's degrees, `None` for an axis without end.
    pub limits_deg: Option<[f64; 2]>,
}

/// What the linear words of the program are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Coordinates {
    /// Positions of the linear joints.
    ///
    /// The control moves all five linearly, the tip bends off the chord.
    Joints,
    /// Places of the tool tip in the part's frame.
    ///
    /// Tool centre point programming.
    Tip,
}

/// The point of the tool whose way is compared with the chord.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Counted {
    /// The tip, as in the paper.
    Tip,
    /// The centre of a ball end.
    BallCentre,
}

/// The tool.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tool {
    /// From the spindle's gauge point to the tip, mm, 0…2000; matters with a head only.
    pub length_mm: f64,
    /// Radius of its ball end, mm, when it has one.
    pub ball_radius_mm: Option<f64>,
    /// Helix angle β₀ of the ball's edge at the equator, degrees, 0…75.
    pub helix_deg: f64,
    /// The point that counts.
    pub counted: Counted,
}

impl Default for Tool {
    fn default() -> Self {
        Self { length_mm: 0.0, ball_radius_mm: None, helix_deg: 0.0, counted: Counted::Tip }
    }
}

/// Positions of the five joints.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Joints {
    /// The linear words, mm.
    pub xyz: [f64; 3],
    /// The rotary words in the order of [`Machine::rotary`], rad.
    pub rotary: [f64; 2],
}

impl Joints {
    /// From the words of a program: mm and degrees.
    pub fn from_degrees(xyz: [f64; 3], rotary_deg: [f64; 2]) -> Self {
        Self { xyz, rotary: rotary_deg.map(f64::to_radians) }
    }
    /// The rotary words in degrees.
    pub fn rotary_deg(&self) -> [f64; 2] {
        self.rotary.map(f64::to_degrees)
    }
    /// Every number is finite.
    pub fn is_finite(&self) -> bool {
        self.xyz.iter().chain(&self.rotary).all(|n| n.is_finite())
    }
    /// The joints at the parameter `t` of the linear move to `other`.
    #[must_use]
    pub fn towards(&self, other: &Self, t: f64) -> Self {
        let mix = |a: f64, b: f64| if t == 1.0 { b } else { a + (b - a) * t };
        Self {
            xyz: std::array::from_fn(|i| mix(self.xyz[i], other.xyz[i])),
            rotary: std::array::from_fn(|i| mix(self.rotary[i], other.rotary[i])),
        }
    }
}

/// A five-axis machine.
#[derive(Clone, Debug, PartialEq)]
pub struct Machine {
    /// The rotary axes: the one that carries the other first; with one on the table and one on the head, the table.
    rotary: [Rotary; 2],
    /// The tool in it.
    tool: Tool,
    /// What the linear words are.
    coordinates: Coordinates,
    /// Travel of X, Y, Z, mm.
    travel_mm: [Option<[f64; 2]>; 3],
    /// Nearer than this to the pole a move is singular, rad.
    pole: f64,
    /// Largest angle between the tool axis and the great circle between a move's ends, rad.
    orientation_tolerance: Option<f64>,
}

/// Why rotary axes make no machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum MachineError {
    /// Both axes have one letter.
    #[error("both rotary axes are {0}")]
    SameLetter(char),
    /// A number is not finite or beyond ±100,000 mm.
    #[error("a length is not within ±100,000 mm")]
    Length,
    /// The ball's centre shall count, but there is no ball.
    #[error("the ball's centre counts, but the tool has no ball radius")]
    NoBall,
}

/// Lengths beyond this, mm, are refused.
pub const LONGEST_MM: f64 = 100_000.0;

/// Positions beyond the end of a travel by less than this (mm, degrees) are rounding.
const ROUNDING: f64 = 1e-9;

/// A joint beyond the end of its travel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Beyond {
    /// Its letter: X, Y, Z, A, B or C.
    pub letter: char,
    /// Where it should go, mm or degrees.
    pub position: f64,
    /// Its travel.
    pub travel: [f64; 2],
}

impl Machine {
    /// A machine of two rotary axes, the carrying one first; of a table and a head axis the order does not matter.
    /// Linear words are joint positions, travel is unlimited, the pole's neighbourhood is 5°.
    ///
    /// # Errors
    /// [`MachineError`] when the two are no machine.
    pub fn new(rotary: [Rotary; 2], tool: Tool) -> Result<Self, MachineError> {
        if rotary[0].letter == rotary[1].letter {
            return Err(MachineError::SameLetter(rotary[0].letter.name()));
        }
        let ball = tool.ball_radius_mm.unwrap_or(0.0);
        let lengths = rotary.iter().flat_map(|axis| axis.point_mm).chain([tool.length_mm, ball, tool.helix_deg]);
        if lengths.into_iter().any(|length| length.is_nan() || length.abs() > LONGEST_MM) {
            return Err(MachineError::Length);
        }
        if tool.counted == Counted::BallCentre && tool.ball_radius_mm.is_none() {
            return Err(MachineError::NoBall);
        }
        let mut rotary = rotary;
        if rotary[0].side == Side::Head && rotary[1].side == Side::Table {
            rotary.swap(0, 1);
        }
        let pole = 5f64.to_radians();
        let (coordinates, travel_mm) = (Coordinates::Joints, [None; 3]);
        Ok(Self { rotary, tool, coordinates, travel_mm, pole, orientation_tolerance: None })
    }

    /// Which side the rotary axes are on.
    pub fn kind(&self) -> Kind {
        match self.rotary.map(|axis| axis.side) {
            [Side::Table, Side::Table] => Kind::TableTable,
            [Side::Head, Side::Head] => Kind::HeadHead,
            _ => Kind::TableHead,
        }
    }
    /// The rotary axes in the order of [`Joints::rotary`](super::Joints): the carrying one first, the table before the
    /// head.
    pub fn rotary(&self) -> &[Rotary; 2] {
        &self.rotary
    }
    /// The place of a letter's axis in [`Machine::rotary`].
    pub fn place_of(&self, letter: Letter) -> Option<usize> {
        self.rotary.iter().position(|axis| axis.letter == letter)
    }
    /// The tool.
    pub fn tool(&self) -> &Tool {
        &self.tool
    }
    /// What the linear words are.
    pub fn coordinates(&self) -> Coordinates {
        self.coordinates
    }
    /// Nearer than this to the pole a move counts as singular, rad.
    pub fn pole(&self) -> f64 {
        self.pole
    }
    /// Largest angle allowed between the tool axis and the great circle between a move's ends, rad.
    pub fn orientation_tolerance(&self) -> Option<f64> {
        self.orientation_tolerance
    }
    /// The same with an orientation tolerance, rad.
    #[must_use]
    pub fn with_orientation_tolerance(mut self, tolerance: Option<f64>) -> Self {
        self.orientation_tolerance = tolerance;
        self
    }
    /// Distance of the counted point from the tip, up the tool axis, mm.
    pub fn counted_height_mm(&self) -> f64 {
        match self.tool.counted {
            Counted::Tip => 0.0,
            Counted::BallCentre => self.tool.ball_radius_mm.unwrap_or(0.0),
        }
    }

    /// The first joint that a position takes beyond its travel.
    pub fn beyond(&self, joints: &Joints) -> Option<Beyond> {
        let linear = ['X', 'Y', 'Z'].into_iter().zip(joints.xyz).zip(self.travel_mm);
        let letters = self.rotary.map(|axis| axis.letter.name());
        let rotary = letters.into_iter().zip(joints.rotary_deg()).zip(self.rotary.map(|axis| axis.limits_deg));
        linear.chain(rotary).find_map(|((letter, position), travel)| {
            let travel = travel?;
            let inside = position >= travel[0] - ROUNDING && position <= travel[1] + ROUNDING;
            (!inside).then_some(Beyond { letter, position, travel })
        })
    }
}
