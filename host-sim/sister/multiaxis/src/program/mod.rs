//! Five-axis programs: read, measured and rewritten, line by line.
//!
//! | step | where |
//! |---|---|
//! | bytes → lines → words | `lines.rs`, `block.rs`, with the lexer of the core |
//! | words → exact coordinates and modes | `quantity.rs`, `codes.rs`, `state.rs`, `apply.rs`, `motion.rs` |
//! | a move → its error and its pieces, as they are written | `split.rs`, `digits.rs` |
//! | pieces → lines | `writer.rs` |
//! | one pass, and what it found | `run.rs`, `settings.rs`, `report.rs`, `profile.rs`, `picture.rs`, `notes.rs`, `reason.rs` |
//! | programs with loops, calls and computed places | `unroll.rs`, with the interpreter of the core |
//!
//! Modes are followed here and not by the interpreter of the core, which reads only what it executes. It keeps a program
//! whole in memory, where these are streamed at any length; it refuses a code that it does not know (G43.4, G43.5, G234,
//! G68.2, G254 among them), where such a line must pass on unchanged and only its moves stay unchecked; its rotary axes
//! start at 0, where a place that the program has not said must stay unknown; and its events no longer hold the digits
//! of a word, which a rewritten line keeps. Where a program must be executed to be read, `unroll` uses its events.
//!
//! Two rules. Nothing is silently wrong: a move with a rotary axis that cannot be checked has a [`Reason`], and where
//! the program does not say where an axis stands it is unknown. And nothing is changed that need not be: only the lines
//! of moves that err too much are replaced, every other byte of the program stays.

mod apply;
mod block;
mod codes;
mod digits;
mod lines;
mod motion;
mod notes;
mod picture;
mod profile;
mod quantity;
mod reason;
mod refusal;
mod report;
mod run;
mod settings;
mod split;
mod state;
mod step;
mod unroll;
mod writer;

pub use digits::Digits;
pub use picture::picture;
pub use profile::Profile;
pub use reason::Reason;
pub use refusal::At;
pub use report::{Left, LeftMove, MoveRow, Places, Report};
pub use run::{Outcome, PassError, Sinks, run};
pub use settings::{CentrePoint, Settings};
pub use split::Splitter;
pub use state::Reading;
pub use unroll::{UnrollOptions, Unrolled, unroll};
