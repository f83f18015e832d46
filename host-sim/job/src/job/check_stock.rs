//! The `[stock]` table: an even allowance, as it is or as touches of the stock correct it, or the surface that the pass before left.

use truepath_core::units::Offset;
use truepath_ground::decimal::Decimal;
use truepath_ground::diagnostics::InputError;
use truepath_ground::document::Section;
use truepath_ground::limits::Limits;
use truepath_ground::units::mm;

use super::Roughing;

/// What the table says.
pub(super) struct Stock {
    /// The nominal allowance; where only a surface is given, a fifth of the diameter until the surface has been read.
    pub(super) allowance: Offset,
    /// File of the actual surface.
    pub(super) surface: Option<String>,
    /// File of touches of the stock.
    pub(super) probe: Option<String>,
    /// The cutter that roughs in the same program.
    pub(super) roughing: Option<Roughing>,
}

impl Stock {
    /// Before a slot: the whole of the cutter is in the material, half of it towards either wall.
    pub(super) const fn of_a_slot(diameter: Offset) -> Self {
        Self { allowance: Offset::from_nm(diameter.nm() / 2), surface: None, probe: None, roughing: None }
    }
}

/// What the table says.
pub(super) fn stock(section: &Section<'_>, diameter: Offset) -> Result<Stock, InputError> {
    let limits = Limits::above("0", "100", "mm");
    let surface = section.text("surface")?;
    let probe = section.text("probe")?;
    if let (Some(_), Some((_, place))) = (&surface, &probe) {
        let found = "stock.probe is given as well as stock.surface";
        let help = "remove one of them: probe with allowance_mm, or surface alone";
        return Err(section.contradiction(place, found, "touches of the stock or its actual surface", help));
    }
    if let Some((_, place)) = probe.as_ref().filter(|(name, _)| name.is_empty()) {
        let expected = "the file name of touches of the stock";
        return Err(section.out_of_range(place, expected, "name the probe file, relative to this file"));
    }
    let roughing = roughing(section)?;
    if let (Some((_, place)), Some(_)) = (surface.as_ref().or(probe.as_ref()), &roughing) {
        let found = "stock.roughing_diameter_mm is given as well";
        let help = "remove roughing_diameter_mm: what was measured is what is there";
        return Err(section.contradiction(place, found, "stock that was measured, or what roughing leaves", help));
    }
    let Some(value) = section.value("allowance_mm") else {
        let Some((name, place)) = surface else {
            return Err(
                section.missing("allowance_mm", &format!("a number, {}, or surface", limits.phrase_in(section.unit())))
            );
        };
        if name.is_empty() {
            let expected = "the file name of a table with the columns x_mm and y_mm";
            return Err(section.out_of_range(&place, expected, "name the surface, relative to this file"));
        }
        section.close()?;
        return Ok(Stock {
            allowance: Offset::from_nm(diameter.nm() / 5),
            surface: Some(name.to_owned()),
            probe: None,
            roughing: None,
        });
    };
    let allowance = section.number_in(&value, limits).map(Decimal::as_mm)?;
    if let Some((_, place)) = surface {
        let found = "stock.surface is given as well as stock.allowance_mm";
        let help = "remove allowance_mm: it follows from the surface";
        return Err(section.contradiction(&place, found, "an even allowance or an actual surface", help));
    }
    if allowance >= diameter {
        let expected = format!("less than the cutter's diameter, {} mm", mm(diameter));
        let help = "take the stock off in more passes, or correct tool.diameter_mm";
        return Err(section.out_of_range(&value, &expected, help));
    }
    section.close()?;
    Ok(Stock { allowance, surface: None, probe: probe.map(|(name, _)| name.to_owned()), roughing })
}

/// The cutter whose passes leave the stock.
fn roughing(section: &Section<'_>) -> Result<Option<Roughing>, InputError> {
    let limits = Limits::within("0.1", "100", "mm");
    let diameter = section.number("roughing_diameter_mm", limits)?.map(Decimal::as_mm);
    let named = section.value("roughing_tool");
    let tool =
        section.whole("roughing_tool", Limits::within("0", "99999", ""), "the T number of the roughing cutter")?;
    match (diameter, named) {
        (None, Some(place)) => {
            let expected = "roughing_diameter_mm beside roughing_tool";
            Err(section.contradiction(
                &place,
                "a roughing cutter without a diameter",
                expected,
                "add roughing_diameter_mm",
            ))
        }
        (diameter, _) => Ok(diameter.map(|diameter| Roughing { diameter, tool })),
    }
}
