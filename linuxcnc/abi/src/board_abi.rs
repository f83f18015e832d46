//! Route B for C: `truepath-board.h` declares what is here.
//!
//! The caller keeps the memory: a [`Remote`] lies in a block of [`BOARD_WORDS`] 64-bit words that C provides. Every
//! function but [`truepath_board_new`] is called by the servo thread, in the order begin, take…, finish; their work is
//! bounded by [`BYTES_A_TICK`](crate::board::BYTES_A_TICK).
//!
//! Pointers must be those of C's own objects, aligned and not null, and a board is used by one thread at a time; what
//! lies at them is not trusted beyond that.

use core::mem::{MaybeUninit, align_of, size_of};

use crate::board::PACKET_BYTES;
use crate::pc::{Inputs, JOINTS, Joints, Limits, Outputs};
use crate::remote::Remote;

/// Words of 64 bits of the block a board lies in.
pub const BOARD_WORDS: usize = 512;

const _: () = assert!(size_of::<Remote>() <= 8 * BOARD_WORDS && align_of::<Remote>() <= 8);
const _: () = assert!(PACKET_BYTES == 75);

/// The block of a board.
#[repr(C, align(8))]
#[derive(Debug)]
pub struct Block {
    words: MaybeUninit<[u64; BOARD_WORDS]>,
}

/// What there is to say about the link, besides the pins of both routes.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub struct Link {
    /// Why the link is lost, see [`Cause`](crate::board::Cause); 0: it is not.
    pub cause: u32,
    /// Not 0: the answer of this tick came.
    pub answered: u32,
    /// Ticks without an answer since the start.
    pub missed: u32,
    /// Answers that came too late.
    pub late: u32,
    /// Packets that were damaged, and answers that cannot be true.
    pub damaged: u32,
}

/// Puts a board into a block, see [`Remote::new`]; `axis_of_joint` is as in [`Joints`]. 0, or the number of a
/// [`RemoteError`](crate::remote::RemoteError), and then the block holds none.
#[unsafe(no_mangle)]
pub extern "C" fn truepath_board_new(
    block: &mut Block,
    axis_of_joint: &[u8; JOINTS],
    limits: &Limits,
    period_ns: u32,
    axes: u32,
    clamp_nm: u32,
) -> u32 {
    let axes = u8::try_from(axes).unwrap_or(u8::MAX);
    match Remote::new(limits, Joints(*axis_of_joint), period_ns, axes, clamp_nm) {
        Ok(remote) => {
            // SAFETY: the block is large enough and aligned, see the assertion above.
            unsafe { (&raw mut *block).cast::<Remote>().write(remote) };
            0
        }
        Err(error) => error.code(),
    }
}

/// See [`Remote::feedback`].
#[unsafe(no_mangle)]
pub extern "C" fn truepath_board_feedback(board: &Remote, measured: &[f64; JOINTS], plain: &mut [f64; JOINTS]) {
    board.feedback(measured, plain);
}

/// See [`Remote::begin`]: writes the bytes to send, gives their number.
#[unsafe(no_mangle)]
pub extern "C" fn truepath_board_begin(board: &mut Remote, inputs: &Inputs, packet: &mut [u8; PACKET_BYTES]) -> usize {
    board.begin(inputs, packet)
}

/// Not all of these bytes could be sent.
#[unsafe(no_mangle)]
pub extern "C" fn truepath_board_not_sent(board: &mut Remote) {
    board.board().not_sent();
}

/// The port failed, or is not open.
#[unsafe(no_mangle)]
pub extern "C" fn truepath_board_port_failed(board: &mut Remote) {
    board.board().port_failed();
}

/// How many bytes may still be read in this tick; 0 when nothing needs to be waited for any more.
#[unsafe(no_mangle)]
pub extern "C" fn truepath_board_room(board: &mut Remote) -> usize {
    board.board().room()
}

/// Bytes that arrived.
///
/// # Safety
/// `count` bytes can be read at `bytes`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn truepath_board_take(board: &mut Remote, bytes: *const u8, count: usize) {
    // SAFETY: the caller's promise.
    board.board().take(unsafe { core::slice::from_raw_parts(bytes, count) });
}

/// Ends the tick, see [`Remote::finish`].
#[unsafe(no_mangle)]
pub extern "C" fn truepath_board_finish(board: &mut Remote, inputs: &Inputs, outputs: &mut Outputs, link: &mut Link) {
    let (driven, counters) = board.finish(inputs, outputs);
    *link = Link {
        cause: driven.cause as u32,
        answered: driven.answered.into(),
        missed: counters.missed,
        late: counters.late,
        damaged: counters.damaged.saturating_add(counters.wrong),
    };
}
