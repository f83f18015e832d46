//! G codes by their numbers.

use core::fmt;

/// The number of a G code in tenths: G1 is 10, G59.3 is 593.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct GCode(u16);

impl GCode {
    /// From tenths: `GCode::from_tenths(593)` is G59.3.
    pub const fn from_tenths(tenths: u16) -> Self {
        Self(tenths)
    }
    /// Its number in tenths.
    pub const fn tenths(self) -> u16 {
        self.0
    }
}

impl fmt::Display for GCode {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (whole, tenth) = (self.0 / 10, self.0 % 10);
        if tenth == 0 { write!(f, "G{whole}") } else { write!(f, "G{whole}.{tenth}") }
    }
}
