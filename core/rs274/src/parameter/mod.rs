//! Parameters: the memory of a program.
//!
//! | file | what |
//! |---|---|
//! | `memory.rs` | the values, lent by the caller |
//! | `numbered.rs` | `#1` … `#65535`: those of a call level, and the rest |
//! | `named.rs` | `#<name>` of a call level, `#<_name>` of the whole program |

mod memory;
mod named;
mod numbered;

pub use memory::{DeviceMemory, HostMemory, Memory, MemoryBuffers};
pub use named::NamedSlot;

/// Values that follow the machine and stand in no memory: the position (`#5420`…), the tool (`#5400`…), modes
/// (`#<_metric>`, `#<_feed>`), and the memory for all others.
pub trait MachineParameters {
    /// The value of a numbered parameter that follows the machine; `None` for all others.
    fn number(&self, number: u32) -> Option<f64>;
    /// The value of a named parameter that follows the machine, by its name in lower case without blanks; `None` for all
    /// others.
    fn named(&self, name: &[u8]) -> Option<f64>;
    /// The values that the program has set.
    fn memory(&self) -> &Memory<'_>;
}

/// The same with a memory that can be written to.
pub(super) trait Surroundings: MachineParameters {
    /// Changes the memory.
    fn change<R>(&mut self, how: impl FnOnce(&mut Memory<'_>) -> R) -> R;
    /// A block of this line is about to be read.
    fn reading(&mut self, line: u32);
    /// A call has ended; `level` is how deep it stood.
    fn level_ended(&mut self, level: u8);
}
