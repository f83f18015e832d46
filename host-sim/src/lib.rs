#![doc = include_str!("../../README.md")]

pub mod cli;
pub mod command;
pub mod coprocessor;
mod monitor;
pub mod settings;
mod terminal;
