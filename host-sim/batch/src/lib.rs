//! A batch of parts that were cut alike and touched at the same places: what drifts from part to part, and when to act.
//!
//! | piece | what it does |
//! |---|---|
//! | [`series`] | readings of many parts → deviations at places |
//! | [`filter`] | force level, cutter size and datum from part to part (Kalman filter), and whether a part goes on as those before |
//! | [`control`] | control chart and capability of a place |
//! | [`batch`] | all of it together: state, charts, forecast, alarms in words |
//!
//! It knows nothing of milling but how a wall answers: `deviation = b + u₀·ΔL + ΔU + n·D + noise`, with the place's own offset b,
//! the deflection u₀ that the correction cancels there, the force level L, the cutter's radius lost U and the datum D.

pub mod batch;
pub mod codes;
pub mod control;
pub mod filter;
pub mod series;
