//! What the requests work on: the flash, the ledger, the slots, the buffers; and whether they may.

use embedded_storage::nor_flash::NorFlash;
use truepath_core::image::DeviceClass;
use truepath_core::link::{
    ActiveImage, DEVICE_ID_BYTES, Denial, DeviceSettings, Item, Progress, ResetCause, Slot, TimingMeter, UpdateStage,
};
use truepath_core::rewrite::Mode;

use super::session::Access;
use crate::computation::{Computation, ProgressMeter};
use crate::ledger::Ledger;
use crate::program::ProgramUpload;
use crate::ram_upload::RamUploads;
use crate::servo::ServoAccess;
use crate::slots::{SLOT_IMAGE_BYTES, Upload};

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
    pub meter: &'a ProgressMeter,
}

/// What a board says about itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Board {
    /// Its name.
    pub name: &'static str,
    /// Why the last reset happened.
    pub last_reset: ResetCause,
    /// What kind of device it is: an image can be signed for some kinds only.
    pub class: DeviceClass,
    /// Whether its button was held at the reset: somebody is there who may provision and revoke keys.
    pub present: bool,
    /// Its number, unlike that of every other board; zeros if it has none.
    pub id: [u8; DEVICE_ID_BYTES],
    /// Drawn by its random number generator at the start, if it has one: nobody else knows it.
    pub secret: Option<[u8; 32]>,
    /// Counts per second of [`Clock::count`](crate::clock::Clock::count).
    pub counter_hz: u32,
}

/// The device is to be reset, after what has been answered is sent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Restart {
    /// By letting the watchdog run out.
    pub watchdog: bool,
}

/// Everything the service keeps, apart from how requests come.
pub(super) struct Handler<'a, F> {
    pub flash: F,
    pub ledger: Ledger,
    pub board: Board,
    pub started_us: u64,
    /// Of the request that is carried out.
    pub now_us: u64,
    /// The time that a host told, seconds since 1970, and when it did.
    pub told_time: Option<(u32, u64)>,
    pub access: Access,
    /// The flash did not take an entry of the log.
    pub log_fails: bool,
    /// What the slots hold, without who is active.
    pub slots: [Slot; 2],
    /// The image in the servo.
    pub active: Option<ActiveImage>,
    /// The image buffer, while the servo does not have it.
    pub image: Option<&'a mut [u8]>,
    /// The uploads to RAM, unless a computation has them.
    pub ram_uploads: Option<RamUploads<'a>>,
    /// Most bytes of a program, a job, a probe log.
    pub capacities: [u32; 3],
    /// What is being uploaded.
    pub current: Option<Item>,
    pub image_upload: Option<Upload>,
    pub program_upload: Option<ProgramUpload>,
    /// Where an update of the program stands.
    pub stage: UpdateStage,
    /// A computation that nobody has fetched yet.
    pub computation: Option<Computation<'a>>,
    /// Whether a computation is under way, fetched or not.
    pub computing: bool,
    pub progress: Progress,
    pub timing: TimingMeter,
    pub meter: &'a ProgressMeter,
}

impl<'a, F: NorFlash> Handler<'a, F> {
    /// The settings in force.
    pub fn settings(&self) -> DeviceSettings {
        self.ledger.now().settings_in_use()
    }
    /// Refused while a computation has the buffers.
    pub fn not_computing(&self) -> Result<(), Denial> {
        if self.computing { Err(Denial::Busy) } else { Ok(()) }
    }
}

/// Refused unless in `Off` or `Bypass`.
pub(super) fn idle<'a>(servo: &mut impl ServoAccess<'a>) -> Result<(), Denial> {
    match servo.with(|servo| servo.mode()) {
        Mode::Off | Mode::Bypass => Ok(()),
        mode => Err(Denial::Mode(mode)),
    }
}
