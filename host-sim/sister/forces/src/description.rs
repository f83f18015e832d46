//! `cuts.toml`: what was cut while forces were recorded.
//!
//! ```toml
//! version = 1
//!
//! [tool]
//! diameter_mm = 25.0
//! teeth = 2
//! helix_deg = 45.0
//!
//! [record]                        # of every cut; what is left out is found in the record
//! feed = "-Fy"                    # column along the travel of the cutter, with its sign
//! across = "-Fx"                  # column to the left of it
//! force_on = "workpiece"          # or "tool"
//! unit = "N"                      # or "kN"
//! rate_hz = 10000
//! repeatability_percent = 3
//!
//! [cutting]                       # what all cuts share
//! axial_depth_mm = 3.0
//! spindle_rpm = 6000
//! milling = "slot"                # or "up", "down" with radial_depth_mm; or entry_deg and exit_deg
//!
//! [[cut]]
//! feed_per_tooth_mm = 0.025       # or feed_mm_per_min
//! record = "f300.csv"             # or means: feed_n and across_n, sigma_n; or torque_nm; or power_w and idle_power_w
//! from_s = 5.0                    # else the part that cuts is found
//! to_s = 6.0
//! use = "fit"                     # or "predict": not fitted, but compared
//! ```

use std::cell::RefCell;
use std::f64::consts::PI;
use std::ops::Range;
use std::path::{Path, PathBuf};

use truepath_ground::diagnostics::{InputError, Source};
use truepath_ground::document::{Section, Spans};
use truepath_ground::length::Unit;
use truepath_ground::limits::Limits;
use truepath_ground::notation;

use crate::codes::{E004, E008, E009};
use crate::cut::Cut;
use crate::fit::REPEATABILITY;

/// A column with its sign.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// Its name in the record.
    pub column: String,
    /// +1 or −1.
    pub sign: f64,
}

/// What holds for every record.
#[derive(Clone, Debug, PartialEq)]
pub struct Recording {
    /// Along the travel and left of it, as far as named.
    pub axes: Option<[Axis; 2]>,
    /// −1 for forces on the workpiece, +1 on the tool; `None` where it is not said.
    pub on_tool: Option<f64>,
    /// Newtons in a unit of the record.
    pub newton: Option<f64>,
    /// Sampling rate, Hz.
    pub rate_hz: Option<f64>,
    /// Corner frequency of the amplifier's low-pass (first order), Hz.
    pub low_pass_hz: Option<f64>,
    /// Share by which a repeated cut differs.
    pub repeatability: f64,
}

/// Where the force of a cut is written.
#[derive(Clone, Debug, PartialEq)]
pub enum Evidence {
    /// In a file over time; with the part that is to be taken, s.
    Record(PathBuf, Option<[f64; 2]>),
    /// A column of power (W) or torque (N·m) of a file.
    Spindle(PathBuf, String, Option<[f64; 2]>, Drive),
    /// Means along the feed and across, N, with their standard deviation.
    Means([f64; 2], f64),
    /// Mean torque, N·m, with its standard deviation.
    Torque(f64, f64),
}

/// What a column of the spindle is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Drive {
    /// Power, W or kW.
    Power,
    /// Torque, N·m.
    Torque,
}

/// One cut.
#[derive(Clone, Debug, PartialEq)]
pub struct Described {
    /// The cut.
    pub cut: Cut,
    /// Its forces.
    pub evidence: Evidence,
    /// Whether it is fitted or only compared.
    pub fitted: bool,
    /// Where it stands in the file.
    pub place: Range<usize>,
}

/// The whole file.
#[derive(Clone, Debug)]
pub struct Description {
    /// What holds for every record.
    pub recording: Recording,
    /// The cuts in their order.
    pub cuts: Vec<Described>,
    /// The unit of its keys, in which people are told.
    pub unit: Unit,
    /// The text, for errors.
    pub source: Source,
}

