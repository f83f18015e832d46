//! How much flash and RAM an image takes, from its sections.

use std::path::Path;

use object::elf::{SHF_ALLOC, SHF_WRITE, SHT_NOBITS};
use object::{Object, ObjectSection, SectionFlags};

use crate::step::Failure;

/// Sizes, bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Sizes {
    /// Code and constants.
    pub text: u64,
    /// Variables that begin with a value: in flash and in RAM.
    pub data: u64,
    /// Variables that begin with zero or with anything.
    pub bss: u64,
}

impl Sizes {
    /// Reads an image.
    ///
    /// # Errors
    /// When it cannot be read.
    pub fn read(elf: &Path) -> Result<Self, Failure> {
        let unreadable = |e: &dyn std::fmt::Display| Failure::found(format!("{}: {e}", elf.display()));
        let bytes = std::fs::read(elf).map_err(|e| unreadable(&e))?;
        let file = object::read::elf::ElfFile32::<object::Endianness>::parse(bytes.as_slice());
        let file = file.map_err(|e| unreadable(&e))?;
        let mut sizes = Self::default();
        for section in file.sections() {
            let SectionFlags::Elf { sh_flags } = section.flags() else { continue };
            let header = section.elf_section_header();
            if sh_flags & u64::from(SHF_ALLOC) == 0 {
                continue;
            }
            let size = section.size();
            if header.sh_type.get(file.endian()) == SHT_NOBITS {
                sizes.bss += size;
            } else if sh_flags & u64::from(SHF_WRITE) != 0 {
                sizes.data += size;
            } else {
                sizes.text += size;
            }
        }
        Ok(sizes)
    }

    /// Bytes of flash.
    pub const fn flash(&self) -> u64 {
        self.text + self.data
    }
    /// Bytes of RAM, without the stack.
    pub const fn ram(&self) -> u64 {
        self.data + self.bss
    }
}
