//! Two pieces of work at the same time, one of them on a thread of its own.
//!
//! The core is single-threaded; what it computes several times over, independently, a PC need not compute one after the
//! other. Results are the same to the last bit. Where no thread can be had, the one follows the other.

use std::sync::Mutex;
use std::thread::{Builder, scope};

/// Does `other` with what it needs on another thread while this one does `own`; returns both results.
pub fn both<L: Send, A: Send, B>(lent: L, other: impl Fn(L) -> A + Sync, own: impl FnOnce() -> B) -> (A, B) {
    // A thread that cannot be had leaves here what was lent to it.
    let lent = Mutex::new(Some(lent));
    let take = || lent.lock().ok().and_then(|mut lent| lent.take()).map(&other);
    scope(|threads| {
        let thread = Builder::new().spawn_scoped(threads, take);
        let own = own();
        let other = match thread {
            Ok(thread) => thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)),
            Err(_) => take(),
        };
        (other.unwrap_or_else(|| unreachable!("it is taken once")), own)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_pieces_of_work_are_done_and_what_was_lent_is_changed() {
        let (mut lent, mut own) = (vec![1, 2], 0);
        let done = both(
            &mut lent,
            |lent| {
                lent.push(3);
                lent.len()
            },
            || {
                own = 5;
                "own"
            },
        );
        assert_eq!((done, lent, own), ((3, "own"), vec![1, 2, 3], 5));
    }
}
