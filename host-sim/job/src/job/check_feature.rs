//! The `[[feature]]` tables: cuts of the program by name.
//!
//! A feature names its place in one of three ways: `blocks = [first, last]` (N words when the program has any, line
//! numbers when it has none), `lines = [first, last]` (always line numbers), or neither, when the program holds
//! `(TRUEPATH BEGIN id)` and `(TRUEPATH END)`.

use std::ops::Range;

use toml::Spanned;
use toml::de::DeValue;
use truepath_core::geometry::Side;
use truepath_core::units::{Offset, Position};
use truepath_ground::codes::J008;
use truepath_ground::decimal::Decimal;
use truepath_ground::diagnostics::{InputError, Source};
use truepath_ground::document::{Section, Value};
use truepath_ground::limits::Limits;
use truepath_ground::units::mm;

/// What a cut is for; only finishing is corrected.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FeatureRole {
    /// Takes off the bulk.
    Rough,
    /// Prepares an even allowance.
    Semi,
    /// Makes the wall.
    Finish,
    /// Goes over the finished wall again.
    Spring,
}

/// How a feature says where it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FeaturePlace {
    /// By comments in the program.
    Markers,
    /// By N words, or line numbers in a program without N words.
    Blocks([u32; 2]),
    /// By line numbers.
    Lines([u32; 2]),
}

/// One `[[feature]]`.
#[derive(Clone, Debug)]
pub struct FeatureTable {
    /// Its name.
    pub id: String,
    /// Where it is.
    pub place: FeaturePlace,
    /// The tool that cuts it, 1…99,999.
    pub tool: Option<u32>,
    /// Side of its wall, over that of the job.
    pub wall: Option<Side>,
    /// What it is for.
    pub role: FeatureRole,
    /// Stock on its wall, over that of the job.
    pub allowance: Option<Offset>,
    /// Heights of its passes, program coordinates.
    pub heights: Option<Vec<Position>>,
    /// Where the name stands in the job.
    pub(crate) id_span: Range<usize>,
    /// Where the place stands.
    pub(crate) place_span: Range<usize>,
    /// Where the tool stands.
    pub(crate) tool_span: Range<usize>,
    /// Where the heights stand.
    pub(crate) heights_span: Range<usize>,
}

/// All of them, in their order.
pub(super) fn features(source: &Source, root: &Section<'_>, diameter: Offset) -> Result<Vec<FeatureTable>, InputError> {
    let mut list: Vec<FeatureTable> = Vec::new();
    for section in root.sections("feature")? {
        let feature = feature(&section, diameter)?;
        if let Some(first) = list.iter().find(|f| f.id == feature.id) {
            let (line, _) = source.line_column(first.id_span.start);
            let found = format!("the feature \"{}\" is given twice, first on line {line}", feature.id);
            let help = "give every feature a name of its own";
            return Err(InputError::new(J008, found, "every name once", help).at(source, feature.id_span));
        }
        list.push(feature);
    }
    Ok(list)
}

