//! How far the making of an image is.

use serde::{Deserialize, Serialize};

/// What is being done, in this order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub enum Stage {
    /// Job and program are read.
    Reading,
    /// The path is sampled.
    Sampling,
    /// The measurement is read and laid against the contour.
    Contacts,
    /// Machine and material are fitted to the contacts.
    Identification,
    /// The correction is refined on the predicted wall.
    Design,
    /// The image is written.
    Image,
}

/// Passes on what changes, so that a listener is called at most 1001 times a stage.
pub(super) struct Gauge<'a, P> {
    listener: &'a mut P,
    told: Option<(Stage, u16)>,
}

impl<'a, P: FnMut(Stage, u16)> Gauge<'a, P> {
    pub(super) const fn new(listener: &'a mut P) -> Self {
        Self { listener, told: None }
    }

    /// The share of a stage that is done, ‰. Never falls within a stage.
    pub(super) fn tell(&mut self, stage: Stage, permille: u16) {
        let now = Some((stage, permille.min(1000)));
        if now > self.told {
            self.told = now;
            (self.listener)(stage, permille.min(1000));
        }
    }
}
