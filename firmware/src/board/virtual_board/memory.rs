//! Memory the device is lent: statics for what the links need, the bank of the flash model, the workspace of the
//! on-board correction.

use core::mem::MaybeUninit;

use static_cell::ConstStaticCell;
use truepath_core::job::Buffers;
use truepath_core::link::ResetCause;

use super::shared_memory;
use crate::computation::ProgressMeter;
use crate::config_service::{IMAGE_BYTES, Memory};
use crate::flash::{BANK_BYTES, BANK_WORDS, Nor, WordState};

/// Frames of the recorder: two seconds of three axes at 1 kHz.
const RECORDING_BYTES: usize = 2_000 * 48;
/// Buffer for a program.
const PROGRAM_BYTES: usize = 512 << 10;
/// Buffer for a job.
const JOB_BYTES: usize = 1 << 10;
/// Buffer for a probe log.
const PROBE_BYTES: usize = 128 << 10;

/// Buffers of the on-board correction: blocks of a contour, samples of a path, states, nodes, probe points.
pub type CorrectionBuffers = Buffers<4_096, 24_576, 24_576, 16_384, 512>;
const _: () = assert!(size_of::<CorrectionBuffers>() <= shared_memory::WORKSPACE_BYTES);

unsafe extern "C" {
    static mut _bank_start: [u8; BANK_BYTES];
    static mut _marks_start: [u8; BANK_WORDS];
}

/// The buffers of the links. Called once.
pub fn lend() -> Memory<'static> {
    static IMAGE: ConstStaticCell<[u8; IMAGE_BYTES]> = ConstStaticCell::new([0; IMAGE_BYTES]);
    static RECORDING: ConstStaticCell<[u8; RECORDING_BYTES]> = ConstStaticCell::new([0; RECORDING_BYTES]);
    static PROGRAM: ConstStaticCell<[u8; PROGRAM_BYTES]> = ConstStaticCell::new([0; PROGRAM_BYTES]);
    static JOB: ConstStaticCell<[u8; JOB_BYTES]> = ConstStaticCell::new([0; JOB_BYTES]);
    static PROBE: ConstStaticCell<[u8; PROBE_BYTES]> = ConstStaticCell::new([0; PROBE_BYTES]);
    static METER: ProgressMeter = ProgressMeter::new();
    Memory {
        image: IMAGE.take(),
        recording: RECORDING.take(),
        program: PROGRAM.take(),
        job: JOB.take(),
        probe: PROBE.take(),
        meter: &METER,
    }
}

/// The bank of the flash model: blank after power-up, as it was after any other reset. Called once.
pub fn bank(cause: ResetCause) -> Nor<'static> {
    // SAFETY: `memory.x` reserves both regions, nothing else refers to them, and this is called once. A byte of the
    // second is made a state only after it was seen to be one.
    unsafe {
        let bytes = &mut *(&raw mut _bank_start);
        let marks = &mut *(&raw mut _marks_start);
        let sound = cause != ResetCause::PowerOn && marks.iter().all(|&mark| mark <= WordState::Torn as u8);
        if !sound {
            marks.fill(WordState::Blank as u8);
        }
        let words = &mut *(&raw mut *marks).cast::<[WordState; BANK_WORDS]>();
        if sound { Nor::new(bytes, words) } else { Nor::erased(bytes, words) }
    }
}

/// The buffers of the on-board correction, in the upper half of the shared memory. Called once.
pub fn correction_buffers() -> &'static mut CorrectionBuffers {
    // SAFETY: the region is as large as the type (asserted above), aligned, and reserved for it (docs/link.md).
    let place = unsafe { &mut *shared_memory::workspace().cast::<MaybeUninit<CorrectionBuffers>>() };
    place.write(CorrectionBuffers::new())
}
