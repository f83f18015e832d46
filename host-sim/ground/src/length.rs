//! How a length is said to people: in millimetres, or in inches where the program is in inches. Files and JSON have millimetres.

use core::fmt;

use serde::{Serialize, Serializer};
use truepath_core::gcode::Units;

use crate::decimal::Decimal;

const MM_PER_INCH: f64 = 25.4;
/// Decimals of an inch at least: a thousandth, of a small length a hundredth of that.
const LEAST: (usize, usize) = (3, 5);

/// The unit in which lengths are said: that of the program.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Unit {
    /// Millimetres, and micrometres where a machinist says those.
    #[default]
    Millimetre,
    /// Inches.
    Inch,
}

impl From<Units> for Unit {
    fn from(units: Units) -> Self {
        match units {
            Units::Millimetres => Self::Millimetre,
            Units::Inches => Self::Inch,
        }
    }
}

impl Unit {
    /// What stands behind a length.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Millimetre => "mm",
            Self::Inch => "in",
        }
    }
    /// What stands behind "in".
    pub const fn word(self) -> &'static str {
        match self {
            Self::Millimetre => "mm",
            Self::Inch => "inches",
        }
    }
    /// A length, given in mm, to be formatted like a number: `{:>10.4}`. A precision is that of millimetres; inches have one decimal more, a
    /// thousandth at least, and without a precision as many as it takes to a few nanometres.
    pub const fn of(self, mm: f64) -> Length {
        Length { mm, unit: self, micro: false }
    }
    /// What stands behind a small length.
    pub const fn small_name(self) -> &'static str {
        match self {
            Self::Millimetre => "µm",
            Self::Inch => "in",
        }
    }
    /// A small length, given in mm, said in micrometres; a precision is theirs.
    pub const fn small(self, mm: f64) -> Length {
        Length { mm, unit: self, micro: true }
    }
    /// A length, given in mm, as a flag takes it: a plain number is in millimetres, inches have their unit behind them.
    pub fn typed(self, mm: f64) -> String {
        match self {
            Self::Millimetre => mm.to_string(),
            Self::Inch => format!("{}in", self.of(mm)),
        }
    }
    /// The number that is said for a length, given in mm.
    pub const fn said(self, mm: f64) -> f64 {
        match self {
            Self::Millimetre => mm,
            Self::Inch => mm / MM_PER_INCH,
        }
    }
    /// The millimetres of a length that was said in this unit.
    pub const fn in_mm(self, said: f64) -> f64 {
        match self {
            Self::Millimetre => said,
            Self::Inch => said * MM_PER_INCH,
        }
    }
}

/// The millimetres of a length on a command line, with or without its unit.
///
/// # Errors
/// What is no such length, in words.
pub fn flag(text: &str) -> Result<f64, String> {
    // A plain number is what it always was, also one that no length can be: the command says what it may be.
    let mm = text.parse().ok().or_else(|| Decimal::length(text).map(Decimal::as_f64));
    mm.ok_or_else(|| {
        "a length is a number of millimetres or has its unit behind it: 0.5, 0.5mm, 20um, 0.02in".to_owned()
    })
}

/// A length that is written in its unit.
#[derive(Clone, Copy, Debug)]
pub struct Length {
    mm: f64,
    unit: Unit,
    micro: bool,
}

impl fmt::Display for Length {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { mm, unit, micro } = *self;
        let value = match (unit, micro) {
            (Unit::Millimetre, false) => return fmt::Display::fmt(&mm, f),
            (Unit::Millimetre, true) => return fmt::Display::fmt(&(mm * 1e3), f),
            (Unit::Inch, _) => unit.said(mm),
        };
        if !value.is_finite() {
            return fmt::Display::fmt(&value, f);
        }
        let text = match f.precision() {
            Some(decimals) if micro => format!("{:.*}", (decimals + 4).max(LEAST.1), value.abs()),
            Some(decimals) => format!("{:.*}", (decimals + 1).max(LEAST.0), value.abs()),
            None => shortest(value.abs()),
        };
        f.pad_integral(!value.is_sign_negative(), "", &text)
    }
}

/// A text in both units. As JSON it is the text, or where the units differ in it a list: in millimetres, in inches.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Said {
    mm: String,
    inches: Option<String>,
}

