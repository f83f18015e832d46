//! Tables written as CSV, one row for each value.

use crate::diagnostics::Failure;

/// A table with the names of the fields as its head.
///
/// # Errors
/// Internal, when memory cannot be written.
pub fn table<T: serde::Serialize>(rows: impl IntoIterator<Item = T>) -> Result<Vec<u8>, Failure> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    for row in rows {
        writer.serialize(row).map_err(|e| Failure::Internal(format!("a table cannot be written: {e}")))?;
    }
    writer.into_inner().map_err(|e| Failure::Internal(format!("a table cannot be written: {e}")))
}
