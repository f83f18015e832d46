//! What a run shows: tables (CSV), summaries (JSON), plots (SVG), and the page (`report.html`).
//!
//! Nothing is computed here that decides a correction.

mod aqdef;
pub mod batch;
pub mod codes;
mod inspection;
pub mod next;
pub mod page;
pub mod pages;
mod planned;
pub mod plot;
mod points;
mod qif;
mod reading;
mod summary;
mod tables;
mod wall;

pub use aqdef::aqdef;
pub use inspection::{InspectSummary, ToleranceSummary, inspect_summary, statements};
pub use planned::{PlannedWall, planned_map_csv, planned_page};
pub use points::{judged_points_csv, points_csv};
pub use qif::{QifWall, qif};
pub use reading::{LawPlaces, PointRow, read_correction, read_points, read_trace, read_wall, read_walls};
pub use summary::{SimulateSummary, simulate_summary};
pub use tables::{Trace, TraceRow, compare_csv, correction_csv, trace, trace_csv, wall_map_csv, walls_csv};
pub use wall::{WallRow, wall_csv};
