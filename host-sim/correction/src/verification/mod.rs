//! Verification programs: where to touch a milled wall, and the program with which a control does it.
//!
//! | step | where |
//! |---|---|
//! | what the user may choose, checked | `settings` |
//! | what the part's program says besides its contour | `shop` |
//! | heights at which the ball meets the wall | `heights` |
//! | places that may be touched at all, the others with the reason | `candidates`, `leads`, `approach` |
//! | what a touch there would tell, by the model of the job or of a fit | `belief`, `sensitivity`, `knowledge` |
//! | the choice of places, each with its reason | `choice`, `reason` |
//! | the plan: touches in order, every coordinate | `ground`, `plan` |
//! | further places, given what was measured: the corrected wall is to become certain | `goal`, `choice_next`, `next` |
//! | the program of a control | `dialect`, `text`, `walk`, `linuxcnc`, `grbl`, `fanuc`, `haas` |
//!
//! A verification program never changes an offset, a parameter of the control or the part: it moves, touches and
//! writes. The ball comes down on the free side, at the stand-off (clearance and ball radius before the wall), and
//! moves towards the wall along its normal; a place is chosen only where this way is proved free.
//!
//! Limits: walls of the contour in the job are known, nothing else: clamps and islands are the operator's to look for.

mod approach;
mod belief;
mod candidates;
mod choice;
mod choice_next;
mod dialect;
mod fanuc;
mod goal;
mod grbl;
mod ground;
mod haas;
mod heights;
mod knowledge;
mod leads;
mod linuxcnc;
mod next;
mod plan;
mod reason;
mod sensitivity;
mod settings;
mod shop;
mod text;
mod walk;

pub use candidates::KeptOff;
pub use dialect::{ProbeDialect, write};
pub use goal::Goal;
pub use heights::Height;
pub use next::{Measured, plan_next};
pub use plan::{Gained, Place, Plan, Touch, plan};
pub use reason::Unknown;
pub use settings::Settings;
pub use shop::Shop;
