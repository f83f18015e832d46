//! Forces from records.

mod real;
mod recovered;
mod refused;
