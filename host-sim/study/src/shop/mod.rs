//! The study of a shop: what the jobs of other machines, and of the same one, are worth to the first correction of another job.
//!
//! Machines of three makes cut jobs from five materials with cutters that wear; nobody knows the machine, its user states one stiffness
//! for all its jobs and the table's coefficients for a material. Every job is corrected three times from the same points: with what the
//! job states, with what the jobs of all *other* machines say as well, and with what the other jobs of the same machine say besides.
//!
//! | piece | what it holds |
//! |---|---|
//! | [`case`] | machines, materials and jobs of a shop |
//! | [`workflow`] | the jobs, corrected three times |
//! | [`outcome`] | one line of the table |
//! | [`summary`] | what came out, in numbers, in words and as a table |

pub mod case;
pub mod outcome;
pub mod summary;
pub mod workflow;
