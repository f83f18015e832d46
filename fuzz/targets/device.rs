//! Any bytes as what reaches a whole device over both of its links: setpoints, requests of every kind, uploads, logins, bytes as they
//! are, time, resets, power that fails. Whatever comes, the device keeps every rule of the safety contract and what it promises beside it.
#![no_main]

use std::cell::RefCell;

use libfuzzer_sys::fuzz_target;
use truepath_bench::whole::Stand;

thread_local! {
    /// The devices, from one input to the next.
    static STAND: RefCell<Stand> = RefCell::new(Stand::new());
}

fuzz_target!(|bytes: &[u8]| {
    STAND.with_borrow_mut(|stand| {
        if let Err(breach) = stand.run(bytes, &|device, _| Box::new(device)) {
            panic!("{breach}");
        }
    });
});
