//! The `[tool]` table: the cutter, and its shape as a beam.

use std::path::Path;

use truepath_core::cut::ToolMaterial;
use truepath_core::job::{Compensation, Cut, Stickout, Tool};
use truepath_core::units::{Offset, Real};
use truepath_ground::codes::J008;
use truepath_ground::decimal::Decimal;
use truepath_ground::diagnostics::{InputError, Source};
use truepath_ground::document::Section;
use truepath_ground::limits::Limits;
use truepath_ground::units::mm;

use super::measured;
use super::open::{Assumed, Open, USUAL_HELIX};
use crate::post::ToolNote;

/// Where numbers of tools and their offsets come from.
const TABLE: &str = "take the number from the tool table of the control";

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

/// What the table says of the cutter, and of its shape as a beam. What it leaves open comes from a comment of the program;
/// where several cutters may be meant they are given too, and the contour decides.
pub(super) fn tool(
    source: &Source,
    section: &Section<'_>,
    folder: &Path,
    open: &Open,
    assumed: &mut Vec<Assumed>,
) -> Result<(Tool, Shank, Vec<ToolNote>), InputError> {
    let limits = Limits::within("0.1", "100", "mm");
    let stated = section.number("diameter_mm", limits)?.map(Decimal::as_mm);
    let mut number = section.whole("number", Limits::within("1", "99999", ""), TABLE)?;
    let mut cutters = Vec::new();
    let mut note = None;
    let diameter = match stated {
        Some(diameter) => {
            if let Some((found, noted)) = open.of_diameter(number, diameter) {
                note = Some(noted);
                if number.is_none() && found.is_some() {
                    assumed.extend(found.map(|n| noted.assumed("tool.number", n.to_string())));
                    number = found;
                }
            }
            diameter
        }
        None => match (open.mill(number), open.post()) {
            (Some(noted), _) => {
                note = Some(noted);
                let diameter = noted.diameter();
                assumed.push(noted.assumed("tool.diameter_mm", mm(diameter).to_string()));
                diameter
            }
            (None, Some(post)) if number.is_none() && post.mills().len() > 1 => {
                cutters = post.mills().into_iter().cloned().collect();
                // Replaced as soon as the contour is known.
                cutters.iter().map(ToolNote::diameter).max().unwrap_or_default()
            }
            _ => section.required_number("diameter_mm", limits)?.as_mm(),
        },
    };
    let measured = section.value("measured_diameter_mm");
    let measured_diameter = match &measured {
        None => None,
        Some(value) => {
            let measured = section.number_in(value, Limits::within("0.1", "110", "mm"))?.as_mm();
            if (measured - diameter).abs().nm() > diameter.nm() / 10 {
                let expected = format!("a diameter within 10 % of diameter_mm, {} mm", mm(diameter));
                return Err(section.out_of_range(value, &expected, "check which of the two is mistyped"));
            }
            Some(measured)
        }
    };
    let limits = Limits::within("1", "12", "");
    let teeth = match (section.whole("teeth", limits, "count the cutter's teeth")?, note) {
        (Some(teeth), _) => teeth,
        (None, Some(ToolNote { teeth: Some(teeth), .. })) => {
            assumed.extend(note.map(|note| note.assumed("tool.teeth", teeth.to_string())));
            u8::try_from(*teeth).unwrap_or(1)
        }
        (None, _) if cutters.iter().any(|cutter| cutter.teeth.is_some()) => 1,
        (None, _) => return Err(section.missing("teeth", "a whole number, 1 to 12")),
    };
    let offset_number = section.whole("offset_number", Limits::within("0", "99999", ""), TABLE)?.unwrap_or(0);
    let helix_deg = section.number("helix_deg", Limits::within("0", "60", "degrees"))?.map(Decimal::as_real);
    let helix_deg = helix_deg.unwrap_or_else(|| {
        let why = "30 to 45 degrees is what is sold; it decides how the error varies over the height".to_owned();
        assumed.push(Assumed { key: "tool.helix_deg", value: USUAL_HELIX.to_owned(), why, line: None });
        Decimal::parse(USUAL_HELIX).map(Decimal::as_real).unwrap_or_default()
    });
    let stickout = section.number("stickout_mm", Limits::above("0", "500", "mm"))?.map(Decimal::as_mm);
    let materials = [("HSS", ToolMaterial::HighSpeedSteel), ("carbide", ToolMaterial::Carbide)];
    let material = section.choice("material", &materials)?;
    let cantilever = match (stickout, material) {
        (Some(length), Some(material)) => Some(Stickout { length, material }),
        (None, None) => None,
        (given, _) => {
            let (there, other) =
                if given.is_some() { ("stickout_mm", "material") } else { ("material", "stickout_mm") };
            let place = section.value(there).map_or(0..0, |v| v.span);
            let help = format!("add {other}, or remove {there}");
            let found = format!("tool.{there} is given without tool.{other}");
            return Err(InputError::new(J008, found, "both or neither: the cutter's own compliance needs both", help)
                .with_keys_in(section.unit())
                .at(source, place));
        }
    };
    let (runout, runout_deg) = runout(source, section, folder)?;
    let choices = [("centre", Compensation::Centre), ("radius", Compensation::Radius)];
    let compensation = section.choice("compensation", &choices)?.unwrap_or_default();
    let shank = shank(section)?;
    section.close()?;
    let tool = Tool {
        diameter,
        measured_diameter,
        runout,
        runout_deg,
        teeth,
        helix_deg,
        cantilever,
        number,
        offset_number,
        compensation,
    };
    within_stickout(section, &tool, &shank)?;
    Ok((tool, shank, cutters))
}

