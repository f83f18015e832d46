//! Probe errors and the cut model → compliance, coefficients, covariance.
//!
//! Weighted least squares with priors (Gauss–Newton on the closed elastic loop, wall envelope included). Everything
//! the user states about machine and material is only a prior; the points correct it as far as they can see it. The
//! tangential chip coefficient is held at its prior: a force twice as large on a machine twice as stiff leaves the
//! same wall, so the compliance carries the scale of both.
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
//! # use truepath_model::cut::{Coefficients, Compliance, ForceTable, State};
//! use truepath_model::identify::{Cut, Observation, PredictionWorkspace, Prior, identify, predict};
//!
//! // `path` is a straight wall of 40 mm; the machine is believed to have 3000 N/mm.
//! let stated = Coefficients {
//!     ktc: Real::from_int(1150),
//!     krc: Real::from_int(345),
//!     kte: Real::ZERO,
//!     kre: Real::ZERO,
//!     size_exponent: Real::ZERO,
//! };
//! let stiffness = Real::from_int(3000);
//! let prior = Prior::around(stated, Compliance::from_stiffness(stiffness, stiffness), setup.law);
//!
//! // Three points whose errors are half of those predicted: it is about twice as stiff.
//! let mut points = [10, 20, 30].map(|mm| {
//!     let s = Offset::from_mm(Real::from_int(mm));
//!     let normal = path.samples()[path.index_at(s)].normal;
//!     Observation::new(s, Real::ratio(1, 2), Offset::ZERO, Offset::from_um(1), normal)
//! });
//! let needed = PredictionWorkspace::needed(&path);
//! let (mut states, mut displacements) = (vec![State::REST; needed], vec![Vector::ZERO; needed]);
//! let mut workspace = PredictionWorkspace { states: &mut states, displacements: &mut displacements };
//! let table = ForceTable::new(Real::ZERO);
//! predict(&path, &table, &prior.mean, |_| Vector::ZERO, &mut points, &mut workspace);
//! for point in &mut points {
//!     point.error = point.predicted.scaled(Real::ratio(1, 2));
//! }
//! let cuts = [Cut { path, points: points.len(), part: 0 }];
//! identify(&cuts, (&prior, None), &mut [], &mut points, |_, _| Vector::ZERO, &mut workspace, &mut |_| ());
//! assert!(points.iter().all(|point| point.residual().abs() < Real::ONE));
//! ```

mod fit;
mod law;
mod neighbours;
mod observation;
mod parameters;
mod part;
mod solve;
mod spread;
mod tails;

pub use fit::{Cut, Fit, identify};
pub use law::{identify_law, speaks_for_mean};
pub use neighbours::neighbours;
pub use observation::{Observation, PredictionWorkspace, Predictor, Search, join_pairs, predict};
pub use parameters::{COUNT, Parameter, Parameters, Prior};
pub use part::{EarlierPart, Eliminated, EliminatedLevel, Level};
pub use solve::{Information, Matrix, square_root};
pub use tails::weights as prior_weights;
