//! `report.html`: the data of a run put into the page that `host-sim/page` holds ready built.
//!
//! [`Page`] and what it is made of are version 1 of the data format of `host-sim/page/README.md`, field by field;
//! [`render`] gives the file, [`render_all`] that of several contours. Long columns travel as whole numbers in base64 ([`Column`]), with as many decimals as the
//! table beside the page has, so that figures in page and table are the same. The same data give the same bytes:
//! nothing of clock, machine or folder enters.

mod by_core;
mod by_plant;
mod column;
mod contour;
mod data;
mod embed;
mod facts;
mod heights;
mod inspection;
mod job;
mod kept;
mod outcome;
mod outlook;
mod points;
mod program;
mod several;

pub use by_core::{Along, PredictedPasses, Words, nominal, predicted, simulated};
pub use by_plant::{milled, milled_twice, parted, trace_of, trace_of_part};
pub use column::Column;
pub use contour::{Contour, Heights, Outlines, PassColumns, Polyline};
pub use data::{Figure, Kind, Page, Parameter, State, Verdict};
pub use embed::{render, render_all};
pub use facts::{Cut, Fact, JobFacts, Stock, Tool};
pub use inspection::{InputFile, Inspected, Limits};
pub use job::subject;
pub use kept::MOST_SAMPLES;
pub use outcome::Outcome;
pub(crate) use outcome::known;
pub use outlook::{Outlook, WallFigures};
pub use points::{MOST_SHOWN, Point, PointStatus, judged_points, points};
pub use program::{Became, Chosen, Program, ProgramCut};
