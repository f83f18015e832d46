//! Route A: the correction is computed on the PC, in LinuxCNC's servo thread.
//!
//! Two sides, as in the firmware. The **servo side** ([`Servo`]) is called once a period before and behind the motion
//! controller; it is bounded, and holds no allocation, no system call and no panic. The **configuration side**
//! ([`Config`]) runs in a thread of its own; it checks images, prepares rewriters and keeps the ledger of spent parts.
//! They share nothing but mailboxes ([`Mailboxes`]), each with room for one item, one sender and one receiver.
//!
//! What LinuxCNC says becomes a setpoint with flags ([`Signals`], [`WorkFrame`]); the other route sends the same
//! setpoint to a board. The rules are in `linuxcnc/README.md`.

mod arming;
mod config;
mod ledger;
mod limits;
mod mailbox;
mod pins;
mod servo;
mod setpoint;
mod shift;
mod trust;

pub use arming::{Refused, Running};
pub use config::Config;
pub use ledger::{LEDGER_BYTES, LedgerError};
pub use limits::{Joints, Limits, OfferError};
pub use mailbox::Mailboxes;
pub use pins::{Inputs, JOINTS, Outputs, Switches};
pub use servo::Servo;
pub use setpoint::{PROBING, Signals, WorkFrame};
pub use shift::Shift;
pub use trust::NO_KEY;

use core::sync::atomic::AtomicU32;

use truepath_core::rewrite::{Rewriter, Settings};

use ledger::Remembered;

/// Both sides, on mailboxes that live as long as they do. The ledger is the content of its file, nothing for a new one.
///
/// # Errors
/// The ledger cannot be used.
pub fn open(
    mailboxes: &'static mut Mailboxes,
    period_ns: &'static AtomicU32,
    joints: Joints,
    ledger: &[u8],
) -> Result<(Servo, Config), LedgerError> {
    let now = if ledger.is_empty() { Remembered::default() } else { ledger::read(ledger)? };
    // The settings are in range, and without an image there is nothing else that could be refused.
    let bare = Rewriter::new(Settings::at_1_khz(), None).map_err(|_| LedgerError::Damaged)?;
    let (servo, config) = mailboxes.split();
    Ok((Servo::new(servo, joints, period_ns, bare, now.spent), Config::new(config, joints, period_ns, now)))
}
