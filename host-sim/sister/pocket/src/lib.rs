//! Pocket compensation: the corrected cutter path of a whole pocket from tool and material data alone, no probe file.
//!
//! Law & Geddam 2003 (LG03): a mechanistic force model, the end mill as a cantilever, the pocket divided into straight
//! and corner sections, and a preset tolerance: a section within it stays as it is, another is shifted. Data flows one
//! way: `tool` and `beam` give the compliance, `wall` (finishing) or `slot` (full immersion) predict the error of the
//! walls along `station`s, `section` divides them, `shift` decides and refines, `sections_table`, `text` and `picture` tell.
//!
//! Limits: as good as the force coefficients, since nothing is measured: [`sensitivity`] says what 20 % do. Shifts in X
//! and Y only: what varies over the height, and the width of a slot, stay.

pub mod beam;
pub mod codes;
mod corner;
mod design;
mod envelope;
mod error;
mod machine;
mod materials;
mod picture;
mod process;
mod ramp;
mod rows;
mod section;
mod sensitivity;
mod shift;
mod slot;
mod station;
mod summary;
mod swept;
mod text;
pub mod tool;
mod wall;

pub use design::{Designed, Wanted, design};
pub use error::PocketError;
pub use machine::Machine;
pub use materials::{MaterialRow, materials, materials_text};
pub use picture::before_after;
pub use process::{Cutting, Process, Walls};
pub use rows::{CorrectionRow, SectionRow, correction_csv, section_rows, sections_csv};
pub use section::{Kind, Section, sections};
pub use sensitivity::{Sensitivity, sensitivity};
pub use slot::slotting;
pub use station::{Station, edits};
pub use summary::{CutterSummary, PocketSummary, Told, pocket_summary};
pub use text::sections_text;
pub use wall::finishing;
