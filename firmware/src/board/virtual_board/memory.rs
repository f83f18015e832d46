//! Memory the device is lent: statics for what the links need, the bank of the flash model, the workspace of the
//! on-board correction.

use core::mem::MaybeUninit;

use static_cell::ConstStaticCell;
use truepath_core::job::Buffers;
use truepath_core::link::ResetCause;

use super::shared_memory;
use crate::computation::ProgressMeter;
use crate::config_service::{IMAGE_BYTES, Memory};
use crate::flash::{BANK_BYTES, BANK_WORDS, FLASH_BYTES, FLASH_WORDS, Nor, PROGRAM_SECTORS, WordState};

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
    static mut _bank_start: [u8; FLASH_BYTES];
    static mut _marks_start: [u8; FLASH_WORDS];
    static _factory_start: [u8; PROGRAM_SECTORS.len()];
    static __vector_table: u32;
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

/// The flash model, as the loader has it: blank after power-up, as it was after any other reset. Called once.
pub fn whole_flash(cause: ResetCause) -> Nor<'static> {
    // SAFETY: `memory.x` reserves both regions, nothing else refers to them, and this is called once.
    unsafe { model(&mut *(&raw mut _bank_start), &mut *(&raw mut _marks_start), cause) }
}

/// A model of the flash, with what the memory holds; blank after power-up.
fn model(bytes: &'static mut [u8], marks: &'static mut [u8], cause: ResetCause) -> Nor<'static> {
    let sound = cause != ResetCause::PowerOn && marks.iter().all(|&mark| mark <= WordState::Torn as u8);
    if !sound {
        marks.fill(WordState::Blank as u8);
    }
    // SAFETY: each byte is the number of a state.
    let words = unsafe { &mut *(core::ptr::from_mut(marks) as *mut [WordState]) };
    if sound { Nor::new(bytes, words) } else { Nor::erased(bytes, words) }
}

/// The flash model, as the program has it: without a loader only the bank. Called once.
pub fn flash(cause: ResetCause, has_loader: bool) -> Nor<'static> {
    if has_loader {
        // The loader has seen to it.
        return whole_flash(ResetCause::Pin);
    }
    // SAFETY: as in `whole_flash`. The image lies behind the bank, and is loaded by the emulator.
    unsafe {
        let bytes = &mut *(&raw mut _bank_start).cast::<[u8; BANK_BYTES]>();
        model(bytes, &mut *(&raw mut _marks_start).cast::<[u8; BANK_WORDS]>(), cause)
    }
}

/// The program that the host puts beside the loader.
pub fn factory_program() -> &'static [u8] {
    // SAFETY: `memory.x` reserves the region, and nothing writes to it.
    unsafe { &*(&raw const _factory_start) }
}

/// Where the program is read.
pub fn program_start() -> u32 {
    &raw const _bank_start as u32 + PROGRAM_SECTORS.start()
}

/// Where the vectors of this image lie.
pub fn vectors() -> u32 {
    &raw const __vector_table as u32
}

/// The buffers of the on-board correction, in the upper half of the shared memory. Called once.
pub fn correction_buffers() -> &'static mut CorrectionBuffers {
    // SAFETY: the region is as large as the type (asserted above), aligned, and reserved for it (docs/link.md).
    let place = unsafe { &mut *shared_memory::workspace().cast::<MaybeUninit<CorrectionBuffers>>() };
    place.write(CorrectionBuffers::new())
}
