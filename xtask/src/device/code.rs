//! What a compiled crate consists of: its functions, how large they are and what they call.
//!
//! Read from the relocations of the object files in its library: every function has a section of its own, and what a
//! section refers to is what the function may call. Code that other crates instantiate from generic functions is not
//! in the library and is not seen.

use std::collections::BTreeMap;
use std::path::Path;

use object::read::archive::ArchiveFile;
use object::{Object, ObjectSection, ObjectSymbol, RelocationTarget, SectionKind};

use crate::step::Failure;

/// A function of the crate.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Function {
    /// Readable name, without the hash.
    pub name: String,
    /// Size of its code, bytes.
    pub bytes: u64,
    /// Symbols it refers to, as the linker knows them, and operations that leave no symbol (`llvm sdiv i128`).
    pub calls: Vec<String>,
}

/// The functions of a crate by symbol.
#[derive(Clone, Debug, Default)]
pub struct Code {
    /// The functions.
    pub functions: BTreeMap<String, Function>,
}

impl Function {
    /// The module of a crate (`truepath_wire`) it belongs to; `None` for what the crate instantiates of others.
    pub fn module(&self, crate_name: &str) -> Option<&str> {
        let (_, behind) = self.name.split_once(&format!("{crate_name}::"))?;
        let end = behind.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(behind.len());
        behind.get(..end)
    }
}

impl Code {
    /// Adds what a library (`.rlib`) holds.
    ///
    /// # Errors
    /// When the file cannot be read or holds no function.
    pub fn read(&mut self, library: &Path) -> Result<(), Failure> {
        let unreadable = |e: &dyn std::fmt::Display| Failure::found(format!("{}: {e}", library.display()));
        let bytes = std::fs::read(library).map_err(|e| unreadable(&e))?;
        let archive = ArchiveFile::parse(bytes.as_slice()).map_err(|e| unreadable(&e))?;
        let before = self.functions.len();
        for member in archive.members() {
            let member = member.map_err(|e| unreadable(&e))?;
            if member.name().ends_with(b".o") {
                let data = member.data(bytes.as_slice()).map_err(|e| unreadable(&e))?;
                self.add(&object::File::parse(data).map_err(|e| unreadable(&e))?);
            }
        }
        if self.functions.len() == before { Err(unreadable(&"no functions in it")) } else { Ok(()) }
    }

    fn add(&mut self, file: &object::File) {
        for section in file.sections().filter(|s| s.kind() == SectionKind::Text && s.size() > 0) {
            // The section's own symbol and the markers of the instruction set ($t, $d) are not functions.
            let Some(symbol) = file
                .symbols()
                .find(|s| s.section_index() == Some(section.index()) && s.name().is_ok_and(|n| n.starts_with('_')))
            else {
                continue;
            };
            let calls = section.relocations().filter_map(|(_, relocation)| {
                let RelocationTarget::Symbol(index) = relocation.target() else { return None };
                file.symbol_by_index(index).ok()?.name().ok().filter(|n| !n.is_empty()).map(str::to_owned)
            });
            let mut calls: Vec<String> = calls.collect();
            calls.sort_unstable();
            calls.dedup();
            let symbol = symbol.name().unwrap_or_default();
            let name = format!("{:#}", rustc_demangle::demangle(symbol));
            self.functions.insert(symbol.to_owned(), Function { name, bytes: section.size(), calls });
        }
    }

    /// Adds operations that leave no symbol, by function.
    ///
    /// # Errors
    /// When most functions are unknown to the library: the operations are not of this build.
    pub fn add_operations(&mut self, operations: BTreeMap<&str, Vec<String>>) -> Result<(), Failure> {
        let (mut known, of) = (0, operations.len());
        for (symbol, mut operations) in operations {
            if let Some(function) = self.functions.get_mut(symbol) {
                known += 1;
                operations.sort_unstable();
                operations.dedup();
                function.calls.append(&mut operations);
            }
        }
        if known * 2 < of { Err(Failure::found("library and intermediate representation differ")) } else { Ok(()) }
    }

    /// The compiler's own routines that the crate calls (division, memory) and the operations that leave no symbol,
    /// with the number of functions that have each.
    pub fn routines(&self) -> BTreeMap<&str, usize> {
        let mut routines = BTreeMap::new();
        for call in self
            .functions
            .values()
            .flat_map(|f| &f.calls)
            .filter(|c| ["__", "mem", "llvm "].iter().any(|p| c.starts_with(p)))
        {
            *routines.entry(call.as_str()).or_default() += 1;
        }
        routines
    }

    /// Every way from a function chosen by `from` to a symbol chosen by `to`, through functions of this crate: the
    /// readable names along the shortest way, one way for each pair of start and symbol.
    pub fn ways(&self, from: impl Fn(&Function) -> bool, to: impl Fn(&str) -> bool) -> Vec<Vec<String>> {
        let mut ways = Vec::new();
        for start in self.functions.iter().filter(|(_, f)| from(f)).map(|(symbol, _)| symbol) {
            let mut reached: BTreeMap<&str, Option<&str>> = BTreeMap::from([(start.as_str(), None)]);
            let mut next = std::collections::VecDeque::from([start.as_str()]);
            while let Some(at) = next.pop_front() {
                for call in self.functions.get(at).into_iter().flat_map(|f| &f.calls) {
                    if reached.contains_key(call.as_str()) {
                        continue;
                    }
                    reached.insert(call, Some(at));
                    next.push_back(call);
                    if to(call) {
                        ways.push(self.way(&reached, call));
                    }
                }
            }
        }
        ways
    }

    fn way(&self, reached: &BTreeMap<&str, Option<&str>>, end: &str) -> Vec<String> {
        let mut names = Vec::new();
        let mut at = Some(end);
        while let Some(symbol) = at {
            names.push(format!("{:#}", rustc_demangle::demangle(symbol)));
            at = reached.get(symbol).copied().flatten();
        }
        names.reverse();
        names
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn function(name: &str, calls: &[&str]) -> (String, Function) {
        let calls = calls.iter().map(|c| (*c).to_owned()).collect();
        (name.to_owned(), Function { name: name.to_owned(), bytes: 2, calls })
    }

    #[test]
    fn a_function_knows_its_module_through_impls_and_closures() {
        let module =
            |name: &str| Function { name: name.into(), ..Function::default() }.module("a_core").map(str::to_owned);
        assert_eq!(module("a_core::gcode::word::read::{closure#0}").as_deref(), Some("gcode"));
        assert_eq!(module("<a_core::cut::path::Path>::sample").as_deref(), Some("cut"));
        assert_eq!(module("<&a_core::units::Offset as core::fmt::Debug>::fmt").as_deref(), Some("units"));
        assert_eq!(module("core::slice::sort::heapsort"), None);
    }

    #[test]
    fn a_forbidden_symbol_is_found_behind_other_functions_and_through_recursion() {
        let functions =
            [function("tick", &["locate"]), function("locate", &["tick", "divide"]), function("other", &["divide"])];
        let code = Code { functions: functions.into_iter().collect() };
        let ways = code.ways(|f| f.name == "tick", |symbol| symbol == "divide");
        assert_eq!(ways, [["tick", "locate", "divide"]]);
        assert!(code.ways(|f| f.name == "tick", |symbol| symbol == "other").is_empty());
    }
}
