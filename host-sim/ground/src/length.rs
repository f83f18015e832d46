//! How a length is said to people: in millimetres, or in inches where the program is in inches. Files and JSON have millimetres.

use core::fmt;
use core::ops::Deref;
use core::str::FromStr;
use std::borrow::Cow;

use serde::{Serialize, Serializer};
use truepath_core::gcode::{KlartextBlock, Lines, Statement, Token, Units, Words};

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
    /// That of a program at a byte of its text: the last of G20 and G21, or of the codes that stand for them, before it.
    pub fn at(program: &[u8], byte: usize) -> Self {
        let mut unit = Self::default();
        for line in Lines::new(program).take_while(|line| line.start <= byte) {
            if let Ok(block) = KlartextBlock::of(line)
                && let Statement::Begin(units) = block.statement
            {
                unit = units.into();
            }
            for token in Words::new(line).map_while(Result::ok) {
                let Token::Word(word) = token else { continue };
                let number = word.value.and_then(|value| value.exactly_times(1)).filter(|_| word.letter == b'G');
                match number {
                    Some(20 | 70) => unit = Self::Inch,
                    Some(21 | 71) => unit = Self::Millimetre,
                    _ => {}
                }
            }
        }
        unit
    }
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
    /// A sentence in this unit, from how it is said in any.
    pub fn remark(self, say: impl Fn(Self) -> String) -> Remark {
        Remark { unit: self, said: Said::of(say) }
    }
    /// Sentences in this unit, from how they are said in any: as many in each.
    pub fn remarks<S: IntoIterator<Item = String>>(self, say: impl Fn(Self) -> S) -> Vec<Remark> {
        let [mm, inches] = [Self::Millimetre, Self::Inch].map(say);
        let both = mm.into_iter().zip(inches);
        both.map(|(mm, inches)| Said::both(mm, inches).remark(self)).collect()
    }
    /// A sentence of the core, which has its lengths in millimetres (`25.4 mm`), in this unit.
    pub fn retold(self, sentence: &str) -> Cow<'_, str> {
        if self == Self::Millimetre {
            return sentence.into();
        }
        let said = |text: &str, mm: f64| {
            let decimals = text.split_once('.').map_or(0, |(_, decimals)| decimals.len().min(4));
            format!("{:.decimals$}", self.of(mm))
        };
        let mut told = String::new();
        let mut pieces = sentence.split(" mm").peekable();
        while let Some(piece) = pieces.next() {
            let behind = pieces.peek().map(|next| next.chars().next());
            let is_length = behind.is_some_and(|next| next.is_none_or(|c| !c.is_alphanumeric() && !"/²³".contains(c)));
            match last_number(piece).filter(|_| is_length) {
                Some((before, text, mm)) => {
                    // Of a range both ends are lengths, and the unit stands behind the second.
                    let word = [", up to ", " to "].into_iter().find(|word| before.ends_with(word));
                    let first = word.and_then(|word| Some((word, last_number(before.strip_suffix(word)?)?)));
                    told += &match first {
                        Some((word, (before, text, mm))) => format!("{before}{}{word}", said(text, mm)),
                        None => before.to_owned(),
                    };
                    told += &format!("{} {}", said(text, mm), self.name());
                }
                None => {
                    told += piece;
                    told += behind.map_or("", |_| " mm");
                }
            }
        }
        told.into()
    }
    /// A sentence about keys of a job, whose lengths have their unit in their names, with the names in this unit: `stock.allowance_in`
    /// in place of `stock.allowance_mm`.
    pub fn keys(self, sentence: &str) -> Cow<'_, str> {
        if self == Self::Millimetre {
            return sentence.into();
        }
        let is_letter = |c: char| c.is_ascii_alphanumeric() || c == '_';
        let words = sentence.split_inclusive(|c| !is_letter(c));
        let renamed = words.map(|word| {
            let (key, end) = word.split_at(word.trim_end_matches(|c| !is_letter(c)).len());
            in_inches(key).map_or_else(|| word.to_owned(), |key| key + end)
        });
        renamed.collect::<String>().into()
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

/// The number at the end of a text: what stands before it, its digits, its value.
fn last_number(text: &str) -> Option<(&str, &str, f64)> {
    let other = |c: char| !c.is_ascii_digit() && !"+-.".contains(c);
    let at = text.rfind(other).map_or(0, |before| before + text[before..].chars().next().map_or(0, char::len_utf8));
    let (before, number) = text.split_at(at);
    Some((before, number, number.parse().ok()?))
}

