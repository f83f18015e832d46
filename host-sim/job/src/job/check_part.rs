//! The `[part]` table: what a customer is told about a part, and the tolerance its wall is judged by.
//!
//! Every key is optional, and so is the table; `truepath inspect` judges by it, the reports of other commands show name
//! and tolerance. Tolerances are limits of the wall error: material left is positive.

use truepath_core::units::Offset;
use truepath_ground::codes::C001;
use truepath_ground::decimal::Decimal;
use truepath_ground::diagnostics::InputError;
use truepath_ground::document::{Section, Value};
use truepath_ground::limits::Limits;
use truepath_ground::units::mm;

/// Longest text, characters.
const LONGEST: usize = 100;
const TEXT_EXPECTED: &str = "1 to 100 characters on one line, none of them invisible";
const HALF_WIDTH: Limits = Limits::within("0.0001", "10", "mm");
const LIMIT: Limits = Limits::within("-10", "10", "mm");

/// What a part is called.
#[derive(Clone, Debug, Default, PartialEq, Eq, serde::Serialize)]
pub struct PartNames {
    /// Its name.
    pub name: Option<String>,
    /// Its drawing.
    pub drawing: Option<String>,
    /// Its serial number.
    pub serial: Option<String>,
    /// Batch of the material.
    pub material_batch: Option<String>,
    /// Who receives it.
    pub customer: Option<String>,
    /// When it was measured, as somebody has written it: no clock is read.
    pub date: Option<String>,
}

/// What the table says, and what the command line says in its place.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct PartTable {
    /// What the part is called.
    pub names: PartNames,
    /// The limits of the wall error.
    pub tolerance: Option<Tolerance>,
    /// Expanded uncertainty (k = 2) of a probed deviation, 0.00001…1 mm.
    pub uncertainty: Option<Offset>,
    /// How far along the contour a point speaks for the wall, 0.1…1000 mm; otherwise the cutter's diameter.
    pub reach: Option<Offset>,
    /// How far up and down a point speaks for the wall, 0.01…1000 mm; otherwise a quarter of the depth of cut.
    pub reach_height: Option<Offset>,
    /// How warm it was when it was measured, −40…100 °C.
    pub temperature: Option<Decimal>,
}

/// Limits of the wall error, both allowed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tolerance {
    /// The deepest cut: −10…10 mm.
    pub lower: Offset,
    /// The most material left, above `lower`.
    pub upper: Offset,
    /// Whether the command line says so.
    pub from_command_line: bool,
}

/// What the command line says in place of the job.
#[derive(Clone, Debug, Default, PartialEq, Eq, clap::Args)]
pub struct PartFlags {
    /// Serial number of the part, in place of part.serial of the job.
    #[arg(long, value_name = "TEXT")]
    pub serial: Option<String>,
    /// Half the width of the tolerance of the wall, mm, or with its unit (0.0005in, 12um), in place of the limits of
    /// the job.
    #[arg(long, value_name = "LENGTH", allow_negative_numbers = true)]
    pub tolerance: Option<String>,
    /// When the part was measured, for the report; without it none is named.
    #[arg(long, value_name = "TEXT")]
    pub date: Option<String>,
}

impl PartFlags {
    /// The part with these flags in force. A tolerance takes the place of every limit of the job.
    ///
    /// # Errors
    /// `C001`, naming the flag, for a text or a number that the job could not hold either.
    pub fn over(&self, part: PartTable) -> Result<PartTable, InputError> {
        let text = |flag: &str, text: &Option<String>, given: Option<String>| match text {
            None => Ok(given),
            Some(text) if is_text(text) => Ok(Some(text.clone())),
            Some(text) => {
                let found = match text.chars().count() {
                    all if all > LONGEST => format!("{flag} on the command line has {all} characters"),
                    _ => format!("{flag} on the command line is {text:?}"),
                };
                Err(InputError::new(C001, found, TEXT_EXPECTED, "write it shorter, on one line, or leave it away"))
            }
        };
        let tolerance = match &self.tolerance {
            None => part.tolerance,
            Some(text) => {
                let half = Decimal::length(text).filter(|d| HALF_WIDTH.admits(*d)).map(Decimal::as_mm);
                let half = half.ok_or_else(|| {
                    let found = format!("--tolerance on the command line is {text:?}");
                    let expected = format!("half the width of the tolerance, {}", HALF_WIDTH.phrase_in_both());
                    InputError::new(
                        C001,
                        found,
                        expected,
                        "write --tolerance 0.02 for ±0.02 mm, 0.0008in for ±0.0008 in",
                    )
                })?;
                Some(Tolerance { lower: -half, upper: half, from_command_line: true })
            }
        };
        let names = PartNames {
            serial: text("--serial", &self.serial, part.names.serial)?,
            date: text("--date", &self.date, part.names.date)?,
            ..part.names
        };
        Ok(PartTable { names, tolerance, ..part })
    }
}

