//! Bytes that are taken from the front; zeros behind their end.

use serde::Serialize;
use serde::ser::SerializeTuple;

/// What is left of an input.
pub(super) struct Tape<'a>(pub &'a [u8]);

impl<'a> Tape<'a> {
    pub fn take(&mut self, count: usize) -> &'a [u8] {
        let (taken, rest) = self.0.split_at(count.min(self.0.len()));
        self.0 = rest;
        taken
    }
    pub fn byte(&mut self) -> u8 {
        self.take(1).first().copied().unwrap_or_default()
    }
    pub fn word(&mut self) -> u16 {
        u16::from_le_bytes([self.byte(), self.byte()])
    }
    /// A signed word.
    pub fn around(&mut self) -> i64 {
        i64::from(self.word() as i16)
    }
    pub fn is_over(&self) -> bool {
        self.0.is_empty()
    }
}

/// Bytes that are framed as they are.
pub(super) struct Raw<'a>(pub &'a [u8]);

impl Serialize for Raw<'_> {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut all = serializer.serialize_tuple(self.0.len())?;
        for byte in self.0 {
            all.serialize_element(byte)?;
        }
        all.end()
    }
}
