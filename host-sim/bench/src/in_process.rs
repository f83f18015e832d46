//! The `host` board: the device of the firmware in this process, on a model of its flash.
//!
//! The same `Device` that the virtual board runs, with the same batches. Its memory is as large as the virtual board's
//! and stays allocated until the process ends.

use truepath_core::correct::{Node, Profile, Scratch, Update};
use truepath_core::cut::{Sample, State};
use truepath_core::gcode::DeviceMemory;
use truepath_core::geometry::{Block, Direction, Vector};
use truepath_core::identify::Observation;
use truepath_core::image::DeviceClass;
use truepath_core::job::Workspace;
use truepath_core::link::ResetCause;
use truepath_core::probe::{Contact, Reading};
use truepath_core::units::{Offset, Real};
use truepath_fw::computation::ProgressMeter;
use truepath_fw::config_service::{Board, IMAGE_BYTES, Memory};
use truepath_fw::device::Device;
use truepath_fw::flash::{BANK_BYTES, BANK_WORDS, Nor, WordState};

use super::bulk::Bulk;
use super::error::BenchError;

/// Answers of a batch.
const OUTPUT_BYTES: usize = 4 << 20;
/// Frames of the recorder: two seconds of three axes at 1 kHz.
const RECORDING_BYTES: usize = 2_000 * 48;
/// Buffers for a program, a job, a probe log.
const PROGRAM_BYTES: usize = 512 << 10;
const JOB_BYTES: usize = 1 << 10;
const PROBE_BYTES: usize = 128 << 10;
/// Room of the on-board correction.
const BLOCKS: usize = 4_096;
const SAMPLES: usize = 24_576;
const NODES: usize = 16_384;
const POINTS: usize = 512;

/// The device in process.
pub struct InProcess {
    /// Always there but during a reset.
    device: Option<Device<'static, Nor<'static>>>,
    now_us: u64,
    output: Vec<u8>,
    workspace: Workspace<'static>,
}

/// A buffer that lives as long as the process.
fn lasting<T: Clone>(value: T, count: usize) -> &'static mut [T] {
    vec![value; count].leak()
}

impl InProcess {
    /// A device as it leaves the factory, switched on.
    ///
    /// # Errors
    /// None in practice: the sizes of the flash model do not fit.
    pub fn start() -> Result<Self, BenchError> {
        Self::made(false)
    }

    /// The same with its button held: keys may be provisioned until the next reset.
    ///
    /// # Errors
    /// As [`Self::start`].
    pub fn attended() -> Result<Self, BenchError> {
        Self::made(true)
    }

    fn made(present: bool) -> Result<Self, BenchError> {
        let (bytes, words) = (lasting(0, BANK_BYTES), lasting(WordState::Blank, BANK_WORDS));
        let memory = Memory {
            image: lasting(0, IMAGE_BYTES),
            recording: lasting(0, RECORDING_BYTES),
            program: lasting(0, PROGRAM_BYTES),
            job: lasting(0, JOB_BYTES),
            probe: lasting(0, PROBE_BYTES),
            meter: Box::leak(Box::new(ProgressMeter::new())),
        };
        let board = Board {
            name: "host",
            last_reset: ResetCause::PowerOn,
            class: DeviceClass::Bench,
            present,
            id: [0; 12],
            secret: None,
            counter_hz: 1_000_000,
        };
        let device = Device::start(Nor::erased(bytes, words), memory, board, 0);
        Ok(Self { device: Some(device), now_us: 0, output: vec![0; OUTPUT_BYTES], workspace: workspace() })
    }

    /// The device, for tests that look inside or cut its power.
    pub fn device(&mut self) -> Option<&mut Device<'static, Nor<'static>>> {
        self.device.as_mut()
    }
    /// Resets the device, for a cause it will tell.
    pub fn reset(&mut self, cause: ResetCause) {
        self.device = self.device.take().map(|device| device.reset(cause, self.now_us));
    }
}

/// Room of the on-board correction.
pub(crate) fn workspace() -> Workspace<'static> {
    let unseen = Observation::new(Offset::ZERO, Real::ZERO, Offset::ZERO, Offset::ZERO, Direction::X);
    Workspace {
        parameters: Box::leak(Box::new(DeviceMemory::new())).lend(),
        blocks: lasting(Block::BLANK, BLOCKS),
        samples: lasting(Sample::BLANK, SAMPLES),
        readings: lasting(Reading::default(), POINTS),
        contacts: lasting(Contact::BLANK, POINTS),
        observations: lasting(unseen, POINTS),
        states: lasting(State::REST, SAMPLES),
        displacements: lasting(Vector::ZERO, SAMPLES),
        profiles: lasting(Profile::default(), NODES),
        updates: lasting(Update::default(), NODES),
        nodes: lasting(Node::default(), NODES),
        scratch: lasting(Scratch::default(), NODES),
    }
}

impl Bulk for InProcess {
    fn describe(&self) -> String {
        "the device in this process".to_owned()
    }
    fn run(&mut self, input: &[u8]) -> Result<Vec<u8>, BenchError> {
        let Self { device: Some(device), now_us, output, workspace } = self else {
            return Err(BenchError::Silent("the device is switched off".to_owned()));
        };
        let batch = device.batch(input, output, now_us, Some(workspace));
        if batch.overflow || batch.malformed {
            return Err(BenchError::Foreign(format!("batch: {batch:?}")));
        }
        let back = output[..batch.written].to_vec();
        if let Some(restart) = batch.restart {
            self.reset(if restart.watchdog { ResetCause::Watchdog } else { ResetCause::Software });
        }
        Ok(back)
    }
}
