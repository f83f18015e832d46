//! What the device tells about itself: identity, status, image slots, the progress of an on-board correction.

use serde::{Deserialize, Serialize};

use super::counters::Counters;
use crate::image::{Binding, DeviceClass, KeyRing};
use crate::rewrite::{Mode, Reason};

/// Identity of the device.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Hello<'a> {
    /// Version of the links, [`LINK_VERSION`](super::LINK_VERSION).
    pub link_version: u8,
    /// Meaning of the numbers, [`SEMANTICS`](crate::image::SEMANTICS).
    pub semantics: u32,
    /// Layout of images, [`FORMAT`](crate::image::FORMAT).
    pub image_format: u16,
    /// Name of the board.
    pub board: &'a str,
    /// Version of the firmware.
    pub firmware: &'a str,
    /// Axes of a setpoint.
    pub axes: u8,
    /// Most nodes of an image.
    pub most_nodes: u32,
    /// Bytes an image slot holds.
    pub slot_bytes: u32,
    /// Bytes of the buffer for a program.
    pub program_bytes: u32,
    /// Bytes of the buffer for a job.
    pub job_bytes: u32,
    /// Bytes of the buffer for a probe log.
    pub probe_bytes: u32,
    /// Resets so far, this one included.
    pub boots: u32,
    /// Why the last reset happened.
    pub last_reset: ResetCause,
}

/// Why a reset happened.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum ResetCause {
    /// The board does not say.
    #[default]
    Unknown,
    /// Power was switched on.
    PowerOn,
    /// The supply was too low.
    BrownOut,
    /// The reset pin.
    Pin,
    /// `Restart`.
    Software,
    /// The watchdog ran out.
    Watchdog,
}

/// Mode, reason, counters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct DeviceStatus {
    /// State of the rewriter.
    pub mode: Mode,
    /// Why the last correction ended or failed.
    pub reason: Reason,
    /// Whether the drive enable is passed on.
    pub drive_enable: bool,
    /// The image in use.
    pub active: Option<ActiveImage>,
    /// Whether the recorder stands, because of a fault.
    pub recording_frozen: bool,
    /// Counters since the reset or `ClearCounters`.
    pub counters: Counters,
    /// Microseconds since the reset.
    pub uptime_us: u64,
}

/// Whose images the device takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct DeviceKeys {
    /// What kind of device it is.
    pub class: DeviceClass,
    /// Whether its button was held at the last reset: keys can be provisioned until the next one.
    pub present: bool,
    /// The keys it trusts and those that were revoked; neither while it is open.
    pub keys: KeyRing,
}

/// Which image is in use.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ActiveImage {
    /// 0 or 1.
    pub slot: u8,
    /// Its checksum.
    pub crc: u32,
}

/// What is uploaded.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Item {
    /// A correction image, to the idle slot.
    Image,
    /// A program, to RAM.
    Program,
    /// A job in its compact form, to RAM.
    Job,
    /// A probe log, to RAM.
    Probe,
    /// A firmware update, over both image slots.
    Firmware,
}

/// What an image slot holds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Slot {
    /// Erased.
    #[default]
    Empty,
    /// An upload was begun and not committed.
    Partial {
        /// Bytes it is to have.
        length: u32,
        /// CRC-32 it is to have.
        crc: u32,
        /// Bytes that are there.
        written: u32,
    },
    /// Neither erased nor an image; an upload erases it.
    Damaged,
    /// A committed image.
    Image {
        /// Bytes.
        length: u32,
        /// Its checksum.
        crc: u32,
        /// Number of its upload, rising; the newer image has the greater one.
        generation: u32,
        /// Whether it is in use.
        active: bool,
        /// What it belongs to.
        binding: Binding,
    },
}

/// How far an on-board correction is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Progress {
    /// What is being done.
    pub stage: Stage,
    /// How much of the stage is done, 0 … 1000.
    pub permille: u16,
    /// How it ended, once it has.
    pub result: Option<Result<Computed, ComputeFailure>>,
}

/// The steps of an on-board correction, in their order.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Stage {
    /// Nothing was asked for since the reset.
    #[default]
    Idle,
    /// Reading the job.
    Job,
    /// Reading the program.
    Program,
    /// Reading the probe log.
    Probe,
    /// Computing engagement and forces.
    Cut,
    /// Fitting the parameters.
    Identify,
    /// Computing the correction.
    Correct,
    /// Making the image and writing it to the idle slot.
    Write,
    /// It has ended; see the result.
    Ended,
}

/// The image made on the device.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Computed {
    /// Slot it was written to.
    pub slot: u8,
    /// Its checksum.
    pub crc: u32,
    /// Its bytes.
    pub length: u32,
}

/// Why an on-board correction failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ComputeFailure {
    /// In which step.
    pub stage: Stage,
    /// Number of the error within the step, as in the messages of the host.
    pub code: u16,
    /// Line of the program or probe log, number of the node, or 0.
    pub line: u32,
    /// Column, or 0.
    pub column: u32,
}
