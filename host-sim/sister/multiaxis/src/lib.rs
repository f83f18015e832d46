//! Five axes: the error a simultaneous move makes because its joints, not its tool, move in straight lines.
//!
//! Source: Tian, "Optimization Method of Process Parameters for Multi-axis NC Machining of Complex Surfaces" (T),
//! repaired where it is wrong; every module says where. [`machine`] is the chain of joints, [`kinematics`] its forward and
//! inverse transformation, [`chord`] the error of one move, [`division`] the locations inserted against it, [`singular`]
//! the neighbourhood of the pole, [`ball`] the contact point of a ball end, [`statistics`] the figures before and after,
//! [`program`] the programs that are read and rewritten.
//!
//! Limits: a host tool in `f64`; nothing of it runs on the device.

pub mod ball;
pub mod chord;
pub mod codes;
pub mod division;
pub mod kinematics;
pub mod machine;
pub mod program;
pub mod singular;
pub mod statistics;
pub mod vector;

pub use chord::{ChordError, chord_error, chord_estimate};
pub use division::{Division, DivisionError, Insertion, Rule, divide, insert};
pub use kinematics::Pose;
pub use machine::{Joints, Machine};
