//! The `[probe]` table, and the flags that stand in for its keys.

use clap::builder::{PossibleValuesParser, TypedValueParser};
use truepath_core::job::{Probe, ZReference};
use truepath_core::probe::{Columns, DecimalSign, Format, Frame, Layout, LengthUnit, PointKind, Separator};
use truepath_core::units::Offset;
use truepath_ground::codes::{C001, J008};
use truepath_ground::decimal::Decimal;
use truepath_ground::diagnostics::{InputError, Source};
use truepath_ground::document::Section;
use truepath_ground::limits::Limits;

use super::open::Assumed;

/// Standard deviation of a reading when the job does not say: 2 µm.
const DEFAULT_NOISE: Offset = Offset::from_um(2);

/// What a file is read as when neither job nor command line names a format and its contents show none.
const DEFAULT_FORMAT: Format = Format::LinuxcncLog;

/// Formats by name.
pub const FORMATS: [(&str, Format); 6] = [
    ("linuxcnc", Format::Linuxcnc),
    ("linuxcnc-log", Format::LinuxcncLog),
    ("grbl", Format::Grbl),
    ("inspection", Format::Inspection),
    ("dprnt", Format::Dprnt),
    ("columns", Format::Columns),
];
/// Separators of columns by name.
const SEPARATORS: [(&str, Separator); 5] = [
    ("auto", Separator::Auto),
    ("comma", Separator::Comma),
    ("semicolon", Separator::Semicolon),
    ("tab", Separator::Tab),
    ("blank", Separator::Blank),
];
/// Decimal signs by name.
const DECIMALS: [(&str, DecimalSign); 3] =
    [("auto", DecimalSign::Auto), ("comma", DecimalSign::Comma), ("point", DecimalSign::Point)];
/// Frames by name.
const FRAMES: [(&str, Frame); 2] = [("work", Frame::Work), ("machine", Frame::Machine)];
/// Points by name.
const POINTS: [(&str, PointKind); 2] = [("tip", PointKind::Tip), ("surface", PointKind::Surface)];
const UNITS: [(&str, LengthUnit); 2] = [("mm", LengthUnit::Millimetre), ("inch", LengthUnit::Inch)];
const REFERENCES: [(&str, ZReference); 2] = [("centre", ZReference::Centre), ("tip", ZReference::Tip)];
/// Keys that only a file of columns has.
const LAYOUT: [&str; 6] = ["columns", "separator", "decimal", "frame", "point", "unit"];
const COLUMNS_EXPECTED: &str =
    "names of the columns in their order: x, y, z, and nx, ny, hit where there are such; any other name for the rest";

/// What the command line says instead of the job.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::Args)]
#[command(next_help_heading = "Probe file, in place of [probe] of the job")]
pub struct ProbeFlags {
    /// Its format.
    #[arg(long, value_name = "FORMAT", value_parser = one_of(&FORMATS))]
    pub format: Option<Format>,
    /// Columns in their order: x,y,z and nx,ny, hit where there are such; other names are not read.
    #[arg(long = "cols", value_name = "NAMES", value_parser = given_columns)]
    pub columns: Option<Columns>,
    /// What separates the columns.
    #[arg(long = "sep", value_name = "NAME", value_parser = one_of(&SEPARATORS))]
    pub separator: Option<Separator>,
    /// What stands before decimals.
    #[arg(long, value_name = "NAME", value_parser = one_of(&DECIMALS))]
    pub decimal: Option<DecimalSign>,
    /// Coordinates of the columns; machine coordinates need probe.work_offset_mm.
    #[arg(long, value_name = "NAME", value_parser = one_of(&FRAMES))]
    pub frame: Option<Frame>,
    /// Ball centre (tip) or touched point (surface).
    #[arg(long, value_name = "NAME", value_parser = one_of(&POINTS))]
    pub point: Option<PointKind>,
    /// Go on although the points do not fit the job (Q009).
    #[arg(long)]
    pub force_data: bool,
    /// Whether columns are in millimetres whatever the job says. No flag: for programs that hand over numbers of their own.
    #[arg(skip)]
    pub millimetres: bool,
}

