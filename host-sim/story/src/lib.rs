//! The story of a part in one file, so that it can be sent, kept and run again: program, job, probe files, corrections,
//! summaries and history.
//!
//! | piece | what it holds |
//! |---|---|
//! | [`contents`] | what was done with which files, and the files |
//! | [`container`] | the same as bytes, which come from anywhere and are trusted in nothing |
//! | [`nameless`] | programs, jobs and probe files without names and comments |

pub mod codes;
pub mod container;
pub mod contents;
pub mod nameless;