const AXIAL: Limits = Limits::above("0", "200", "mm");
const RADIAL: Limits = Limits::above("0", "100", "mm");
const SPEED: Limits = Limits::within("1", "200000", "rev/min");
const ANGLE: Limits = Limits::within("0", "180", "degrees");
const FORCE: Limits = Limits::within("-1000000", "1000000", "N");
const TIME: Limits = Limits::within("0", "1000000", "s");

#[derive(Clone, Copy)]
enum Milling {
    Up,
    Down,
    Slot,
}

const MILLING: [(&str, Milling); 3] = [("up", Milling::Up), ("down", Milling::Down), ("slot", Milling::Slot)];

/// Keys of a cut that all may share.
#[derive(Clone, Copy, Default)]
struct Shared {
    axial: Option<f64>,
    radial: Option<f64>,
    rpm: Option<f64>,
    milling: Option<Milling>,
    entry: Option<f64>,
    exit: Option<f64>,
}

impl Shared {
    fn read(section: &Section<'_>) -> Result<Self, InputError> {
        let number = |key, limits| Ok::<_, InputError>(section.number(key, limits)?.map(|n| n.as_f64()));
        Ok(Self {
            axial: number("axial_depth_mm", AXIAL)?,
            radial: number("radial_depth_mm", RADIAL)?,
            rpm: number("spindle_rpm", SPEED)?,
            milling: section.choice("milling", &MILLING)?,
            entry: number("entry_deg", ANGLE)?,
            exit: number("exit_deg", ANGLE)?,
        })
    }

    fn over(self, common: Self) -> Self {
        // Angles and a radial depth exclude each other, so that those of a cut replace both.
        let own = self.entry.is_some() || self.radial.is_some() || self.milling.is_some();
        let geometry = if own { self } else { common };
        Self {
            axial: self.axial.or(common.axial),
            rpm: self.rpm.or(common.rpm),
            radial: geometry.radial,
            milling: geometry.milling,
            entry: geometry.entry,
            exit: geometry.exit,
        }
    }
}

impl Description {
    /// Reads the file.
    ///
    /// # Errors
    /// What is wrong with it, with its place.
    pub fn read(path: &Path) -> Result<Self, InputError> {
        Self::parse(Source::read(path)?, path.parent().unwrap_or(Path::new("")))
    }

    /// Reads its text; records lie in `folder`.
    ///
    /// # Errors
    /// What is wrong with it, with its place.
    pub fn parse(source: Source, folder: &Path) -> Result<Self, InputError> {
        let table = notation::parse(&source, "the description of the cuts")?;
        let spans = RefCell::new(Spans::new());
        let root = Section::root(&source, &table, &spans);
        notation::version(&source, &root)?;
        let tool = root.required_section("tool", "diameter_mm, teeth and helix_deg")?;
        let diameter_mm = tool.required_number("diameter_mm", Limits::within("0.1", "200", "mm"))?.as_f64();
        let teeth = tool
            .whole("teeth", Limits::within("1", "64", ""), "write the number of teeth")?
            .ok_or_else(|| tool.missing("teeth", "a whole number, 1 to 64"))?;
        let helix_deg = tool.required_number("helix_deg", Limits::within("0", "75", "degrees"))?.as_f64();
        tool.close()?;
        let recording = match root.section("record")? {
            Some(section) => recording(&source, &section)?,
            None => Recording {
                axes: None,
                on_tool: None,
                newton: None,
                rate_hz: None,
                low_pass_hz: None,
                repeatability: REPEATABILITY,
            },
        };
        let common = match root.section("cutting")? {
            Some(section) => {
                let shared = Shared::read(&section)?;
                section.close()?;
                shared
            }
            None => Shared::default(),
        };
        let tool = Cut {
            diameter_mm,
            teeth,
            helix_deg,
            axial_depth_mm: 0.0,
            arc_rad: [0.0; 2],
            feed_per_tooth_mm: 0.0,
            spindle_rpm: 0.0,
        };
        let mut cuts = Vec::new();
        for section in root.sections("cut")? {
            cuts.push(cut(&source, &section, common, &tool, folder)?);
        }
        root.close()?;
        let unit = root.unit();
        drop(root);
        if cuts.iter().all(|c| !c.fitted) {
            let end = source.bytes().len();
            return Err(E009.error("there is no [[cut]] to fit", "two feeds at least").at(&source, end..end));
        }
        drop(table);
        Ok(Self { recording, cuts, unit, source: source.clone() })
    }
}

