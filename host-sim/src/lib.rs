#![doc = include_str!("../../README.md")]

pub mod cli;
pub mod command;
#[cfg(not(target_family = "wasm"))]
pub mod coprocessor;
mod help;
#[cfg(not(target_family = "wasm"))]
mod monitor;
pub mod settings;
pub mod streams;
mod terminal;
