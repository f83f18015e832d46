//! The error of a whole wall, at every height: how large, how sure, and what makes it.
//!
//! A mean over the height is what a shift in x and y brings to zero. What a drawing calls the profile of a surface is the largest
//! error anywhere, which a helical tooth and a bending cutter leave beside it.
//!
//! | piece | what it holds |
//! |---|---|
//! | [`wall`] | the figures of a wall that is known at every height |
//! | [`causes`] | what makes the error at its worst place |
//! | [`unmodelled`] | machines that no points tell apart, because a model is not the cut, and one that does not bend |
//! | [`draws`] | how sure the predicted error is |
//! | [`expected`] | the figures of a predicted wall |
//! | [`predicted`] | the wall of one pass, as the identified machine cuts it |
//! | [`touched`] | the same of a measurement, without any model |

pub mod causes;
pub mod draws;
pub mod expected;
pub mod predicted;
pub mod touched;
pub mod unmodelled;
pub mod wall;
