//! The simulated machine: LinuxCNC without a screen, started as an ordinary user, driven by `linuxcnc/tests/drive.py`.

pub mod board;
mod leftovers;
pub mod sample;
pub mod session;
mod user;
