//! What has to hold in a recording.

pub mod case;
pub mod equal;
pub mod limits;
pub mod link;
mod ramp;
pub mod scenario;
mod uncorrected;
