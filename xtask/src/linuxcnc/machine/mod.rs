//! The simulated machine: LinuxCNC without a screen, started as an ordinary user, driven by `linuxcnc/tests/drive.py`.

mod leftovers;
pub mod sample;
pub mod session;
mod user;
