//! What has to hold in a recording.

pub mod equal;
pub mod limits;
mod ramp;
pub mod scenario;
