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
//!
//! ```
//! use truepath_model::probe::{CutWith, Format, Given, Layout, LengthUnit, Outcome, Reading, read};
//! use truepath_units::Offset;
//!
//! let given = Given {
//!     format: Format::Linuxcnc,
//!     layout: Layout::default(),
//!     work_offset: None,
//!     program_unit: LengthUnit::Millimetre,
//!     program_crc: 0,
//!     ball_diameter: Offset::from_um(6_000),
//!     cut_with: CutWith::Nothing,
//! };
//! let file = b"31.0 60.0 -5.0 0 0 0 0 0 0\n31.002 50.0 -5.0 0 0 0 0 0 0\n";
//! let mut readings = [Reading::default(); 8];
//! assert_eq!(read(file, &given, &mut readings), Ok(2));
//! assert_eq!((readings[1].position[0].nm(), readings[1].outcome), (31_002_000, Outcome::Touched));
//! ```

mod columns;
mod console;
mod contact;
mod error;
mod format;
mod heading;
mod inspection;
mod linuxcnc;
mod number;
mod read;
mod reading;
mod row;
mod suspect;
mod words;

pub use contact::{Contact, Contacts, MOST_ALIKE, Rejected, Setting};
pub use error::{ProbeError, ProbeErrorKind};
pub use format::{Columns, CutWith, DecimalSign, Format, Frame, Given, Layout, LengthUnit, PointKind, Separator};
pub use read::read;
pub use reading::{Outcome, Reading};
pub use suspect::{Suspicion, suspect};