/// Whether a text can stand in one line of a report: nothing in it is unseen, so that two parts whose names look the same are the
/// same.
fn is_text(text: &str) -> bool {
    let letters = || text.chars().zip(std::iter::once(' ').chain(text.chars()));
    let unseen = letters().any(|(c, before)| c.is_control() || is_unseen(c) || (is_joiner(c) && before.is_ascii()));
    !text.trim().is_empty() && text.chars().count() <= LONGEST && !unseen
}

/// The text of a key that [can stand in one line](is_text).
pub(super) fn line(section: &Section<'_>, key: &'static str) -> Result<Option<String>, InputError> {
    match section.text(key)? {
        None => Ok(None),
        Some((text, _)) if is_text(text) => Ok(Some(text.to_owned())),
        Some((_, value)) => {
            Err(section.out_of_range(&value, TEXT_EXPECTED, "write it shorter, on one line, or leave the key away"))
        }
    }
}

/// Letters that take no room or show nothing, and marks that turn the direction of writing: with them a text could look like
/// another one.
const fn is_unseen(c: char) -> bool {
    matches!(
        c,
        '\u{ad}' | '\u{34f}' | '\u{61c}' | '\u{115f}' | '\u{1160}' | '\u{17b4}' | '\u{17b5}' | '\u{180b}'..='\u{180f}'
            | '\u{200b}' | '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2060}'..='\u{206f}' | '\u{2800}'
            | '\u{3164}' | '\u{fe00}'..='\u{fe0f}' | '\u{feff}' | '\u{ffa0}' | '\u{fff9}'..='\u{fffb}' | '\u{e0000}'..='\u{e0fff}'
    )
}

/// Persian and the scripts of India are written with these; after a Latin letter or a digit they only hide.
const fn is_joiner(c: char) -> bool {
    matches!(c, '\u{200c}' | '\u{200d}')
}

/// What the table says.
pub(super) fn part(section: Option<&Section<'_>>) -> Result<PartTable, InputError> {
    let Some(section) = section else { return Ok(PartTable::default()) };
    let text = |key| line(section, key);
    let length = |key, limits| Ok::<_, InputError>(section.number(key, limits)?.map(Decimal::as_mm));
    let names = PartNames {
        name: text("name")?,
        drawing: text("drawing")?,
        serial: text("serial")?,
        material_batch: text("material_batch")?,
        customer: text("customer")?,
        date: text("date")?,
    };
    let table = PartTable {
        names,
        tolerance: tolerance(section)?,
        uncertainty: length("uncertainty_mm", Limits::within("0.00001", "1", "mm"))?,
        reach: length("reach_mm", Limits::within("0.1", "1000", "mm"))?,
        reach_height: length("reach_height_mm", Limits::within("0.01", "1000", "mm"))?,
        temperature: section.number("temperature_c", Limits::within("-40", "100", "degrees Celsius"))?,
    };
    section.close()?;
    Ok(table)
}

/// A half width, or both limits.
fn tolerance(section: &Section<'_>) -> Result<Option<Tolerance>, InputError> {
    let limit = |value: &Value<'_>| section.number_in(value, LIMIT).map(Decimal::as_mm);
    let half = section.number("tolerance_mm", HALF_WIDTH)?.map(Decimal::as_mm);
    match (half, section.value("lower_mm"), section.value("upper_mm")) {
        (half, None, None) => Ok(half.map(|half| Tolerance { lower: -half, upper: half, from_command_line: false })),
        (Some(_), Some(value), _) | (Some(_), None, Some(value)) => {
            let found = format!("{} is given as well as part.tolerance_mm", value.path);
            let help = "remove tolerance_mm for limits of your own, or remove the limits";
            Err(section.contradiction(&value, &found, "a half width or two limits", help))
        }
        (None, Some(low), None) => {
            Err(section.missing("upper_mm", &format!("a number, {}", LIMIT.phrase_in(low.unit()))))
        }
        (None, None, Some(high)) => {
            Err(section.missing("lower_mm", &format!("a number, {}", LIMIT.phrase_in(high.unit()))))
        }
        (None, Some(low), Some(high)) => {
            let (lower, upper) = (limit(&low)?, limit(&high)?);
            if upper <= lower {
                let expected = format!("above part.lower_mm, {} mm", mm(lower));
                let help = "upper_mm is the limit of material left (positive), lower_mm that of too deep a cut";
                return Err(section.out_of_range(&high, &expected, help));
            }
            Ok(Some(Tolerance { lower, upper, from_command_line: false }))
        }
    }
}
