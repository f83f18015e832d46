//! The values of parameters, in memory lent by the caller.
//!
//! | | device | host |
//! |---|---:|---:|
//! | numbered parameters that are set | 512 | 6,000 |
//! | named parameters | 64 | 2,000 |
//! | bytes of all names | 512 | 32,768 |
//! | levels of calls, each with `#1` … `#33` of its own | 10 | 10 |
//!
//! What does not fit is refused with the limit. The values a program finds are those the memory holds when it starts.

use super::super::{Dialect, ParameterError};
use super::named::{NamedSlot, Names};
use super::numbered::{LEVELS, Levels, LocalValues, Table};

/// The parameters of a program.
#[derive(Debug)]
pub struct Memory<'a> {
    table: Table<'a>,
    names: Names<'a>,
    levels: Levels<'a>,
}

impl Memory<'_> {
    /// The value of a numbered parameter; 0 when it was never set, or no number in the dialects in which it is vacant then.
    pub fn get(&self, number: u16) -> f64 {
        self.levels.get(number).or_else(|| self.table.get(number)).unwrap_or(self.levels.vacant())
    }

    /// The value of a numbered parameter that is not local, when it was set.
    pub fn given(&self, number: u16) -> Option<f64> {
        self.table.get(number)
    }

    /// Sets a numbered parameter.
    ///
    /// # Errors
    /// The table is full, or the number is 0.
    pub fn set(&mut self, number: u16, value: f64) -> Result<(), ParameterError> {
        if self.levels.set(number, value) { Ok(()) } else { self.table.set(number, value) }
    }

    /// The value of a named parameter, by its name in lower case without blanks.
    pub fn named(&self, name: &[u8]) -> Option<f64> {
        self.names.get(name, self.levels.depth()).or(match name {
            b"_call_level" => Some(f64::from(self.levels.depth())),
            b"_value" | b"_value_returned" => Some(0.0),
            _ => None,
        })
    }

    /// Sets a named parameter: one whose name begins with `_` for the whole program, any other for the present call.
    ///
    /// # Errors
    /// No room for the name.
    pub fn set_named(&mut self, name: &[u8], value: f64) -> Result<(), ParameterError> {
        self.names.set(name, self.levels.depth(), value)
    }

    /// Forgets everything.
    pub fn clear(&mut self) {
        self.table.clear();
        self.levels.clear();
        self.names.clear();
    }

    /// Ends all calls and forgets what belongs to them.
    pub(in super::super) fn start(&mut self, dialect: Dialect) {
        self.levels.start(dialect);
        self.names.leave(0);
    }

    /// Begins a call with local parameters of its own.
    pub(in super::super) fn enter(&mut self) {
        self.levels.enter();
    }

    /// Ends it.
    pub(in super::super) fn leave(&mut self) {
        self.levels.leave();
        self.names.leave(self.levels.depth());
    }
}

/// A memory of its own: `PARAMETERS` numbered and `NAMES` named parameters, whose names have `BYTES` bytes together.
/// Empty, it is all zeros, so that a static one takes no room in flash.
#[derive(Debug)]
pub struct MemoryBuffers<const PARAMETERS: usize, const NAMES: usize, const BYTES: usize> {
    numbers: [u16; PARAMETERS],
    values: [f64; PARAMETERS],
    slots: [NamedSlot; NAMES],
    bytes: [u8; BYTES],
    locals: [LocalValues; LEVELS],
}

/// What the device has.
pub type DeviceMemory = MemoryBuffers<512, 64, 512>;
/// What the host has.
pub type HostMemory = MemoryBuffers<6_000, 2_000, 32_768>;

impl<const PARAMETERS: usize, const NAMES: usize, const BYTES: usize> MemoryBuffers<PARAMETERS, NAMES, BYTES> {
    /// Empty.
    pub const fn new() -> Self {
        Self {
            numbers: [0; PARAMETERS],
            values: [0.0; PARAMETERS],
            slots: [NamedSlot::FREE; NAMES],
            bytes: [0; BYTES],
            locals: [[0.0; _]; LEVELS],
        }
    }

    /// Lends it, emptied.
    pub fn lend(&mut self) -> Memory<'_> {
        let mut memory = Memory {
            table: Table::new(&mut self.numbers, &mut self.values),
            names: Names::new(&mut self.slots, &mut self.bytes),
            levels: Levels::new(&mut self.locals),
        };
        memory.clear();
        memory
    }
}

impl<const PARAMETERS: usize, const NAMES: usize, const BYTES: usize> Default
    for MemoryBuffers<PARAMETERS, NAMES, BYTES>
{
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn a_parameter_that_was_never_set_is_zero_and_a_name_unknown() {
        let mut buffers = MemoryBuffers::<4, 4, 16>::new();
        let memory = buffers.lend();
        assert_eq!((memory.get(7), memory.get(500), memory.named(b"_a")), (0.0, 0.0, None));
    }

    #[test]
    fn a_full_table_refuses_with_its_limit_and_still_takes_what_it_has() {
        let mut buffers = MemoryBuffers::<2, 1, 4>::new();
        let mut memory = buffers.lend();
        for number in [500, 40_000, 500, 7] {
            memory.set(number, f64::from(number)).unwrap();
        }
        assert_eq!(memory.set(501, 1.0), Err(ParameterError::TooMany { limit: 2 }));
        assert_eq!((memory.get(40_000), memory.get(500), memory.get(7)), (40_000.0, 500.0, 7.0));
        memory.set_named(b"abcd", 1.0).unwrap();
        memory.set_named(b"abcd", 2.0).unwrap();
        assert_eq!(memory.set_named(b"b", 1.0), Err(ParameterError::TooManyNames { limit: 1, bytes: 4 }));
        assert_eq!(memory.named(b"abcd"), Some(2.0));
    }
}
