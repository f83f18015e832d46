//! The file of dimensions: `version = 1` and one `[[dimension]]` for each, every key with its unit.

use std::cell::RefCell;
use std::collections::BTreeSet;
use std::ops::Range;

use truepath_core::units::{Offset, Position};
use truepath_ground::codes::J007;
use truepath_ground::decimal::Decimal;
use truepath_ground::diagnostics::{InputError, Source};
use truepath_ground::document::{Section, Spans};
use truepath_ground::length::Unit;
use truepath_ground::limits::Limits;
use truepath_ground::notation::{parse, version};

use super::results::Results;
use super::walls::Axis;
use crate::codes::{M043, M044, M050};

/// What is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// The room between two walls.
    Width,
    /// The same across the middle of a round wall, of a bore or of a boss.
    Diameter,
    /// From a face to a wall.
    Distance,
    /// The material between two walls, or between a face and a wall.
    Thickness,
}

/// Kinds by name.
pub const KINDS: [(&str, Kind); 4] = [
    ("width", Kind::Width),
    ("diameter", Kind::Diameter),
    ("distance", Kind::Distance),
    ("thickness", Kind::Thickness),
];

/// Names of what is measured along Z.
const ALONG_Z: [&str; 4] = ["depth", "step", "height", "floor"];

impl Kind {
    /// Its name in the file.
    pub fn name(self) -> &'static str {
        KINDS.iter().find(|(_, kind)| *kind == self).map_or("", |(name, _)| name)
    }
}

/// What it is measured with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Instrument {
    /// A calliper.
    Calliper,
    /// A micrometer.
    Micrometer,
    /// A bore gauge, set with a ring or a micrometer.
    BoreGauge,
    /// A coordinate measuring machine.
    Cmm,
}

/// Instruments by name, the American spelling among them.
pub const INSTRUMENTS: [(&str, Instrument); 5] = [
    ("calliper", Instrument::Calliper),
    ("micrometer", Instrument::Micrometer),
    ("bore_gauge", Instrument::BoreGauge),
    ("cmm", Instrument::Cmm),
    ("caliper", Instrument::Calliper),
];

impl Instrument {
    /// Its name in the file.
    pub fn name(self) -> &'static str {
        INSTRUMENTS.iter().find(|(_, instrument)| *instrument == self).map_or("", |(name, _)| name)
    }

    /// Its name in a sentence.
    pub const fn words(self) -> &'static str {
        match self {
            Self::Calliper => "calliper",
            Self::Micrometer => "micrometer",
            Self::BoreGauge => "bore gauge",
            Self::Cmm => "measuring machine",
        }
    }

    /// Whether it takes dimensions of a kind: a bore gauge reaches what lies around it alone.
    pub fn measures(self, kind: Kind) -> bool {
        self != Self::BoreGauge || matches!(kind, Kind::Width | Kind::Diameter)
    }

    /// What its reading stays within, ±, at two standard deviations: the limit of error that its class allows up to 100 mm
    /// (ISO 13385-1 for callipers with 0.01 mm steps, ISO 3611 for micrometers) with a hand's feel for the walls.
    pub const fn uncertainty(self) -> Offset {
        Offset::from_um(match self {
            Self::Calliper => 30,
            Self::Micrometer => 8,
            Self::BoreGauge => 6,
            Self::Cmm => 4,
        })
    }
}

/// Where a line of measurement lies across its direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Across {
    /// Through the middle of the walls.
    Middle,
    /// At a coordinate, mm.
    At(f64),
}

/// At which height.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Level {
    /// Z of the program.
    Z(Position),
    /// Above the cutter's tip.
    AboveTip(Offset),
}

/// A dimension as the file has it.
#[derive(Clone, Debug, PartialEq)]
pub struct Dimension {
    /// What it is called: in the file, or by kind and place.
    pub name: String,
    /// What is measured.
    pub kind: Kind,
    /// Along which axis.
    pub along: Axis,
    /// Where across it.
    pub across: Across,
    /// A coordinate along the axis between the walls, where several pairs stand there, mm.
    pub near: Option<f64>,
    /// Coordinate of the face that it is measured from, mm.
    pub face: Option<f64>,
    /// What the face may be off its coordinate, ± at two standard deviations.
    pub face_uncertainty: Offset,
    /// At which height.
    pub level: Level,
    /// With what.
    pub instrument: Instrument,
    /// What a reading stays within, ± at two standard deviations.
    pub uncertainty: Offset,
    /// What was read.
    pub value: Offset,
    /// The unit of the key that it stands under.
    pub unit: Unit,
    /// Where the value stands in the file.
    pub value_span: Range<usize>,
    /// Where the place stands in the file.
    pub place_span: Range<usize>,
    /// Where the height stands in the file.
    pub level_span: Range<usize>,
}

/// What an edge finder leaves open of a face, ± at two standard deviations.
pub(super) const FACE: Offset = Offset::from_um(20);

