//! Job, program and measurement → the image of a correction: what the command line and the device both run.
//!
//! ```text
//! Job ── ContourPass::read ── ContourPass::sample ── contacts ── identified ── law, design ── check_clamp ── write_image
//!        program        path           probe file   machine       correction                    bytes
//! ```
//!
//! [`image`] goes the whole way in memory lent by the caller; the command line takes the same steps one by one, because
//! it also reports what lies between. The physics is in the modules above this one; here is what a job decides: which
//! side, which step, which prior, which law, which limits.
//!
//! A [`Job`] may come over a wire: it is checked before anything is computed, and every loop is bounded by the buffers
//! lent. The time is not: on a contour of thousands of blocks a fraction of a millimetre long it grows with the square of
//! their number.

mod array;
mod check;
mod compact;
mod correction;
mod error;
mod facts;
mod identification;
mod measure;
mod pass;
mod stage;
mod whole;
mod wire;
mod workspace;

pub use array::{Written, to_nominal_feed, write_image};
pub use compact::COMPACT_BYTES;
pub use correction::{check_clamp, largest, law};
pub use error::{Buffer, JobError};
pub use facts::{
    Compensation, Correct, Cut, Force, ForceModel, Job, LARGEST_NUMBER, LawName, Machine, Part, Probe, Stickout, Tool,
    ZReference,
};
pub use identification::{Identified, identified};
pub use measure::{REACH, contacts, contacts_among, observations, on_wall, readings, same_place, setting};
pub use pass::ContourPass;
pub use stage::Stage;
pub use whole::{Made, image};
pub use workspace::{BLOCK_BYTES, Buffers, Counts, NODE_BYTES, POINT_BYTES, SAMPLE_BYTES, STATE_BYTES, Workspace};
