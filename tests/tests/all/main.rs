//! The whole system: parts from the program to the corrected wall, and boards under setpoints and faults.

mod conformance_small;
mod corners;
mod discrepancy;
mod errors;
mod hil_client;
mod hil_clock;
mod hil_device;
mod hil_difference;
mod hil_equality;
mod hil_faults;
mod hil_judge;
mod hil_support;
mod learning;
mod learning_support;
mod noise;
mod planned_device;
mod second_pass;
mod story;
mod taken_back;
mod verification;
