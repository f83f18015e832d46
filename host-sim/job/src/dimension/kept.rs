//! A file of dimensions as it is kept beside a correction: whole in itself, so that the correction can be made again from it.

use toml::{Table, Value};
use truepath_core::units::Position;
use truepath_ground::diagnostics::{InputError, Source};
use truepath_ground::units::mm;

use super::file::{Across, Dimension, Level};
use super::read;
use super::walls::Axis;
use crate::qif::is_qif;

/// The bytes that are kept: as they are given; of values that stand in the file of a measuring machine the dimensions with
/// these values, each in the line that it has in the file given.
///
/// # Errors
/// As when it is read.
pub fn kept(source: &Source) -> Result<Vec<u8>, InputError> {
    let names_values = || {
        let table = String::from_utf8_lossy(source.bytes()).parse::<Table>();
        table.is_ok_and(|table| table.contains_key("values"))
    };
    if !is_qif(source.bytes()) && !names_values() {
        return Ok(source.bytes().to_vec());
    }
    let mut text = "version = 1\ndimension = [\n".to_owned();
    let mut line = 3;
    for dimension in read(source)? {
        let (own, _) = source.line_column(dimension.value_span.start);
        while line < own {
            text.push('\n');
            line += 1;
        }
        text += &format!("    {},\n", Value::Table(written(&dimension)));
        line += 1;
    }
    Ok((text + "]\n").into_bytes())
}

fn written(dimension: &Dimension) -> Table {
    let mut table = Table::new();
    let mut put = |key: &str, value: Value| drop(table.insert(key.to_owned(), value));
    put("name", Value::from(dimension.name.as_str()));
    put("kind", Value::from(dimension.kind.name()));
    put("along", Value::from(dimension.along.of(["x", "y"])));
    match dimension.across {
        Across::Middle => put("through", Value::from("middle")),
        Across::At(at) => put(if dimension.along == Axis::X { "y_mm" } else { "x_mm" }, Value::from(at)),
    }
    if let Some(near) = dimension.near {
        put("near_mm", Value::from(near));
    }
    if let Some(face) = dimension.face {
        put("face_mm", Value::from(face));
        put("face_uncertainty_mm", Value::from(mm(dimension.face_uncertainty)));
    }
    match dimension.level {
        Level::Z(z) => put("z_mm", Value::from(mm(z - Position::ZERO))),
        Level::AboveTip(above) => put("height_mm", Value::from(mm(above))),
    }
    put("instrument", Value::from(dimension.instrument.name()));
    put("uncertainty_mm", Value::from(mm(dimension.uncertainty)));
    put("value_mm", Value::from(mm(dimension.value)));
    table
}
