//! The configuration service: requests of the configuration link in, responses out.
//!
//! Who calls it: the task of the configuration link, below the setpoint path. A request may take long (an erase of the
//! flash takes seconds on a real part); the setpoint path goes on meanwhile, because the service reaches it only through
//! the short closures of [`ServoAccess`].
//!
//! A request that changed something is answered again, not carried out again, when it comes once more with the same
//! `id` and the same content, as long as what it changed is still so: once an arming has ended or the drives were
//! dropped, the request is carried out again, which for the arming of a part means that it is refused. Requests that
//! only read, and those that were denied, are simply carried out again. A reset forgets this: what was on the way then
//! has to be asked for (`Status`, `List`, `Check`).

mod access;
mod activate;
mod compute;
mod handler;
mod keys;
mod log;
mod operate;
mod report;
mod session;
mod update;
mod upload;

use embedded_storage::nor_flash::NorFlash;
use heapless::Vec;
use truepath_core::image::Rights;
use truepath_core::link::{
    ActiveImage, Ask, CHUNK_BYTES, Change, Deframer, Denial, Framed, Item, LinkError, LogEntry, PACKET_BYTES, Progress,
    Reply, Request, Response, TimingMeter, decode_request, encode,
};
use truepath_core::rewrite::{Mode, Rewriter};

use crate::computation::Computation;
use crate::ledger::Ledger;
use crate::ram_upload::{RamUpload, RamUploads};
use crate::servo::{Servo, ServoAccess};
use crate::slots;
pub use handler::{Board, IMAGE_BYTES, Memory, Restart};
use handler::{Handler, idle};

/// The service.
pub struct ConfigService<'a, F: NorFlash> {
    handler: Handler<'a, F>,
    deframer: Deframer<{ PACKET_BYTES - 1 }>,
    answer: [u8; PACKET_BYTES],
    /// Bytes of `answer`, while it may have to be sent again.
    answered: Option<usize>,
    /// The packet it answers.
    asked: Vec<u8, PACKET_BYTES>,
}

impl<'a, F: NorFlash> ConfigService<'a, F> {
    /// Reads ledger and slots after a reset and makes the servo, in `Off`, with the image that was active if it can
    /// still be used, and the settings and armed passes of parts that were in force.
    pub fn start(mut flash: F, memory: Memory<'a>, board: Board, now_us: u64) -> (Self, Servo<'a>) {
        let mut ledger = Ledger::open(&mut flash);
        // A lost count of boots does no harm: what cannot be written here fails again, and loudly, at the next change.
        let _ = ledger.change(&mut flash, |now| now.boots = now.boots.saturating_add(1));
        let stage = update::stage(&mut flash);
        update::count(&mut flash, &mut ledger, stage);
        let Memory { image, recording, program, job, probe, meter } = memory;
        let slots = [0, 1].map(|slot| slots::survey(&mut flash, slot, image));
        let settings = ledger.now().settings_in_use();
        let bare = Rewriter::new(settings.rewriter, None).expect("the ledger has checked the settings");
        let mut servo = Servo::new(settings, bare, ledger.now().spent, recording);
        let ram_uploads = RamUploads {
            program: RamUpload::new(Item::Program, program),
            job: RamUpload::new(Item::Job, job),
            probe: RamUpload::new(Item::Probe, probe),
        };
        let mut handler = Handler {
            flash,
            ledger,
            board,
            started_us: now_us,
            now_us,
            told_time: None,
            access: session::Access::default(),
            log_fails: false,
            slots,
            active: None,
            image: Some(image),
            capacities: [&ram_uploads.program, &ram_uploads.job, &ram_uploads.probe].map(RamUpload::capacity),
            ram_uploads: Some(ram_uploads),
            current: None,
            image_upload: None,
            program_upload: None,
            stage,
            computation: None,
            computing: false,
            progress: Progress::default(),
            timing: TimingMeter::new(&settings, board.counter_hz),
            meter,
        };
        // An image that cannot be used any more leaves the device without one; `Status` and `List` say so.
        handler.back_to(handler.ledger.now().active, &mut servo);
        let service =
            Self { handler, deframer: Deframer::new(), answer: [0; PACKET_BYTES], answered: None, asked: Vec::new() };
        (service, servo)
    }

