//! Logging in to a device with keys, where it asks for it.

use std::fmt;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use truepath_core::image::{KeyId, PublicKey, Role};
use truepath_core::link::{Ask, login_message};

/// Signs a message with a private key.
type Sign = dyn Fn(&[u8]) -> [u8; 64] + Send + Sync;

/// A key to log in with, and the session that it has. Its copies share the session.
///
/// A client that has one logs in when a request is denied for want of a role, with the role that it wants and no higher one.
#[derive(Clone)]
pub struct Access {
    key: KeyId,
    sign: Arc<Sign>,
    session: Arc<Mutex<Option<u64>>>,
}

impl Access {
    /// Access with a key, by what signs with it.
    pub fn new(key: &PublicKey, sign: impl Fn(&[u8]) -> [u8; 64] + Send + Sync + 'static) -> Self {
        Self { key: key.id(), sign: Arc::new(sign), session: Arc::default() }
    }
    /// Number of the session.
    pub fn session(&self) -> Option<u64> {
        *self.lock()
    }
    /// Has another session, or none.
    pub fn set_session(&self, session: Option<u64>) {
        *self.lock() = session;
    }
    fn lock(&self) -> MutexGuard<'_, Option<u64>> {
        self.session.lock().unwrap_or_else(PoisonError::into_inner)
    }
    /// The answer to a challenge.
    pub fn login(&self, role: Role, device: &[u8; 12], nonce: &[u8; 32]) -> Ask<'static> {
        let key = self.key;
        let signature = (self.sign)(&login_message(device, nonce, key, role));
        let mut halves = [[0; 32]; 2];
        halves.as_flattened_mut().copy_from_slice(&signature);
        Ask::Login { key, role, signature: halves }
    }
}

impl fmt::Debug for Access {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Access").field("key", &self.key).finish_non_exhaustive()
    }
}
