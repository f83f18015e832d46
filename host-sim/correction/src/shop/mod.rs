//! What the parts of a shop say of machine and material before a part of another job is touched.
//!
//! Compliance belongs to a machine, and to what is mounted in it; the coefficients of the force belong to a material. What the points of
//! a job say of their sum is kept as an information matrix ([`Said`]), and the matrices of many jobs add up: a linear mixed model with
//! effects of shop, make, machine, mounting and material, and a scatter of every job by itself (Searle, Casella & McCulloch, *Variance
//! Components*, ch. 7; Gelman & Hill, *Data Analysis Using Regression and Multilevel/Hierarchical Models*, ch. 12), gives what is to be
//! expected of the next job, and how sure ([`Shop`]). No drawing and no point is needed for it.
//!
//! It narrows where the fit begins, and never overrules the points of a part: where they are more probable without it,
//! the part is fitted without it and says so ([`Agreement`]).

mod agreement;
mod belief;
mod effects;
mod quantities;
mod said;

pub use agreement::{Agreement, CONTRADICTED};
pub(crate) use agreement::{after, agreement};
pub use belief::Belief;
pub use effects::{Member, Setting, Shop};
pub use quantities::{QUANTITIES, Quantities, Quantity};
pub use said::Said;
