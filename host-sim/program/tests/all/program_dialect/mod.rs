//! Corrected programs of what controls can do beyond plain lines and arcs: expressions, loops, subprograms, cycles,
//! shifts of the origin. They are written right, or refused by name with the line and what to do.

mod compensated;
mod computed;
mod cycles;
mod path;
mod refused;
mod repeated;
