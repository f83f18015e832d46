//! What happens to the cutter: stock → engagement → force → elastic loop → wall.
//!
//! ```
//! use truepath_model::cut::{CutSetup, Milling, Path, Runout, Sample, WallLaw};
//! use truepath_units::geometry::{Block, Contour, Curve, Point, Side, Vector};
//! use truepath_units::{Offset, Real};
//!
//! let setup = CutSetup {
//!     radius: Offset::from_um(10_000),
//!     teeth: 6,
//!     helix_deg: Real::from_int(30),
//!     axial_depth: Real::from_int(10),
//!     allowance: Offset::from_um(3_000),
//!     spindle_rpm: Real::from_int(1500),
//!     wall: Side::Right,
//!     milling: Milling::of(Side::Right, true),
//!     law: WallLaw::Mean,
//!     runout: Runout::NONE,
//! };
//! let curve = Curve::line(Point::from_nm(0, 0), Point::from_nm(40_000_000, 0)).unwrap();
//! let blocks = [Block { curve, s: Offset::ZERO, feed: Real::from_int(400), line: 1 }];
//! let contour = Contour::new(&blocks).unwrap();
//! let step = Offset::from_um(500);
//! let mut buffer = vec![Sample::BLANK; Path::samples_needed(&contour, &setup, step)];
//! let path = Path::sample(&contour, &setup, step, &mut buffer, |_| ()).unwrap();
//!
//! let index = path.index_at(Offset::from_um(20_000));
//! let frame = path.frame(index, Vector::ZERO).unwrap();
//! let degrees = path.engagement(index, Vector::ZERO, &frame) * Real::from_int(180) / Real::PI;
//! assert!((degrees - Real::ratio(45_573, 1000)).abs() < Real::ratio(1, 100)); // acos(1 − h/r)
//! ```

mod cantilever;
mod coarse_look;
mod compliance;
mod corner;
mod elastic;
mod engagement;
mod force;
mod near;
mod path;
mod sample;
mod seam;
mod setup;
mod teeth;
mod walk;
mod wall;

pub use cantilever::{Cantilever, ToolMaterial};
pub use compliance::Compliance;
pub(crate) use elastic::mixed;
pub use elastic::{Heights, Kept, Loop, Passage, State};
pub use engagement::Frame;
pub use force::{ForceTable, SplitForce, chip_area};
pub use near::Near;
pub use path::{Path, PathError};
pub use sample::Sample;
pub use setup::{Coefficients, CutSetup, Helix, Milling, Runout, WallLaw};
pub use teeth::Teeth;
pub(crate) use wall::Sought;
pub use wall::{Displacements, Envelope, WallError, left_by};
