//! How quantities of a job travel that have no form of their own: numbers as units of 2⁻³², choices as one byte.
//!
//! Used as `#[serde(with = "super::wire")]`. A byte that names no choice is refused while the job is read.

use serde::de::{Deserialize, Deserializer, Error};
use serde::ser::{Serialize, Serializer};

use super::facts::Compensation;
use crate::correct::Target;
use crate::cut::{ToolMaterial, WallLaw};
use crate::gcode::{ArcCentres, Dialect, PointlessLength};
use crate::geometry::Side;
use crate::probe::Format;
use crate::units::Real;

/// A quantity with a raw form.
pub(super) trait Wire: Copy {
    /// What is written.
    type Raw: Serialize + for<'de> Deserialize<'de>;
    /// The raw form.
    fn raw(self) -> Self::Raw;
    /// The quantity; `None` for a raw form that means nothing.
    fn from_raw(raw: Self::Raw) -> Option<Self>;
}

pub(super) fn serialize<T: Wire, S: Serializer>(value: &T, serializer: S) -> Result<S::Ok, S::Error> {
    value.raw().serialize(serializer)
}

pub(super) fn deserialize<'de, T: Wire, D: Deserializer<'de>>(deserializer: D) -> Result<T, D::Error> {
    T::from_raw(T::Raw::deserialize(deserializer)?).ok_or_else(|| D::Error::custom("a number that names no choice"))
}

impl Wire for Real {
    type Raw = i64;
    fn raw(self) -> i64 {
        self.bits()
    }
    fn from_raw(raw: i64) -> Option<Self> {
        Some(Self::from_bits(raw))
    }
}

impl<T: Wire> Wire for Option<T> {
    type Raw = Option<T::Raw>;
    fn raw(self) -> Self::Raw {
        self.map(T::raw)
    }
    fn from_raw(raw: Self::Raw) -> Option<Self> {
        match raw {
            None => Some(None),
            Some(raw) => T::from_raw(raw).map(Some),
        }
    }
}

/// A choice as its place in a list.
macro_rules! choice {
    ($type:ty: $($number:literal = $value:path),+) => {
        impl Wire for $type {
            type Raw = u8;
            fn raw(self) -> u8 {
                match self {
                    $($value => $number,)+
                }
            }
            fn from_raw(raw: u8) -> Option<Self> {
                match raw {
                    $($number => Some($value),)+
                    _ => None,
                }
            }
        }
    };
}

choice!(Side: 0 = Side::Left, 1 = Side::Right);
choice!(ToolMaterial: 0 = ToolMaterial::HighSpeedSteel, 1 = ToolMaterial::Carbide);
choice!(
    Format: 0 = Format::Linuxcnc, 1 = Format::Columns, 2 = Format::LinuxcncLog, 3 = Format::Grbl, 4 = Format::Inspection,
    5 = Format::Dprnt
);
choice!(
    Dialect: 0 = Dialect::Linuxcnc, 1 = Dialect::Fanuc, 2 = Dialect::Haas, 3 = Dialect::Siemens, 4 = Dialect::Mach,
    5 = Dialect::Heidenhain
);
choice!(PointlessLength: 0 = PointlessLength::Calculator, 1 = PointlessLength::Least);
choice!(ArcCentres: 0 = ArcCentres::Detect, 1 = ArcCentres::Incremental, 2 = ArcCentres::Absolute);
choice!(Compensation: 0 = Compensation::Centre, 1 = Compensation::Radius);
choice!(Target: 0 = Target::Mean, 1 = Target::Tip, 2 = Target::Minimax);
choice!(WallLaw: 0 = WallLaw::Mean, 1 = WallLaw::Helical);