impl ProbeFlags {
    /// The probe of a job with these flags in force. A flag of columns makes the file one of columns.
    ///
    /// # Errors
    /// `C001` for flags that contradict each other or the job.
    pub fn over(&self, probe: Probe) -> Result<Probe, InputError> {
        let of_columns = [
            self.columns.is_some(),
            self.separator.is_some(),
            self.decimal.is_some(),
            self.frame.is_some(),
            self.point.is_some(),
        ]
        .contains(&true);
        let format = self.format.unwrap_or(if of_columns { Format::Columns } else { probe.format });
        let refused = |(found, expected, help): Wrong| InputError::new(C001, found, expected, help);
        if format != Format::Columns {
            let wrong = "the command line describes columns and names another format";
            return match of_columns {
                true => Err(refused((wrong, "flags of one format", "leave --format away, or the flags of columns"))),
                false => Ok(Probe { format, layout: None, ..probe }),
            };
        }
        let said = probe.layout.unwrap_or_default();
        let layout = Layout {
            columns: self.columns.or(said.columns),
            separator: self.separator.unwrap_or(said.separator),
            decimal: self.decimal.unwrap_or(said.decimal),
            frame: self.frame.unwrap_or(said.frame),
            point: self.point.unwrap_or(said.point),
            unit: if self.millimetres { LengthUnit::Millimetre } else { said.unit },
        };
        let probe = Probe { format, layout: Some(layout), ..probe };
        contradiction(&probe).map_or(Ok(probe), |wrong| Err(refused(wrong)))
    }
}

/// Found, expected, help.
type Wrong = (&'static str, &'static str, &'static str);

/// What the options of columns contradict each other in.
fn contradiction(probe: &Probe) -> Option<Wrong> {
    let layout = probe.layout?;
    if (layout.separator, layout.decimal) == (Separator::Comma, DecimalSign::Comma) {
        return Some((
            "commas are to separate the columns and to stand before the decimals",
            "two different signs",
            "say separator = \"semicolon\", or decimal = \"point\"",
        ));
    }
    if layout.frame == Frame::Machine && probe.work_offset.is_none() {
        return Some((
            "the columns are in machine coordinates and the work offset is not known",
            "probe.work_offset_mm = [x, y, z]",
            "add work_offset_mm to [probe]: the machine position of the work zero (G54), tool length included",
        ));
    }
    None
}

/// Takes one of a list of names, as [`Section::choice`](truepath_ground::document::Section::choice) does in a job.
pub fn one_of<T: Copy + Send + Sync, const N: usize>(
    choices: &'static [(&'static str, T); N],
) -> impl TypedValueParser<Value = T> {
    PossibleValuesParser::new(choices.iter().map(|(name, _)| *name)).try_map(|text| {
        let choice = choices.iter().find(|(name, _)| *name == text);
        choice.map(|(_, choice)| *choice).ok_or(text)
    })
}

fn given_columns(text: &str) -> Result<Columns, String> {
    columns(text)
        .ok_or_else(|| "expected x, y and z, each once, and nx and ny both or not at all: x,y,z,nx,ny".to_owned())
}

/// Columns from their names, separated by commas; `None` when x, y or z is missing, one is named twice, or nx and ny are
/// not both there.
pub fn columns(text: &str) -> Option<Columns> {
    let names: Vec<String> = text.split(',').map(|name| name.trim().to_ascii_lowercase()).collect();
    let place = |wanted: &str| {
        let mut places = names.iter().enumerate().filter(|(_, name)| *name == wanted).map(|(at, _)| at);
        match (places.next(), places.next()) {
            (Some(at), None) => u8::try_from(at).ok().map(Some),
            (None, _) => Some(None),
            (Some(_), Some(_)) => None,
        }
    };
    let axes = [place("x")??, place("y")??, place("z")??];
    let normal = match (place("nx")?, place("ny")?) {
        (Some(x), Some(y)) => Some([x, y]),
        (None, None) => None,
        _ => return None,
    };
    Some(Columns { axes, normal, hit: place("hit")? })
}

