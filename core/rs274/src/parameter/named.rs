//! Named parameters: `#<name>` belongs to a call, `#<_name>` to the whole program.
//!
//! Names stand in one run of bytes, in the order of the slots, lower case and without blanks. When a call ends, its names
//! are taken out and the rest moves up.

use super::super::ParameterError;

/// A named parameter: where its name stands, to which call it belongs, its value.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct NamedSlot {
    value: f64,
    start: u16,
    len: u8,
    level: u8,
}

impl NamedSlot {
    /// No parameter.
    pub const FREE: Self = Self { value: 0.0, start: 0, len: 0, level: 0 };
}

/// The named parameters.
#[derive(Debug)]
pub(in super::super) struct Names<'a> {
    slots: &'a mut [NamedSlot],
    bytes: &'a mut [u8],
    used: usize,
    used_bytes: usize,
}

impl<'a> Names<'a> {
    pub(super) const fn new(slots: &'a mut [NamedSlot], bytes: &'a mut [u8]) -> Self {
        Self { slots, bytes, used: 0, used_bytes: 0 }
    }

    pub(super) fn clear(&mut self) {
        self.used = 0;
        self.used_bytes = 0;
    }

    fn find(&self, name: &[u8], level: u8) -> Option<usize> {
        let level = level_of(name, level);
        let slots = self.slots.get(..self.used)?;
        slots.iter().position(|slot| slot.level == level && self.name(slot) == name)
    }

    fn name(&self, slot: &NamedSlot) -> &[u8] {
        let start = usize::from(slot.start);
        self.bytes.get(start..start.saturating_add(usize::from(slot.len))).unwrap_or(&[])
    }

    pub(super) fn get(&self, name: &[u8], level: u8) -> Option<f64> {
        self.slots.get(self.find(name, level)?).map(|slot| slot.value)
    }

    pub(super) fn set(&mut self, name: &[u8], level: u8, value: f64) -> Result<(), ParameterError> {
        let count = |n: usize| u16::try_from(n).unwrap_or(u16::MAX);
        let full = ParameterError::TooManyNames { limit: count(self.slots.len()), bytes: count(self.bytes.len()) };
        let (place, start) = match self.find(name, level) {
            Some(place) => (place, None),
            None => (self.used, Some(self.used_bytes)),
        };
        let Some(start) = start else {
            return self.slots.get_mut(place).map(|slot| slot.value = value).ok_or(full);
        };
        let end = start.saturating_add(name.len());
        let (Some(bytes), Some(slot)) = (self.bytes.get_mut(start..end), self.slots.get_mut(place)) else {
            return Err(full);
        };
        let (Ok(start), Ok(len)) = (u16::try_from(start), u8::try_from(name.len())) else {
            return Err(full);
        };
        bytes.copy_from_slice(name);
        *slot = NamedSlot { value, start, len, level: level_of(name, level) };
        self.used = self.used.saturating_add(1);
        self.used_bytes = end;
        Ok(())
    }

    /// Forgets the names of calls deeper than `level`.
    pub(in super::super) fn leave(&mut self, level: u8) {
        let (mut kept, mut kept_bytes) = (0usize, 0usize);
        for index in 0..self.used {
            let Some(mut slot) = self.slots.get(index).copied().filter(|s| s.level <= level || s.level == GLOBAL)
            else {
                continue;
            };
            let from = usize::from(slot.start);
            let to = from.saturating_add(usize::from(slot.len));
            if kept_bytes < from && to <= self.bytes.len() {
                // Never longer than the bytes already left behind, so this cannot fail.
                self.bytes.copy_within(from..to, kept_bytes);
                slot.start = u16::try_from(kept_bytes).unwrap_or(u16::MAX);
            }
            if let Some(place) = self.slots.get_mut(kept) {
                *place = slot;
            }
            kept = kept.saturating_add(1);
            kept_bytes = kept_bytes.saturating_add(usize::from(slot.len));
        }
        self.used = kept;
        self.used_bytes = kept_bytes;
    }
}

/// The level of names of the whole program.
const GLOBAL: u8 = u8::MAX;

fn level_of(name: &[u8], level: u8) -> u8 {
    if name.first() == Some(&b'_') { GLOBAL } else { level }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn names_of_a_call_end_with_it_and_those_of_the_program_stay() {
        let (mut slots, mut bytes) = ([NamedSlot::FREE; 4], [0; 16]);
        let mut names = Names::new(&mut slots, &mut bytes);
        names.set(b"a", 0, 1.0).unwrap();
        names.set(b"depth", 1, 2.0).unwrap();
        names.set(b"a", 1, 3.0).unwrap();
        names.set(b"_all", 1, 4.0).unwrap();
        assert_eq!((names.get(b"a", 1), names.get(b"a", 0), names.get(b"_all", 0)), (Some(3.0), Some(1.0), Some(4.0)));
        names.leave(0);
        assert_eq!((names.get(b"a", 1), names.get(b"depth", 1), names.get(b"_all", 2)), (None, None, Some(4.0)));
        assert_eq!((names.get(b"a", 0), names.used, names.used_bytes), (Some(1.0), 2, 5));
    }
}
