//! The cut model → correction array.
//!
//! When the correction works, the actual path *is* the nominal path, so the engagement is the nominal one:
//! `Δ(s) = −C·F(nominal engagement at s)` cancels the mean law in one shot. For the helical law the mean over height
//! is not the mean over a revolution and the envelope of the cutter counts: the shot is refined by a few passes on
//! the *predicted wall error*. P23 eqs. (8)–(12) and the first-order mirror are kept as named laws to compare with.
//!
//! ```
//! # use truepath_model::cut::{CutSetup, Milling, Path, Runout, Sample, WallLaw};
//! # use truepath_units::geometry::{Block, Contour, Curve, Point, Side, Vector};
//! # use truepath_units::{Offset, Real};
//! #
//! # let setup = CutSetup {
//! #     radius: Offset::from_um(10_000),
//! #     teeth: 6,
//! #     helix_deg: Real::from_int(30),
//! #     axial_depth: Real::from_int(10),
//! #     allowance: Offset::from_um(3_000),
//! #     spindle_rpm: Real::from_int(1500),
//! #     wall: Side::Right,
//! #     milling: Milling::of(Side::Right, true),
//! #     law: WallLaw::Mean,
//! #     runout: Runout::NONE,
//! # };
//! # let curve = Curve::line(Point::from_nm(0, 0), Point::from_nm(40_000_000, 0)).unwrap();
//! # let blocks = [Block { curve, s: Offset::ZERO, feed: Real::from_int(400), line: 1 }];
//! # let contour = Contour::new(&blocks).unwrap();
//! # let step = Offset::from_um(500);
//! # let mut buffer = vec![Sample::BLANK; Path::samples_needed(&contour, &setup, step)];
//! # let path = Path::sample(&contour, &setup, step, &mut buffer, |_| ()).unwrap();
//! # use truepath_model::cut::{Coefficients, Compliance, ForceTable, Loop, State};
//! use truepath_model::correct::{
//!     Band, Design, DesignWorkspace, InOrder, Law, Node, Predicted, Profile, Scratch, Target, Update, design,
//! };
//!
//! // `path` is a straight wall of 40 mm.
//! let coefficients = Coefficients {
//!     ktc: Real::from_int(1150),
//!     krc: Real::from_int(345),
//!     kte: Real::ZERO,
//!     kre: Real::ZERO,
//!     size_exponent: Real::ZERO,
//! };
//! let compliance = Compliance::from_stiffness(Real::from_int(1150), Real::from_int(1150));
//! let table = ForceTable::new(coefficients.size_exponent);
//! let machine = Loop { path: &path, table: &table, coefficients, compliance, undersize: Offset::ZERO };
//!
//! let wanted = Design { law: Law::Model, target: Target::Mean, band: Band::WHOLE, max_gouge: None };
//! let (samples, working) = (path.count(), path.working().len());
//! let mut workspace = DesignWorkspace {
//!     states: &mut vec![State::REST; working],
//!     displacements: &mut vec![Vector::ZERO; working],
//!     profiles: &mut vec![Profile::default(); samples],
//!     updates: &mut vec![Update::default(); samples],
//!     scratch: &mut vec![Scratch::default(); samples],
//!     residual: &[],
//!     beside_sigma: &[],
//!     reader: InOrder,
//! };
//! let (mut nodes, mut predicted) = (vec![Node::default(); samples], vec![Predicted::default(); samples]);
//! design(&machine, &wanted, &mut nodes, &mut predicted, &mut workspace, &mut |_| ());
//!
//! let middle = &predicted[samples / 2];
//! assert!(middle.before.mean.abs() > Offset::from_um(50));
//! assert!(middle.after.mean.abs() < Offset::from_um(1));
//! ```

mod corner;
mod design;
mod guard;
mod moved;
mod node;
mod paper;
mod profile;
mod reader;
mod refine;
mod scratch;
mod shrinkage;
mod uncertainty;

pub use design::{Design, DesignStep, DesignWorkspace, Law, Predicted, design};
pub use guard::{GUARD_SIGMAS, Guarded, guarded_design, guarded_given};
pub use node::{Node, commanded};
pub use paper::{PaperRatio, PaperTransfer};
pub use profile::{Band, HEIGHTS, Height, Profile, Target, add_residual, begin, finish, profile, read};
pub use reader::{Again, InOrder, WallReader};
pub use refine::Update;
pub(crate) use refine::{SMOOTHED, fill_gaps, settle_ends, smooth};
pub use scratch::Scratch;
pub use shrinkage::Damped;
