//! G codes: what they are called, which exclude each other, and which are refused.
//!
//! Modal groups: RS274/NGC (NIST 6556) table 4, with the additions of LinuxCNC, Fanuc and Haas. Codes that would change
//! where the cutter goes in a way not computed here are refused by name; of those only the codes that cancel such a
//! thing, which is then never on, are accepted without effect.

use super::{Dialect, GCode, GcodeErrorKind, Number, SettingError};

/// Codes of one group exclude each other in a block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Group {
    /// G4 G10 G28 G30 G52 G53 G65 G92 and theirs: this block only.
    OneShot,
    /// G0 G1 G2 G3, splines, probing, cycles, G80.
    Motion,
    /// G17 G18 G19.
    Plane,
    /// G90 G91.
    Distance,
    /// G90.1 G91.1.
    ArcDistance,
    /// G93 G94 G95.
    FeedMode,
    /// G20 G21, G70 G71.
    Units,
    /// G40 G41 G42.
    Compensation,
    /// G43 G43.1 G43.2 G44 G49.
    ToolLength,
    /// G98 G99.
    ReturnLevel,
    /// G54 … G59.3, G54.1, G154.
    WorkOffset,
    /// G61 G61.1 G64.
    PathControl,
    /// G96 G97.
    SpindleMode,
    /// How closely and how fast the path is followed, beside [`Self::PathControl`]: G187, and what [`GCode::group_in`] adds.
    Smoothness,
    /// G8: radius programming, which is what a mill does.
    Diameter,
    /// G13.1 G15 G40.1 G50 G50.1 G67 G69: cancel polar coordinates, the turning of a tool with its path, scaling, mirroring, a modal
    /// macro, rotation, which are all refused. They do not exclude each other.
    Cancel,
}

impl Group {
    /// Number of groups.
    pub(super) const COUNT: usize = 16;

    /// Its place in a set.
    pub(super) const fn bit(self) -> u32 {
        1u32.wrapping_shl(self as u32)
    }
}

impl GCode {
    /// From a written number; `None` when it is negative, above 999.9 or has more than one decimal.
    pub fn new(value: Number) -> Option<Self> {
        match value.exactly_times(10) {
            Some(tenths) if (0..10_000).contains(&tenths) => Some(Self::from_tenths(tenths as u16)),
            _ => None,
        }
    }

    /// The code that stands for one of a dialect: G153 of Siemens is G53, G700 and G710 are G70 and G71, for feeds as well.
    pub(super) const fn in_dialect(self, dialect: Dialect) -> Self {
        match (dialect, self.tenths()) {
            (Dialect::Siemens, 1_530) => Self::from_tenths(530),
            (Dialect::Siemens, 7_000) => Self::from_tenths(700),
            (Dialect::Siemens, 7_100) => Self::from_tenths(710),
            _ => self,
        }
    }

    /// The group it belongs to in a dialect. Some codes only say how closely and how fast a path is followed: look-ahead
    /// and high speed (G5, G5.1, G8) of Fanuc and Haas, exact stop (G9), slower corners and the watch over the spindle of
    /// Fanuc (G62, G25, G26), the look-ahead limit of Haas (G103), and those of Siemens (G60, G601 … G603, G641 … G645, G450,
    /// G451). G110 … G129 of Haas are its further work offsets.
    ///
    /// # Errors
    /// As [`Self::group`].
    pub(super) const fn group_in(self, dialect: Dialect) -> Result<Group, GcodeErrorKind> {
        match (dialect, self.tenths()) {
            (Dialect::Haas, tenths) if tenths >= 1_100 && tenths <= 1_290 && tenths % 10 == 0 => Ok(Group::WorkOffset),
            (Dialect::Fanuc, 131) => Ok(Group::Cancel),
            (Dialect::Fanuc | Dialect::Haas, 50 | 51 | 80 | 90)
            | (Dialect::Fanuc, 250 | 260 | 620)
            | (Dialect::Haas, 1030)
            | (Dialect::Siemens, 90 | 600 | 6_010 | 6_020 | 6_030 | 4_500 | 4_510)
            | (Dialect::Siemens, 6_410 | 6_420 | 6_430 | 6_440 | 6_450) => Ok(Group::Smoothness),
            _ => self.group(),
        }
    }

    /// The group it belongs to.
    ///
    /// # Errors
    /// The reason for which it is refused, or [`GcodeErrorKind::UnknownG`].
    pub(super) const fn group(self) -> Result<Group, GcodeErrorKind> {
        Ok(match self.tenths() {
            0 | 10 | 20 | 30 | 50..=53 | 331 | 382..=385 | 730 | 740 | 760 => Group::Motion,
            800 | 810 | 820 | 830 | 840 | 850 | 860 | 870 | 880 | 890 => Group::Motion,
            40 | 100 | 280 | 281 | 300 | 301 | 520 | 530 | 650 | 920..=923 => Group::OneShot,
            170 | 180 | 190 => Group::Plane,
            900 | 910 => Group::Distance,
            901 | 911 => Group::ArcDistance,
            930 | 940 | 950 => Group::FeedMode,
            200 | 210 | 700 | 710 => Group::Units,
            400 | 410 | 411 | 420 | 421 => Group::Compensation,
            430..=432 | 440 | 490 => Group::ToolLength,
            980 | 990 => Group::ReturnLevel,
            540 | 541 | 550 | 560 | 570 | 580 | 590..=593 | 1540 => Group::WorkOffset,
            610 | 611 | 640 => Group::PathControl,
            960 | 970 => Group::SpindleMode,
            1870 => Group::Smoothness,
            80 => Group::Diameter,
            150 | 401 | 500 | 501 | 670 | 690 => Group::Cancel,
            171 | 181 | 191 => return Err(GcodeErrorKind::WrongPlane(self)),
            70 | 330 | 720 => return Err(GcodeErrorKind::Setting(SettingError::Lathe(self))),
            651 | 652 | 660 => return Err(GcodeErrorKind::Macro(self)),
            60..=62 | 434 | 542..=549 => return Err(GcodeErrorKind::Unsupported(self)),
            160 | 310 | 380 | 510 | 511 | 680..=683 => return Err(GcodeErrorKind::Unsupported(self)),
            _ => return Err(GcodeErrorKind::UnknownG(self)),
        })
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
        assert!(accepted.clone().all(|g| (g as usize) < Group::COUNT));
        assert_eq!(accepted.count(), 89);
    }
}
