//! What the servo side and the desk side hand to each other.

use truepath_core::rewrite::{Rewriter, Spent};

use super::mailbox::{Mailbox, Receiver, Sender};

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
    /// An image to be used from now on, or none any more. Desk to servo, taken in `Off` and `Bypass` only.
    offer: Mailbox<Option<Loaded>>,
    /// An image that is used no more. Servo to desk.
    returned: Mailbox<&'static [u8]>,
    /// A part that is about to be armed. Servo to desk.
    spending: Mailbox<Spent>,
    /// Whether the ledger remembers it, on the disk. Desk to servo.
    written: Mailbox<bool>,
}

/// The servo's ends.
pub(super) struct ServoEnds {
    pub offer: Receiver<Option<Loaded>>,
    pub returned: Sender<&'static [u8]>,
    pub spending: Sender<Spent>,
    pub written: Receiver<bool>,
}

/// The desk's ends.
pub(super) struct DeskEnds {
    pub offer: Sender<Option<Loaded>>,
    pub returned: Receiver<&'static [u8]>,
    pub spending: Receiver<Spent>,
    pub written: Sender<bool>,
}

impl Mailboxes {
    pub(super) fn split(&'static mut self) -> (ServoEnds, DeskEnds) {
        let (desk_offer, offer) = self.offer.split();
        let (returned, desk_returned) = self.returned.split();
        let (spending, desk_spending) = self.spending.split();
        let (desk_written, written) = self.written.split();
        (
            ServoEnds { offer, returned, spending, written },
            DeskEnds { offer: desk_offer, returned: desk_returned, spending: desk_spending, written: desk_written },
        )
    }
}
