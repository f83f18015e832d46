//! Mailboxes, each with room for one item, between two threads: one puts, the other takes, neither waits; and what the
//! servo side and the configuration side hand to each other.
//!
//! Why not `heapless::spsc`: its two ends forget the length of the queue, so each access divides by a number that only
//! the running program knows, and the division by zero, which never happens, is a panic that the proof finds.

use core::cell::UnsafeCell;
use core::mem::MaybeUninit;
use core::sync::atomic::{AtomicBool, Ordering};

use truepath_core::rewrite::{Rewriter, Spent};

/// A mailbox. What is in it when it is given up is forgotten.
pub struct Mailbox<T> {
    full: AtomicBool,
    item: UnsafeCell<MaybeUninit<T>>,
}

// SAFETY: an item goes from the thread of the sender to that of the receiver, and the flag orders their accesses: see there.
unsafe impl<T: Send> Sync for Mailbox<T> {}

/// Its only sender.
pub struct Sender<T: 'static>(&'static Mailbox<T>);

/// Its only receiver.
pub struct Receiver<T: 'static>(&'static Mailbox<T>);

impl<T: Send + 'static> Mailbox<T> {
    /// An empty one.
    pub const fn new() -> Self {
        Self { full: AtomicBool::new(false), item: UnsafeCell::new(MaybeUninit::uninit()) }
    }

    /// Its ends; there is no second pair, because it is borrowed for good.
    pub fn split(&'static mut self) -> (Sender<T>, Receiver<T>) {
        (Sender(self), Receiver(self))
    }
}

impl<T: Send + 'static> Default for Mailbox<T> {
    fn default() -> Self {
        Self::new()
    }
}

impl<T> Sender<T> {
    /// Whether the last item was taken.
    pub fn is_free(&self) -> bool {
        !self.0.full.load(Ordering::Acquire)
    }

    /// Puts an item into the free place.
    ///
    /// # Errors
    /// The item back: the last one was not yet taken.
    pub fn send(&mut self, item: T) -> Result<(), T> {
        if !self.is_free() {
            return Err(item);
        }
        // SAFETY: while it is not full only the one sender touches the item, and this is it, borrowed exclusively. What the
        // receiver did to it happened before, by its release.
        unsafe { (*self.0.item.get()).write(item) };
        self.0.full.store(true, Ordering::Release);
        Ok(())
    }
}

impl<T> Receiver<T> {
    /// Takes the item, if there is one.
    pub fn take(&mut self) -> Option<T> {
        if !self.0.full.load(Ordering::Acquire) {
            return None;
        }
        // SAFETY: while it is full only the one receiver touches the item, and this is it, borrowed exclusively. It was
        // written before, by the sender's release, and is read once: after this the place is free.
        let item = unsafe { (*self.0.item.get()).assume_init_read() };
        self.0.full.store(false, Ordering::Release);
        Some(item)
    }
}

/// An image with the rewriter made from it.
#[derive(Clone, Debug)]
pub(super) struct Loaded {
    pub rewriter: Rewriter<'static>,
    /// What the image lies in, to be given back.
    pub bytes: &'static [u8],
}

/// The places between the two sides.
#[derive(Default)]
pub struct Mailboxes {
    /// An image to be used from now on, or none any more. Configuration to servo, taken in `Off` and `Bypass` only.
    offer: Mailbox<Option<Loaded>>,
    /// An image that is used no more. Servo to configuration.
    returned: Mailbox<&'static [u8]>,
    /// A part that is about to be armed. Servo to configuration.
    spending: Mailbox<Spent>,
    /// Whether the ledger remembers it, on the disk. Configuration to servo.
    written: Mailbox<bool>,
}

/// The servo's ends.
pub(super) struct ServoEnds {
    pub offer: Receiver<Option<Loaded>>,
    pub returned: Sender<&'static [u8]>,
    pub spending: Sender<Spent>,
    pub written: Receiver<bool>,
}

/// The ends of the configuration side.
pub(super) struct ConfigEnds {
    pub offer: Sender<Option<Loaded>>,
    pub returned: Receiver<&'static [u8]>,
    pub spending: Receiver<Spent>,
    pub written: Sender<bool>,
}

impl Mailboxes {
    pub(super) fn split(&'static mut self) -> (ServoEnds, ConfigEnds) {
        let (config_offer, offer) = self.offer.split();
        let (returned, config_returned) = self.returned.split();
        let (spending, config_spending) = self.spending.split();
        let (config_written, written) = self.written.split();
        (
            ServoEnds { offer, returned, spending, written },
            ConfigEnds {
                offer: config_offer,
                returned: config_returned,
                spending: config_spending,
                written: config_written,
            },
        )
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    extern crate std;
    use super::*;
    use std::boxed::Box;

    #[test]
    fn an_item_is_taken_once_and_a_full_place_gives_the_next_one_back() {
        let (mut sender, mut receiver) = Box::leak(Box::new(Mailbox::new())).split();
        assert_eq!(receiver.take(), None);
        assert_eq!(sender.send(1), Ok(()));
        assert_eq!((sender.is_free(), sender.send(2)), (false, Err(2)));
        assert_eq!((receiver.take(), receiver.take()), (Some(1), None));
        assert_eq!((sender.is_free(), sender.send(3)), (true, Ok(())));
        assert_eq!(receiver.take(), Some(3));
    }

    #[test]
    fn items_of_several_words_arrive_whole_and_in_order_from_another_thread() {
        let (mut sender, mut receiver) = Box::leak(Box::new(Mailbox::new())).split();
        let count = 20_000u64;
        let thread = std::thread::spawn(move || {
            for number in 0..count {
                while sender.send([number; 9]).is_err() {
                    std::thread::yield_now();
                }
            }
        });
        for number in 0..count {
            let item = loop {
                match receiver.take() {
                    Some(item) => break item,
                    None => std::thread::yield_now(),
                }
            };
            assert_eq!(item, [number; 9]);
        }
        thread.join().unwrap();
    }
}
