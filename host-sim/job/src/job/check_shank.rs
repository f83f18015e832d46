//! What `[tool]` says of a cutter's shape as a beam, beside stick-out and material: fluted part and shank.

use truepath_core::job::Tool;
use truepath_core::units::Offset;
use truepath_ground::decimal::Decimal;
use truepath_ground::diagnostics::InputError;
use truepath_ground::document::Section;
use truepath_ground::limits::Limits;
use truepath_ground::units::mm;

/// The shape of a cutter as a beam; used by `truepath pocket`. What is not given follows from the rest of the table.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Shank {
    /// Length of the fluted part, up to the stick-out; without it all of the stick-out is fluted.
    pub flute_length: Option<Offset>,
    /// Diameter of the shank; without it the cutting diameter.
    pub diameter: Option<Offset>,
    /// Equivalent diameter of the fluted part over the cutting diameter, 0.3…1; without it by tooth count.
    pub core_ratio: Option<f64>,
    /// Young's modulus, 50…800 kN/mm²; without it that of the material.
    pub modulus_kn_per_mm2: Option<f64>,
}

/// Reads the keys; the section stays open.
pub(super) fn shank(section: &Section<'_>) -> Result<Shank, InputError> {
    let length = |key, limits| Ok::<_, InputError>(section.number(key, limits)?.map(Decimal::as_mm));
    let plain = |number: Decimal| number.as_billionths() as f64 / 1e9;
    Ok(Shank {
        flute_length: length("flute_length_mm", Limits::above("0", "500", "mm"))?,
        diameter: length("shank_diameter_mm", Limits::within("0.1", "100", "mm"))?,
        core_ratio: section.number("core_ratio", Limits::within("0.3", "1", ""))?.map(plain),
        modulus_kn_per_mm2: section.number("modulus_kn_per_mm2", Limits::within("50", "800", "kN/mm²"))?.map(plain),
    })
}

/// The fluted part cannot be longer than what sticks out, and without a stick-out there is no beam to describe.
pub(super) fn within_stickout(section: &Section<'_>, tool: &Tool, shank: &Shank) -> Result<(), InputError> {
    let keys = ["flute_length_mm", "shank_diameter_mm", "core_ratio", "modulus_kn_per_mm2"];
    let Some(cantilever) = tool.cantilever else {
        return match keys.into_iter().find_map(|key| section.value(key)) {
            None => Ok(()),
            Some(value) => {
                let found = format!("{} is given without tool.stickout_mm", value.path);
                let expected = "stickout_mm and material beside it: the cutter is a beam only with both";
                Err(section.contradiction(&value, &found, expected, "add stickout_mm and material, or remove this key"))
            }
        };
    };
    match (shank.flute_length, section.value("flute_length_mm")) {
        (Some(length), Some(value)) if length > cantilever.length => {
            let expected = format!("at most tool.stickout_mm, {} mm", mm(cantilever.length));
            let help = "count only the flutes outside the collet, or measure the stick-out again";
            Err(section.contradiction(&value, "the flutes are longer than the cutter sticks out", &expected, help))
        }
        _ => Ok(()),
    }
}
