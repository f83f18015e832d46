//! Corrections on parts of the virtual machine.

mod compensated_program;
mod device_image;
mod dimensions;
mod feed;
mod lots;
mod probed_stock;
mod roughing;
mod runout;
mod sharp_corners;
mod shrinkage;
mod two_threads;
