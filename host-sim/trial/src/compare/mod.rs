//! Laws of correction compared on one machine: none, a constant offset, the first-order mirror, the law of the 2023 paper,
//! and the model.
//!
//! The laws get the same measurement. What each leaves is read off the identified machine, which is the model's own
//! prediction and flatters the model, or off a virtual machine that shares no physics with it. The corrections are
//! compared as such, not as written programs: tolerances of the text and the clamp of the job play no part, but a
//! correction beyond the clamp is said to be so. The ends of the contour, max(6 mm, 0.8 · cutter radius), are left out as
//! no law can know how the cutter comes and goes.

mod laws;
mod machine;
mod score;

pub use laws::{Candidate, candidates};
pub use machine::{identified, virtual_machine};
pub use score::{Place, Row, Walls, judged, row};
