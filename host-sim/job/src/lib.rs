//! What is cut and what was measured: the job file, the cut it means in a program of many, its contour and stock, and the
//! probe file of the milled part.
//!
//! | step | where |
//! |---|---|
//! | what the text of a program says of control, cutters and material | [`post`] |
//! | the job file, checked; what it leaves open | [`job`] |
//! | the cutter, where the contour decides it | `cutter` |
//! | the depth of the cut, where the job does not say it | `depth` |
//! | the job that a program asks for, for `truepath init` | [`draft`] |
//! | what a path under G41 is, where the job does not say it | `drawn` |
//! | the cuts of a program, and which of them the job means | [`feature`] |
//! | the surface the stock really has | [`surface`] |
//! | the stock as it was touched before the pass | [`probed_stock`], between its places [`allowance`] |
//! | the stock as the program's own roughing leaves it | [`roughed_stock`] |
//! | feeds in place of the programmed ones | [`feed`] |
//! | contour, cut and machine as the core takes them | [`pass`], at every depth [`levels`] |
//! | results of measuring machines in QIF 3 | `qif` |
//! | the format of a probe file, by its contents | `probe_format` |
//! | the points of a probe file on that contour | [`measurement`], on several of them `sharing` |
//! | dimensions taken by hand in place of points, or beside them | [`dimension`], `dimensioned` |
//! | what refuses a job, a program or a point, as an error with its place | [`refusal`] |

pub mod allowance;
pub mod codes;
mod cutter;
mod depth;
pub mod dimension;
mod dimensioned;
pub mod draft;
mod drawn;
pub mod feature;
pub mod feed;
pub mod job;
pub mod levels;
pub mod measurement;
mod otherwise;
pub mod pass;
pub mod post;
mod probe_format;
pub mod probed_stock;
mod qif;
pub mod refusal;
pub mod roughed_stock;
mod sharing;
pub mod signing;
pub mod surface;
