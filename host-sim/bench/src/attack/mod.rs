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
mod tally;

pub use attacker::{Act, Attacker, Stray};
pub use checker::Checker;
pub use rule::{Alarm, Rule, SETTLED};
pub use servo::{HostServo, Make, Servo};
pub use session::session;
pub use setup::Setup;
pub use tally::Tally;

use crate::chance::Chance;

/// The servo as the firmware has it.
pub fn host<'a>(setup: &'a Setup) -> Box<dyn Servo + 'a> {
    Box::new(HostServo::new(setup))
}

/// Sessions one after the other while `more` says so; it is told the tally before each. Session `k` of a seed is always the
/// same. Ends with the first alarm, which is given with what was done up to there.
pub fn attack(seed: u64, make: Make<'_>, more: &mut dyn FnMut(&Tally) -> bool) -> (Tally, Option<Box<Alarm>>) {
    let mut tally = Tally::default();
    while more(&tally) {
        let number = tally.sessions;
        let mut chance = Chance::new(seed, number.wrapping_add(1 << 32));
        if let Err(alarm) = session(&mut chance, make, &mut tally) {
            return (tally, Some(Box::new(Alarm { session: number, ..*alarm })));
        }
    }
    (tally, None)
}
