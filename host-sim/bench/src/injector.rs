//! The faulty cable between controller and coprocessor: loses, damages, delays, repeats and pauses frames, seeded.
//!
//! It works on encoded frames, delimiter included, so it also makes what a frame layer never sees by itself: frames
//! that grow together because the delimiter is lost, and frames split in two by a zero inside.
//!
//! After smoltcp's `FaultInjector`: product code, usable from the command line.

use super::chance::{Chance, Probability};

/// What goes wrong on the cable.
///
/// A frame is damaged in bits, bytes, a burst, its end or its delimiter.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::Args)]
#[command(next_help_heading = "Faults of the cable, as probabilities 0 to 1 per frame")]
pub struct Faults {
    /// Lost.
    #[arg(long, value_name = "P", default_value = "0")]
    pub drop: Probability,
    /// Damaged.
    #[arg(long, value_name = "P", default_value = "0")]
    pub corrupt: Probability,
    /// Overtaken by one to four others.
    #[arg(long, value_name = "P", default_value = "0")]
    pub reorder: Probability,
    /// Sent twice.
    #[arg(long, value_name = "P", default_value = "0")]
    pub repeat: Probability,
    /// A pause before it.
    #[arg(long, value_name = "P", default_value = "0")]
    pub pause: Probability,
    /// Length of a pause, microseconds.
    #[arg(long, value_name = "US", default_value_t = 25_000)]
    pub pause_us: u32,
    /// Every frame is late by up to so many microseconds.
    #[arg(long = "jitter", value_name = "US", default_value_t = 0)]
    pub jitter_us: u32,
}

/// How often each fault was injected.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
pub struct Injected {
    /// Frames given to the cable.
    pub frames: u64,
    /// Lost.
    pub dropped: u64,
    /// Damaged.
    pub corrupted: u64,
    /// Overtaken by others.
    pub reordered: u64,
    /// Sent twice.
    pub repeated: u64,
    /// Pauses.
    pub pauses: u64,
}

/// What comes out of the cable.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Delivery<T> {
    /// Time since the frame before, beyond the tick, µs.
    pub delay_us: u32,
    /// The bytes.
    pub bytes: Vec<u8>,
    /// What the frame was said to hold.
    pub content: T,
    /// Whether the frame is whole in them. A frame that only lost its delimiter is: whether it arrives depends on what
    /// follows.
    pub whole: bool,
}

/// A cable with faults.
#[derive(Clone, Debug)]
pub struct FaultInjector<T> {
    faults: Faults,
    chance: Chance,
    injected: Injected,
    /// A delayed frame, and how many others go before it.
    held: Option<(Delivery<T>, u64)>,
}

impl<T: Clone> FaultInjector<T> {
    /// A cable; the same seed gives the same faults.
    pub fn new(faults: Faults, seed: u64) -> Self {
        Self { faults, chance: Chance::new(seed, 1), injected: Injected::default(), held: None }
    }
    /// What was injected so far.
    pub const fn injected(&self) -> &Injected {
        &self.injected
    }

    /// One frame into the cable; `out` gets what comes out at the other end, with the content it was said to have.
    pub fn pass(&mut self, frame: &[u8], content: T, mut out: impl FnMut(Delivery<T>)) {
        self.injected.frames += 1;
        let mut delay_us = self.chance.below(u64::from(self.faults.jitter_us) + 1) as u32;
        if self.chance.happens(self.faults.pause) {
            self.injected.pauses += 1;
            delay_us = delay_us.saturating_add(self.faults.pause_us);
        }
        let mut delivery = Delivery { delay_us, bytes: frame.to_vec(), content, whole: true };
        if self.chance.happens(self.faults.drop) {
            self.injected.dropped += 1;
            // Time passes all the same.
            delivery.bytes.clear();
            delivery.whole = false;
        } else if self.chance.happens(self.faults.corrupt) {
            self.injected.corrupted += 1;
            damage(&mut self.chance, &mut delivery.bytes);
            delivery.whole = contains(&delivery.bytes, frame);
        }
        if self.held.is_none() && self.chance.happens(self.faults.reorder) {
            self.injected.reordered += 1;
            let before = 1 + self.chance.below(4);
            self.held = Some((delivery, before));
            return;
        }
        let again = self.chance.happens(self.faults.repeat).then(|| delivery.clone());
        out(delivery);
        if let Some(mut again) = again {
            self.injected.repeated += 1;
            again.delay_us = 0;
            out(again);
        }
        match self.held.take() {
            Some((late, 1)) => out(late),
            Some((late, more)) => self.held = Some((late, more - 1)),
            None => {}
        }
    }
}

impl<T> FaultInjector<T> {
    /// The end of the stream: a frame that is still held back comes out.
    pub fn finish(&mut self, out: impl FnMut(Delivery<T>)) {
        self.held.take().map(|(late, _)| late).into_iter().for_each(out);
    }
}

