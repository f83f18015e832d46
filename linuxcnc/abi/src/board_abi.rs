//! The controller's end of the setpoint link for C: `truepath-board.h` declares what is here.
//!
//! The caller keeps the memory: a [`Board`] lies in a block of [`BOARD_WORDS`] 64-bit words that C provides. Every
//! function but [`truepath_board_new`] is called by the servo thread, in the order begin, take…, finish; their work is
//! bounded by [`BYTES_A_TICK`](crate::board::BYTES_A_TICK).
//!
//! Pointers must be those of C's own objects, aligned and not null, and a board is used by one thread at a time; what
//! lies at them is not trusted beyond that.

use core::mem::{MaybeUninit, align_of, size_of};

use truepath_core::rewrite::{AXES, Flags, Setpoint};

use crate::board::{Board, BoardSettings, BoardSettingsError, PACKET_BYTES};

/// Words of 64 bits of the block a board lies in.
pub const BOARD_WORDS: usize = 256;

const _: () = assert!(size_of::<Board>() <= 8 * BOARD_WORDS && align_of::<Board>() <= 8);
const _: () = assert!(PACKET_BYTES == 75);

/// The block of a board.
#[repr(C, align(8))]
pub struct Block {
    words: MaybeUninit<[u64; BOARD_WORDS]>,
}

/// [`BoardSettings`] for C.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
#[expect(missing_docs, reason = "named as in BoardSettings")]
pub struct Settings {
    pub acceleration_nm_per_s2: u64,
    pub least_nm: [i64; AXES],
    pub greatest_nm: [i64; AXES],
    pub slew_nm_per_s: u32,
    pub tick_hz: u32,
    pub clamp_nm: i32,
    pub axes: u32,
}

/// What is sent in a tick.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub struct Sent {
    /// Commanded positions, machine coordinates, nm.
    pub axes_nm: [i64; AXES],
    /// Spindle speed, 10⁻³ rev/min.
    pub spindle_millirpm: u32,
    /// Checksum of the frame in force.
    pub frame_crc: u32,
    /// Bits of [`Flags`].
    pub flags: u32,
    /// Not 0: a drive may be enabled.
    pub drives_on: u32,
}

/// What goes to the drives and to the pins.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub struct Got {
    /// To be added to the commanded position of each axis, nm.
    pub correction_nm: [i32; AXES],
    /// Not 0: drive enables may be passed on.
    pub enable: u32,
    /// Why the link is lost, see [`Cause`](crate::board::Cause); 0: it is not.
    pub cause: u32,
    /// State of the board, by its last right answer.
    pub state: u32,
    /// Why its last correction ended.
    pub reason: u32,
    /// Warnings, bits of [`Status`](truepath_core::rewrite::Status).
    pub status: u32,
    /// Place on the path.
    pub node: u32,
    /// Sequence and flags of the setpoint.
    pub sequence: u32,
    /// Flags as they were sent.
    pub flags: u32,
    /// Not 0: the answer of this tick came.
    pub answered: u32,
    /// Ticks without an answer since the start.
    pub missed: u32,
    /// Answers that came too late.
    pub late: u32,
    /// Packets that were damaged, and answers that cannot be true.
    pub damaged: u32,
}

/// Puts a board into a block. 0, or why the settings are refused: 1 axes, 2 tick rate, 3 clamp, 4 speed or acceleration,
/// 5 joint limits, 6 the correction could not move at this tick rate. On an error the block holds none.
#[unsafe(no_mangle)]
pub extern "C" fn truepath_board_new(block: &mut Block, settings: &Settings) -> u32 {
    let mut joint_limits_nm = [(0, 0); AXES];
    for ((to, low), high) in joint_limits_nm.iter_mut().zip(settings.least_nm).zip(settings.greatest_nm) {
        *to = (low, high);
    }
    let settings = BoardSettings {
        axes: u8::try_from(settings.axes).unwrap_or(u8::MAX),
        tick_hz: settings.tick_hz,
        clamp_nm: settings.clamp_nm,
        slew_nm_per_s: settings.slew_nm_per_s,
        acceleration_nm_per_s2: settings.acceleration_nm_per_s2,
        joint_limits_nm,
    };
    match Board::new(settings) {
        Ok(board) => {
            // SAFETY: the block is large enough and aligned, see the assertion above.
            unsafe { (&raw mut *block).cast::<Board>().write(board) };
            0
        }
        Err(BoardSettingsError::Axes(_)) => 1,
        Err(BoardSettingsError::TickRate(_)) => 2,
        Err(BoardSettingsError::Clamp(_)) => 3,
        Err(BoardSettingsError::Caps) => 4,
        Err(BoardSettingsError::JointLimits { .. }) => 5,
        Err(BoardSettingsError::Limits(_)) => 6,
    }
}

/// Begins a tick: writes the bytes to send, gives their number.
#[unsafe(no_mangle)]
pub extern "C" fn truepath_board_begin(board: &mut Board, sent: &Sent, packet: &mut [u8; PACKET_BYTES]) -> usize {
    let setpoint = Setpoint {
        axes: sent.axes_nm,
        spindle_millirpm: sent.spindle_millirpm,
        spindle_age_ticks: 0,
        sequence: 0,
        frame_crc: sent.frame_crc,
        flags: Flags(sent.flags as u16),
    };
    board.begin(&setpoint, sent.drives_on != 0, packet)
}

/// Not all of these bytes could be sent.
#[unsafe(no_mangle)]
pub extern "C" fn truepath_board_not_sent(board: &mut Board) {
    board.not_sent();
}

/// The port failed, or is not open.
#[unsafe(no_mangle)]
pub extern "C" fn truepath_board_port_failed(board: &mut Board) {
    board.port_failed();
}

/// How many bytes may still be read in this tick; 0 when nothing needs to be waited for any more.
#[unsafe(no_mangle)]
pub extern "C" fn truepath_board_room(board: &Board) -> usize {
    board.room()
}

/// Bytes that arrived.
///
/// # Safety
/// `count` bytes can be read at `bytes`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn truepath_board_take(board: &mut Board, bytes: *const u8, count: usize) {
    // SAFETY: the caller's promise.
    board.take(unsafe { core::slice::from_raw_parts(bytes, count) });
}

/// Ends the tick.
#[unsafe(no_mangle)]
pub extern "C" fn truepath_board_finish(board: &mut Board, got: &mut Got) {
    let driven = board.finish();
    let counters = board.counters();
    *got = Got {
        correction_nm: driven.correction_nm,
        enable: driven.enable.into(),
        cause: driven.cause as u32,
        state: driven.board.mode as u32,
        reason: driven.board.reason.code().into(),
        status: driven.status.0.into(),
        node: driven.board.place.node,
        sequence: driven.sequence,
        flags: driven.flags.0.into(),
        answered: driven.answered.into(),
        missed: counters.missed,
        late: counters.late,
        damaged: counters.damaged.saturating_add(counters.wrong),
    };
}
