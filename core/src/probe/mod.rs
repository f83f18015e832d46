//! Measurement files → contacts on the nominal contour → normal errors.
//!
//! | step | where |
//! |---|---|
//! | six formats, one reader each | [`Format`], [`read`] |
//! | point, distance from the wall, hit or miss, normal | [`Reading`] |
//! | contact, height, wall error, or why not | [`Contacts`], [`Rejected`] |
//! | what is wrong when most are off the wall | [`suspect`] |
//!
//! A file is read line by line into readings; [`Contacts`] turns a reading into an
//! [`Observation`](crate::identify::Observation)-ready contact by the nominal normal (P18 eqs. (1)–(2) shift one
//! coordinate only, which is wrong by up to 1.5 mm for a 6 mm ball on a 45° wall).

mod columns;
mod console;
mod contact;
mod error;
mod format;
mod heading;
mod inspection;
mod log;
mod number;
mod probeopen;
mod read;
mod reading;
mod row;
mod suspect;
mod words;

pub use contact::{Contact, Contacts, Rejected, Setting};
pub use error::{ProbeError, ProbeErrorKind};
pub use format::{Columns, CutWith, DecimalSign, Format, Frame, Given, Layout, LengthUnit, PointKind, Separator};
pub use read::read;
pub use reading::{Outcome, Reading};
pub use suspect::{Suspicion, suspect};
