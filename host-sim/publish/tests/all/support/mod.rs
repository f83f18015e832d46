//! Summaries of batches that were never cut, and a broker of Mosquitto with somebody who listens.

pub mod batches;
#[cfg(unix)]
pub mod mosquitto;
