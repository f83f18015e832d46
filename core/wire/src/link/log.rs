//! The log of changes: who changed what on the device, and when.

use core::fmt;

use serde::{Deserialize, Serialize};

use crate::image::{KeyId, Role};

/// Most entries in one [`Reply::Log`](super::Reply::Log).
pub const LOG_ENTRIES: usize = 8;

/// A change that was asked for over the configuration link.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct LogEntry {
    /// Number of the entry, one more each time. One that is missing between two others was not kept.
    pub sequence: u32,
    /// Resets of the device up to then, as in `Hello`.
    pub boots: u32,
    /// Microseconds since that reset.
    pub uptime_us: u64,
    /// Seconds since 1970 by the clock that a host told ([`Ask::Time`](super::Ask::Time)) since that reset; nobody checks it.
    pub host_s: Option<u32>,
    /// Number of the key of who asked; nobody is known on an open device.
    pub by: Option<KeyId>,
    /// What was done.
    pub change: Change,
    /// Number of the key it is about: of the signer of an image, the one that was provisioned or revoked, the one whose session a
    /// login has ended, the one that a failed login named.
    pub key: Option<KeyId>,
    /// What [`Change`] says of it, or 0.
    pub value: u32,
    /// Logins that failed since the entry before; 65,535 and above: 65,535.
    pub refused: u16,
    /// Counter of a signed image or of firmware, below which none of its pass, or of firmware, is taken any more; else 0.
    pub counter: u32,
}

/// What was done. The order of the variants is the number on the wire and in the flash.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Change {
    /// An image was made the active one; the value is its checksum.
    Activated,
    /// The active image was taken out of use; the value is its checksum.
    Deactivated,
    /// Other settings; the value is the CRC-32 of their postcard encoding.
    Configured,
    /// A key was provisioned.
    Provisioned,
    /// A key was revoked.
    Revoked,
    /// A pass of a part was armed; the value is the part's serial.
    Armed,
    /// An arming was ended.
    Disarmed,
    /// The drives were acknowledged as disabled.
    Acknowledged,
    /// The counters were set to zero.
    CountersCleared,
    /// The recorder was let run again.
    RecordingReleased,
    /// A reset was asked for; the value is 1 if by the watchdog.
    Restarted,
    /// Somebody logged in; the value is the number of the role.
    LoggedIn,
    /// Somebody logged out.
    LoggedOut,
    /// A login failed: the first one since the entry before. Those behind it are counted in `refused` of the next entry.
    LoginRefused,
    /// A firmware update was handed to the loader; the value is its name, the key that of its signer.
    Installed,
    /// The firmware on trial was kept; the value is its name, the key that of its signer.
    Confirmed,
}

impl Change {
    /// All of them, in the order of their numbers.
    pub const ALL: [Self; 16] = [
        Self::Activated,
        Self::Deactivated,
        Self::Configured,
        Self::Provisioned,
        Self::Revoked,
        Self::Armed,
        Self::Disarmed,
        Self::Acknowledged,
        Self::CountersCleared,
        Self::RecordingReleased,
        Self::Restarted,
        Self::LoggedIn,
        Self::LoggedOut,
        Self::LoginRefused,
        Self::Installed,
        Self::Confirmed,
    ];
    /// Its number.
    pub const fn number(self) -> u8 {
        self as u8
    }
    /// That of a number; none of a number that a later version may have written.
    pub fn of(number: u8) -> Option<Self> {
        Self::ALL.get(usize::from(number)).copied()
    }
}

impl fmt::Display for LogEntry {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let value = self.value;
        match self.change {
            Change::Activated => write!(f, "image {value:08x} activated")?,
            Change::Deactivated => write!(f, "image {value:08x} taken out of use")?,
            Change::Configured => write!(f, "settings {value:08x}")?,
            Change::Provisioned => f.write_str("key provisioned")?,
            Change::Revoked => f.write_str("key revoked")?,
            Change::Armed => write!(f, "part {value} armed")?,
            Change::Disarmed => f.write_str("disarmed")?,
            Change::Acknowledged => f.write_str("drives acknowledged as disabled")?,
            Change::CountersCleared => f.write_str("counters set to zero")?,
            Change::RecordingReleased => f.write_str("recorder released")?,
            Change::Restarted => f.write_str(if value == 0 { "restarted" } else { "restarted by the watchdog" })?,
            Change::LoggedIn => {
                let role = Role::ALL.get(value as usize).copied().unwrap_or_default();
                write!(f, "logged in to {role}")?;
            }
            Change::LoggedOut => f.write_str("logged out")?,
            Change::LoginRefused => f.write_str("login refused, key")?,
            Change::Installed => write!(f, "firmware {value:08x} handed to the loader")?,
            Change::Confirmed => write!(f, "firmware {value:08x} confirmed")?,
        }
        match (self.change, self.key) {
            (Change::Activated | Change::Installed | Change::Confirmed, Some(key)) => {
                write!(f, ", signed by {key}, counter {}", self.counter)
            }
            (Change::LoggedIn, Some(key)) => write!(f, ", which ended the session of {key}"),
            (_, Some(key)) => write!(f, " {key}"),
            (_, None) => Ok(()),
        }
    }
}
