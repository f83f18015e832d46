//! The `[pocket]` table: what `truepath pocket` cuts, and how far its walls may be off.

use truepath_core::units::Offset;
use truepath_ground::decimal::Decimal;
use truepath_ground::diagnostics::InputError;
use truepath_ground::document::Section;
use truepath_ground::limits::Limits;

/// What is cut.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Mode {
    /// A finishing pass along one wall.
    Wall,
    /// A slot at full immersion, with a wall on either side.
    Slot,
}

/// How the stations of a section are shifted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum PerSection {
    /// By the predicted profile of the error.
    Profile,
    /// By one value.
    ///
    /// As in LG03.
    Constant,
}

/// What the table says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PocketTable {
    /// A finishing pass along a wall, or a slot.
    pub mode: Mode,
    /// Half of the width of the band the walls may lie in, 0.000001 to 1 mm.
    pub tolerance: Offset,
    /// How a section is shifted.
    pub per_section: PerSection,
}

/// Half band when the job does not say: 0.02 mm.
const DEFAULT_TOLERANCE: Offset = Offset::from_um(20);

/// Names of what is cut.
const MODES: [(&str, Mode); 2] = [("wall", Mode::Wall), ("slot", Mode::Slot)];
/// Names of the ways to shift a section.
const WAYS: [(&str, PerSection); 2] = [("profile", PerSection::Profile), ("constant", PerSection::Constant)];

/// Reads the table.
pub(super) fn pocket(section: &Section<'_>) -> Result<PocketTable, InputError> {
    let mode = section.choice("mode", &MODES)?.unwrap_or(Mode::Wall);
    let tolerance = section.number("tolerance_mm", Limits::within("0.000001", "1", "mm"))?;
    let per_section = section.choice("per_section", &WAYS)?.unwrap_or(PerSection::Profile);
    section.close()?;
    let tolerance = tolerance.map_or(DEFAULT_TOLERANCE, Decimal::as_mm);
    Ok(PocketTable { mode, tolerance, per_section })
}

impl Default for PocketTable {
    /// A finishing pass, 0.02 mm, the profile.
    fn default() -> Self {
        Self { mode: Mode::Wall, tolerance: DEFAULT_TOLERANCE, per_section: PerSection::Profile }
    }
}
