//! The states of the safety contract, by name.

use core::fmt;

use serde::{Deserialize, Serialize};

/// The states of the safety contract.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[repr(u8)]
pub enum Mode {
    /// After power-up or reset: nothing goes out, until the controller acknowledges that the drives are disabled.
    #[default]
    Off = 0,
    /// Positions unchanged.
    Bypass = 1,
    /// Positions unchanged; waiting for the gate.
    Armed = 2,
    /// Corrected positions; also while the correction ramps out behind the end of the path.
    Active = 3,
    /// Place frozen, correction held.
    Hold = 4,
    /// The correction ramps to zero, then `Bypass`.
    Fault = 5,
}

impl fmt::Display for Mode {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Off => "Off",
            Self::Bypass => "Bypass",
            Self::Armed => "Armed",
            Self::Active => "Active",
            Self::Hold => "Hold",
            Self::Fault => "Fault",
        })
    }
}
