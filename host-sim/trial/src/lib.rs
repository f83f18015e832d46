//! Trial cuts: a pass on the virtual machine, recorded setpoints through the code of the device, and laws of correction
//! compared on one machine.

pub mod codes;
pub mod compare;
pub mod dynamometer;
pub mod probing;
pub mod process;
pub mod recorded;
pub mod replay;
pub mod setpoints;
pub mod virtual_mill;
