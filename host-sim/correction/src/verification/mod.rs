//! Verification programs: where to touch a milled wall, and the program with which a control does it.
//!
//! | step | where |
//! |---|---|
//! | what the user may choose, checked | `settings` |
//! | what the part's program says besides its contour | `part_program` |
//! | heights at which the ball meets the wall | `heights` |
//! | places that may be touched at all, the others with the reason | `candidates`, `leads`, `approach` |
//! | what a touch there would tell, by the model of the job or of a fit | `estimate`, `sensitivity`, `covariance` |
//! | the choice of places, each with its reason | `choice`, `reason` |
//! | the plan: touches in order, every coordinate | `probing_setup`, `plan` |
//! | places where the stock is touched, before the pass | `stock` |
//! | further places, given what was measured: the corrected wall is to become certain | `wall_sensitivity`, `choice_next`, `next` |
//! | widths that leave two walls apart, and what would tell them | `unseparated` |
//! | dimensions to be taken by hand, a sheet for them and the file to type them into | `dimensions`, `dimension_text` |
//! | the program of a control | `dialect`, `text`, `walk`, `linuxcnc`, `grbl`, `fanuc`, `haas`, `dprnt` |
//!
//! A verification program never changes an offset, a parameter of the control or the part: it moves, touches and
//! writes. The ball comes down on the free side, at the stand-off (clearance and ball radius before the wall), and
//! moves towards the wall along its normal; a place is chosen only where this way is proved free.
//!
//! Limits: walls of the contour in the job are known, nothing else: clamps and islands are the operator's to look for.

mod approach;
mod candidates;
mod choice;
mod choice_next;
mod covariance;
mod dialect;
mod dimension_text;
mod dimensions;
mod dprnt;
mod estimate;
mod fanuc;
mod grbl;
mod haas;
mod heights;
mod leads;
mod linuxcnc;
mod next;
mod part_program;
mod plan;
mod probing_setup;
mod profile_heights;
mod reason;
mod sensitivity;
mod settings;
mod stock;
mod text;
mod unseparated;
mod walk;
mod wall_sensitivity;

pub use candidates::KeptOff;
pub use dialect::{ProbeDialect, write};
pub use dimension_text::{sheet, table};
pub use dimensions::{DimensionPlan, DimensionSettings, PlannedDimension, USUAL_DIMENSIONS, plan_dimensions};
pub use heights::{Height, ball_with_room};
pub use next::{Measured, plan_next};
pub use part_program::PartProgram;
pub use plan::{Gained, Place, Plan, Touch, plan, plan_every};
pub use reason::Unknown;
pub use settings::Settings;
pub use stock::{STOCK_HEIGHTS, plan_stock};
pub use unseparated::{unseparated, unseparated_contours};
pub use wall_sensitivity::WallSensitivity;