    /// The flash.
    pub fn flash(&mut self) -> &mut F {
        &mut self.handler.flash
    }
    /// Everything that was lent, at a reset; what the servo has of it is handed in. A computation that is under way
    /// elsewhere has its part of the memory and must be given back by [`ConfigService::finish`] before.
    pub fn into_parts(self, image: Option<&'a mut [u8]>, recording: &'a mut [u8]) -> (F, Memory<'a>, Board) {
        let Handler { flash, board, ram_uploads, image: at_service, computation, meter, .. } = self.handler;
        let (ram_uploads, at_service) = match computation {
            Some(computation) => (Some(computation.uploads), Some(computation.image)),
            None => (ram_uploads, at_service),
        };
        let image = image.or(at_service).unwrap_or_default();
        let [program, job, probe] = ram_uploads.map_or_else(Default::default, |RamUploads { program, job, probe }| {
            [program, job, probe].map(RamUpload::into_buffer)
        });
        (flash, Memory { image, recording, program, job, probe, meter }, board)
    }

    /// A computation that was asked for: to be run at the lowest priority and given to [`ConfigService::finish`].
    pub fn take_computation(&mut self) -> Option<Computation<'a>> {
        self.handler.computation.take()
    }
    /// Writes the image that was computed to the idle slot, and lets requests use the buffers again. Takes as long as
    /// an upload does.
    pub fn finish(&mut self, computation: Computation<'a>, servo: &mut impl ServoAccess<'a>) {
        self.handler.finish(computation, servo);
    }

    /// Called while nothing is asked, as from the timer of a millisecond: counts the stamps of the frames since the last time,
    /// and writes what the log has in RAM, if the flash may be written.
    pub fn rest(&mut self, servo: &mut impl ServoAccess<'a>) {
        self.count_stamps(servo);
        self.handler.rest(servo);
    }
    /// Counts the stamps of the frames since the last time.
    pub fn count_stamps(&mut self, servo: &mut impl ServoAccess<'a>) {
        self.handler.count_stamps(servo);
    }

    /// Called as [`ConfigService::rest`]: the restart that ends the trial of a program that nobody has confirmed.
    pub fn trial_is_over(&self, now_us: u64, servo: &mut impl ServoAccess<'a>) -> Option<Restart> {
        self.handler.trial_is_over(now_us, servo)
    }

    /// Bytes of the stream; `send` gets the answer to each undamaged request. After a request to restart the rest of
    /// the bytes is left.
    pub fn receive(
        &mut self,
        mut bytes: &[u8],
        now_us: u64,
        servo: &mut impl ServoAccess<'a>,
        send: &mut impl FnMut(&[u8]),
    ) -> Option<Restart> {
        let Self { handler, deframer, answer, answered, asked } = self;
        while let Some(framed) = deframer.feed(&mut bytes) {
            let Framed::Packet(packet) = framed else {
                servo.with(|servo| servo.count_message(true));
                continue;
            };
            let again = asked.as_slice() == &*packet;
            let mut copy: Vec<u8, PACKET_BYTES> = Vec::new();
            // It has room: the deframer takes no longer packet.
            let _ = copy.extend_from_slice(packet);
            let request = decode_request(packet);
            let damaged = !matches!(request, Ok(_) | Err(LinkError::Content { .. }));
            servo.with(|servo| servo.count_message(damaged));
            if damaged {
                continue;
            }
            let mut still_so = |ask: &Ask<'_>| holds(ask, servo.with(|servo| servo.mode()), handler.is_logged_in());
            let remembered = answered.filter(|_| again && request.as_ref().is_ok_and(|(r, _)| still_so(&r.ask)));
            if let Some(bytes) = remembered {
                send(answer.get(..bytes).unwrap_or(&[]));
                continue;
            }
            *asked = copy;
            handler.now_us = now_us;
            let mut scratch = [0; CHUNK_BYTES];
            let (response, keep, restart) = match request {
                Ok((Request { id, ask }, session)) => {
                    let answer = match handler.permit(&ask, session) {
                        Ok(()) => handler.carry_out(&ask, now_us, servo, &mut scratch),
                        Err(denial) => Err(denial),
                    };
                    let restart = match (&ask, &answer) {
                        (Ask::Restart { watchdog }, Ok(_)) => Some(Restart { watchdog: *watchdog }),
                        _ => None,
                    };
                    let keep = changes(&ask) && answer.is_ok();
                    (Response { id, answer }, keep, restart)
                }
                Err(LinkError::Content { id }) => (Response { id, answer: Err(Denial::Unknown) }, false, None),
                Err(_) => continue,
            };
            let used = encode(&response, answer).unwrap_or(0);
            *answered = keep.then_some(used);
            send(answer.get(..used).unwrap_or(&[]));
            if restart.is_some() {
                return restart;
            }
        }
        None
    }
}