fn recording(source: &Source, section: &Section<'_>) -> Result<Recording, InputError> {
    let axis = |key| {
        let Some((text, place)) = section.text(key)? else { return Ok(None) };
        let (sign, column) = match text.strip_prefix('-') {
            Some(rest) => (-1.0, rest),
            None => (1.0, text.strip_prefix('+').unwrap_or(text)),
        };
        if column.trim().is_empty() {
            return Err(section.out_of_range(
                &place,
                "the name of a column",
                "name it as the record does, with a sign",
            ));
        }
        Ok(Some(Axis { column: column.trim().to_owned(), sign }))
    };
    let axes = match (axis("feed")?, axis("across")?) {
        (Some(feed), Some(across)) => Some([feed, across]),
        (None, None) => None,
        (Some(_), None) => return Err(section.missing("across", "the column of the force to the left of the travel")),
        (None, Some(_)) => return Err(section.missing("feed", "the column of the force along the travel")),
    };
    let newton = match section.text("unit")? {
        None => None,
        Some((text, place)) => Some(
            newton(text)
                .ok_or_else(|| E004.error(format!("unit is \"{text}\""), "\"N\" or \"kN\"").at(source, place.span))?,
        ),
    };
    let number = |key, limits| Ok::<_, InputError>(section.number(key, limits)?.map(|n| n.as_f64()));
    let recording = Recording {
        axes,
        on_tool: section.choice("force_on", &[("tool", 1.0), ("workpiece", -1.0)])?,
        newton,
        rate_hz: number("rate_hz", Limits::within("1", "10000000", "Hz"))?,
        low_pass_hz: number("low_pass_hz", Limits::within("1", "10000000", "Hz"))?,
        repeatability: number("repeatability_percent", Limits::within("0.01", "50", "%"))?
            .map_or(REPEATABILITY, |p| 0.01 * p),
    };
    section.close()?;
    Ok(recording)
}

/// Newtons in a unit.
pub fn newton(unit: &str) -> Option<f64> {
    match unit.trim() {
        "N" | "n" | "Newton" | "newton" => Some(1.0),
        "kN" | "KN" | "kn" => Some(1000.0),
        _ => None,
    }
}

