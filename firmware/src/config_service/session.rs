//! Who is logged in, and what was tried.

use truepath_core::image::{KeyId, Role};
use truepath_core::link::{LogEntry, NONCE_BYTES, SessionEnd};

/// Somebody who is logged in.
#[derive(Clone, Copy)]
pub struct Session {
    pub number: u64,
    pub key: KeyId,
    pub role: Role,
    /// Of its last request.
    pub at_us: u64,
}

/// Sessions and logins since the reset.
#[derive(Default)]
pub struct Access {
    pub session: Option<Session>,
    /// The last one that ended, and why: whoever had it is told.
    pub ended: Option<(u64, SessionEnd)>,
    pub challenge: Option<[u8; NONCE_BYTES]>,
    /// Challenges so far.
    pub challenges: u32,
    /// Failed logins in the present window, and its start.
    pub failed: u8,
    pub first_failed_us: u64,
    /// Who asks the present request, if he is logged in.
    pub by: Option<KeyId>,
    pub role: Role,
    /// Logins that failed since the last entry of the log, and whether one of them has an entry.
    pub refused: u16,
    pub refusal_is_logged: bool,
}

impl Access {
    pub fn end(&mut self, why: SessionEnd) -> Option<Session> {
        let session = self.session.take()?;
        self.ended = Some((session.number, why));
        Some(session)
    }
    /// Ends the session of a key.
    pub fn revoke(&mut self, key: KeyId) {
        if self.session.is_some_and(|session| session.key == key) {
            self.end(SessionEnd::Revoked);
        }
    }
    /// Puts into an entry who asks and how many logins failed before it.
    pub fn sign(&mut self, entry: LogEntry) -> LogEntry {
        let refused = core::mem::take(&mut self.refused);
        self.refusal_is_logged = false;
        LogEntry { by: self.by, refused, ..entry }
    }
}
