//! Probing programs, executed as a control would execute them.

mod control;

pub use control::{Control, Printed, Wall, Xy};
