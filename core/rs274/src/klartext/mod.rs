//! HEIDENHAIN's conversational language (Klartext, `.h`): its blocks and words, without knowing what they do.
//!
//! It is a language of its own and not a dialect of G-code words: a block begins with the name of what it does (`L`,
//! `CR`, `TOOL CALL`, `CYCL DEF`), which says what the words behind it mean. So it has a reader of lines of its own, which
//! gives the same `Sentence` to the same machine: `flow/klartext.rs` follows labels, repetitions
//! and jumps and computes Q parameters, `execute/klartext` turns a block into the words of G-code that do the same, with
//! the spans of the original, so that modes, feeds, tools, radius compensation, corners and arcs are those of every
//! other dialect and every message has the line and column of the block.
//!
//! | file | what |
//! |---|---|
//! | `kind.rs`, `statement.rs` | what blocks do, and which one a line is |
//! | `word.rs` | the words behind it |
//! | `text.rs` | names, numbers, Q parameters |
//! | `formula.rs` | what is computed with them |
//!
//! Sources: the user's manuals of iTNC 530, TNC 320/620/640 and TNC7 (conversational programming).

mod formula;
mod kind;
mod statement;
mod text;
mod word;

pub(super) use formula::{Formula, comparison};
pub use kind::{Form, Statement};
pub use statement::KlartextBlock;
pub(super) use text::{behind, number as written_number, parameter};
pub use word::{KlartextValue, KlartextWord, KlartextWords, letter};
