//! The controller's end of the setpoint link (Route B): setpoint out, answer of the same tick in, or what to do without
//! one. A state machine without I/O and clock; `docs/link.md` has the frames, and a section on this end.
//!
//! Called once a tick by the servo thread: [`Board::begin`] gives the bytes to send, [`Board::take`] gets the bytes
//! that arrive until it says that the answer is there or the deadline has passed, [`Board::finish`] gives what goes to
//! the drives. Work is bounded by [`BYTES_A_TICK`]; nothing allocates, divides or panics, and no float is in it.
//!
//! | in this tick | what goes to the drives |
//! |---|---|
//! | the answer, and it is right | setpoint + its correction |
//! | none, for at most [`HOLD_TICKS`] ticks in a row | setpoint + the last correction |
//! | none for longer, or the board went to `Off` with a correction on | link lost: the drive enable is dropped, the last correction is held until the drives are off, then there is none |
//!
//! A link that is lost stays lost until the drives are off and [`RECOVERY_TICKS`] right answers in a row came without
//! correction, with nothing armed. While it is lost, every setpoint says "drives disabled, aborted", so that a board
//! which still hears ends its correction and its arming by itself.

mod answer;
mod follow;
mod settings;
mod tick;

pub use answer::{Counters, Fault, Verdict};
pub use settings::{BoardSettings, BoardSettingsError};
pub use tick::{BYTES_A_TICK, Board, Cause, Driven, HOLD_TICKS, PACKET_BYTES, RECOVERY_TICKS};