/// What the table says, and whether it says the format.
pub(super) fn probe(
    source: &Source,
    section: &Section<'_>,
    assumed: &mut Vec<Assumed>,
) -> Result<(Probe, bool), InputError> {
    let ball_diameter = section.required_number("ball_diameter_mm", Limits::within("0.1", "50", "mm"))?.as_mm();
    // Without a format the file itself shows it; keys of columns say that it is one of columns.
    let of_columns = LAYOUT.into_iter().any(|key| section.value(key).is_some());
    let named = section.choice("format", &FORMATS)?;
    let stated = named.is_some() || of_columns;
    let format = named.unwrap_or(if of_columns { Format::Columns } else { DEFAULT_FORMAT });
    let z_reference = section.choice("z_reference", &REFERENCES)?.unwrap_or_else(|| {
        let why = "the probe's length is set to the middle of the ball, as most controls calibrate it".to_owned();
        assumed.push(Assumed { key: "probe.z_reference", value: "\"centre\"".to_owned(), why, line: None });
        ZReference::Centre
    });
    let noise = section.number("noise_mm", Limits::above("0", "0.1", "mm"))?.map_or(DEFAULT_NOISE, Decimal::as_mm);
    let work_offset = work_offset(source, section, stated.then_some(format))?;
    let layout = layout(source, section, format)?;
    let probe = Probe { ball_diameter, format, layout, work_offset, z_reference, noise };
    if let Some((found, expected, help)) = contradiction(&probe) {
        let key = if probe.work_offset.is_none() && layout.is_some_and(|l| l.frame == Frame::Machine) {
            "frame"
        } else {
            "decimal"
        };
        let span = section.value(key).map_or(0..0, |value| value.span);
        return Err(InputError::new(J008, found, expected, help).at(source, span));
    }
    section.close()?;
    Ok((probe, stated))
}

fn layout(source: &Source, section: &Section<'_>, format: Format) -> Result<Option<Layout>, InputError> {
    if format != Format::Columns {
        let Some(value) = LAYOUT.into_iter().find_map(|key| section.value(key)) else { return Ok(None) };
        let found = format!("{} is given, and format is not \"columns\"", value.path);
        let help = "remove it: frame, unit and point follow from the other formats; or say format = \"columns\"";
        return Err(InputError::new(J008, found, "keys of one format", help).at(source, value.span));
    }
    let columns = match section.text("columns")? {
        None => None,
        Some((text, value)) => Some(columns(text).ok_or_else(|| {
            section.out_of_range(
                &value,
                COLUMNS_EXPECTED,
                "write columns = \"x,y,z\" or, with normals, \"x,y,z,nx,ny\"",
            )
        })?),
    };
    Ok(Some(Layout {
        columns,
        separator: section.choice("separator", &SEPARATORS)?.unwrap_or_default(),
        decimal: section.choice("decimal", &DECIMALS)?.unwrap_or_default(),
        frame: section.choice("frame", &FRAMES)?.unwrap_or_default(),
        point: section.choice("point", &POINTS)?.unwrap_or_default(),
        unit: section.choice("unit", &UNITS)?.unwrap_or_default(),
    }))
}

/// Machine coordinates of the work zero.
fn work_offset(
    source: &Source,
    section: &Section<'_>,
    format: Option<Format>,
) -> Result<Option<[Offset; 3]>, InputError> {
    let Some(value) = section.value("work_offset_mm") else { return Ok(None) };
    if !matches!(format, None | Some(Format::Columns | Format::Grbl)) {
        let found = "probe.work_offset_mm is given for a format in work coordinates";
        let help = "remove it; only \"grbl\" and columns in machine coordinates need it";
        return Err(section.contradiction(&value, found, "a format in machine coordinates", help));
    }
    let expected = "three lengths, -10000 to 10000 mm";
    let help = "write work_offset_mm = [x, y, z], the machine position of the work zero";
    let entries = value.raw.as_array().map(|a| a.iter().collect::<Vec<_>>());
    let Some([x, y, z]) = entries.and_then(|v| <[_; 3]>::try_from(v).ok()) else {
        return Err(section.wrong_type(&value, expected, help));
    };
    let length = |entry: &toml::Spanned<toml::de::DeValue<'_>>| {
        let number = entry.get_ref().is_integer() || entry.get_ref().is_float();
        let decimal = number.then(|| Decimal::parse(&source.excerpt(entry.span()))).flatten();
        decimal.map(|d| value.mm(d)).filter(|d| Limits::within("-10000", "10000", "mm").admits(*d)).map(Decimal::as_mm)
    };
    match (length(x), length(y), length(z)) {
        (Some(x), Some(y), Some(z)) => Ok(Some([x, y, z])),
        _ => Err(section.out_of_range(&value, expected, help)),
    }
}
