//! The study: how well the method does on machines that the model has never seen, and where it stops working.
//!
//! Cases are drawn from fixed [`families`] by fixed [`seeds`]; each goes the user's whole way on the plant: the first part is
//! milled and probed, the program corrected, the next part milled with it and judged. What is refused or fails is kept
//! as a failure. Results are appended to a table as they come, so an interrupted study goes on where it was.

pub mod case;
pub mod case_table;
pub mod codes;
pub mod contour;
pub mod draw;
pub mod export;
pub mod families;
pub mod id;
pub mod limit;
pub mod machine;
pub mod markdown;
pub mod nuisance;
pub mod outcome;
pub mod page;
pub mod parallel;
pub mod part;
pub mod places;
pub mod plan;
pub mod plots;
pub mod prior;
pub mod reference;
pub mod seeds;
pub mod shop;
pub mod statistics;
pub mod summary;
pub mod text;
pub mod workflow;
