//! The study of plans: how often a planned wall is right at *every* height, in how much time, and whether the prediction is true.
//!
//! A case draws part, machine and points; the plant cuts the program as it is, pass by pass, with the stock as a field; the points of
//! that part are planned with; the program of the recommended choice, as it would be loaded at the machine, is cut on the same
//! plant and judged at every height. Where no choice holds the tolerance, the most accurate one is cut.
//!
//! | piece | what it holds |
//! |---|---|
//! | [`case`] | part, machine, points and tolerance of a seed |
//! | [`outcome`] | one line of the table |
//! | [`workflow`] | the whole way of a case |
//! | [`summary`] | what came out, in numbers, in words and as a table |

pub mod case;
pub mod outcome;
pub mod summary;
pub mod workflow;