fn cut(
    source: &Source,
    section: &Section<'_>,
    common: Shared,
    tool: &Cut,
    folder: &Path,
) -> Result<Described, InputError> {
    let shared = Shared::read(section)?.over(common);
    let place = section.place();
    let incomplete = |key: &str, expected: &str| {
        let found = format!("{key} of a cut is missing");
        let help = format!("add {key} under [cutting] or [[cut]]");
        InputError::new(E008, found, expected, help).with_keys_in(section.unit()).at(source, place.clone())
    };
    let axial_depth_mm = shared
        .axial
        .ok_or_else(|| incomplete("axial_depth_mm", &format!("a number, {}", AXIAL.phrase_in(section.unit()))))?;
    let spindle_rpm = shared.rpm.ok_or_else(|| incomplete("spindle_rpm", &format!("a number, {}", SPEED.phrase())))?;
    let leaving = || {
        let radial = shared
            .radial
            .ok_or_else(|| incomplete("radial_depth_mm", &format!("a number, {}", RADIAL.phrase_in(section.unit()))))?;
        if radial > tool.diameter_mm {
            let found = format!("the radial depth is {radial} mm");
            let error =
                InputError::new(E008, found, format!("at most the diameter, {} mm", tool.diameter_mm), "correct it");
            return Err(error.told_in(section.unit()).at(source, place.clone()));
        }
        Ok((1.0 - radial / tool.radius_mm()).acos())
    };
    let arc_rad = match (shared.entry, shared.exit, shared.milling) {
        (Some(entry), Some(exit), None) if entry < exit => [entry.to_radians(), exit.to_radians()],
        (None, None, Some(Milling::Slot)) => [0.0, PI],
        (None, None, Some(Milling::Up)) => [0.0, leaving()?],
        (None, None, Some(Milling::Down)) => [PI - leaving()?, PI],
        _ => {
            let help = "add milling = \"slot\", or milling = \"up\" or \"down\" with radial_depth_mm, or entry_deg below exit_deg";
            let error =
                InputError::new(E008, "the engagement of a cut is missing or given twice", "one way to say it", help)
                    .with_keys_in(section.unit());
            return Err(error.at(source, place));
        }
    };
    let number = |key, limits| Ok::<_, InputError>(section.number(key, limits)?.map(|n| n.as_f64()));
    let per_tooth = number("feed_per_tooth_mm", Limits::above("0", "10", "mm"))?;
    let per_minute = number("feed_mm_per_min", Limits::above("0", "100000", "mm/min"))?;
    let feed_per_tooth_mm = match (per_tooth, per_minute) {
        (Some(feed), None) => feed,
        (None, Some(feed)) => feed / (spindle_rpm * f64::from(tool.teeth)),
        _ => return Err(incomplete("feed_per_tooth_mm", "it, or feed_mm_per_min")),
    };
    let cut = Cut { axial_depth_mm, spindle_rpm, arc_rad, feed_per_tooth_mm, ..tool.clone() };
    let span = match (number("from_s", TIME)?, number("to_s", TIME)?) {
        (None, None) => None,
        (from, to) => Some([from.unwrap_or(0.0), to.unwrap_or(f64::INFINITY)]),
    };
    let sigma = number("sigma_n", Limits::within("0", "100000", "N"))?;
    let means = (number("feed_n", FORCE)?, number("across_n", FORCE)?);
    let torque = number("torque_nm", Limits::within("-100000", "100000", "N·m"))?;
    let power = number("power_w", Limits::within("0", "1000000", "W"))?;
    let idle = number("idle_power_w", Limits::within("0", "1000000", "W"))?.unwrap_or(0.0);
    let of_power = |watt: f64| watt / (2.0 * PI * spindle_rpm / 60.0);
    let file = section.text("record")?.map(|(name, _)| folder.join(name));
    let column = [("power", Drive::Power), ("torque", Drive::Torque)].into_iter().find_map(|(key, drive)| {
        section.text(key).transpose().map(|text| text.map(|(name, _)| (name.to_owned(), drive)))
    });
    let evidence = match (file, column.transpose()?, means, torque, power) {
        (Some(file), None, (None, None), None, None) => Evidence::Record(file, span),
        (Some(file), Some((name, drive)), (None, None), None, None) => Evidence::Spindle(file, name, span, drive),
        (None, None, (Some(feed), Some(across)), None, None) => Evidence::Means([feed, across], sigma.unwrap_or(0.0)),
        (None, None, (None, None), Some(torque), None) => Evidence::Torque(torque, 0.0),
        (None, None, (None, None), None, Some(power)) => {
            Evidence::Torque(of_power(power - idle), 0.01 * of_power(power))
        }
        _ => return Err(incomplete("record", "one of record, feed_n with across_n, torque_nm, power_w")),
    };
    let fitted = section.choice("use", &[("fit", true), ("predict", false)])?.unwrap_or(true);
    section.close()?;
    Ok(Described { cut, evidence, fitted, place: section.place() })
}
