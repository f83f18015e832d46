//! The values of a measuring machine that a file of dimensions names: Q-DAS or QIF 3, told by the file itself.

use std::path::Path;

use truepath_ground::decimal::Decimal;
use truepath_ground::diagnostics::{InputError, Source};

use super::aqdef;
use crate::codes::M053;
use crate::qif::{Length, Qif, is_qif};

/// A file of results.
#[derive(Clone, Debug)]
pub(super) enum Results {
    Aqdef(aqdef::Results),
    Qif(Source, Vec<Length>),
}

impl Results {
    /// Reads a file that another one names.
    ///
    /// # Errors
    /// A file that cannot be read, `M050` and `M052` for one that is none of these formats.
    pub(super) fn beside(named_in: &Source, name: &str) -> Result<Self, InputError> {
        let folder = Path::new(named_in.name()).parent().unwrap_or(Path::new(""));
        let source = Source::read(&folder.join(name))?;
        if !is_qif(source.bytes()) {
            return aqdef::Results::of(source).map(Self::Aqdef);
        }
        let lengths = Qif::read(&source)?.lengths()?;
        Ok(Self::Qif(source, lengths))
    }

    /// The last value of a name, mm.
    ///
    /// # Errors
    /// `M050` and `M053` where there is none.
    pub(super) fn value(&self, name: &str) -> Result<Decimal, InputError> {
        let (source, lengths) = match self {
            Self::Aqdef(results) => return results.value(name),
            Self::Qif(source, lengths) => (source, lengths),
        };
        let named = |length: &&Length| length.names.iter().any(|own| own == name);
        if let Some(found) = lengths.iter().rfind(named) {
            return Ok(found.value);
        }
        let names: Vec<&str> = lengths.iter().flat_map(|one| one.names.first().map(String::as_str)).take(12).collect();
        let found = format!("{} has no length \"{name}\"", source.name());
        let expected =
            if names.is_empty() { "lengths with a value".to_owned() } else { format!("one of {}", names.join(", ")) };
        Err(M053.error(found, expected).at(source, 0..0))
    }
}
