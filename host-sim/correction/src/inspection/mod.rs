//! The judgement of a milled wall from its probe points: tolerance, uncertainty, verdict, and what it does not cover.
//!
//! `rule` judges one deviation, `judgement` the part; `set_aside` says which readings are not judged and leave a doubt,
//! `coverage` which stretches of the contour no point speaks for, and `face` over the height. Comparisons are of whole nanometres, so that a value on
//! a limit lies within it on every computer.
//!
//! Source of the rule: ISO 14253-1, acceptance and rejection zones reduced by the expanded uncertainty on both sides.
//!
//! Limits: a point is judged as it is, without filtering of the ball's radius or of roughness; the form between points is
//! not measured.

mod coverage;
mod judgement;
mod rule;
mod set_aside;

pub use coverage::{Coverage, Extent, Face, Layer, Reach, Stretch, Touched, coverage};
pub use judgement::{Count, Judgement, NamedWall, State, Verdict, judge, judge_every};
pub use rule::{PointVerdict, Rule};
pub use set_aside::SetAside;
