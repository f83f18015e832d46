//! What is published of batches, and how it reaches brokers and agents.

mod adapter;
mod board;
#[cfg(unix)]
mod broker;
mod support;
