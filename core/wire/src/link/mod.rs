//! Both links of the coprocessor: the only place that knows their bytes. `docs/link.md` is the specification.
//!
//! The **setpoint link** carries one [`SetpointFrame`] each tick and one answer; [`Endpoint`] decides what becomes of a
//! frame. The **configuration link** carries [`Request`] and [`Response`] in postcard. Both are COBS-encoded on byte
//! streams and end with a CRC-32. Nothing here does I/O or reads a clock: bytes and times are arguments.
//!
//! Everything that is called once a tick ([`Endpoint::frame`], [`Endpoint::answer`], [`Endpoint::watch`], the
//! deframer, the recorder and the trace) has bounded loops, no division, no 128-bit product, no formatting and no panic.
//!
//! ```
//! use truepath_wire::link::{LinkError, MAX_SETPOINT_BYTES, SetpointFrame, setpoint_bytes};
//! use truepath_wire::rewrite::Setpoint;
//!
//! let setpoint = Setpoint { sequence: 7, axes: [1_000, 2_000, 3_000, 0, 0, 0], ..Setpoint::default() };
//! let mut raw = [0; MAX_SETPOINT_BYTES];
//! let bytes = SetpointFrame { axes: 3, setpoint }.encode(&mut raw).unwrap();
//! assert_eq!(bytes, setpoint_bytes(3));
//! assert_eq!(SetpointFrame::decode(&raw[..bytes], 3), Ok(setpoint));
//!
//! raw[5] ^= 1;
//! assert!(matches!(SetpointFrame::decode(&raw[..bytes], 3), Err(LinkError::Checksum { .. })));
//! ```

mod access;
mod answer;
mod counters;
mod denial;
mod device;
mod endpoint;
mod error;
mod log;
mod message;
mod packet;
mod recorder;
mod setpoint;
mod settings;
mod stream;
mod stuffing;
mod timing;
mod trace;
mod update;

pub use access::{
    AccessError, DEVICE_ID_BYTES, DeviceSession, LOGIN_BYTES, MOST_TRIES, NONCE_BYTES, SESSION_SILENCE_US, SessionEnd,
    TRY_WINDOW_US, login_message,
};
pub use answer::{AnswerFrame, FORWARD, MAX_ANSWER_BYTES, answer_bytes};
pub use counters::Counters;
pub use denial::Denial;
pub use device::{
    ActiveImage, ComputeFailure, Computed, DeviceKeys, DeviceStatus, Hello, Item, Progress, ResetCause, Slot, Stage,
};
pub use endpoint::{BEHIND, Endpoint, RESTART_AFTER, Verdict};
pub use error::LinkError;
pub use log::{Change, LOG_ENTRIES, LogEntry};
pub use message::{Ask, CHUNK_BYTES, MESSAGE_BYTES, PACKET_BYTES, Reply, Request, Response};
pub use packet::{decode, decode_request, encode, encode_request};
pub use recorder::Recorder;
pub use setpoint::{MAX_SETPOINT_BYTES, SetpointFrame, setpoint_bytes};
pub use settings::{DeviceSetting, DeviceSettings, DeviceSettingsError};
pub use stream::{Deframer, Framed};
pub use stuffing::{MAX_STUFFED, stuff, unstuff};
pub use timing::{STAMPS_AT_ONCE, Spread, Stamp, Stamps, TIMING_BINS, TIMING_EDGES_NS, Timing, TimingMeter};
pub use trace::{TRACE_SAMPLES, Trace, TraceSample};
pub use update::{Firmware, TRIAL_US, UpdateStage, UpdateStatus};

/// Version of both links; a setpoint frame of another version is refused, and `Hello` tells it.
pub const LINK_VERSION: u8 = 2;