fn feature(section: &Section<'_>, diameter: Offset) -> Result<FeatureTable, InputError> {
    const ROLES: [(&str, FeatureRole); 4] = [
        ("rough", FeatureRole::Rough),
        ("semi", FeatureRole::Semi),
        ("finish", FeatureRole::Finish),
        ("spring", FeatureRole::Spring),
    ];
    const NUMBER: &str = "take the number from the T word of the program";
    let Some((id, value)) = section.text("id")? else {
        return Err(section.missing("id", "a name in quotation marks"));
    };
    if !is_id(id) {
        let expected = "1 to 64 letters, digits, `-`, `_` or `.`";
        return Err(section.out_of_range(
            &value,
            expected,
            "choose a short name: it may stand in a comment of the program",
        ));
    }
    let (blocks, lines) = (section.value("blocks"), section.value("lines"));
    let (place, place_span) = match (&blocks, &lines) {
        (Some(blocks), None) => (FeaturePlace::Blocks(range(section, blocks)?), blocks.span.clone()),
        (None, Some(lines)) => (FeaturePlace::Lines(range(section, lines)?), lines.span.clone()),
        (None, None) => (FeaturePlace::Markers, value.span.clone()),
        (Some(_), Some(lines)) => {
            return Err(section.out_of_range(lines, "either blocks or lines", "remove one of the two"));
        }
    };
    let span_of = |key| section.value(key).map_or_else(|| value.span.clone(), |v| v.span);
    let feature = FeatureTable {
        id: id.to_owned(),
        place,
        tool: section.whole("tool", Limits::within("1", "99999", ""), NUMBER)?,
        wall: section.choice("wall", &[("left", Side::Left), ("right", Side::Right)])?,
        role: section.choice("role", &ROLES)?.unwrap_or(FeatureRole::Finish),
        allowance: allowance(section, diameter)?,
        heights: heights(section)?,
        id_span: value.span.clone(),
        place_span,
        tool_span: span_of("tool"),
        heights_span: span_of("z_mm"),
    };
    section.close()?;
    Ok(feature)
}

/// What may stand in a comment of a program as a name.
pub(crate) fn is_id(text: &str) -> bool {
    (1..=64).contains(&text.len()) && text.bytes().all(|b| b.is_ascii_alphanumeric() || b"-_.".contains(&b))
}

fn range(section: &Section<'_>, value: &Value<'_>) -> Result<[u32; 2], InputError> {
    let expected = "two whole numbers, the first and the last, rising, 0 to 99999999";
    let help = "write [first, last]";
    let entries: Vec<_> = value.raw.as_array().map(|a| a.iter().collect()).unwrap_or_default();
    let [first, last] = entries[..] else { return Err(section.wrong_type(value, expected, help)) };
    let whole = |entry: &Spanned<DeValue<'_>>| {
        let number = number(section, entry).and_then(Decimal::as_whole)?;
        u32::try_from(number).ok().filter(|n| *n <= 99_999_999)
    };
    match (whole(first), whole(last)) {
        (Some(first), Some(last)) if first <= last => Ok([first, last]),
        _ => Err(section.out_of_range(value, expected, help)),
    }
}

fn number(section: &Section<'_>, entry: &Spanned<DeValue<'_>>) -> Option<Decimal> {
    let is_number = entry.get_ref().is_integer() || entry.get_ref().is_float();
    is_number.then(|| Decimal::parse(&section.text_at(entry.span())))?
}

fn allowance(section: &Section<'_>, diameter: Offset) -> Result<Option<Offset>, InputError> {
    let Some(value) = section.value("allowance_mm") else { return Ok(None) };
    let allowance = section.number_in(&value, Limits::above("0", "100", "mm"))?.as_mm();
    if allowance < diameter {
        return Ok(Some(allowance));
    }
    let expected = format!("less than the cutter's diameter, {} mm", mm(diameter));
    Err(section.out_of_range(&value, &expected, "take the stock off in more passes, or correct tool.diameter_mm"))
}

fn heights(section: &Section<'_>) -> Result<Option<Vec<Position>>, InputError> {
    let Some(value) = section.value("z_mm") else { return Ok(None) };
    let expected = "heights of the passes, -4000 to 4000 mm";
    let help = "write z_mm = [-7.5, -15.0]: one height for every pass, in program coordinates";
    let entries = value.raw.as_array().filter(|list| !list.is_empty());
    let entries = entries.ok_or_else(|| section.wrong_type(&value, expected, help))?;
    let reach = Offset::from_um(4_000_000);
    let height = |entry| number(section, entry).map(|z| value.mm(z).as_mm()).filter(|z| z.abs() <= reach);
    let list: Option<Vec<Position>> = entries.iter().map(|e| height(e).map(|z| Position::from_nm(z.nm()))).collect();
    list.map(Some).ok_or_else(|| section.out_of_range(&value, expected, help))
}
