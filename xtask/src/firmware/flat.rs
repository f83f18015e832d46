//! A program as it lies in the flash, from its ELF file: what an update is made of.

use std::path::Path;

use object::read::elf::{FileHeader, ProgramHeader};
use object::{Endianness, Object, ObjectSymbol, elf};

use crate::step::Failure;

/// Where the vectors lie, with which a program begins.
const VECTORS: &str = "__vector_table";

/// The bytes of a program, from its vectors on; between its parts ones, as in a blank flash.
///
/// # Errors
/// It cannot be read, or is no program.
pub fn read(path: &Path) -> Result<Vec<u8>, Failure> {
    let failed = |what: &dyn std::fmt::Display| Failure::found(format!("{}: {what}", path.display()));
    let bytes = std::fs::read(path).map_err(|e| failed(&e))?;
    let file = object::read::elf::ElfFile32::<Endianness>::parse(bytes.as_slice()).map_err(|e| failed(&e))?;
    let vectors = file.symbols().find(|symbol| symbol.name() == Ok(VECTORS)).ok_or_else(|| failed(&VECTORS))?;
    let (start, endian) = (vectors.address(), file.endian());
    let header = elf::FileHeader32::<Endianness>::parse(bytes.as_slice()).map_err(|e| failed(&e))?;
    let mut program = Vec::new();
    for segment in header.program_headers(endian, bytes.as_slice()).map_err(|e| failed(&e))? {
        let at = u64::from(segment.p_paddr(endian)).checked_sub(start);
        let data = segment.data(endian, bytes.as_slice()).map_err(|()| failed(&"a segment beyond its end"))?;
        let (Some(at), true) = (at, segment.p_type(endian) == elf::PT_LOAD && !data.is_empty()) else { continue };
        let at = usize::try_from(at).map_err(|e| failed(&e))?;
        program.resize(program.len().max(at + data.len()), 0xFF);
        program[at..at + data.len()].copy_from_slice(data);
    }
    if program.is_empty() { Err(failed(&"nothing behind the vectors")) } else { Ok(program) }
}
