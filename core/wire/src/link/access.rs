//! The login that gives a role: what is signed, how long it lasts, why it is refused. The least role of each request is
//! [`Ask::least`](super::Ask::least).
//!
//! A client asks for a challenge and signs [`login_message`] with its Ed25519 key; the device gives a number to the session,
//! which from then on stands behind each request ([`encode_request`](super::encode_request)). A request without one has the
//! role [`Role::Read`]. A device without a key is open: every client has every role.

use core::fmt;

use serde::{Deserialize, Serialize};
use truepath_units::errors;

use crate::image::{KeyId, MOST_KEYS, Rights, Role};

/// Bytes of a challenge.
pub const NONCE_BYTES: usize = 32;
/// Bytes of the number of a device.
pub const DEVICE_ID_BYTES: usize = 12;
/// Wrong logins before none is tried any more, until [`TRY_WINDOW_US`] has passed since the first of them.
pub const MOST_TRIES: u8 = 5;
/// Time in which [`MOST_TRIES`] wrong logins are tried, µs.
pub const TRY_WINDOW_US: u64 = 60_000_000;
/// Time without a request after which a session ends, µs.
pub const SESSION_SILENCE_US: u64 = 600_000_000;

/// First bytes of what is signed to log in; no image begins so.
const LOGIN: [u8; 16] = *b"truepath login 1";

/// Bytes of what is signed to log in.
pub const LOGIN_BYTES: usize = LOGIN.len() + DEVICE_ID_BYTES + NONCE_BYTES + 9;

/// What is signed to log in: 16 bytes `truepath login 1`, number of the device, challenge, number of the key, number of the
/// role.
pub fn login_message(
    device: &[u8; DEVICE_ID_BYTES],
    nonce: &[u8; NONCE_BYTES],
    key: KeyId,
    role: Role,
) -> [u8; LOGIN_BYTES] {
    let mut message = [0; LOGIN_BYTES];
    let bytes = LOGIN.iter().chain(device).chain(nonce).chain(&key.0).copied().chain([role as u8]);
    for (place, byte) in message.iter_mut().zip(bytes) {
        *place = byte;
    }
    message
}

errors! {
    /// Why somebody may not ask what he asks, or is not let in. The sentence of each variant is the text shown.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
    pub enum AccessError {
        /// The request needs a role that whoever asks does not have.
        Role {
            /// The least that may ask it.
            needed: Role,
        } = "K110", "this needs the role {needed}, and whoever asks has not logged in with it"
            => "log in with a key of this device that has the role: --key FILE";
        /// The device does not trust the key.
        UnknownKey {
            /// Its number.
            key: KeyId,
        } = "K111", "nobody can log in with key {key}: it is not provisioned here, or was revoked"
            => "use a key that the device trusts (truepath device keys), or provision this one with the button of the board";
        /// The key is not good for the role.
        Beyond {
            /// Its number.
            key: KeyId,
            /// The highest role it has.
            most: Role,
        } = "K112", "key {key} has the role {most} at most"
            => "log in with a key that has the role, or provision one";
        /// There is no challenge that could be answered.
        NoChallenge = "K113", "no challenge is open: each is good for one try, and for the one who asked last"
            => "ask for another one and log in again";
        /// The signature is not one of this challenge, device and role by this key.
        Forged {
            /// Number of the key.
            key: KeyId,
        } = "K114", "the answer to the challenge is not signed by key {key} for this device and role"
            => "use the private key of a public one that is provisioned; if you did, somebody else spoke to the device meanwhile";
        /// Too many logins failed.
        TooManyTries {
            /// Seconds until one is tried again.
            wait_s: u32,
        } = "K115", "too many logins failed: none is tried for {wait_s} s"
            => "wait, and find out who tries";
        /// The session of this number is over.
        Ended {
            /// Why.
            why: SessionEnd,
        } = "K116", "the session has ended: {why}"
            => "log in again";
        /// A key cannot be provisioned a second time with other rights.
        OtherRights {
            /// Its number.
            key: KeyId,
        } = "K117", "key {key} is provisioned already, with other rights"
            => "revoke it and provision another key";
    }
}

impl core::error::Error for AccessError {}

/// Why a session ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum SessionEnd {
    /// A reset, or it never was, or it was not the last one.
    Unknown,
    /// Somebody else has logged in.
    NewLogin,
    /// Nothing was asked for [`SESSION_SILENCE_US`].
    Silence,
    /// `Logout`.
    Logout,
    /// Its key was revoked.
    Revoked,
}

impl SessionEnd {
    /// All of them, in the order of their numbers.
    pub const ALL: [Self; 5] = [Self::Unknown, Self::NewLogin, Self::Silence, Self::Logout, Self::Revoked];
}

impl fmt::Display for SessionEnd {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Unknown => "the device was reset, or does not know it",
            Self::NewLogin => "somebody else has logged in (truepath device log says who)",
            Self::Silence => "nothing was asked for ten minutes",
            Self::Logout => "it was logged out",
            Self::Revoked => "its key was revoked",
        })
    }
}

/// Who is logged in, and who could.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct DeviceSession {
    /// The device has no key: everybody has every role.
    pub open: bool,
    /// The role of whoever asks.
    pub role: Role,
    /// The key of the session there is, whoever asks.
    pub key: Option<KeyId>,
    /// Logins that failed since the last entry of the log.
    pub refused: u16,
    /// Rights of the keys, in the order of [`DeviceKeys`](super::DeviceKeys).
    pub rights: [Rights; MOST_KEYS],
}
