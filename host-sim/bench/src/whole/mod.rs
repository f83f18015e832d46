//! A whole device that is told anything: bytes decide what reaches it over both links, when, and what becomes of its power; everything
//! that comes of it is judged.
//!
//! The setpoint link is judged by the [`Checker`](crate::attack::Checker) of the attack, with every rule of the safety contract; the
//! configuration link by promises of its own ([`Promise`]), from requests and answers alone. The device is that of the firmware, on the
//! model of its flash.
//!
//! | piece | what it does |
//! |---|---|
//! | [`Stand`] | devices in several states, ready for one input after the other |
//! | [`Whole`], [`WholeDevice`] | what is told everything |
//! | [`Breach`], [`Broken`] | what was broken |

mod asks;
mod broken;
mod contract;
mod device;
mod flash;
mod run;
mod stand;
mod tape;
mod things;

pub use broken::{Breach, Broken, Promise};
pub use device::{Whole, WholeDevice};
pub use stand::{Make, Stand, example};
