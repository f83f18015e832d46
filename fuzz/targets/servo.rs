//! Any bytes as the chances of an attack on the servo: image, settings, controller and cable are drawn from them, and every
//! answer keeps every rule of the safety contract.
#![no_main]

use libfuzzer_sys::fuzz_target;
use truepath_bench::Chance;
use truepath_bench::attack::{Tally, host, session};

fuzz_target!(|bytes: &[u8]| {
    if let Err(alarm) = session(&mut Chance::taped(bytes), &host, &mut Tally::default()) {
        panic!("{alarm}");
    }
});
