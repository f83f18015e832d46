//! The setpoint path: bytes in, answer out, in the same call.
//!
//! Who calls it: the interrupt (executor) of the setpoint link, above everything else on the board, as bytes or a
//! frame arrive, and [`Servo::watch`] from a timer at least every millisecond. The deadline is `deadline_us` of the
//! settings, counted from the arrival of the frame; an answer that would be later is withheld.
//!
//! There is no lock in here. The board shares the servo with the configuration service by [`ServoAccess`], which holds the
//! setpoint path off while its closure runs; every method below says how long that is. The longest, arming, is a copy of the
//! state, a CRC of 38 bytes and six comparisons: some thousands of instructions.

use truepath_core::link::{
    Counters, Deframer, DeviceSettings, Endpoint, Framed, LinkError, MAX_ANSWER_BYTES, MAX_SETPOINT_BYTES, Recorder,
    STAMPS_AT_ONCE, Stamp, Stamps, TRACE_SAMPLES, Trace, TraceSample, setpoint_bytes,
};
use truepath_core::rewrite::{ArmRequest, Mode, Reason, Refusal, Rewriter, Spent, SpentList, State};

use crate::active::Loaded;
use crate::clock::Clock;

/// Samples of the live trace that wait to be fetched; at 1 kHz and one sample in eight half a second.
pub const TRACE_QUEUE: usize = 64;
/// One tick in this many is traced.
pub const TRACE_EVERY: u32 = 8;
/// Stamps of frames that wait to be counted; at 20 kHz for 3 ms, and they are taken out each millisecond.
pub const STAMPS: usize = 64;
/// Frames that are still recorded after a fault.
pub const RECORD_AFTER: usize = 16;
/// Longest packet of the setpoint link without its 0x00: the frame and one byte of COBS.
const PACKET: usize = MAX_SETPOINT_BYTES + 1;
/// Longest packet that goes back.
const ANSWER: usize = MAX_ANSWER_BYTES + 2;

/// Access to the servo beside others who have it.
///
/// A closure cannot ask for the servo again through the access it came from, so nobody ever holds it twice:
///
/// ```compile_fail,E0499
/// # use truepath_fw::servo::ServoAccess;
/// fn nested<'a>(servo: &mut impl ServoAccess<'a>) {
///     servo.with(|outer| servo.with(|inner| (outer.mode(), inner.mode())));
/// }
/// ```
///
/// One after the other is well:
///
/// ```
/// # use truepath_fw::servo::ServoAccess;
/// fn in_turn<'a>(servo: &mut impl ServoAccess<'a>) {
///     servo.with(|servo| servo.mode());
///     servo.with(|servo| servo.mode());
/// }
/// ```
pub trait ServoAccess<'a> {
    /// Runs a closure while the setpoint path stands still. Only what is bounded and short belongs in it.
    fn with<R>(&mut self, f: impl FnOnce(&mut Servo<'a>) -> R) -> R;
}

/// A servo that nobody else has.
impl<'a> ServoAccess<'a> for Servo<'a> {
    fn with<R>(&mut self, f: impl FnOnce(&mut Servo<'a>) -> R) -> R {
        f(self)
    }
}

/// The setpoint path.
pub struct Servo<'a> {
    endpoint: Endpoint,
    /// Passes setpoints on when there is no image.
    bare: Rewriter<'static>,
    loaded: Option<Loaded<'a>>,
    deframer: Deframer<PACKET>,
    recorder: Recorder<'a>,
    trace: Trace<TRACE_QUEUE>,
    stamps: Stamps<STAMPS>,
    /// Where answers of the stream are made: memory of a call would have to be cleared each time.
    answer: [u8; ANSWER],
}

impl<'a> Servo<'a> {
    /// The servo after a reset: `Off`, without an image. `bare` is a rewriter for the same settings.
    pub fn new(settings: DeviceSettings, bare: Rewriter<'static>, spent: SpentList, recording: &'a mut [u8]) -> Self {
        Self {
            endpoint: Endpoint::new(settings, spent),
            bare,
            loaded: None,
            deframer: Deframer::new(),
            recorder: Recorder::new(recording, setpoint_bytes(settings.axes), RECORD_AFTER),
            trace: Trace::new(TRACE_EVERY),
            stamps: Stamps::new(),
            answer: [0; ANSWER],
        }
    }

