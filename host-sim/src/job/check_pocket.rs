//! The `[pocket]` table: what `truepath pocket` cuts, and how far its walls may be off.

use truepath_core::units::Offset;

use super::Decimal;
use super::document::Section;
use super::limits::Limits;
use crate::diagnostics::InputError;
use crate::pocket::{Mode, PerSection};

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
