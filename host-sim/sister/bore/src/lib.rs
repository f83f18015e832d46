//! Bores milled by a circling cutter: the envelope of all teeth, its waviness and roughness, and what they depend on.
//!
//! N. Urinov, L. Dubrovets, R. Isamov, Z. Khojaeva, N. Amonov, "Simulation modeling of formation of geometric parameters of
//! surface quality at milling" (IJARSET 7(10), 2020). The paper finds the profile by solving for the time of every ray; its
//! printed result (64.121 mm) is smaller than any root can be. Here the passes of the teeth are curves in closed form, so that
//! the envelope and its crests are exact. Rigid kinematics only: no deflection, no vibration, no lead-in.
//!
//! From below: [`arc`] the curve of a pass; [`motion`] cutter and spindle; [`passes`] which passes there are; [`takeover`] and
//! [`envelope`] the profile; [`roots`] the paper's equation at one ray; [`setup`] feed and speed; [`filter`], [`circle`] and
//! [`texture`] the parameters under their ISO names; [`depth`] the profile over the height; [`dependence`] and [`wanted`] what
//! the waviness depends on, and the feed for a wanted one; [`picture`] and [`tables`] what is drawn and written.

pub mod arc;
pub mod circle;
pub mod codes;
pub mod dependence;
pub mod depth;
pub mod envelope;
pub mod filter;
pub mod motion;
pub mod passes;
pub mod picture;
mod refusal;
pub mod roots;
pub mod setup;
mod sweep;
pub mod tables;
pub mod takeover;
pub mod texture;
pub mod wanted;

pub use refusal::Refusal;
