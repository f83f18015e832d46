//! What a device says of its own program, and of an update of it.

use serde::{Deserialize, Serialize};

use crate::image::{KeyId, MOST_KEYS};
use crate::update::{Label, UpdateHead};

/// Time without a confirmation after which a program on trial gives up, as soon as the drives are not enabled, µs.
pub const TRIAL_US: u64 = 300_000_000;

/// Where an update stands.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum UpdateStage {
    /// No loader started the program: there are no updates.
    #[default]
    NoLoader,
    /// None is under way.
    Settled,
    /// One is installed, and starts with the next reset.
    Installed,
    /// The program runs for the first time. Without a confirmation the one before comes back with the next reset.
    Trial,
    /// The last one was not confirmed: this is the program before it again.
    RolledBack,
}

impl UpdateStage {
    /// All of them, in the order of their numbers.
    pub const ALL: [Self; 5] = [Self::NoLoader, Self::Settled, Self::Installed, Self::Trial, Self::RolledBack];
}

/// A program that came as an update.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Firmware {
    /// Its version.
    pub version: Label,
    /// The first bytes of its SHA-512: its name in the log.
    pub name: u32,
    /// Its counter.
    pub counter: u32,
    /// Number of the key it is signed with.
    pub key: KeyId,
}

impl From<&UpdateHead> for Firmware {
    fn from(head: &UpdateHead) -> Self {
        Self { version: head.version, name: head.name(), counter: head.counter, key: head.key }
    }
}

/// The program of a device, and where an update of it stands.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct UpdateStatus {
    /// Where it stands.
    pub stage: UpdateStage,
    /// Most bytes of a program.
    pub most: u32,
    /// The program that runs; nothing of one that came through the debug port.
    pub running: Option<Firmware>,
    /// Counter below which no update is taken.
    pub least: u32,
    /// Whose firmware is taken: of the keys, in the order of [`DeviceKeys`](super::DeviceKeys).
    pub signs: [bool; MOST_KEYS],
}
