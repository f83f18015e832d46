//! G codes: what they are called, which exclude each other, and which are refused.
//!
//! Modal groups: RS274/NGC (NIST 6556) table 4, with LinuxCNC's additions. Codes that would change where the cutter
//! goes in a way not computed here are refused by name; only codes that cancel such a thing, which is then never on,
//! are accepted without effect.

use core::fmt;

use super::{GcodeErrorKind, Number};

/// The number of a G code in tenths: G1 is 10, G59.3 is 593.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct GCode(u16);

/// Codes of one group exclude each other in a block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Group {
    /// G4 G28 G30 G53: this block only.
    OneShot,
    /// G0 G1 G2 G3 G80.
    Motion,
    /// G17.
    Plane,
    /// G90 G91.
    Distance,
    /// G90.1 G91.1.
    ArcDistance,
    /// G94.
    FeedMode,
    /// G20 G21.
    Units,
    /// G40 G41 G42.
    Compensation,
    /// G43 G43.1 G49.
    ToolLength,
    /// G98 G99: the height canned cycles return to; without cycles it has no effect.
    ReturnLevel,
    /// G54 … G59.3.
    WorkOffset,
    /// G61 G61.1 G64.
    PathControl,
    /// G15 G50.1 G67 G69: cancel polar coordinates, mirroring, a modal macro, rotation, which are all refused.
    Cancel,
}

impl Group {
    /// Number of groups.
    pub(super) const COUNT: usize = 13;

    /// Its place in a table of [`Self::COUNT`].
    pub(super) const fn index(self) -> usize {
        self as usize
    }
}

impl GCode {
    /// From a written number; `None` when it is negative, above 999.9 or has more than one decimal.
    pub fn new(value: Number) -> Option<Self> {
        match value.exactly_times(10) {
            Some(tenths) if (0..10_000).contains(&tenths) => Some(Self(tenths as u16)),
            _ => None,
        }
    }
    /// From tenths: `GCode::from_tenths(593)` is G59.3.
    pub const fn from_tenths(tenths: u16) -> Self {
        Self(tenths)
    }
    /// Its number in tenths.
    pub const fn tenths(self) -> u16 {
        self.0
    }

    /// The group it belongs to.
    ///
    /// # Errors
    /// The reason for which it is refused, or [`GcodeErrorKind::UnknownG`].
    pub(super) const fn group(self) -> Result<Group, GcodeErrorKind> {
        Ok(match self.0 {
            40 | 280 | 300 | 530 => Group::OneShot,
            0 | 10 | 20 | 30 | 800 => Group::Motion,
            170 => Group::Plane,
            900 | 910 => Group::Distance,
            901 | 911 => Group::ArcDistance,
            940 => Group::FeedMode,
            200 | 210 => Group::Units,
            400 | 410 | 411 | 420 | 421 => Group::Compensation,
            430 | 431 | 490 => Group::ToolLength,
            980 | 990 => Group::ReturnLevel,
            540 | 550 | 560 | 570 | 580 | 590 | 591 | 592 | 593 => Group::WorkOffset,
            610 | 611 | 640 => Group::PathControl,
            150 | 501 | 670 | 690 => Group::Cancel,
            180 | 190 | 171 | 181 | 191 => return Err(GcodeErrorKind::WrongPlane(self)),
            930 | 950 => return Err(GcodeErrorKind::WrongFeedMode(self)),
            100 | 281 | 301 | 520 | 920..=923 => {
                return Err(GcodeErrorKind::ShiftsCoordinates(self));
            }
            730 | 740 | 760 | 810..=890 => return Err(GcodeErrorKind::CannedCycle(self)),
            650 | 651 | 652 | 660 => return Err(GcodeErrorKind::Macro(self)),
            50..=53 | 60 | 61 | 62 => return Err(GcodeErrorKind::Spline(self)),
            432 | 434 | 541..=549 | 1540 => {
                return Err(GcodeErrorKind::Unsupported(self));
            }
            160 | 310 | 330 | 331 | 380..=385 | 500 | 510 | 511 | 680..=683 | 700 | 710 | 960 | 970 | 1870 => {
                return Err(GcodeErrorKind::Unsupported(self));
            }
            _ => return Err(GcodeErrorKind::UnknownG(self)),
        })
    }
}

impl fmt::Display for GCode {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (whole, tenth) = (self.0 / 10, self.0 % 10);
        if tenth == 0 { write!(f, "G{whole}") } else { write!(f, "G{whole}.{tenth}") }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::super::Decimal;
    use super::*;
    use std::string::ToString;

    #[test]
    fn codes_print_as_they_are_spoken() {
        assert_eq!(GCode::from_tenths(10).to_string(), "G1");
        assert_eq!(GCode::new(Number::Exact(Decimal::new(5930, 2).unwrap())).unwrap().to_string(), "G59.3");
    }

    #[test]
    fn a_number_that_is_no_code_is_none() {
        for (mantissa, decimals) in [(-1, 0), (1000, 0), (125, 2)] {
            assert_eq!(GCode::new(Number::Exact(Decimal::new(mantissa, decimals).unwrap())), None);
        }
    }

    #[test]
    fn every_accepted_code_has_a_group_inside_the_table() {
        let accepted = (0..10_000).filter_map(|t| GCode::from_tenths(t).group().ok());
        assert!(accepted.clone().all(|g| g.index() < Group::COUNT));
        assert_eq!(accepted.count(), 43);
    }
}
