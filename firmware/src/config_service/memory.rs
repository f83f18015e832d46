//! What a board lends the device and tells it about itself.

use truepath_core::link::ResetCause;

use crate::slots::SLOT_IMAGE_BYTES;
use crate::work::Meter;

/// Bytes of the buffer for the active image, the largest one a slot holds.
pub const IMAGE_BYTES: usize = SLOT_IMAGE_BYTES;

/// Memory the device runs in; what it holds before does not matter.
pub struct Memory<'a> {
    /// For the active image: [`IMAGE_BYTES`]; with less, only smaller images can be taken.
    pub image: &'a mut [u8],
    /// For the recorder: 48 bytes a frame of three axes.
    pub recording: &'a mut [u8],
    /// For a program.
    pub program: &'a mut [u8],
    /// For a job in its compact form.
    pub job: &'a mut [u8],
    /// For a probe log.
    pub probe: &'a mut [u8],
    /// Progress of the on-board correction.
    pub meter: &'a Meter,
}

/// What a board says about itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Board {
    /// Its name.
    pub name: &'static str,
    /// Why the last reset happened.
    pub last_reset: ResetCause,
}
