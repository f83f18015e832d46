//! What cargo-mutants would change: one mutant, as its list has it, and how it may end.

use serde_json::Value;

use crate::repository::{cargo, read};
use crate::step::Failure;

/// How a mutant ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// A test failed.
    Killed,
    /// No test failed.
    Survived,
    /// It does not compile.
    Unviable,
    /// The tests went round for ever.
    TimedOut,
}

impl End {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Killed, Self::Survived, Self::Unviable, Self::TimedOut];
}

/// A mutant.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Mutant {
    /// All of it: `core/wire/src/rewrite/limit.rs:40:12: replace > with >= in Limits::step`.
    pub name: String,
    /// The file, relative to the root.
    pub file: String,
    /// Line and column where the change begins, from 1.
    pub place: (usize, usize),
    /// What is changed, as the document names it.
    pub change: String,
    /// Its kind: `FnValue`, `BinaryOperator`, …
    pub genre: String,
    /// What stands there then.
    pub replacement: String,
}

impl Mutant {
    /// Without kind and replacement, which a line of its results does not have.
    pub fn read(line: &str) -> Option<Self> {
        let (place, change) = line.split_once(": ")?;
        let mut place = place.split(':');
        let (file, line_number, column) = (place.next()?, place.next()?, place.next()?);
        Some(Self {
            name: line.to_owned(),
            file: file.to_owned(),
            place: (line_number.parse().ok()?, column.parse().ok()?),
            change: change.to_owned(),
            ..Self::default()
        })
    }
    fn listed(said: &Value) -> Option<Self> {
        let text = |key: &str| said[key].as_str().map(str::to_owned);
        Some(Self { genre: text("genre")?, replacement: text("replacement")?, ..Self::read(said["name"].as_str()?)? })
    }
    /// What it is known by in the document: its line moves.
    pub fn known_by(&self) -> (String, String) {
        (self.file.clone(), self.change.clone())
    }
}

/// The mutants of a folder, in the order of its files.
///
/// # Errors
/// When cargo-mutants cannot tell.
pub fn list(folder: &str, package: &str) -> Result<Vec<Mutant>, Failure> {
    let files = format!("{folder}/**");
    let said = read(cargo().args(["mutants", "--list", "--json", "--package", package, "--file", &files]))?;
    let unread = || Failure::found("cargo mutants --list --json: another form than this program reads");
    let list: Vec<Value> = serde_json::from_str(&said).map_err(|_| unread())?;
    list.iter().map(Mutant::listed).collect::<Option<_>>().ok_or_else(unread)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mutant_is_read_from_the_list_and_from_a_line() {
        let line = "core/wire/src/rewrite/limit.rs:40:12: replace || with && in Limits::step";
        let said = serde_json::json!({ "name": line, "genre": "BinaryOperator", "replacement": "&&" });
        let mutant = Mutant::listed(&said).unwrap();
        assert_eq!(
            (mutant.place, mutant.genre.as_str(), mutant.replacement.as_str()),
            ((40, 12), "BinaryOperator", "&&")
        );
        assert_eq!(mutant.known_by(), Mutant::read(line).unwrap().known_by());
        assert_eq!(Mutant::read("no mutant"), None);
    }
}
