//! What has to hold in a recording.

mod case;
pub mod equal;
pub mod limits;
mod ramp;
pub mod scenario;
mod uncorrected;
