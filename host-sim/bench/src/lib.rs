//! The bench: a board, real or not, under setpoints and faults, every answer compared with the host's own code.
//!
//! | piece | what it does |
//! |---|---|
//! | [`Wire`], [`Client`] | byte streams, and the configuration link on them |
//! | [`Board`] | [`BulkBoard`] over [`InProcess`] or the [`Emulator`]'s shared memory, [`UartBoard`] over streams |
//! | [`Traffic`] | what a controller sends: recorded setpoints, or a part milled again and again |
//! | [`FaultInjector`] | the cable: loses, damages, delays, repeats, pauses |
//! | [`Expectation`] | the host's own endpoint and rewriter, fed with the same bytes |
//! | [`Judge`] | rules for every answer that know nothing of that code |
//! | [`Campaign`] | all of it in one run |
//! | [`mod@attack`] | random images, settings, controllers and cables against the host's own servo, judged by the contract alone |
//! | [`mod@whole`] | a whole device that is told anything over both links, judged by the contract and by what it promises beside it |
//! | [`Example`] | an image to try things with |
//! | [`Watch`], [`RunStatus`] | what somebody who looks on sees of it |
//!
//! Frames and messages are those of `truepath_core::link`; nothing here knows their bytes.

mod access;
pub mod attack;
mod board;
mod bulk;
mod campaign;
mod chance;
mod client;
pub mod codes;
mod compare;
mod difference;
mod emulator;
mod error;
mod example;
mod expect;
mod in_process;
mod injector;
mod judge;
mod load;
mod on_board;
mod prepare;
pub mod records;
mod round_trip;
pub mod traffic;
mod uart;
mod watch;
pub mod whole;
mod wire;

pub use access::Access;
pub use board::{Board, Clients, Event, Exchange};
pub use bulk::{BATCH_BYTES, Bulk, BulkBoard};
pub use campaign::{Campaign, Outcome, Plan};
pub use chance::{Chance, Probability};
pub use client::{Client, Committed};
pub use difference::Difference;
pub use emulator::{ELF, Emulator, LOADER, find_elf, find_loader};
pub use error::BenchError;
pub use example::{EXAMPLE_FEED, EXAMPLE_PASS, Example};
pub use expect::Expectation;
pub use in_process::InProcess;
pub use injector::{Delivery, FaultInjector, Faults, Injected};
pub use judge::{Happened, Judge, Violation};
pub use load::Load;
pub use on_board::{Ingredients, begin, compute, look, stage, too_long};
pub use prepare::{Identity, configure, identify, prepare, restart, to_off};
pub use round_trip::RoundTrip;
pub use traffic::Traffic;
pub use uart::UartBoard;
pub use watch::{RunStatus, TRAIL_EVERY, Watch};
pub use wire::{Arrival, Line, Wire};