impl<'a, F: NorFlash> Handler<'a, F> {
    /// Does what a request asks.
    fn carry_out<'s>(
        &mut self,
        ask: &Ask<'_>,
        now_us: u64,
        servo: &mut impl ServoAccess<'a>,
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
                self.restart_timing(servo);
                self.keep(self.entry(Change::CountersCleared));
                Ok(Reply::Done)
            }
            Ask::Trace => {
                let (dropped, samples) = servo.with(|servo| servo.drain_trace());
                Ok(Reply::Trace { dropped, samples })
            }
            Ask::Recording { from } => self.recording(from, servo, scratch),
            Ask::ReleaseRecording => {
                servo.with(|servo| servo.release_recording());
                self.keep(self.entry(Change::RecordingReleased));
                Ok(Reply::Done)
            }
            Ask::Compute => self.compute(servo),
            Ask::Progress => Ok(Reply::Progress(self.progress())),
            Ask::Restart { watchdog } => {
                self.keep(LogEntry { value: watchdog.into(), ..self.entry(Change::Restarted) });
                self.rest(servo);
                Ok(Reply::Done)
            }
            Ask::Keys => Ok(Reply::Keys(self.keys())),
            Ask::Provision(key) => self.provision(key, Rights::default(), servo),
            Ask::Revoke(key) => self.revoke(key, servo),
            Ask::Log { from } => Ok(self.log(from, servo)),
            Ask::Time { unix_s } => {
                self.told_time = Some((unix_s, now_us));
                Ok(Reply::Done)
            }
            Ask::Challenge => Ok(self.challenge()),
            Ask::Login { key, role, signature } => self.login(key, role, &signature),
            Ask::Logout => Ok(self.logout()),
            Ask::Session => Ok(Reply::Session(self.session())),
            Ask::ProvisionAs { key, rights } => self.provision(key, rights, servo),
            Ask::Timing => {
                self.count_stamps(servo);
                Ok(Reply::Timing(self.timing.timing()))
            }
            Ask::Update => Ok(Reply::Update(self.update())),
            Ask::Install => self.install(servo),
            Ask::Confirm => self.confirm(servo),
            Ask::ProvisionFirmware { key, rights } => self.provision(key, Rights { firmware: true, ..rights }, servo),
        }
    }
}

/// Whether what the answer to a request said of the mode, or of the session, is still so. Only such an answer is given again: an arming
/// that an emergency stop has ended meanwhile must not be called done. Of the other requests nothing but a further
/// request, or a reset, undoes what was done.
const fn holds(ask: &Ask<'_>, mode: Mode, logged_in: bool) -> bool {
    match ask {
        Ask::Login { .. } => logged_in,
        Ask::AcknowledgeDrivesDisabled => matches!(mode, Mode::Bypass),
        Ask::Arm(_) => matches!(mode, Mode::Armed),
        _ => true,
    }
}

/// Whether carrying a request out twice is not the same as once.
const fn changes(ask: &Ask<'_>) -> bool {
    !matches!(
        ask,
        Ask::Hello
            | Ask::Status
            | Ask::Check(_)
            | Ask::List
            | Ask::Settings
            | Ask::Recording { .. }
            | Ask::Progress
            | Ask::Keys
            | Ask::Log { .. }
            | Ask::Session
            | Ask::Timing
            | Ask::Update
    )
}
