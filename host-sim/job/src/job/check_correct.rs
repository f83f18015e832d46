//! The `[correct]` table.

use truepath_core::correct::Target;
use truepath_core::job::{Correct, LawName};
use truepath_core::units::Offset;
use truepath_ground::decimal::Decimal;
use truepath_ground::diagnostics::{InputError, Source};
use truepath_ground::document::Section;
use truepath_ground::limits::Limits;
use truepath_ground::units::mm;

use super::Route;

/// Correction allowed when the job does not say: 0.5 mm.
const DEFAULT_CLAMP: Offset = Offset::from_um(500);
/// Tolerance of the written path when the job does not say: 1 µm.
const DEFAULT_TOLERANCE: Offset = Offset::from_um(1);

/// Largest radius of a written arc when the job does not say: 1 m, which every control takes.
const DEFAULT_ARC_RADIUS: Offset = Offset::from_um(1_000_000);

/// How the corrected program is written; the command line's affair, not the device's.
#[derive(Clone, Copy, Debug)]
pub(super) struct Writing {
    pub(super) tolerance: Offset,
    pub(super) max_arc_radius: Offset,
    pub(super) max_kink_deg: f64,
    pub(super) discrepancy: bool,
    pub(super) route: Route,
}

/// Routes by name.
pub const ROUTES: [(&str, Route); 2] = [("program", Route::Program), ("coprocessor", Route::Coprocessor)];

/// What is made of what the points show beside machine and material, by name.
const DISCREPANCY: [(&str, bool); 2] = [("cancel", true), ("ignore", false)];

/// What the table says.
pub(super) fn correct(
    source: &Source,
    section: Option<&Section<'_>>,
    depth: Option<Offset>,
) -> Result<(Correct, Writing), InputError> {
    const LAWS: [(&str, LawName); 3] =
        [("model", LawName::Model), ("mirror", LawName::Mirror), ("paper", LawName::Paper)];
    const TARGETS: [(&str, Target); 3] = [("mean", Target::Mean), ("tip", Target::Tip), ("minimax", Target::Minimax)];
    let mut correct = Correct {
        law: LawName::Model,
        clamp: DEFAULT_CLAMP,
        target: Target::Mean,
        band: [Offset::ZERO, depth.unwrap_or_default()],
        max_gouge: None,
        setup: 1,
    };
    let mut writing = Writing {
        tolerance: DEFAULT_TOLERANCE,
        max_arc_radius: DEFAULT_ARC_RADIUS,
        max_kink_deg: 1.0,
        discrepancy: true,
        route: Route::Program,
    };
    let Some(section) = section else { return Ok((correct, writing)) };
    correct.law = section.choice("law", &LAWS)?.unwrap_or(correct.law);
    let length =
        |key, limits, otherwise| Ok::<_, InputError>(section.number(key, limits)?.map_or(otherwise, Decimal::as_mm));
    writing.tolerance = length("tolerance_mm", Limits::within("0.0001", "0.1", "mm"), writing.tolerance)?;
    writing.max_arc_radius = length("max_arc_radius_mm", Limits::within("10", "100000", "mm"), writing.max_arc_radius)?;
    if let Some(degrees) = section.number("max_kink_deg", Limits::within("0.1", "10", "degrees"))? {
        writing.max_kink_deg = degrees.as_billionths() as f64 / 1e9;
    }
    correct.clamp = section.number("clamp_mm", Limits::above("0", "4", "mm"))?.map_or(correct.clamp, Decimal::as_mm);
    correct.target = section.choice("target", &TARGETS)?.unwrap_or(correct.target);
    correct.band = band(source, section, depth)?.unwrap_or(correct.band);
    correct.max_gouge = section.number("max_gouge_mm", Limits::within("0", "1", "mm"))?.map(Decimal::as_mm);
    let clamping = "number the clampings of a part from 1";
    correct.setup = section.whole("setup", Limits::within("1", "99999", ""), clamping)?.unwrap_or(correct.setup);
    writing.discrepancy = section.choice("discrepancy", &DISCREPANCY)?.unwrap_or(writing.discrepancy);
    writing.route = section.choice("route", &ROUTES)?.unwrap_or(Route::Program);
    section.close()?;
    Ok((correct, writing))
}

fn band(source: &Source, section: &Section<'_>, depth: Option<Offset>) -> Result<Option<[Offset; 2]>, InputError> {
    let Some(value) = section.value("band_mm") else { return Ok(None) };
    let Some(depth) = depth else {
        let found = "correct.band_mm is given without cut.axial_depth_mm";
        return Err(section.contradiction(&value, found, "both, or neither", "add axial_depth_mm to [cut]"));
    };
    let expected = format!("two heights above the cutter's tip, rising, within 0 to {} mm", mm(depth));
    let help = "write band_mm = [low, high]; cut.axial_depth_mm bounds it";
    let Some([low, high]) =
        value.raw.as_array().map(|a| a.iter().collect::<Vec<_>>()).and_then(|v| <[_; 2]>::try_from(v).ok())
    else {
        return Err(section.wrong_type(&value, &expected, help));
    };
    let height = |entry: &toml::Spanned<toml::de::DeValue<'_>>| {
        let text = source.excerpt(entry.span());
        if entry.get_ref().is_integer() || entry.get_ref().is_float() {
            Decimal::parse(&text).map(|height| value.mm(height).as_mm())
        } else {
            None
        }
    };
    match (height(low), height(high)) {
        (Some(low), Some(high)) if low >= Offset::ZERO && low < high && high <= depth => Ok(Some([low, high])),
        _ => Err(section.out_of_range(&value, &expected, help)),
    }
}
