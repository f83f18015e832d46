//! The attack: random images, settings, controllers and cables against the servo, and a checker that knows only the
//! contract.
//!
//! The servo is the host's own endpoint and rewriter, the code that the firmware runs. The checker sees what a controller sees:
//! the bytes it sent, the answers and when they came, what became of its commands, mode and drive enable. Its geometry, its
//! framing and its limits are its own. Each rule has a number and stands in `docs/safety.md`; tests break every one of them
//! in a double of the servo and ask for the alarm of that very rule.
//!
//! | piece | what it does |
//! |---|---|
//! | [`Setup`] | an image and settings, drawn at random |
//! | [`Attacker`] | the controller: mills, and does what it must not |
//! | [`Servo`], [`HostServo`] | what is attacked |
//! | [`Checker`], [`Rule`], [`Alarm`] | the rules |
//! | [`session`], [`attack`] | one of them, and as many as there is time for |

mod attacker;
mod checker;
mod geometry;
mod rule;
mod servo;
mod session;
mod setup;

use std::collections::BTreeMap;

use truepath_core::rewrite::Reason;

pub use attacker::{Act, Attacker, Stray};
pub use checker::{Checker, SETTLED};
pub use rule::{Alarm, Rule};
pub use servo::{HostServo, Servo};
pub use session::session;
pub use setup::Setup;

use crate::chance::Chance;

/// What the sessions so far were.
#[derive(Clone, Debug, Default)]
pub struct Tally {
    /// Images and settings tried.
    pub sessions: u64,
    /// Setpoints sent.
    pub setpoints: u64,
    /// Answers judged.
    pub answers: u64,
    /// Commands judged.
    pub commands: u64,
    /// Parts armed.
    pub armed: u64,
    /// Answers in `Off`, `Bypass`, `Armed`, `Active`, `Hold`, `Fault`.
    pub modes: [u64; 6],
    /// Corrections that ended, by their reason.
    pub ended: BTreeMap<u16, u64>,
    /// Largest share of the limits of size, speed and acceleration that was used, 1/1000.
    pub used: [u64; 3],
    /// How often a rule that is stricter than the contract would have raised an alarm, in the order of [`SETTLED`].
    pub settled: [u64; SETTLED.len()],
}

impl Tally {
    /// How often a correction ended for a reason.
    pub fn ended_by(&self, reason: Reason) -> u64 {
        self.ended.get(&reason.code()).copied().unwrap_or(0)
    }
}

/// Makes what is attacked.
pub type Make<'m> = &'m dyn for<'a> Fn(&'a Setup) -> Box<dyn Servo + 'a>;

/// The servo as the firmware has it.
pub fn host<'a>(setup: &'a Setup) -> Box<dyn Servo + 'a> {
    Box::new(HostServo::new(setup))
}

/// Sessions one after the other while `more` says so; it is told the tally before each. Session `k` of a seed is always the
/// same.
///
/// # Errors
/// The first alarm, with the session it happened in.
pub fn attack(seed: u64, make: Make<'_>, more: &mut dyn FnMut(&Tally) -> bool) -> Result<Tally, (Box<Alarm>, Tally)> {
    let mut tally = Tally::default();
    while more(&tally) {
        let number = tally.sessions;
        let mut chance = Chance::new(seed, number.wrapping_add(1 << 32));
        if let Err(alarm) = session(&mut chance, make, &mut tally) {
            return Err((Box::new(Alarm { session: number, ..*alarm }), tally));
        }
    }
    Ok(tally)
}