/// Whether a frame is one of the pieces between zeros.
fn contains(bytes: &[u8], frame: &[u8]) -> bool {
    let content = frame.strip_suffix(&[0]).unwrap_or(frame);
    bytes.split(|&b| b == 0).any(|piece| piece == content)
}

/// Changes a frame so that it is no longer what it was.
fn damage(chance: &mut Chance, bytes: &mut Vec<u8>) {
    let before = bytes.clone();
    let place = |chance: &mut Chance, len: usize| chance.below(len as u64) as usize;
    while *bytes == before {
        match chance.below(7) {
            // One bit; on the delimiter it makes two frames one.
            0 | 1 => {
                let at = place(chance, bytes.len());
                bytes[at] ^= 1 << chance.below(8);
            }
            2 => {
                let at = place(chance, bytes.len());
                bytes[at] = chance.bits() as u8;
            }
            // A zero inside: one frame becomes two pieces.
            3 => {
                let at = place(chance, bytes.len());
                bytes[at] = 0;
            }
            // A burst of up to 32 bits.
            4 => {
                let at = place(chance, bytes.len());
                for byte in bytes.iter_mut().skip(at).take(4) {
                    *byte ^= chance.bits() as u8;
                }
            }
            5 => {
                let at = place(chance, bytes.len());
                bytes.insert(at, chance.bits() as u8);
            }
            // Cut off.
            _ => {
                let at = place(chance, bytes.len());
                bytes.truncate(at);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn probability(share: f64) -> Probability {
        Probability::new(share).expect("a probability")
    }

    fn through(faults: Faults, frames: u64) -> (Vec<Delivery<u64>>, Injected) {
        let mut cable = FaultInjector::new(faults, 11);
        let mut out = Vec::new();
        for k in 0..frames {
            let [a, b] = (k as u16 % 255 + 1).to_le_bytes();
            cable.pass(&[1, a, b | 1, 0x55, 0xaa, 0], k, |d| out.push(d));
        }
        cable.finish(|d| out.push(d));
        (out, *cable.injected())
    }

    #[test]
    fn a_good_cable_changes_nothing() {
        let (out, injected) = through(Faults::default(), 1000);
        assert!(out.iter().enumerate().all(|(k, d)| d.whole && d.content == k as u64 && d.delay_us == 0));
        assert_eq!(injected, Injected { frames: 1000, ..Injected::default() });
    }

    #[test]
    fn a_damaged_frame_is_never_the_same_bytes() {
        let faults = Faults { corrupt: probability(0.5), ..Faults::default() };
        let (out, injected) = through(faults, 20_000);
        let sent = |delivery: &Delivery<u64>| {
            let [a, b] = (delivery.content as u16 % 255 + 1).to_le_bytes();
            vec![1, a, b | 1, 0x55, 0xaa, 0]
        };
        let changed = out.iter().filter(|d| d.bytes != sent(d)).count() as u64;
        assert_eq!(changed, injected.corrupted);
        assert!((9_000..11_000).contains(&injected.corrupted));
        // Whole are those that only lost or gained a delimiter.
        let split = |d: &Delivery<u64>| d.bytes.split(|&b| b == 0).any(|piece| piece == &sent(d)[..5]);
        assert!(out.iter().all(|d| d.whole == split(d)));
        let only_delimiter = out.iter().filter(|d| d.whole && d.bytes != sent(d)).count();
        assert!((1..2_000).contains(&only_delimiter), "{only_delimiter}");
    }

    #[test]
    fn frames_come_later_or_twice_but_are_not_lost_by_it() {
        let faults = Faults { reorder: probability(0.2), repeat: probability(0.1), ..Faults::default() };
        let (out, injected) = through(faults, 10_000);
        assert_eq!(out.len() as u64, injected.frames + injected.repeated);
        let late = out.windows(2).filter(|pair| pair[1].content < pair[0].content).count() as u64;
        // The last one may have had nothing to overtake it.
        assert!(late == injected.reordered || late + 1 == injected.reordered);
        assert!(injected.reordered > 500 && injected.repeated > 500);
    }

    #[test]
    fn a_lost_frame_still_takes_its_time() {
        let faults =
            Faults { drop: probability(0.3), pause: probability(0.1), pause_us: 9, jitter_us: 5, ..Faults::default() };
        let (out, injected) = through(faults, 10_000);
        assert_eq!(out.len(), 10_000);
        assert_eq!(out.iter().filter(|d| d.bytes.is_empty()).count() as u64, injected.dropped);
        assert_eq!(out.iter().filter(|d| d.delay_us >= 9).count() as u64, injected.pauses);
        assert!(out.iter().all(|d| d.delay_us <= 14));
    }
}