impl Said {
    /// What is said in a unit.
    pub fn of(say: impl Fn(Unit) -> String) -> Self {
        let [mm, inches] = [Unit::Millimetre, Unit::Inch].map(say);
        Self { inches: (inches != mm).then_some(inches), mm }
    }
    /// The text in a unit.
    pub fn in_unit(&self, unit: Unit) -> &str {
        self.inches.as_deref().filter(|_| unit == Unit::Inch).unwrap_or(&self.mm)
    }
}

impl<T: Into<String>> From<T> for Said {
    fn from(text: T) -> Self {
        Self { mm: text.into(), inches: None }
    }
}

impl Serialize for Said {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match &self.inches {
            None => self.mm.serialize(serializer),
            Some(inches) => [&self.mm, inches].serialize(serializer),
        }
    }
}

/// Up to seven decimals, without noughts at the end.
fn shortest(value: f64) -> String {
    let text = format!("{value:.7}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

#[cfg(test)]
mod tests {
    use super::{Said, Unit, flag};

    #[test]
    fn a_flag_is_in_millimetres_or_says_its_unit() {
        let all = ["3", "-2.5", "20um", "0.5in", "1 mm"].map(|text| flag(text).ok());
        assert_eq!(all, [3.0, -2.5, 0.02, 12.7, 1.0].map(Some));
        let typed = [Unit::Millimetre, Unit::Inch].map(|unit| unit.typed(0.0127));
        assert_eq!(typed, ["0.0127", "0.0005in"]);
        assert_eq!(typed.map(|text| flag(&text).ok()), [Some(0.0127); 2]);
        assert!(flag("5 feet").is_err_and(|said| said.contains("0.02in")));
    }

    #[test]
    fn a_text_has_two_wordings_where_the_units_differ_in_it() {
        let said = Said::of(|unit| format!("{:.3} {}", unit.of(0.0254), unit.name()));
        assert_eq!(serde_json::to_string(&said).unwrap(), r#"["0.025 mm","0.0010 in"]"#);
        assert_eq!([Unit::Millimetre, Unit::Inch].map(|unit| said.in_unit(unit)), ["0.025 mm", "0.0010 in"]);
        let plain = Said::of(|_| "predicted".to_owned());
        assert_eq!(
            (serde_json::to_string(&plain).unwrap(), plain.clone()),
            ("\"predicted\"".to_owned(), "predicted".into())
        );
        assert_eq!(plain.in_unit(Unit::Inch), "predicted");
    }

    #[test]
    fn millimetres_are_written_as_numbers_are() {
        let unit = Unit::Millimetre;
        for mm in [0.0, -0.0, 0.123_456, -12.5, 1e6, f64::NAN, f64::INFINITY] {
            assert_eq!(format!("{:>10.4}|{0:+.3}|{0}", unit.of(mm)), format!("{mm:>10.4}|{mm:+.3}|{mm}"));
            assert_eq!(format!("{:<6.1}", unit.small(mm)), format!("{:<6.1}", mm * 1e3));
        }
        assert_eq!((unit.name(), unit.small_name()), ("mm", "µm"));
    }

    #[test]
    fn inches_have_the_decimals_a_machinist_says() {
        let unit = Unit::Inch;
        assert_eq!(format!("{:.4} {0:.3}", unit.of(0.0305)), "0.00120 0.0012");
        assert_eq!(format!("{:.1} {:.2}", unit.of(384.596), unit.of(9.525)), "15.142 0.375");
        assert_eq!(format!("{:>9.4}|{:<8.4}|{0:+.4}", unit.of(-0.254), unit.of(0.254)), " -0.01000|0.01000 |-0.01000");
        assert_eq!(format!("{:+.4}", unit.of(0.0254)), "+0.00100");
        assert_eq!(
            format!("{} {} {} {}", unit.of(12.7), unit.of(0.0254), unit.of(25.4), unit.of(0.02)),
            "0.5 0.001 1 0.0007874"
        );
        assert_eq!(format!("{:.1} {:.2}", unit.small(0.0254), unit.small(0.000_254)), "0.00100 0.000010");
        assert_eq!(format!("{:.6}", unit.of(0.000_254)), "0.0000100");
        assert_eq!(format!("{:.4}", unit.of(f64::NAN)), "NaN");
    }
}
