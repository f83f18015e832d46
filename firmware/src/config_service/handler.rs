//! Behind the desk: what a request does, apart from how it came.

use embedded_storage::nor_flash::NorFlash;
use truepath_core::link::{ActiveImage, Ask, CHUNK_BYTES, Denial, DeviceSettings, Item, Progress, Reply, Slot};
use truepath_core::rewrite::{Mode, Rewriter};

use super::{Board, Desk, Memory};
use crate::ledger::Ledger;
use crate::servo::{Alone, Servo, ServoAccess};
use crate::shelf::Shelf;
use crate::slots::{self, Upload};
use crate::work::{Meter, Shelves, Work};

/// Everything the desk keeps.
pub(super) struct Office<'a, F> {
    pub flash: F,
    pub ledger: Ledger,
    pub board: Board,
    pub started_us: u64,
    /// What the slots hold, without who is active.
    pub slots: [Slot; 2],
    /// The image in the servo.
    pub active: Option<ActiveImage>,
    /// The image buffer, while the servo does not have it.
    pub image: Option<&'a mut [u8]>,
    /// The uploads to RAM, unless a computation has them.
    pub shelves: Option<Shelves<'a>>,
    /// Most bytes of a program, a job, a probe log.
    pub capacities: [u32; 3],
    /// What is being uploaded.
    pub current: Option<Item>,
    pub upload: Option<Upload>,
    /// A computation that nobody has fetched yet.
    pub work: Option<Work<'a>>,
    /// Whether a computation is under way, fetched or not.
    pub computing: bool,
    pub progress: Progress,
    pub meter: &'a Meter,
}

impl<'a, F: NorFlash> Desk<'a, F> {
    /// Reads ledger and slots after a reset and makes the servo, in `Off`, with the image that was active if it can
    /// still be used, and the settings and armed passes of parts that were in force.
    pub fn start(mut flash: F, memory: Memory<'a>, board: Board, now_us: u64) -> (Self, Servo<'a>) {
        let mut ledger = Ledger::open(&mut flash);
        // A lost count of boots does no harm: what cannot be written here fails again, and loudly, at the next change.
        let _ = ledger.change(&mut flash, |now| now.boots = now.boots.saturating_add(1));
        let Memory { image, recording, program, job, probe, meter } = memory;
        let slots = [0, 1].map(|slot| slots::survey(&mut flash, slot, image));
        let settings = ledger.now().settings_in_use();
        let bare = Rewriter::new(settings.rewriter, None).expect("the ledger has checked the settings");
        let servo = Servo::new(settings, bare, ledger.now().spent, recording);
        let shelves = Shelves {
            program: Shelf::new(Item::Program, program),
            job: Shelf::new(Item::Job, job),
            probe: Shelf::new(Item::Probe, probe),
        };
        let mut office = Office {
            flash,
            ledger,
            board,
            started_us: now_us,
            slots,
            active: None,
            image: Some(image),
            capacities: [&shelves.program, &shelves.job, &shelves.probe].map(Shelf::capacity),
            shelves: Some(shelves),
            current: None,
            upload: None,
            work: None,
            computing: false,
            progress: Progress::default(),
            meter,
        };
        let servo = Alone::new(servo);
        if let Some(active) = office.ledger.now().active {
            // An image that cannot be used any more leaves the device without one; `Status` and `List` say so.
            let _ = office.load(active, &settings.rewriter, &servo);
        }
        (Desk::new(office), servo.into_servo())
    }
}

impl<'a, F: NorFlash> Office<'a, F> {
    /// Does what a request asks.
    pub fn carry_out<'s>(
        &mut self,
        ask: &Ask<'_>,
        now_us: u64,
        servo: &impl ServoAccess<'a>,
        scratch: &'s mut [u8; CHUNK_BYTES],
    ) -> Result<Reply<'s>, Denial> {
        match *ask {
            Ask::Hello => Ok(Reply::Hello(self.hello())),
            Ask::Status => Ok(Reply::Status(self.status(now_us, servo))),
            Ask::AcknowledgeDrivesDisabled => self.acknowledge(now_us, servo),
            Ask::Check(request) => self.check(&request, servo),
            Ask::Arm(request) => self.arm(&request, servo),
            Ask::Disarm => self.disarm(servo),
            Ask::Begin { item, length, crc } => self.begin(item, length, crc, servo),
            Ask::Chunk { offset, bytes } => self.chunk(offset, bytes, servo),
            Ask::Commit => self.commit(servo),
            Ask::List => Ok(Reply::Slots(self.list())),
            Ask::Activate { slot, crc } => self.activate(ActiveImage { slot, crc }, servo),
            Ask::Deactivate => self.deactivate(servo),
            Ask::Settings => Ok(Reply::Settings(self.settings())),
            Ask::Configure(settings) => self.configure(settings, servo),
            Ask::ClearCounters => {
                idle(servo)?;
                servo.with(|servo| servo.clear_counters());
                Ok(Reply::Done)
            }
            Ask::Trace => {
                let (dropped, samples) = servo.with(|servo| servo.drain_trace());
                Ok(Reply::Trace { dropped, samples })
            }
            Ask::Recording { from } => self.recording(from, servo, scratch),
            Ask::ReleaseRecording => {
                servo.with(|servo| servo.release_recording());
                Ok(Reply::Done)
            }
            Ask::Compute => self.compute(servo),
            Ask::Progress => Ok(Reply::Progress(self.progress())),
            Ask::Restart { .. } => Ok(Reply::Done),
        }
    }

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
pub(super) fn idle<'a>(servo: &impl ServoAccess<'a>) -> Result<(), Denial> {
    match servo.with(|servo| servo.mode()) {
        Mode::Off | Mode::Bypass => Ok(()),
        mode => Err(Denial::Mode(mode)),
    }
}
