//! Who asks: challenge, login, session.
//!
//! There is one session at a time; its number stands behind the requests of whoever has it. A challenge is good for one try.
//! It is the hash of the number of boots, of a count and of the time, so it never comes twice as long as the ledger counts its
//! boots; and of a secret that the board draws at its start, if it has a random number generator. Without one a challenge,
//! and the number of a session, can be computed before by who knows the device.

use embedded_storage::nor_flash::NorFlash;
use sha2::{Digest, Sha512};
use truepath_core::image::{KeyId, Role};
use truepath_core::link::{
    AccessError, Ask, Change, Denial, DeviceSession, LogEntry, MOST_TRIES, NONCE_BYTES, Reply, SESSION_SILENCE_US,
    SessionEnd, TRY_WINDOW_US, login_message,
};

use super::handler::Handler;
use super::session::Session;

impl<'a, F: NorFlash> Handler<'a, F> {
    /// Refused unless whoever asks has the role for it. Every request comes through here first.
    pub fn permit(&mut self, ask: &Ask<'_>, session: Option<u64>) -> Result<(), Denial> {
        let (now_us, open) = (self.now_us, self.ledger.keys().is_open());
        let access = &mut self.access;
        if access.session.is_some_and(|session| now_us.saturating_sub(session.at_us) > SESSION_SILENCE_US) {
            access.end(SessionEnd::Silence);
        }
        (access.by, access.role) = (None, if open { Role::Engineer } else { Role::Read });
        if let Some(number) = session {
            let Some(session) = access.session.as_mut().filter(|session| session.number == number) else {
                let of_number = access.ended.filter(|(ended, _)| *ended == number);
                let why = of_number.map_or(SessionEnd::Unknown, |(_, why)| why);
                return Err(Denial::Access(AccessError::Ended { why }));
            };
            session.at_us = now_us;
            (access.by, access.role) = (Some(session.key), session.role);
        }
        let needed = ask.least();
        if access.role < needed { Err(Denial::Access(AccessError::Role { needed })) } else { Ok(()) }
    }

    /// 64 bytes that are others for each challenge and purpose.
    fn unique(&self, purpose: &[u8]) -> [u8; 64] {
        let mut hash = Sha512::new();
        hash.update(purpose);
        hash.update(self.board.secret.unwrap_or_default());
        hash.update(self.ledger.now().boots.to_le_bytes());
        hash.update(self.access.challenges.to_le_bytes());
        hash.update(self.now_us.to_le_bytes());
        hash.finalize().into()
    }

    #[inline(never)]
    pub fn challenge<'s>(&mut self) -> Reply<'s> {
        self.access.challenges = self.access.challenges.wrapping_add(1);
        let nonce = self.unique(b"challenge").first_chunk().copied().unwrap_or_default();
        self.access.challenge = Some(nonce);
        Reply::Challenge { device: self.board.id, nonce, random: self.board.secret.is_some() }
    }

    #[inline(never)]
    pub fn login<'s>(&mut self, key: KeyId, role: Role, signature: &[[u8; 32]; 2]) -> Result<Reply<'s>, Denial> {
        let (now_us, access) = (self.now_us, &mut self.access);
        let passed_us = now_us.saturating_sub(access.first_failed_us);
        if passed_us >= TRY_WINDOW_US {
            access.failed = 0;
        }
        if access.failed >= MOST_TRIES {
            let wait_s = TRY_WINDOW_US.saturating_sub(passed_us).div_ceil(1_000_000) as u32;
            return Err(Denial::Access(AccessError::TooManyTries { wait_s }));
        }
        let nonce = access.challenge.take().ok_or(Denial::Access(AccessError::NoChallenge))?;
        if let Err(error) = self.verify_login(&nonce, key, role, signature) {
            self.login_failed(key);
            return Err(Denial::Access(error));
        }
        let number = self.unique(b"session").first_chunk().map_or(0, |bytes| u64::from_le_bytes(*bytes));
        let before = self.access.end(SessionEnd::NewLogin).map(|session| session.key);
        self.access.session = Some(Session { number, key, role, at_us: now_us });
        self.access.by = Some(key);
        self.keep(LogEntry { key: before, value: role as u32, ..self.entry(Change::LoggedIn) });
        Ok(Reply::LoggedIn { session: number })
    }

    fn verify_login(
        &self,
        nonce: &[u8; NONCE_BYTES],
        key: KeyId,
        role: Role,
        signature: &[[u8; 32]; 2],
    ) -> Result<(), AccessError> {
        let (public, rights) = self.ledger.keys().find(key).ok_or(AccessError::UnknownKey { key })?;
        let message = login_message(&self.board.id, nonce, key, role);
        let signature = signature.as_flattened().first_chunk();
        if !signature.is_some_and(|signature| public.signed(&message, signature)) {
            return Err(AccessError::Forged { key });
        }
        if role > rights.role { Err(AccessError::Beyond { key, most: rights.role }) } else { Ok(()) }
    }

    /// Counts it, and logs the first since the last entry: who tries again and again cannot fill the log with that.
    fn login_failed(&mut self, key: KeyId) {
        let now_us = self.now_us;
        let access = &mut self.access;
        if access.failed == 0 {
            access.first_failed_us = now_us;
        }
        access.failed = access.failed.saturating_add(1);
        access.refused = access.refused.saturating_add(1);
        if !access.refusal_is_logged {
            self.keep(LogEntry { key: Some(key), ..self.entry(Change::LoginRefused) });
            self.access.refusal_is_logged = true;
        }
    }

    pub fn logout<'s>(&mut self) -> Reply<'s> {
        // Whoever has no session has nothing to end, least of all somebody else's.
        if self.access.by.is_some() {
            self.keep(self.entry(Change::LoggedOut));
            self.access.end(SessionEnd::Logout);
        }
        Reply::Done
    }

    pub fn session(&self) -> DeviceSession {
        let (keys, access) = (self.ledger.keys(), &self.access);
        DeviceSession {
            open: keys.is_open(),
            role: access.role,
            key: access.session.map(|session| session.key),
            refused: access.refused,
            rights: keys.rights(),
        }
    }
    /// Whether what a login was answered is still so.
    pub fn is_logged_in(&self) -> bool {
        self.access.session.is_some()
    }
}
