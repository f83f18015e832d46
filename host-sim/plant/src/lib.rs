//! The plant: a virtual machine tool that mills, is probed and is judged.
//!
//! It takes the place of the real machine in demonstrations and tests, so it shares no physics code with the core and models more
//! than the core does: teeth on a helix, edge forces, chip-size effect, cross-coupled compliance, bending over the height, runout,
//! wear, uneven stock, a yielding wall, drift, drives that lag, a probe with noise, lobes and wild touches. A correction that works here has not been judged by the model that made it.
//!
//! Frame and signs: XY plane, mm, N, rad. `t` is the direction of travel, `n` points from the cutter's centre towards the finished
//! wall, immersion φ is measured from `n` towards `t`. With the spindle clockwise, a wall on the right is climb milling. Wall
//! error is positive where material is left. Floating point throughout.
//!
//! Order of work: [`Path`] from segments, [`Cut`] and [`Machine`], [`mill`] gives [`Milled`], which has the wall errors, the
//! [`Score`], the surface for a next pass, and can be probed with [`probe`].
//!
//! ```
//! use truepath_plant::{Cut, Machine, Path, Segment, Side, Spindle, mill};
//!
//! let wall = Segment::Line { from: [0.0, 0.0], to: [60.0, 0.0] };
//! let path = Path::new(&[wall], Side::Right, 0.1)?;
//! let cut = Cut {
//!     radius_mm: 10.0, teeth: 6, helix_deg: 30.0, axial_depth_mm: 10.0,
//!     feed_mm_per_min: 400.0, feed_changes: vec![], spindle_rpm: 1500.0, spindle: Spindle::Clockwise,
//!     allowance_mm: 3.0, surface: None, memory_mm: None,
//! };
//! let machine = Machine {
//!     ktc_n_per_mm2: 1147.7, krc_n_per_mm2: 344.3,
//!     compliance_mm_per_n: Machine::compliance_of_stiffness(1150.0, 1150.0),
//!     ..Machine::rigid()
//! };
//! let score = mill(&path, &cut, &machine, None)?.score();
//! assert!(score.max_error_mm > 0.05);
//! # Ok::<(), truepath_plant::PlantError>(())
//! ```

mod allowance;
mod arcs;
mod chip;
mod driven;
mod drives;
mod dynamometer;
mod error;
mod feel;
mod flutes;
mod follow;
mod grid;
mod machine;
mod mill;
mod parallel;
mod part;
mod path;
mod place;
mod probe;
mod probe_errors;
mod score;
mod segment;
mod setup;
mod stock;
mod swept;
mod uneven_stock;
mod vector;
mod wall;
mod yielding;

pub use arcs::EngagedArcs;
pub use drives::Drives;
pub use dynamometer::Dynamometer;
pub use error::PlantError;
pub use feel::{Felt, RawStock};
pub use flutes::{Flutes, NormalTangential};
pub use machine::{BendLaw, Machine, WallLaw};
pub use mill::{Milled, Sample, Track, mill};
pub use part::{
    Equilibrium, HeightScore, Heights, LapFacts, LapSample, Part, Run, Surface, SurfaceScore, Worst, laps_along,
};
pub use path::{Path, Side};
pub use place::Place;
pub use probe::{ProbePlan, Touch, probe, probeopen_text};
pub use probe_errors::ProbeErrors;
pub use score::{Comparison, Judged, Score, judged_levels, judged_trim_mm};
pub use segment::Segment;
pub use setup::{Cut, FeedChange, Spindle};
pub use uneven_stock::UnevenStock;
pub use vector::Point;
pub use yielding::YieldingWall;
