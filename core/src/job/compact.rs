//! The compact form of a job: postcard (<https://postcard.jamesmunns.com/wire-format>) of its fields in their order.

use super::{Job, JobError};

/// Most bytes of a job in its compact form.
pub const COMPACT_BYTES: usize = 256;

impl Job {
    /// Writes the compact form into a buffer and gives the bytes in use.
    ///
    /// # Errors
    /// [`JobError::Compact`] when the buffer is too short; [`COMPACT_BYTES`] are always enough.
    pub fn to_compact<'b>(&self, buffer: &'b mut [u8]) -> Result<&'b [u8], JobError> {
        postcard::to_slice(self, buffer).map(|used| &*used).map_err(|_| JobError::Compact)
    }

    /// Reads the compact form and checks every range.
    ///
    /// # Errors
    /// [`JobError::Compact`] when the bytes are not exactly one job, [`JobError::Range`] when it is out of range.
    pub fn from_compact(bytes: &[u8]) -> Result<Self, JobError> {
        match postcard::take_from_bytes::<Self>(bytes) {
            Ok((job, [])) => job.check().map(|()| job),
            _ => Err(JobError::Compact),
        }
    }
}
