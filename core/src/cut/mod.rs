//! What happens to the cutter: stock → engagement → force → elastic loop → wall.

mod cantilever;
mod compliance;
mod corner;
mod elastic;
mod engagement;
mod force;
mod path;
mod setup;
mod walk;
mod wall;

pub use cantilever::{Cantilever, ToolMaterial};
pub use compliance::Compliance;
pub use elastic::{Loop, Passage, State};
pub use engagement::Frame;
pub use force::{ForceTable, SplitForce, chip_area};
pub use path::{Path, PathError, Sample};
pub use setup::{Coefficients, CutSetup, Helix, Milling, WallLaw};
pub use wall::{Envelope, WallError};
