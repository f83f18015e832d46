//! The cut model → correction array.
//!
//! When the correction works, the actual path *is* the nominal path, so the engagement is the nominal one:
//! `Δ(s) = −C·F(nominal engagement at s)` cancels the mean law in one shot. For the helical law the mean over height
//! is not the mean over a revolution and the envelope of the cutter counts: the shot is refined by a few passes on
//! the *predicted wall error*. P23 eqs. (8)–(12) and the first-order mirror are kept as named laws to compare with.

mod design;
mod guard;
mod node;
mod paper;
mod profile;
mod prudence;
mod reader;
mod refine;
mod uncertainty;

pub use design::{Design, DesignStep, DesignWorkspace, Law, Predicted, design, design_observed};
pub use guard::{GUARD_SIGMAS, Guarded, guarded_design, guarded_given};
pub use node::{Node, commanded};
pub use paper::{PaperRatio, PaperTransfer};
pub use profile::{Band, HEIGHTS, Profile, Target, add_residual, begin, finish, profile, read_slices};
pub use prudence::Damped;
pub use reader::{InOrder, WallReader};
pub use refine::Update;
