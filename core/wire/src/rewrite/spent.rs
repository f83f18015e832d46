//! Which passes of parts have been armed: one part, one arming, for a series of any length.
//!
//! Serial numbers of parts are to count up. The [`SPENT_CAPACITY`] newest armings are known exactly, so among these
//! parts may be machined in any order. When an older one leaves that list, its serial number stays as a floor of its
//! program, feature and pass: from then on this serial and all below it count as armed. There are [`SPENT_FLOORS`]
//! floors, each for another pass of a program, the one longest untouched gives way.
//!
//! Limits: up to [`SPENT_FLOORS`] different passes in use in turn are remembered for ever. With more of them, a pass is
//! forgotten when after its last arming 16 others were armed and then 24 other passes have got or raised their floor.
//! A serial number typed far too high locks its pass for all below it once it has become a floor.

use serde::{Deserialize, Serialize};

/// Armings that are known exactly; the oldest becomes a floor first.
pub const SPENT_CAPACITY: usize = 16;
/// Passes of programs of which a floor is known.
pub const SPENT_FLOORS: usize = 24;

/// A pass of a part that has been armed. Numbers are stored with their full length, so that a list always has the
/// room it needs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct Spent {
    /// Serial number of the part.
    #[serde(with = "postcard::fixint::le")]
    pub part_serial: u32,
    /// CRC-32 of the program.
    #[serde(with = "postcard::fixint::le")]
    pub program_crc: u32,
    /// Feature.
    #[serde(with = "postcard::fixint::le")]
    pub feature: u32,
    /// Pass.
    #[serde(with = "postcard::fixint::le")]
    pub pass: u32,
}

impl Spent {
    /// Whether it is the same pass of the same program, of whatever part.
    const fn is_same_pass(&self, other: &Self) -> bool {
        self.program_crc == other.program_crc && self.feature == other.feature && self.pass == other.pass
    }
}

/// The armed passes of parts, newest first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct SpentList {
    newest: [Option<Spent>; SPENT_CAPACITY],
    floors: [Option<Spent>; SPENT_FLOORS],
}

impl SpentList {
    /// Nothing was armed yet.
    pub const EMPTY: Self = Self { newest: [None; SPENT_CAPACITY], floors: [None; SPENT_FLOORS] };

    /// The newest arming.
    pub fn last(&self) -> Option<Spent> {
        self.newest.first().copied().flatten()
    }

    /// Whether a pass of a part was armed, or counts as armed because a later part was, long ago.
    pub fn contains(&self, pass: &Spent) -> bool {
        self.newest.iter().flatten().any(|armed| armed == pass)
            || self.floors.iter().flatten().any(|f| f.is_same_pass(pass) && pass.part_serial <= f.part_serial)
    }

    /// A pass of a part is armed.
    pub fn spend(&mut self, pass: Spent) {
        self.newest.rotate_right(1);
        if let Some(newest) = self.newest.first_mut()
            && let Some(forgotten) = newest.replace(pass)
        {
            self.raise(forgotten);
        }
    }

    /// The floor of a pass of a program becomes the newest, and at least as high as this part.
    fn raise(&mut self, mut to: Spent) {
        let held = self.floors.iter().position(|floor| floor.is_some_and(|floor| floor.is_same_pass(&to)));
        // Without one, the oldest gives way.
        let place = held.unwrap_or(SPENT_FLOORS.saturating_sub(1));
        if let Some(Some(before)) = held.and_then(|held| self.floors.get(held)) {
            to.part_serial = to.part_serial.max(before.part_serial);
        }
        if let Some(moved) = self.floors.get_mut(..=place) {
            moved.rotate_right(1);
        }
        if let Some(newest) = self.floors.first_mut() {
            *newest = Some(to);
        }
    }
}

impl Default for SpentList {
    fn default() -> Self {
        Self::EMPTY
    }
}
