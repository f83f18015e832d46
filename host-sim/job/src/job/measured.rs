//! Files that `truepath forces` has written and a job names: coefficients and runout.

use std::cell::RefCell;
use std::ops::Range;
use std::path::Path;

use truepath_ground::diagnostics::{InputError, Source};
use truepath_ground::document::{Section, Spans};
use truepath_ground::notation;

use crate::codes::J001;

/// Reads a part of such a file. Its other tables are for people.
///
/// # Errors
/// `J001` where the job names it when it cannot be read, and what is wrong with it.
pub(super) fn read<T>(
    job: &Source,
    named: Range<usize>,
    path: &Path,
    part: impl FnOnce(&Section<'_>) -> Result<T, InputError>,
) -> Result<T, InputError> {
    let source = Source::read(path)
        .map_err(|error| J001.error(error.found(), "forces.toml as truepath forces writes it").at(job, named))?;
    let table = notation::parse(&source, "the file of measured forces")?;
    let spans = RefCell::new(Spans::new());
    let root = Section::root(&source, &table, &spans);
    notation::version(&source, &root)?;
    part(&root)
}
