//! The call graph of an image, from its symbols, its code and what the compiler says of its stack frames.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use object::{Object, ObjectSection, ObjectSymbol, SymbolKind};

use super::registers;
use super::thumb::{Effect, decode};
use crate::step::Failure;

/// A function.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Function {
    /// Readable name.
    pub name: String,
    /// Bytes of its stack frame; `None` when nobody knows.
    pub frame: Option<u32>,
    /// Functions it calls or jumps to, by address; those among them that it calls through a register it loaded itself.
    pub calls: BTreeSet<u32>,
    /// Whether it also calls through a register whose value does not follow from its own code.
    pub indirect: bool,
}

/// The functions by address.
#[derive(Clone, Debug, Default)]
pub struct Graph {
    /// The functions.
    pub functions: BTreeMap<u32, Function>,
    /// Values of all symbols by name.
    pub symbols: BTreeMap<String, u32>,
}

impl Graph {
    /// Reads an image.
    ///
    /// # Errors
    /// When it cannot be read or holds no function.
    pub fn read(elf: &Path) -> Result<Self, Failure> {
        let unreadable = |e: &dyn std::fmt::Display| Failure::found(format!("{}: {e}", elf.display()));
        let bytes = std::fs::read(elf).map_err(|e| unreadable(&e))?;
        let file = object::File::parse(bytes.as_slice()).map_err(|e| unreadable(&e))?;
        let mut graph = Self::default();
        let mut ends = BTreeMap::new();
        // Where code ($t) and data ($d) begin.
        let mut marks: BTreeMap<u32, bool> = BTreeMap::new();
        for symbol in file.symbols() {
            let name = symbol.name().unwrap_or_default();
            let address = symbol.address() as u32;
            if name.starts_with("$t") || name.starts_with("$d") {
                marks.insert(address, name.starts_with("$t"));
                continue;
            }
            graph.symbols.insert(name.to_owned(), address);
            if symbol.kind() == SymbolKind::Text && symbol.is_definition() {
                let start = address & !1;
                let end = start + symbol.size() as u32;
                let known = ends.entry(start).or_insert(end);
                *known = end.max(*known);
                let name = format!("{:#}", rustc_demangle::demangle(name));
                let function = graph.functions.entry(start).or_default();
                // Of several names for the same code the first that is not the compiler's own.
                if function.name.is_empty() {
                    function.name = name;
                }
            }
        }
        let frames = frames(&file);
        for section in file.sections().filter(|s| s.kind() == object::SectionKind::Text) {
            let (base, data) = (section.address() as u32, section.data().map_err(|e| unreadable(&e))?);
            let starts: Vec<u32> =
                graph.functions.range(base..base + data.len() as u32).map(|(&start, _)| start).collect();
            for (i, &start) in starts.iter().enumerate() {
                // Hand-written code has no size: it ends where the next function begins.
                let next = starts.get(i + 1).copied().unwrap_or(base + data.len() as u32);
                let end = ends.get(&start).copied().filter(|&end| end > start).unwrap_or(next);
                graph.scan(start, end, base, data, &marks, frames.get(&start).copied());
            }
        }
        if graph.functions.is_empty() { Err(unreadable(&"no functions in it")) } else { Ok(graph) }
    }

    fn scan(&mut self, start: u32, end: u32, base: u32, data: &[u8], marks: &BTreeMap<u32, bool>, frame: Option<u32>) {
        let is_code = |at: u32| marks.range(..=at).next_back().is_none_or(|(_, &code)| code);
        let word = |at: u32| {
            let place = at.checked_sub(base)? as usize;
            Some(u32::from_le_bytes(*data.get(place..)?.first_chunk()?))
        };
        let code = data.get((start - base) as usize..(end - base) as usize).unwrap_or(&[]);
        let through = registers::calls(code, start, is_code, word);
        let (mut targets, mut indirect, mut pushed, mut unknown) = (BTreeSet::new(), false, 0, false);
        let mut at = start;
        while at < end {
            if !is_code(at) {
                at += 2;
                continue;
            }
            let rest = data.get((at - base) as usize..).unwrap_or(&[]);
            let Some((effect, bytes)) = decode(rest, at) else { break };
            match effect {
                Effect::Call(to) => {
                    targets.insert(to);
                }
                // A branch out of the function is a tail call; one within it is a loop.
                Effect::Branch(to) if to < start || to >= end => {
                    targets.insert(to);
                }
                Effect::Indirect(_) => match through.get(&at).map(|to| to & !1) {
                    // The beginning of a function, or it is no address of one.
                    Some(to) if self.functions.contains_key(&to) => {
                        targets.insert(to);
                    }
                    _ => indirect = true,
                },
                Effect::Push(bytes) => pushed += bytes,
                Effect::PushUnknown => unknown = true,
                Effect::Branch(_) | Effect::Other => {}
            }
            at += bytes;
        }
        let calls = targets.into_iter().filter_map(|to| self.holding(to)).collect();
        let counted = (!unknown).then_some(pushed);
        if let Some(function) = self.functions.get_mut(&start) {
            function.calls = calls;
            function.indirect = indirect;
            function.frame = frame.or(counted);
        }
    }

    /// The function an address lies in.
    fn holding(&self, address: u32) -> Option<u32> {
        self.functions.range(..=address).next_back().map(|(&start, _)| start)
    }

    /// Functions whose name contains a text.
    pub fn named<'a>(&'a self, part: &'a str) -> impl Iterator<Item = u32> + 'a {
        self.functions.iter().filter(move |(_, f)| f.name.contains(part)).map(|(&start, _)| start)
    }
}

/// Frames by address, from the compiler: an address of four bytes and a size in LEB128 for each function.
fn frames(file: &object::File) -> BTreeMap<u32, u32> {
    let mut frames = BTreeMap::new();
    let data = file.section_by_name(".stack_sizes").and_then(|s| s.data().ok()).unwrap_or(&[]);
    let mut rest = data;
    while let Some((address, behind)) = rest.split_first_chunk::<4>() {
        let (mut size, mut shift, mut used) = (0u32, 0, 0);
        for &byte in behind {
            used += 1;
            size |= u32::from(byte & 0x7F).checked_shl(shift).unwrap_or(0);
            shift += 7;
            if byte & 0x80 == 0 {
                break;
            }
        }
        frames.insert(u32::from_le_bytes(*address) & !1, size);
        rest = behind.get(used..).unwrap_or(&[]);
    }
    frames
}
