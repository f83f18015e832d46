//! Results of a measuring machine in the transfer format of quality departments, Q-DAS ASCII (AQDEF).
//!
//! Key fields, one a line, describe part and characteristics, `K2002/3 pocket X` the name of the third; `/0` counts for all. Behind
//! them stand values, a line for each part: characteristics apart by SI (0x0F), what belongs to a value behind it by DC4 (0x14), the
//! first of it an attribute of which 255 and 256 make it no value. `K0001/3 39.87` gives a value as well.
//!
//! | key | what |
//! |---|---|
//! | K0100 | how many characteristics |
//! | K1001, K1002 | number and name of the part |
//! | K2001, K2002 | number and name of a characteristic |
//! | K2101, K2110, K2111 | its nominal, its limits |
//! | K2142 | its unit |
//!
//! Its text is UTF-8 or, as most programs write it, that of Windows-1252. Where a dimension was taken the format does not say: that is
//! the file of dimensions' part.

use truepath_ground::decimal::Decimal;
use truepath_ground::diagnostics::{InputError, Source};

use crate::codes::M050;

/// Characteristics that a file may have.
const MOST: usize = 10_000;

/// A file of results.
#[derive(Clone, Debug)]
pub(super) struct Results {
    source: Source,
    characteristics: Vec<Characteristic>,
}

#[derive(Clone, Debug, Default)]
struct Characteristic {
    number: String,
    name: String,
    unit: String,
    /// The last value, with its line.
    last: Option<(String, u32)>,
}

impl Results {
    /// Reads a file.
    ///
    /// # Errors
    /// `M050` for one that is none of this format.
    pub(super) fn of(source: Source) -> Result<Self, InputError> {
        let text = decoded(&source)?;
        let mut all: Vec<Characteristic> = Vec::new();
        let mut common = Characteristic::default();
        for (line, text) in (1u32..).zip(text.lines()) {
            let key = text.strip_prefix('K').filter(|rest| rest.as_bytes().iter().take(4).all(u8::is_ascii_digit));
            match key.and_then(|rest| rest.split_at_checked(4)) {
                Some((key, rest)) => {
                    let (place, value) = match rest.strip_prefix('/') {
                        Some(rest) => rest.split_once([' ', '\t']).unwrap_or((rest, "")),
                        None => ("1", rest),
                    };
                    let place = place.parse::<usize>().ok().filter(|place| *place <= MOST);
                    let value = value.trim();
                    let of_part = !(key.starts_with('2') || key == "0001");
                    match place {
                        _ if of_part => {}
                        Some(0) => common.set(key, value, line),
                        Some(place) => at(&mut all, place - 1).set(key, value, line),
                        None => {
                            let found = format!("K{key}{rest} names no characteristic");
                            let expected = format!("a number up to {MOST} behind the stroke");
                            return Err(M050.error(found, expected).at(&source, source.line_span(line)));
                        }
                    }
                }
                None if text.trim().is_empty() => {}
                None => {
                    for (place, value) in text.split('\u{f}').enumerate().take(MOST) {
                        at(&mut all, place).take(value, line);
                    }
                }
            }
        }
        if all.iter().all(|c| c.number.is_empty() && c.name.is_empty()) {
            let found = format!("{} names no characteristic", source.name());
            return Err(M050.error(found, "key fields K2001 or K2002 of a Q-DAS file").at(&source, 0..0));
        }
        for characteristic in &mut all {
            if characteristic.unit.is_empty() {
                characteristic.unit.clone_from(&common.unit);
            }
        }
        Ok(Self { source, characteristics: all })
    }

    /// The last value of the characteristic of a name or a number, mm.
    ///
    /// # Errors
    /// `M050` where there is none, or its unit is no length.
    pub(super) fn value(&self, name: &str) -> Result<Decimal, InputError> {
        let named = |c: &&Characteristic| c.name == name || c.number == name;
        let mut all = self.characteristics.iter().filter(named);
        let first = all.next();
        if all.next().is_some() {
            let found = format!("{} has several characteristics \"{name}\"", self.source.name());
            let help =
                "name the [[dimension]] by the number of its characteristic (K2001), or rename the characteristic";
            return Err(InputError::new(M050, found, "one of that name", help).at(&self.source, 0..0));
        }
        let Some(found) = first else {
            let names: Vec<&str> = self.characteristics.iter().map(|c| c.name.as_str()).take(12).collect();
            let found = format!("{} has no characteristic \"{name}\"", self.source.name());
            return Err(M050.error(found, format!("one of {}", names.join(", "))).at(&self.source, 0..0));
        };
        let Some((text, line)) = &found.last else {
            let what = format!("{} has no value of \"{name}\"", self.source.name());
            return Err(M050.error(what, "a value behind the key fields").at(&self.source, 0..0));
        };
        // A shift of the decimal point is exact.
        let factor = match found.unit.to_lowercase().as_str() {
            "" | "mm" => "",
            "µm" | "um" | "\u{3bc}m" | "micron" => "e-3",
            "cm" => "e1",
            "m" => "e3",
            _ => {
                let what = format!("\"{name}\" is in {}", found.unit);
                return Err(M050.error(what, "K2142 mm, µm, cm or m").at(&self.source, self.source.line_span(*line)));
            }
        };
        let number = Decimal::parse(&format!("{}{factor}", text.replace(',', ".")));
        number.ok_or_else(|| {
            let what = format!("the value of \"{name}\" is {text}");
            M050.error(what, "a decimal number").at(&self.source, self.source.line_span(*line))
        })
    }
}

