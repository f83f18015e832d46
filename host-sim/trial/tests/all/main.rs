//! Corrections on parts of the virtual machine.

mod compensated_program;
mod device_image;
mod feed;
mod prudence;
mod two_threads;
