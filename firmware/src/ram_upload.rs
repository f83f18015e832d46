//! Uploads to RAM: program, job and probe log, in lent memory, lost at a reset.

use truepath_core::image::crc32;
use truepath_core::link::{Denial, Item};

/// What the on-board correction reads.
pub struct RamUploads<'a> {
    /// The program.
    pub program: RamUpload<'a>,
    /// The job, in its compact form.
    pub job: RamUpload<'a>,
    /// The probe log.
    pub probe: RamUpload<'a>,
}

/// The upload of one item.
pub struct RamUpload<'a> {
    item: Item,
    buffer: &'a mut [u8],
    length: usize,
    crc: u32,
    written: usize,
    complete: bool,
}

impl<'a> RamUpload<'a> {
    /// Nothing uploaded yet.
    pub fn new(item: Item, buffer: &'a mut [u8]) -> Self {
        Self { item, buffer, length: 0, crc: 0, written: 0, complete: false }
    }
    /// Most bytes it takes.
    pub fn capacity(&self) -> u32 {
        self.buffer.len() as u32
    }
    /// The item, once it is complete and undamaged.
    pub fn content(&self) -> Option<&[u8]> {
        self.complete.then(|| self.buffer.get(..self.length)).flatten()
    }
    /// Where the next chunk goes.
    pub fn next(&self) -> u32 {
        self.written as u32
    }
    /// The buffer back.
    pub fn into_buffer(self) -> &'a mut [u8] {
        self.buffer
    }

    /// Begins an upload, or goes on with one of the same length and CRC-32; gives where the next chunk goes.
    ///
    /// # Errors
    /// [`Denial::TooLong`], also for no bytes.
    pub fn begin(&mut self, length: u32, crc: u32) -> Result<u32, Denial> {
        let most = self.capacity();
        if length == 0 || length > most {
            return Err(Denial::TooLong { item: self.item, length, most });
        }
        if (self.length, self.crc) != (length as usize, crc) {
            (self.length, self.crc, self.written, self.complete) = (length as usize, crc, 0, false);
        }
        Ok(self.written as u32)
    }

    /// Takes the next bytes; gives where the ones after them go.
    ///
    /// # Errors
    /// [`Denial::Offset`], with nothing changed.
    pub fn chunk(&mut self, offset: u32, bytes: &[u8]) -> Result<u32, Denial> {
        let expected = self.written as u32;
        let end = self.written + bytes.len();
        let fits = offset == expected && end <= self.length;
        let Some(place) = self.buffer.get_mut(self.written..end).filter(|_| fits) else {
            return Err(Denial::Offset { expected, found: offset, bytes: bytes.len() as u32 });
        };
        place.copy_from_slice(bytes);
        self.written = end;
        Ok(end as u32)
    }

    /// Checks the whole; gives its CRC-32.
    ///
    /// # Errors
    /// [`Denial::Incomplete`], with nothing changed; [`Denial::Checksum`], then it has to be sent anew.
    pub fn commit(&mut self) -> Result<u32, Denial> {
        if self.written < self.length {
            return Err(Denial::Incomplete { length: self.length as u32, written: self.written as u32 });
        }
        let found = crc32(self.buffer.get(..self.length).unwrap_or(&[]));
        if found != self.crc {
            self.written = 0;
            return Err(Denial::Checksum { expected: self.crc, found });
        }
        self.complete = true;
        Ok(found)
    }
}