    /// Bytes of the stream that had arrived at `arrived_us`; `send` gets the answer to each frame that has one.
    pub fn receive(&mut self, mut bytes: &[u8], arrived_us: u64, clock: &impl Clock, send: &mut impl FnMut(&[u8])) {
        let called = clock.count();
        let Self { endpoint, bare, loaded, deframer, recorder, trace, stamps, answer } = self;
        let rewriter = loaded.as_ref().and_then(Loaded::rewriter).unwrap_or(bare);
        while let Some(framed) = deframer.feed(&mut bytes) {
            let packet = match framed {
                Framed::Packet(packet) => packet,
                Framed::Overlong => {
                    endpoint.damaged(LinkError::Buffer);
                    continue;
                }
            };
            let verdict = endpoint.packet(rewriter, packet, arrived_us);
            // The frame now lies behind its COBS code.
            recorder.record(packet.get(1..).unwrap_or(&[]));
            after(endpoint, recorder, trace);
            if verdict.is_accepted() {
                let made = endpoint.answer_packet(clock.now_us(), answer);
                stamps.leave(verdict, arrived_us, clock.count().wrapping_sub(called));
                if let Some(bytes) = made {
                    send(answer.get(..bytes).unwrap_or(&[]));
                }
            }
        }
    }

    /// A frame as it travels on SPI; writes the answer, as it travels there, and gives its bytes.
    pub fn frame(&mut self, raw: &[u8], arrived_us: u64, clock: &impl Clock, answer: &mut [u8]) -> Option<usize> {
        let called = clock.count();
        let Self { endpoint, bare, loaded, recorder, trace, stamps, .. } = self;
        let rewriter = loaded.as_ref().and_then(Loaded::rewriter).unwrap_or(bare);
        let verdict = endpoint.frame(rewriter, raw, arrived_us);
        recorder.record(raw);
        after(endpoint, recorder, trace);
        if !verdict.is_accepted() {
            return None;
        }
        let made = endpoint.answer(clock.now_us(), answer);
        stamps.leave(verdict, arrived_us, clock.count().wrapping_sub(called));
        made
    }

    /// The controller did not fetch the last answer by [`Servo::answer_by_us`]: it counts as withheld. Some stores.
    pub fn withdraw(&mut self) {
        self.endpoint.withdraw();
    }
    /// When the answer to the last accepted frame must have been fetched, µs. A load.
    pub fn answer_by_us(&self) -> u64 {
        self.endpoint.due_by_us()
    }

    /// Looks at the silence of the link.
    pub fn watch(&mut self, now_us: u64) {
        let rewriter = self.loaded.as_ref().and_then(Loaded::rewriter).unwrap_or(&self.bare);
        if self.endpoint.watch(rewriter, now_us) {
            after(&mut self.endpoint, &mut self.recorder, &mut self.trace);
        }
    }

    /// Whether the drive enable is passed on: for the pin. A load.
    pub fn drive_enable(&self) -> bool {
        self.endpoint.drive_enable()
    }
    /// Whether the last correction ended in a fault, until the next arming: for the pin. A load.
    pub fn fault(&self) -> bool {
        self.endpoint.state().reason().is_fault()
    }
    /// State of the rewriter. A load.
    pub fn mode(&self) -> Mode {
        self.endpoint.mode()
    }
    /// Why the last correction ended or failed. A load.
    pub fn reason(&self) -> Reason {
        self.endpoint.state().reason()
    }
    /// All of the state, to be copied.
    pub fn state(&self) -> &State {
        self.endpoint.state()
    }
    /// Axes of a frame. A load.
    pub fn axes(&self) -> u8 {
        self.endpoint.settings().axes
    }
    /// Counters; a copy of some hundred bytes.
    pub fn counters(&self) -> Counters {
        *self.endpoint.counters()
    }
    /// Sets the counters to zero.
    pub fn clear_counters(&mut self) {
        self.endpoint.clear_counters();
    }
    /// Counts a message of the configuration link.
    pub fn count_message(&mut self, damaged: bool) {
        self.endpoint.count_message(damaged);
    }
    /// Whether an image is in use.
    pub fn has_image(&self) -> bool {
        self.loaded.is_some()
    }