/// The key of a length in inches for one in millimetres: `allowance_in` beside `allowance_mm`, `feed_in_per_min`. `None` for what is no
/// length alone, as a force per millimetre.
pub fn in_inches(key: &str) -> Option<String> {
    other_unit(key, "_mm", "_in")
}

/// The key in millimetres of one in inches: the other way.
pub fn in_millimetres(key: &str) -> Option<String> {
    other_unit(key, "_in", "_mm")
}

fn other_unit(key: &str, unit: &str, other: &str) -> Option<String> {
    let at = key.rfind(unit).filter(|&at| !key[..at].ends_with("_per"))?;
    let behind = &key[at + unit.len()..];
    matches!(behind, "" | "_per_min" | "_per_tooth" | "_per_s").then(|| format!("{}{other}{behind}", &key[..at]))
}

/// What a length on a command line may be, given in mm, in both units: `0.1 to 5 mm (0.00394 to 0.196 in)`.
pub fn between(low: f64, high: f64) -> String {
    let [low_in, high_in] = within([low, high]);
    format!("{low} to {high} mm ({low_in} to {high_in} in)")
}

/// The ends of a range, given in mm, in inches with three digits: within it, so that what is told is taken.
pub(crate) fn within(ends: [f64; 2]) -> [String; 2] {
    let mut round: [fn(f64) -> f64; 2] = [f64::ceil, f64::floor];
    ends.map(|mm| {
        let inches = Unit::Inch.said(mm);
        let decimals = if inches == 0.0 { 0 } else { (2 - inches.abs().log10().floor() as i32).clamp(0, 7) };
        let digits = inches * 10_f64.powi(decimals);
        // A whole inch stays one, whatever the division leaves.
        let whole = (digits - digits.round()).abs() < 1e-6;
        let digits = if whole { digits.round() } else { round[0](digits) };
        round.reverse();
        let decimals = usize::try_from(decimals).unwrap_or(0);
        shortest(format!("{:.decimals$}", digits / 10_f64.powf(decimals as f64)))
    })
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

/// A length of a command line, and the unit it was typed in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Typed {
    /// The length, mm, where it is one in millimetres if it has no unit.
    pub mm: f64,
    /// Its unit, where it has one.
    pub unit: Option<Unit>,
}

impl FromStr for Typed {
    type Err = String;
    fn from_str(text: &str) -> Result<Self, String> {
        let unit = match text.chars().last() {
            Some('m') => Some(Unit::Millimetre),
            Some('n' | 'h' | '"') => Some(Unit::Inch),
            _ => None,
        };
        Ok(Self { mm: flag(text)?, unit })
    }
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
            None => shortest(format!("{:.7}", value.abs())),
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
        Self::both(mm, inches)
    }
    fn both(mm: String, inches: String) -> Self {
        Self { inches: (inches != mm).then_some(inches), mm }
    }
    /// The sentence in the unit of a program.
    pub const fn remark(self, unit: Unit) -> Remark {
        Remark { unit, said: self }
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

/// A sentence to the user, such as a warning: a text in the unit of the program, which can be said in the other one as well. As JSON
/// it is that text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Remark {
    unit: Unit,
    said: Said,
}

impl Remark {
    /// The same with its texts changed alike, whatever the unit.
    #[must_use]
    pub fn map(&self, change: impl Fn(&str) -> String) -> Self {
        Self { unit: self.unit, said: Said::of(|unit| change(self.said.in_unit(unit))) }
    }
}

impl Deref for Remark {
    type Target = str;
    fn deref(&self) -> &str {
        self.said.in_unit(self.unit)
    }
}

impl fmt::Display for Remark {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self)
    }
}

impl From<String> for Remark {
    fn from(text: String) -> Self {
        Self { unit: Unit::default(), said: text.into() }
    }
}

impl From<&str> for Remark {
    fn from(text: &str) -> Self {
        text.to_owned().into()
    }
}

impl From<Remark> for Said {
    fn from(remark: Remark) -> Self {
        remark.said
    }
}

impl Serialize for Remark {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self)
    }
}

