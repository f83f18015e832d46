//! Programs with planned passes, each read again by the interpreter and, where it is installed, by LinuxCNC's.

mod linuxcnc;
mod parts;
mod planned;
mod refused;
mod search;
mod shop;
