//! Engagement, force, elastic loop and correction against reference numbers and invariances.

mod again;
mod corner;
mod cut_reference;
mod engagement_properties;
mod guard;
mod invariance;
mod laws;
mod process;
mod runout;
mod seam;
mod widths;