const COORDINATE: Limits = Limits::within("-4000", "4000", "mm");
const UNCERTAINTY: Limits = Limits::above("0", "1", "mm");
/// What the file is called in errors.
const FILE: &str = "the file of dimensions";

/// Reads the file.
///
/// # Errors
/// `M043` at a value that was not filled in, `M044` for a dimension along Z, and what is wrong with a key, each with its
/// place.
pub(super) fn read(source: &Source) -> Result<Vec<Dimension>, InputError> {
    if let Some(span) = without_value(source) {
        let key = if source.bytes().get(span.clone()).is_some_and(|text| text.starts_with(b"value_in")) {
            "value_in"
        } else {
            "value_mm"
        };
        return Err(not_filled_in(key, "a dimension").at(source, span.end - 1..span.end));
    }
    let table = parse(source, FILE)?;
    let spans: RefCell<Spans> = RefCell::default();
    let root = Section::root(source, &table, &spans);
    version(source, &root)?;
    let results = root.text("values")?.map(|(name, _)| Results::beside(source, name)).transpose()?;
    let sections = root.sections("dimension")?;
    root.close()?;
    if sections.is_empty() {
        return Err(root.missing("dimension", "at least one [[dimension]]"));
    }
    let mut taken = BTreeSet::new();
    let one = |section: &Section<'_>| {
        let from_results = results.is_some() && section.value("value_mm").is_none();
        let dimension = dimension(source, section, results.as_ref())?;
        if from_results && !taken.insert(dimension.name.clone()) {
            let found = format!("two dimensions take the value of \"{}\"", dimension.name);
            let help = "give every characteristic and its [[dimension]] a name of their own";
            return Err(InputError::new(M050, found, "one for each characteristic", help).at(source, section.place()));
        }
        Ok(dimension)
    };
    sections.iter().map(one).collect()
}

/// A key of a value with nothing behind it, which is no TOML, and its equals sign.
fn without_value(source: &Source) -> Option<Range<usize>> {
    let text = std::str::from_utf8(source.bytes()).ok()?;
    let mut at = 0;
    for line in text.split_inclusive('\n') {
        let bare = line.split('#').next().unwrap_or_default().trim_end();
        let named = ["value_mm", "value_in"].into_iter().find_map(|key| bare.trim_start().strip_prefix(key));
        if named.is_some_and(|rest| rest.trim() == "=") {
            return Some(at + bare.len() - bare.trim_start().len()..at + bare.len());
        }
        at += line.len();
    }
    None
}

fn not_filled_in(key: &str, name: &str) -> InputError {
    M043.error(format!("{key} of {name} is empty"), "what was measured, in the unit of the key")
}

fn dimension(source: &Source, section: &Section<'_>, results: Option<&Results>) -> Result<Dimension, InputError> {
    let given = section.text("name")?.map(|(name, _)| name.to_owned());
    let kind = kind(source, section)?;
    let along = section.choice("along", &Axis::NAMES)?;
    let along = along.ok_or_else(|| section.missing("along", "\"x\" or \"y\", the axis it is measured along"))?;
    let (across, place_span) = across(source, section, kind, along)?;
    let near = section.number("near_mm", COORDINATE)?.map(Decimal::as_f64);
    let face_value = section.value("face_mm");
    let face = face_value.as_ref().map(|value| section.number_in(value, COORDINATE)).transpose()?;
    let face = face.map(Decimal::as_f64);
    match (kind, &face_value) {
        (Kind::Distance, None) => {
            return Err(section.missing("face_mm", "the coordinate of the face that it is measured from"));
        }
        (Kind::Width | Kind::Diameter, Some(value)) => {
            let found = format!("a {} from a face", kind.name());
            return Err(section.contradiction(
                value,
                &found,
                "kind = \"distance\", or no face_mm",
                "a width lies between two walls of this cut; a distance is measured from a face",
            ));
        }
        _ => {}
    }
    let face_uncertainty = section.number("face_uncertainty_mm", UNCERTAINTY)?.map_or(FACE, Decimal::as_mm);
    let (level, level_span) = level(section)?;
    let instrument = section.choice("instrument", &INSTRUMENTS)?;
    let expected = "\"calliper\", \"micrometer\", \"bore_gauge\" or \"cmm\"";
    let instrument = instrument.ok_or_else(|| section.missing("instrument", expected))?;
    let uncertainty = section.number("uncertainty_mm", UNCERTAINTY)?;
    let uncertainty = uncertainty.map_or(instrument.uncertainty(), Decimal::as_mm);
    let name = given.unwrap_or_else(|| named(kind, along, across, level));
    let unit = section.value("value_mm").map_or(section.unit(), |value| value.unit());
    let (value, value_span) = value(source, section, results, &name)?;
    section.close()?;
    Ok(Dimension {
        name,
        kind,
        along,
        across,
        near,
        face,
        face_uncertainty,
        level,
        instrument,
        uncertainty,
        value,
        unit,
        value_span,
        place_span,
        level_span,
    })
}

