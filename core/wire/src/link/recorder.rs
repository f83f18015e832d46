//! The last raw setpoint frames, kept when a fault happens.

use crate::rewrite::Reason;

/// A ring of frames of one length in a lent buffer. After a fault it takes a stated number of frames more and then
/// stands, until it is released.
#[derive(Debug)]
pub struct Recorder<'a> {
    buffer: &'a mut [u8],
    frame_bytes: usize,
    /// Frames the buffer holds.
    capacity: usize,
    /// Frames in it.
    count: usize,
    /// Where the next one goes.
    next: usize,
    /// Frames still to be taken after a fault.
    after: usize,
    left: Option<usize>,
}

impl<'a> Recorder<'a> {
    /// For frames of `frame_bytes` ([`setpoint_bytes`](super::setpoint_bytes)), as many as the buffer holds; after a
    /// fault `after` more, at most as many as leave one from before the fault.
    pub fn new(buffer: &'a mut [u8], frame_bytes: usize, after: usize) -> Self {
        let capacity = buffer.len().checked_div(frame_bytes).unwrap_or(0);
        let after = after.min(capacity.saturating_sub(1));
        Self { buffer, frame_bytes, capacity, count: 0, next: 0, after, left: None }
    }

    /// Takes a frame as it arrived, good or damaged; one of another length has no place and is passed over.
    #[inline]
    pub fn record(&mut self, raw: &[u8]) {
        if raw.len() != self.frame_bytes || self.is_frozen() || self.capacity == 0 {
            return;
        }
        if let Some(left) = &mut self.left {
            *left = left.wrapping_sub(1);
        }
        let start = self.next.wrapping_mul(self.frame_bytes);
        if let Some(place) = self.buffer.get_mut(start..start.wrapping_add(raw.len())) {
            copy(raw, place);
        }
        self.next = self.next.wrapping_add(1);
        if self.next == self.capacity {
            self.next = 0;
        }
        self.count = self.count.wrapping_add(1).min(self.capacity);
    }

    /// A fault happened: a few more frames, then it stands. Further faults change nothing, but at a silence it stands
    /// at once: no frames follow.
    #[inline]
    pub fn fault(&mut self, reason: Reason) {
        if reason == Reason::Silence {
            self.left = Some(0);
        } else if self.left.is_none() {
            self.left = Some(self.after);
        }
    }

    /// Whether it stands and can be read.
    #[inline]
    pub const fn is_frozen(&self) -> bool {
        matches!(self.left, Some(0))
    }

    /// Empties it and lets it run again.
    pub fn release(&mut self) {
        self.left = None;
        self.count = 0;
        self.next = 0;
    }

    /// Empties it for frames of another length.
    pub fn restart(&mut self, frame_bytes: usize) {
        self.release();
        self.frame_bytes = frame_bytes;
        self.capacity = self.buffer.len().checked_div(frame_bytes).unwrap_or(0);
        self.after = self.after.min(self.capacity.saturating_sub(1));
    }

    /// Gives the buffer back.
    pub fn into_buffer(self) -> &'a mut [u8] {
        self.buffer
    }

    /// Frames in it.
    pub const fn total(&self) -> usize {
        self.count
    }

    /// Frames from number `from` on, 0 the oldest, in one piece: as many as lie together and fit into `most` bytes,
    /// at least one if there is one and it fits. Empty behind the last one and while it runs.
    pub fn frames(&self, from: usize, most: usize) -> &[u8] {
        if !self.is_frozen() || from >= self.count {
            return &[];
        }
        let oldest = if self.count < self.capacity { 0 } else { self.next };
        let first = oldest.saturating_add(from);
        let first = if first < self.capacity { first } else { first.saturating_sub(self.capacity) };
        let together = self.capacity.saturating_sub(first).min(self.count.saturating_sub(from));
        let count = together.min(most.checked_div(self.frame_bytes).unwrap_or(0));
        let start = first.saturating_mul(self.frame_bytes);
        self.buffer.get(start..start.saturating_add(count.saturating_mul(self.frame_bytes))).unwrap_or(&[])
    }
}

/// Copies a frame by its words, two at a time. As one slice, or in a loop of one word, it is left to the copying routine, which takes
/// six instructions a byte where either side does not begin at a word.
#[inline(never)]
fn copy(from: &[u8], to: &mut [u8]) {
    let (pairs, rest) = from.as_chunks::<8>();
    let (places, places_rest) = to.as_chunks_mut::<8>();
    for (place, &[a, b, c, d, e, f, g, h]) in places.iter_mut().zip(pairs) {
        let [first, second] = place.as_chunks_mut::<4>().0 else { continue };
        *first = [a, b, c, d];
        *second = [e, f, g, h];
    }
    for (place, byte) in places_rest.iter_mut().zip(rest) {
        *place = *byte;
    }
}

#[cfg(test)]
mod tests {
    use super::copy;

    #[test]
    fn every_byte_of_a_frame_of_any_length_is_copied_and_none_behind_it() {
        let from: [u8; 48] = core::array::from_fn(|i| i as u8 | 0x80);
        for length in 0..from.len() {
            let mut to = [0; 48];
            copy(from.split_at(length).0, to.split_at_mut(length).0);
            let (copied, behind) = to.split_at(length);
            assert!(from.starts_with(copied) && behind.iter().all(|&byte| byte == 0), "{length}: {to:?}");
        }
    }
}
