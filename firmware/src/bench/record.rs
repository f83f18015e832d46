//! A record of the bench link: channel (u8), 0 (u8), length (u16), that many bytes, padding to four bytes.

/// Bytes before those of a record.
pub const HEAD_BYTES: usize = 4;
/// Most bytes of a record.
pub const MOST_BYTES: usize = u16::MAX as usize;

/// What a record is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Channel {
    /// Bytes of the setpoint link, either way.
    Setpoint = 0,
    /// Bytes of the configuration link, either way.
    Config = 1,
    /// To the device: microseconds (u32) by which the time advances.
    Time = 2,
}

/// A record.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Record<'a> {
    /// What it is for.
    pub channel: Channel,
    /// Its bytes, without padding.
    pub bytes: &'a [u8],
}

/// Reads records one after the other; ends at the end of the bytes or where there is no record.
#[derive(Clone, Debug)]
pub struct Records<'a> {
    rest: &'a [u8],
    all: usize,
    malformed: bool,
}

impl<'a> Records<'a> {
    /// Over the bytes of a batch.
    pub const fn new(bytes: &'a [u8]) -> Self {
        Self { rest: bytes, all: bytes.len(), malformed: false }
    }
    /// Bytes read so far.
    pub const fn consumed(&self) -> usize {
        self.all - self.rest.len()
    }
    /// Whether it ended before the end.
    pub const fn is_malformed(&self) -> bool {
        self.malformed
    }

    fn record(&self) -> Option<(Record<'a>, &'a [u8])> {
        let (&[channel, reserved, low, high], rest) = self.rest.split_first_chunk::<HEAD_BYTES>()?;
        let channel = match channel {
            0 => Channel::Setpoint,
            1 => Channel::Config,
            2 => Channel::Time,
            _ => return None,
        };
        let length = usize::from(u16::from_le_bytes([low, high]));
        let bytes = rest.get(..length)?;
        let rest = rest.get(length.next_multiple_of(4)..)?;
        (reserved == 0).then_some((Record { channel, bytes }, rest))
    }
}

impl<'a> Iterator for Records<'a> {
    type Item = Record<'a>;

    fn next(&mut self) -> Option<Record<'a>> {
        let found = self.record();
        self.malformed = found.is_none() && !self.rest.is_empty();
        let (record, rest) = found?;
        self.rest = rest;
        Some(record)
    }
}

/// Writes records one after the other.
#[derive(Debug)]
pub struct Writer<'a> {
    bytes: &'a mut [u8],
    used: usize,
    overflow: bool,
}

impl<'a> Writer<'a> {
    /// Into a buffer.
    pub const fn new(bytes: &'a mut [u8]) -> Self {
        Self { bytes, used: 0, overflow: false }
    }
    /// Adds a record of at most [`MOST_BYTES`]. What does not fit, and everything after it, is left out and reported
    /// by [`Writer::finish`].
    pub fn put(&mut self, channel: Channel, content: &[u8]) {
        let end = self.used + HEAD_BYTES + content.len().next_multiple_of(4);
        let fits = !self.overflow && content.len() <= MOST_BYTES;
        let Some(place) = self.bytes.get_mut(self.used..end).filter(|_| fits) else {
            self.overflow = true;
            return;
        };
        let (head, body) = place.split_at_mut(HEAD_BYTES);
        let [low, high] = (content.len() as u16).to_le_bytes();
        head.copy_from_slice(&[channel as u8, 0, low, high]);
        let (data, padding) = body.split_at_mut(content.len());
        data.copy_from_slice(content);
        padding.fill(0);
        self.used = end;
    }
    /// Bytes used, and whether something did not fit.
    pub fn finish(self) -> (usize, bool) {
        (self.used, self.overflow)
    }
}
