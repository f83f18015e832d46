//! Programs, read and interpreted: against written results, LinuxCNC and what holds for all of them.

mod canon;
mod compensation;
mod compensation_properties;
mod compensation_start;
mod contour;
mod corner;
mod decimal;
mod disturbed;
mod errors;
mod flow;
mod interpret;
#[cfg(feature = "klartext")]
mod klartext;
mod machine;
mod plain;
mod properties;
mod search;
mod tolerance;