/// Decimals without noughts at the end.
fn shortest(text: String) -> String {
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

#[cfg(test)]
mod tests {
    use super::{Said, Typed, Unit, between, flag};

    #[test]
    fn a_flag_is_in_millimetres_or_says_its_unit() {
        let all = ["3", "-2.5", "20um", "0.5in", "1 mm"].map(|text| flag(text).ok());
        assert_eq!(all, [3.0, -2.5, 0.02, 12.7, 1.0].map(Some));
        let typed = [Unit::Millimetre, Unit::Inch].map(|unit| unit.typed(0.0127));
        assert_eq!(typed, ["0.0127", "0.0005in"]);
        assert_eq!(typed.map(|text| flag(&text).ok()), [Some(0.0127); 2]);
        let typed: [Typed; 3] = ["1in", "2", "3 \""].map(|text| text.parse().unwrap());
        assert_eq!(typed.map(|length| length.unit), [Some(Unit::Inch), None, Some(Unit::Inch)]);
        assert_eq!(typed.map(|length| length.mm), [25.4, 2.0, 76.2]);
        assert!("5 feet".parse::<Typed>().is_err());
        assert_eq!(between(0.1, 5.0), "0.1 to 5 mm (0.00394 to 0.196 in)", "0.197 in is more than 5 mm");
        assert_eq!(between(-4000.0, 0.0), "-4000 to 0 mm (-157 to 0 in)");
        assert_eq!(between(25.4, 2540.0), "25.4 to 2540 mm (1 to 100 in)");
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
    fn a_remark_is_a_text_in_the_unit_of_the_program_and_can_be_said_in_both() {
        let say = |unit: Unit| format!("{:.3} {} left", unit.of(0.0254), unit.name());
        let [mm, inches] = [Unit::Millimetre, Unit::Inch].map(|unit| unit.remark(say));
        assert_eq!(
            (&*mm, &*inches, inches.to_string().as_str()),
            ("0.025 mm left", "0.0010 in left", "0.0010 in left")
        );
        assert_eq!(serde_json::to_string(&inches).unwrap(), r#""0.0010 in left""#);
        assert_eq!(Said::from(mm), Said::from(inches.clone()));
        let named = Said::from(inches.map(|text| format!("contour-1: {text}")));
        assert_eq!(named.in_unit(Unit::Millimetre), "contour-1: 0.025 mm left");
        assert_eq!(Said::from(super::Remark::from("plain")), "plain".into());
    }

    #[test]
    fn a_program_is_in_the_unit_of_the_last_code_before_a_place() {
        let program = b"(G21 G20)\nG90 G020 G17\nG1 X1\nG21 X2\n";
        let of = |text: &str| Unit::at(program, String::from_utf8_lossy(program).find(text).unwrap());
        assert_eq!(["(G21", "G17", "X1", "X2"].map(of), [Unit::Millimetre, Unit::Inch, Unit::Inch, Unit::Millimetre]);
        assert_eq!(Unit::at(b"0 BEGIN PGM PART INCH\n1 L X+1\n", 30), Unit::Inch);
        assert_eq!(Unit::at(b"", 5), Unit::Millimetre);
    }

    #[test]
    fn sentences_of_the_core_are_told_in_inches() {
        let of_core = "radius 25.4 mm cannot reach an end -12.700 mm away at 40 mm/min within 3 mm² of X mm, 1000 mm";
        assert_eq!(Unit::Millimetre.retold(of_core), of_core);
        assert_eq!(
            Unit::Inch.retold(of_core),
            "radius 1.000 in cannot reach an end -0.5000 in away at 40 mm/min within 3 mm² of X mm, 39.370 in"
        );
        assert_eq!(Unit::Inch.retold("µm mm 5 mm"), "µm mm 0.197 in");
        assert_eq!(
            Unit::Inch.retold("within 0 to 12.7 mm, above 0, up to 200 mm, tool 3 to 5 of it"),
            "within 0.000 to 0.500 in, above 0.000, up to 7.874 in, tool 3 to 5 of it"
        );
        let keys = "add axial_depth_mm, or stock.allowance_mm = 1; feed_mm_per_min, n_per_mm and mm stay";
        assert_eq!(
            Unit::Inch.keys(keys),
            "add axial_depth_in, or stock.allowance_in = 1; feed_in_per_min, n_per_mm and mm stay"
        );
        assert_eq!(Unit::Millimetre.keys(keys), keys);
        assert_eq!(Unit::Inch.retold(""), "");
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
