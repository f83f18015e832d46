//! LinuxCNC.
