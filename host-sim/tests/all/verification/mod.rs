//! Verification programs: planned by the rules, executed line by line on a simulated control, their results read back.

mod command_line;
mod further;
mod linuxcnc_interpreter;
mod parts;
mod plans;
mod programs;
mod round_trip;
mod wall;
