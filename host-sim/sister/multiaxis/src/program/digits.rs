//! How many decimals the inserted locations are written with.
//!
//! The rotary words are rounded first and the linear words follow from the rounded ones, so that the rounding of an
//! angle does not move the counted point at all; the rounding of X, Y and Z moves it by at most √3/2 of the last digit,
//! because kinematics turn but do not stretch. Four decimals of a millimetre keep that at 0.087 µm, six of an inch at
//! 0.022 µm. Never fewer than the program itself writes; `--decimals` names what the control takes when it is less.

use super::quantity::Scale;

/// The decimals a control takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Digits {
    millimetres: u8,
    inches: u8,
    degrees: u8,
}

impl Default for Digits {
    fn default() -> Self {
        Self { millimetres: 4, inches: 6, degrees: 4 }
    }
}

impl Digits {
    /// What a control takes that knows so many decimals of a millimetre and of a degree: one more of an inch.
    pub const fn at_most(millimetres: u8) -> Self {
        Self { millimetres, inches: millimetres + 1, degrees: millimetres }
    }
    /// Decimals of a word; `own` are the most that the program has written, of lengths and angles.
    pub fn of(self, scale: Scale, own: [u8; 2]) -> u8 {
        let (least, own) = match scale {
            Scale::Millimetres => (self.millimetres, own[0]),
            Scale::Inches => (self.inches, own[0]),
            Scale::Degrees => (self.degrees, own[1]),
        };
        least.max(own).min(9)
    }
    /// The farthest that the rounding of both rotary words can turn the tool axis, rad.
    pub fn turn(self, own: [u8; 2]) -> f64 {
        10f64.powi(-i32::from(self.of(Scale::Degrees, own))).to_radians()
    }
    /// The farthest that the rounding of X, Y and Z can move the counted point, mm.
    pub fn displacement(self, scale: Scale, own: [u8; 2]) -> f64 {
        let step = 10f64.powi(-i32::from(self.of(scale, own)));
        let unit = if scale == Scale::Inches { 25.4 } else { 1.0 };
        0.5 * 3f64.sqrt() * step * unit
    }
}