impl Characteristic {
    fn set(&mut self, key: &str, value: &str, line: u32) {
        match key {
            "2001" => value.clone_into(&mut self.number),
            "2002" => value.clone_into(&mut self.name),
            "2142" => value.clone_into(&mut self.unit),
            "0001" => self.take(value, line),
            _ => {}
        }
    }

    /// A value with its attributes, where it is one.
    fn take(&mut self, text: &str, line: u32) {
        let mut parts = text.split('\u{14}').map(str::trim);
        let value = parts.next().unwrap_or_default();
        if !value.is_empty() && !matches!(parts.next(), Some("255" | "256")) {
            self.last = Some((value.to_owned(), line));
        }
    }
}

/// The text of a file, byte for byte where it is not UTF-8: Latin-1, which names and the sign for micro need no more of
/// Windows-1252 than.
fn decoded(source: &Source) -> Result<String, InputError> {
    let bytes = source.bytes();
    if bytes.starts_with(&[0xff, 0xfe]) || bytes.starts_with(&[0xfe, 0xff]) {
        let found = format!("{} is UTF-16", source.name());
        let help = "export it as ASCII or ANSI, or save it as UTF-8";
        return Err(InputError::new(M050, found, "text in UTF-8 or ANSI", help).at(source, 0..2));
    }
    let text =
        std::str::from_utf8(bytes).map_or_else(|_| bytes.iter().copied().map(char::from).collect(), str::to_owned);
    Ok(text.trim_start_matches('\u{feff}').to_owned())
}

/// The characteristic of a place, which is made where there is none.
fn at(all: &mut Vec<Characteristic>, place: usize) -> &mut Characteristic {
    if all.len() <= place {
        all.resize_with(place + 1, Characteristic::default);
    }
    &mut all[place]
}

#[cfg(test)]
mod tests {
    use super::*;

    const FILE: &str = "K0100 3\r\nK1001 4711\r\nK1002 housing\r\nK2002/1 pocket X\r\nK2101/1 40\r\nK2002/2 pocket Y\r\n\
        K2142/0 mm\r\nK2001/3 17\r\nK2002/3 bore\r\nK2142/3 \u{b5}m\r\n39.870\u{14}0\u{14}23.11.2026/10:00:00\u{f}29,910\u{14}0\u{f}20010\r\n\
        39.872\u{f}1.0\u{14}255\u{f}20012\r\n";

    #[test]
    fn the_last_valid_value_of_every_characteristic_is_read_in_its_unit() {
        let results = Results::of(Source::new("part.dfq", FILE.as_bytes().to_vec())).unwrap();
        let value = |name| results.value(name).map(|value| value.as_mm().nm());
        assert_eq!(value("pocket X").unwrap(), 39_872_000);
        assert_eq!(value("pocket Y").unwrap(), 29_910_000, "the second part has no valid one");
        assert_eq!((value("bore").unwrap(), value("17").unwrap()), (20_012_000, 20_012_000));
        let refused = value("slot").unwrap_err();
        assert_eq!(refused.code(), "M050");
        assert!(refused.to_string().contains("pocket X, pocket Y, bore"), "{refused}");
    }

    #[test]
    fn ansi_text_is_read_and_utf_16_and_a_name_that_stands_twice_are_named() {
        let of = |bytes: Vec<u8>| Results::of(Source::new("part.dfq", bytes));
        let ansi: Vec<u8> =
            FILE.replace("pocket X", "L\u{e4}nge").chars().map(|c| u8::try_from(u32::from(c)).unwrap()).collect();
        assert!(std::str::from_utf8(&ansi).is_err());
        let results = of(ansi).unwrap();
        let value = |name| results.value(name).map(|value| value.as_mm().nm());
        assert_eq!((value("L\u{e4}nge").unwrap(), value("bore").unwrap()), (39_872_000, 20_012_000));
        let marked = of(format!("\u{feff}{FILE}").into_bytes()).unwrap();
        assert_eq!(marked.value("pocket Y").unwrap().as_mm().nm(), 29_910_000);
        let wide: Vec<u8> =
            std::iter::once('\u{feff}').chain(FILE.chars()).flat_map(|c| (c as u16).to_le_bytes()).collect();
        let refused = of(wide).unwrap_err();
        assert!(refused.code() == "M050" && refused.to_string().contains("UTF-16"), "{refused}");
        let twice = of(FILE.replace("pocket Y", "pocket X").into_bytes()).unwrap();
        let refused = twice.value("pocket X").unwrap_err();
        assert!(refused.code() == "M050" && refused.to_string().contains("several"), "{refused}");
        assert_eq!(twice.value("17").unwrap().as_mm().nm(), 20_012_000);
    }

    #[test]
    fn a_file_of_another_format_is_named() {
        for text in ["", "X,Y,Z\n1,2,3\n", "K2002/99999999 far\n1.0\n"] {
            let refused = Results::of(Source::new("part.dfq", text.as_bytes().to_vec())).unwrap_err();
            assert_eq!(refused.code(), "M050", "{text}");
        }
    }
}
