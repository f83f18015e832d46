//! The whole device in one thread: servo and configuration service on one flash, without interrupts.
//!
//! The boards run the same [`Servo`] and [`ConfigService`] in an interrupt and in a thread; tests and the bench of the host run
//! them here. Both links are fed with bytes as they come from a UART, cut anywhere. Time is an argument, microseconds
//! on a clock that never goes back, not even over a reset.
//!
//! ```
//! use truepath_core::image::DeviceClass;
//! use truepath_core::link::{Ask, PACKET_BYTES, Reply, Request, ResetCause, Response, decode, encode};
//! use truepath_fw::config_service::{Board, IMAGE_BYTES, Memory};
//! use truepath_fw::device::Device;
//! use truepath_fw::flash::{BANK_BYTES, BANK_WORDS, Nor, WordState};
//! use truepath_fw::computation::ProgressMeter;
//!
//! let (mut bank, mut words) = (vec![0; BANK_BYTES], vec![WordState::Blank; BANK_WORDS]);
//! let flash = Nor::erased(&mut bank, &mut words);
//! let [mut image, mut recording] = [IMAGE_BYTES, 48_000].map(|bytes| vec![0; bytes]);
//! let [mut program, mut job, mut probe] = [65_536, 512, 65_536].map(|bytes| vec![0; bytes]);
//! let memory = Memory {
//!     image: &mut image,
//!     recording: &mut recording,
//!     program: &mut program,
//!     job: &mut job,
//!     probe: &mut probe,
//!     meter: &ProgressMeter::new(),
//! };
//! let board = Board { name: "in process", last_reset: ResetCause::PowerOn, class: DeviceClass::Bench, present: false,
//!     id: [0; 12], secret: None, counter_hz: 1_000_000 };
//! let mut device = Device::start(flash, memory, board, 0);
//!
//! let mut packet = [0; PACKET_BYTES];
//! let used = encode(&Request { id: 1, ask: Ask::Hello }, &mut packet)?;
//! let mut answer = vec![];
//! device.config_bytes(&packet[..used], 10, |bytes| answer.extend_from_slice(bytes));
//! let end = answer.len() - 1;
//! let answer: Response = decode(&mut answer[..end])?;
//! assert!(matches!(answer.answer, Ok(Reply::Hello(hello)) if hello.board == "in process"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use embedded_storage::nor_flash::NorFlash;
use truepath_core::job::Workspace;
use truepath_core::link::ResetCause;
use truepath_core::rewrite::State;

use crate::bench::{self, Batch};
use crate::clock::Clock;
use crate::config_service::{Board, ConfigService, Memory, Restart};
use crate::servo::Servo;

/// The device.
pub struct Device<'a, F: NorFlash> {
    servo: Servo<'a>,
    config: ConfigService<'a, F>,
}

impl<'a, F: NorFlash> Device<'a, F> {
    /// Power-up: finds in the flash what the device remembers. It is in `Off` then.
    pub fn start(flash: F, memory: Memory<'a>, board: Board, now_us: u64) -> Self {
        let (config, servo) = ConfigService::start(flash, memory, board, now_us);
        Self { servo, config }
    }

    /// Bytes of the setpoint link; `answer` gets each answer as it goes out, at the same time.
    pub fn setpoint_bytes(&mut self, bytes: &[u8], now_us: u64, answer: impl FnMut(&[u8])) {
        self.setpoint_bytes_answered(bytes, now_us, &now_us, answer);
    }
    /// The same when answering takes time: `clock` is read when an answer is ready.
    pub fn setpoint_bytes_answered(
        &mut self,
        bytes: &[u8],
        arrived_us: u64,
        clock: &impl Clock,
        mut answer: impl FnMut(&[u8]),
    ) {
        self.servo.receive(bytes, arrived_us, clock, &mut answer);
    }
    /// Bytes of the configuration link; `answer` gets each answer. When it gives a restart, the rest of the bytes was
    /// left, and the device waits for [`Device::reset`].
    pub fn config_bytes(&mut self, bytes: &[u8], now_us: u64, mut answer: impl FnMut(&[u8])) -> Option<Restart> {
        self.config.receive(bytes, now_us, &mut self.servo, &mut answer)
    }
    /// The timer of a millisecond: notices the silence of the setpoint link, lets the log be written. When it gives a restart,
    /// the device waits for [`Device::reset`].
    pub fn watch(&mut self, now_us: u64) -> Option<Restart> {
        self.servo.watch(now_us);
        self.config.rest(&mut self.servo);
        self.config.trial_is_over(now_us, &mut self.servo)
    }
    /// Runs a computation that was asked for, to its end; says whether there was one.
    pub fn compute(&mut self, workspace: &mut Workspace<'_>) -> bool {
        let Some(mut computation) = self.config.take_computation() else { return false };
        computation.run(workspace);
        self.config.finish(computation, &mut self.servo);
        true
    }
    /// A batch of the bench link, see [`mod@bench`]. `now_us` is the time before it, and the time behind it afterwards.
    pub fn batch(
        &mut self,
        input: &[u8],
        output: &mut [u8],
        now_us: &mut u64,
        workspace: Option<&mut Workspace<'_>>,
    ) -> Batch {
        bench::run(&mut self.servo, &mut self.config, input, output, now_us, workspace)
    }

    /// A reset: the flash stays, everything else begins anew.
    pub fn reset(self, cause: ResetCause, now_us: u64) -> Self {
        let (flash, memory, board) = self.into_parts();
        Self::start(flash, memory, Board { last_reset: cause, ..board }, now_us)
    }
    /// The flash, with all it holds, the memory, and what the board said.
    pub fn into_parts(self) -> (F, Memory<'a>, Board) {
        let (image, recording) = self.servo.into_memory();
        self.config.into_parts(image, recording)
    }

    /// Whether the drive enable is passed on.
    pub fn drive_enable(&self) -> bool {
        self.servo.drive_enable()
    }
    /// Whether the last correction ended in a fault.
    pub fn fault(&self) -> bool {
        self.servo.fault()
    }
    /// A copy of the state of the rewriter.
    pub fn state(&self) -> State {
        *self.servo.state()
    }
    /// The servo.
    pub fn servo(&mut self) -> &mut Servo<'a> {
        &mut self.servo
    }
    /// The flash.
    pub fn flash(&mut self) -> &mut F {
        self.config.flash()
    }
}
