#![doc = include_str!("../../README.md")]

pub mod canon;
pub mod cli;
pub mod command;
pub mod correction;
pub mod diagnostics;
pub mod image;
pub mod job;
pub mod measurement;
pub mod output;
pub mod pass;
pub mod plant;
pub mod plot;
pub mod program;
pub mod report;
pub mod setpoints;
pub mod workshop;