    /// The controller acknowledges that the drives are disabled. A write of the state.
    ///
    /// # Errors
    /// As [`Endpoint::acknowledge`].
    pub fn acknowledge(&mut self, now_us: u64) -> Result<(), Refusal> {
        let rewriter = self.loaded.as_ref().and_then(Loaded::rewriter).unwrap_or(&self.bare);
        self.endpoint.acknowledge(rewriter, now_us)
    }
    /// What [`Servo::arm`] would say; gives the pass of the part that would be spent. As arming.
    ///
    /// # Errors
    /// As [`Endpoint::arm`].
    pub fn check(&self, request: &ArmRequest) -> Result<Spent, Refusal> {
        let rewriter = self.loaded.as_ref().and_then(Loaded::rewriter).unwrap_or(&self.bare);
        self.endpoint.check(rewriter, request)
    }
    /// Arms. A copy of the state, a CRC of 38 bytes, six comparisons.
    ///
    /// # Errors
    /// As [`Endpoint::arm`].
    pub fn arm(&mut self, request: &ArmRequest) -> Result<(), Refusal> {
        let rewriter = self.loaded.as_ref().and_then(Loaded::rewriter).unwrap_or(&self.bare);
        self.endpoint.arm(rewriter, request)
    }
    /// Disarms. A few stores.
    ///
    /// # Errors
    /// As [`Endpoint::disarm`].
    pub fn disarm(&mut self) -> Result<(), Refusal> {
        let rewriter = self.loaded.as_ref().and_then(Loaded::rewriter).unwrap_or(&self.bare);
        self.endpoint.disarm(rewriter)
    }

    /// Takes the image out of use, in `Off` and `Bypass` only, where nobody looks at it. A move of some 1.5 kB.
    pub fn take_image(&mut self) -> Option<Loaded<'a>> {
        if self.is_idle() { self.loaded.take() } else { None }
    }
    /// Puts an image in use, in `Off` and `Bypass` only, and when the one before has been taken; otherwise the image
    /// comes back. A move of some 1.5 kB.
    #[must_use]
    pub fn give_image(&mut self, image: Loaded<'a>) -> Option<Loaded<'a>> {
        if !self.is_idle() || self.loaded.is_some() {
            return Some(image);
        }
        self.loaded = Some(image);
        None
    }
    /// Whether no correction is on or waiting. A load.
    pub fn is_idle(&self) -> bool {
        matches!(self.mode(), Mode::Off | Mode::Bypass)
    }

    /// Uses other settings; in `Off` only, and with the image taken out, because that was prepared for the old ones.
    /// The recording starts anew. A move of two rewriters.
    ///
    /// # Errors
    /// Not in `Off`.
    pub fn configure(&mut self, settings: DeviceSettings, bare: Rewriter<'static>) -> Result<(), Refusal> {
        self.endpoint.configure(settings)?;
        self.bare = bare;
        self.recorder.restart(setpoint_bytes(settings.axes));
        Ok(())
    }

    /// The oldest samples of the trace, at most [`TRACE_SAMPLES`]. A copy of less than 1 KiB.
    pub fn drain_trace(&mut self) -> (u32, heapless::Vec<TraceSample, TRACE_SAMPLES>) {
        self.trace.drain()
    }
    /// The oldest stamps of frames, at most [`STAMPS_AT_ONCE`], and how many were lost before them. A copy of 128 bytes.
    pub fn drain_stamps(&mut self) -> (u32, heapless::Vec<Stamp, STAMPS_AT_ONCE>) {
        self.stamps.drain()
    }
    /// Whether the recorder stands. A load.
    pub fn recording_frozen(&self) -> bool {
        self.recorder.is_frozen()
    }
    /// Copies recorded frames from number `from` on; gives all frames there are and the bytes copied. A copy of at
    /// most `into`.
    pub fn recording(&self, from: usize, into: &mut [u8]) -> (usize, usize) {
        let frames = self.recorder.frames(from, into.len());
        for (to, byte) in into.iter_mut().zip(frames) {
            *to = *byte;
        }
        (self.recorder.total(), frames.len())
    }
    /// Lets the recorder run again.
    pub fn release_recording(&mut self) {
        self.recorder.release();
    }

    /// The memory back, at a reset: that of the image, if it has it, and that of the recording.
    pub fn into_memory(self) -> (Option<&'a mut [u8]>, &'a mut [u8]) {
        (self.loaded.map(Loaded::unload), self.recorder.into_buffer())
    }
}

/// What follows a frame or a silence: trace and recorder.
#[inline]
fn after(endpoint: &mut Endpoint, recorder: &mut Recorder<'_>, trace: &mut Trace<TRACE_QUEUE>) {
    if let Some(output) = endpoint.due() {
        trace.record(endpoint.state(), output);
    }
    if let Some(reason) = endpoint.take_fault() {
        recorder.fault(reason);
    }
}
