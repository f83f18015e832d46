//! The memory that the board shares with the host: batches of the bench link. Its layout is in `docs/link.md`.

use core::ptr::slice_from_raw_parts_mut;

use cortex_m::asm::dmb;

const MAGIC: u32 = u32::from_le_bytes(*b"TPBK");
const VERSION: u32 = 1;
const INPUT: usize = 0x1000;
const OUTPUT: usize = 0x40_0000;
const OUTPUT_BYTES: usize = 4 << 20;
const WORKSPACE: usize = 0x80_0000;
/// Bytes of the workspace of the on-board correction.
pub const WORKSPACE_BYTES: usize = 8 << 20;

/// Words at the start, by index.
#[derive(Clone, Copy)]
enum Word {
    Magic,
    Version,
    Request,
    Done,
    InputBytes,
    OutputBytes,
    Presence,
}

unsafe extern "C" {
    static mut _psram_start: [u8; WORKSPACE + WORKSPACE_BYTES];
}

fn base() -> *mut u8 {
    (&raw mut _psram_start).cast()
}

/// Where the workspace lies.
pub fn workspace() -> *mut u8 {
    // SAFETY: within the region that `memory.x` names.
    unsafe { base().add(WORKSPACE) }
}

fn read(word: Word) -> u32 {
    // SAFETY: an aligned word of the region; the host may write to it at any time, hence volatile.
    unsafe { base().cast::<u32>().add(word as usize).read_volatile() }
}

fn write(word: Word, value: u32) {
    // SAFETY: as in `read`.
    unsafe { base().cast::<u32>().add(word as usize).write_volatile(value) }
}

/// Whether the host says that somebody is at the device: what the button is on a board that has one.
pub fn presence() -> bool {
    read(Word::Presence) == 1
}

/// The shared memory. There is one.
pub struct SharedMemory(());

impl SharedMemory {
    /// Tells the host that the device is ready. What was requested and not done before a reset is still to be done.
    pub fn ready() -> Self {
        write(Word::Version, VERSION);
        dmb();
        write(Word::Magic, MAGIC);
        Self(())
    }

    /// The number of a batch that is to be run.
    pub fn request(&self) -> Option<u32> {
        let request = read(Word::Request);
        (request != read(Word::Done)).then_some(request)
    }

    /// Input and output of the batch that was requested.
    pub fn records(&mut self) -> (&[u8], &mut [u8]) {
        dmb();
        let bytes = (read(Word::InputBytes) as usize).min(OUTPUT - INPUT);
        // SAFETY: both lie apart in the region, and the host touches neither between the request and its end.
        unsafe {
            let input = &*slice_from_raw_parts_mut(base().add(INPUT), bytes);
            let output = &mut *slice_from_raw_parts_mut(base().add(OUTPUT), OUTPUT_BYTES);
            (input, output)
        }
    }

    /// A batch is done.
    pub fn done(&mut self, request: u32, output_bytes: usize) {
        write(Word::OutputBytes, output_bytes as u32);
        dmb();
        write(Word::Done, request);
    }
}
