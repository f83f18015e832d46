//! What the commands do, apart from how they are called (`cli`) and printed.

pub mod correct;
pub mod demo;
pub mod device;
mod doubts;
pub mod hil;
pub mod inspect;
mod levels;
pub mod probe;
pub mod second_pass;
pub mod simulate;
mod first_pass;
pub mod split;