/// The radial offset of the axis and its direction behind a tooth, degrees; nothing for a cutter that runs true.
fn runout(source: &Source, section: &Section<'_>, folder: &Path) -> Result<(Offset, Real), InputError> {
    const KEYS: [&str; 2] = ["runout_mm", "runout_deg"];
    let limits = [Limits::within("0", "0.2", "mm"), Limits::within("0", "360", "degrees")];
    let read = |section: &Section<'_>, [offset, behind]: [&'static str; 2]| {
        let offset = section.number(offset, limits[0])?.map(Decimal::as_mm);
        Ok::<_, InputError>((offset, section.number(behind, limits[1])?.map_or(Real::ZERO, Decimal::as_real)))
    };
    if let Some((name, place)) = section.text("runout_from")? {
        if let Some(value) = KEYS.into_iter().find_map(|key| section.value(key)) {
            let found = format!("{} is given as well as tool.runout_from", value.path);
            let help = "remove runout_from, or what it takes the place of";
            return Err(section.contradiction(&value, &found, "the runout of a file or a stated one", help));
        }
        return measured::read(source, place.span, &folder.join(name), |root| {
            let help = "offset_mm, which truepath forces writes where a record shows runout";
            let section = root.required_section("runout", help)?;
            match read(&section, ["offset_mm", "behind_deg"])? {
                (Some(offset), behind) => Ok((offset, behind)),
                (None, _) => Err(section.missing("offset_mm", help)),
            }
        });
    }
    match (read(section, KEYS)?, section.value(KEYS[1])) {
        ((None, _), Some(value)) => {
            let found = "tool.runout_deg is given without tool.runout_mm";
            Err(section.contradiction(&value, found, "both, or runout_mm alone", "add runout_mm, or remove this key"))
        }
        ((offset, behind), _) => Ok((offset.unwrap_or(Offset::ZERO), behind)),
    }
}

/// The cutter must stick out, and have flutes, at least as far as it cuts deep.
pub(super) fn reach(
    source: &Source,
    section: &Section<'_>,
    (tool, shank): (&Tool, &Shank),
    cut: &Cut,
) -> Result<(), InputError> {
    if let (Some(length), Some(value)) = (shank.flute_length, section.value("flute_length_mm"))
        && length < cut.axial_depth
    {
        let expected = format!("at least cut.axial_depth_mm, {} mm", mm(cut.axial_depth));
        let help = "flutes shorter than the cut is deep do not cut at its top: correct one of them";
        return Err(section.contradiction(&value, "the flutes are shorter than the cut is deep", &expected, help));
    }
    match (tool.cantilever, section.value("stickout_mm")) {
        (Some(c), Some(value)) if c.length < cut.axial_depth => {
            let expected = format!("at least cut.axial_depth_mm, {} mm", mm(cut.axial_depth));
            let found = format!("{} is {}", value.path, source.excerpt(value.span.clone()));
            Err(section.contradiction(&value, &found, &expected, "measure from the collet to the cutter's tip"))
        }
        _ => Ok(()),
    }
}

/// Reads the keys; the section stays open.
fn shank(section: &Section<'_>) -> Result<Shank, InputError> {
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
fn within_stickout(section: &Section<'_>, tool: &Tool, shank: &Shank) -> Result<(), InputError> {
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
