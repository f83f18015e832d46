//! The `[correct]` table.

use truepath_core::correct::Target;
use truepath_core::job::{Correct, LawName};
use truepath_core::units::Offset;

use super::check::text_of;
use super::document::Section;
use super::limits::Limits;
use super::{Decimal, Route};
use crate::diagnostics::{InputError, Source};

/// Correction allowed when the job does not say: 0.5 mm.
const DEFAULT_CLAMP: Offset = Offset::from_um(500);
/// Tolerance of the written path when the job does not say: 1 µm.
const DEFAULT_TOLERANCE: Offset = Offset::from_um(1);

/// What the table says; the tolerance of the written path and the route concern the command line only.
pub(super) fn correct(
    source: &Source,
    section: Option<&Section<'_>>,
    depth: Offset,
) -> Result<(Correct, Offset, Route), InputError> {
    const LAWS: [(&str, LawName); 3] =
        [("model", LawName::Model), ("mirror", LawName::Mirror), ("paper", LawName::Paper)];
    const TARGETS: [(&str, Target); 3] = [("mean", Target::Mean), ("tip", Target::Tip), ("minimax", Target::Minimax)];
    const ROUTES: [(&str, Route); 2] = [("program", Route::Program), ("coprocessor", Route::Coprocessor)];
    let mut correct = Correct {
        law: LawName::Model,
        clamp: DEFAULT_CLAMP,
        target: Target::Mean,
        band: [Offset::ZERO, depth],
        max_gouge: None,
        setup: 1,
    };
    let Some(section) = section else { return Ok((correct, DEFAULT_TOLERANCE, Route::Program)) };
    correct.law = section.choice("law", &LAWS)?.unwrap_or(correct.law);
    let tolerance = section
        .number("tolerance_mm", Limits::within("0.0001", "0.1", "mm"))?
        .map_or(DEFAULT_TOLERANCE, Decimal::as_mm);
    correct.clamp = section.number("clamp_mm", Limits::above("0", "4", "mm"))?.map_or(correct.clamp, Decimal::as_mm);
    correct.target = section.choice("target", &TARGETS)?.unwrap_or(correct.target);
    correct.band = band(source, section, depth)?.unwrap_or(correct.band);
    correct.max_gouge = section.number("max_gouge_mm", Limits::within("0", "1", "mm"))?.map(Decimal::as_mm);
    let clamping = "number the clampings of a part from 1";
    correct.setup = section.whole("setup", Limits::within("1", "99999", ""), clamping)?.unwrap_or(correct.setup);
    let route = section.choice("route", &ROUTES)?.unwrap_or(Route::Program);
    section.close()?;
    Ok((correct, tolerance, route))
}

fn band(source: &Source, section: &Section<'_>, depth: Offset) -> Result<Option<[Offset; 2]>, InputError> {
    let Some(value) = section.value("band_mm") else { return Ok(None) };
    let expected = format!("two heights above the cutter's tip, rising, within 0 to {} mm", text_of(depth));
    let help = "write band_mm = [low, high]; cut.axial_depth_mm bounds it";
    let Some([low, high]) =
        value.raw.as_array().map(|a| a.iter().collect::<Vec<_>>()).and_then(|v| <[_; 2]>::try_from(v).ok())
    else {
        return Err(section.wrong_type(&value, &expected, help));
    };
    let height = |entry: &toml::Spanned<toml::de::DeValue<'_>>| {
        let text = source.excerpt(entry.span());
        if entry.get_ref().is_integer() || entry.get_ref().is_float() {
            Decimal::parse(&text).map(Decimal::as_mm)
        } else {
            None
        }
    };
    match (height(low), height(high)) {
        (Some(low), Some(high)) if low >= Offset::ZERO && low < high && high <= depth => Ok(Some([low, high])),
        _ => Err(section.out_of_range(&value, &expected, help)),
    }
}