fn kind(source: &Source, section: &Section<'_>) -> Result<Kind, InputError> {
    if let Some((text, value)) = section.text("kind")?.filter(|(text, _)| ALONG_Z.contains(text)) {
        let found = format!("kind is \"{text}\", which is measured along Z");
        return Err(M044.error(found, "width, diameter, distance or thickness").at(source, value.span));
    }
    let kind = section.choice("kind", &KINDS)?;
    kind.ok_or_else(|| section.missing("kind", "\"width\", \"diameter\", \"distance\" or \"thickness\""))
}

/// The place across the direction of measurement: a coordinate, or through the middle.
fn across(
    source: &Source,
    section: &Section<'_>,
    kind: Kind,
    along: Axis,
) -> Result<(Across, Range<usize>), InputError> {
    let through = section.text("through")?;
    let [x, y] = ["x_mm", "y_mm"].map(|key| section.value(key));
    let (own, other, key) = match along {
        Axis::X => (y, x, "y_mm"),
        Axis::Y => (x, y, "x_mm"),
    };
    if let Some(value) = other {
        let found = format!("{} across a dimension along {along}", value.path);
        let help = format!("write {key}: a line along {along} lies at one {}", along.other());
        return Err(section.contradiction(&value, &found, key, &help));
    }
    match (through, own) {
        (Some((_, value)), Some(_)) => Err(section.contradiction(
            &value,
            "both a coordinate and through",
            "one of them",
            "leave through out, or the coordinate",
        )),
        (Some(("middle", value)), None) => Ok((Across::Middle, value.span)),
        (Some((text, value)), None) => {
            let found = format!("through is \"{text}\"");
            Err(InputError::new(J007, found, "\"middle\"", "write \"middle\", or a coordinate in its place")
                .at(source, value.span))
        }
        (None, Some(value)) => {
            let at = section.number_in(&value, COORDINATE)?;
            Ok((Across::At(at.as_f64()), value.span))
        }
        (None, None) if kind == Kind::Diameter => Ok((Across::Middle, section.place())),
        (None, None) => {
            Err(section.missing("through", &format!("{key}, the coordinate of the line, or through = \"middle\"")))
        }
    }
}

fn level(section: &Section<'_>) -> Result<(Level, Range<usize>), InputError> {
    let [z, above] = ["z_mm", "height_mm"].map(|key| section.value(key));
    match (z, above) {
        (Some(value), Some(_)) => Err(section.contradiction(
            &value,
            "both z_mm and height_mm",
            "one of them",
            "z_mm is a coordinate of the program, height_mm counts from the cutter's tip up",
        )),
        (Some(value), None) => {
            let z = section.number_in(&value, COORDINATE)?.as_mm();
            Ok((Level::Z(Position::ZERO + z), value.span))
        }
        (None, Some(value)) => {
            let above = section.number_in(&value, Limits::within("0", "1000", "mm"))?.as_mm();
            Ok((Level::AboveTip(above), value.span))
        }
        (None, None) => {
            Err(section.missing("z_mm", "Z of the jaws in program coordinates, or height_mm above the tip"))
        }
    }
}

/// The value: in the file, or that of its name among the results of a measuring machine. A number between quotation marks, as
/// a sheet leaves room for it, counts as well.
fn value(
    source: &Source,
    section: &Section<'_>,
    results: Option<&Results>,
    name: &str,
) -> Result<(Offset, Range<usize>), InputError> {
    const VALUE: Limits = Limits::above("0", "4000", "mm");
    let Some(value) = section.value("value_mm") else {
        if let Some(results) = results {
            return Ok((results.value(name)?.as_mm(), section.place()));
        }
        return Err(section.missing("value_mm", "what was measured, in the unit of the key"));
    };
    let Some(text) = value.raw.as_str() else {
        return Ok((section.number_in(&value, VALUE)?.as_mm(), value.span));
    };
    let text = text.trim();
    if text.is_empty() {
        return Err(not_filled_in(&value.unit().keys("value_mm"), name).at(source, value.span));
    }
    match Decimal::parse(&text.replace(',', ".")).map(|number| value.mm(number)) {
        Some(number) if VALUE.admits(number) => Ok((number.as_mm(), value.span)),
        Some(_) => Err(section.out_of_range(
            &value,
            &VALUE.phrase_in(value.unit()),
            "type what was measured, in the unit of the key",
        )),
        None => Err(section.wrong_type(
            &value,
            &format!("a number, {}", VALUE.phrase_in(value.unit())),
            "type the number alone",
        )),
    }
}

/// A name by kind and place.
fn named(kind: Kind, along: Axis, across: Across, level: Level) -> String {
    let across = match across {
        Across::Middle => "through the middle".to_owned(),
        Across::At(at) => format!("at {}{at}", along.other()),
    };
    let level = match level {
        Level::Z(z) => format!("Z{}", (z - Position::ZERO).nm() as f64 / 1e6),
        Level::AboveTip(above) => format!("{} mm above the tip", above.nm() as f64 / 1e6),
    };
    format!("{} along {along} {across}, {level}", kind.name())
}
