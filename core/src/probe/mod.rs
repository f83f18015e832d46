//! Measurement files → contacts on the nominal contour → normal errors.
//!
//! Two formats: LinuxCNC's PROBEOPEN (nine numbers X…W, work coordinates, program units, ball centre) and columns
//! with a header. A file is read line by line into readings; [`Contacts`] turns a reading into an
//! [`Observation`](crate::identify::Observation)-ready contact by the nominal normal (P18 eqs. (1)–(2) shift one
//! coordinate only, which is wrong by up to 1.5 mm for a 6 mm ball on a 45° wall).

mod contact;
mod error;
mod read;

pub use contact::{Contact, Contacts, Rejected, Setting, Suspicion, suspect};
pub use error::{ProbeError, ProbeErrorKind};
pub use read::{Columns, Format, LengthUnit, Reading, read};
