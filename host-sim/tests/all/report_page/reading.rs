//! The data of a page, and tables, as numbers.

use std::fs;
use std::path::Path;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde_json::Value;

/// The data of a page.
pub fn data(file: &Path) -> Value {
    let text = fs::read_to_string(file).unwrap();
    let (_, rest) = text.split_once(r#"<script type="application/json" id="truepath-data">"#).unwrap();
    let (data, _) = rest.split_once("</script>").unwrap();
    serde_json::from_str(data).unwrap()
}

/// A column of the data, by the same arithmetic as in the page.
pub fn column(column: &Value) -> Vec<Option<f64>> {
    let unit = 10f64.powi(column["decimals"].as_i64().unwrap() as i32);
    let offset = column["offset"].as_i64().unwrap_or(0);
    let bytes = STANDARD.decode(column["data"].as_str().unwrap()).unwrap();
    let number = |four: &[u8; 4]| match i32::from_le_bytes(*four) {
        i32::MIN => None,
        n => Some((offset + i64::from(n)) as f64 / unit),
    };
    bytes.as_chunks::<4>().0.iter().map(number).collect()
}

/// A column of numbers without holes.
pub fn full(value: &Value) -> Vec<f64> {
    column(value).into_iter().map(Option::unwrap).collect()
}

/// A column of a table; empty and "NaN" are no value.
pub fn table(file: &Path, name: &str) -> Vec<Option<f64>> {
    let text = fs::read_to_string(file).unwrap();
    let mut rows = csv::Reader::from_reader(text.as_bytes());
    let at = rows.headers().unwrap().iter().position(|n| n == name).unwrap_or_else(|| panic!("no column {name}"));
    rows.records().map(|row| row.unwrap()[at].parse::<f64>().ok().filter(|v| v.is_finite())).collect()
}

/// A column of words of a table.
pub fn words(file: &Path, name: &str) -> Vec<String> {
    let text = fs::read_to_string(file).unwrap();
    let mut rows = csv::Reader::from_reader(text.as_bytes());
    let at = rows.headers().unwrap().iter().position(|n| n == name).unwrap();
    rows.records().map(|row| row.unwrap()[at].to_owned()).collect()
}

/// A text of the page, in millimetres; none is empty.
pub fn in_mm(said: &Value) -> &str {
    said.get(0).unwrap_or(said).as_str().unwrap_or_default()
}
