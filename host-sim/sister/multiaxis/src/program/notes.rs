//! What a user should look at in a program, each kind once with its first line and how often.

use std::collections::BTreeMap;
use std::fmt;

/// A kind of remark.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Note {
    /// A cutting move before any F.
    FeedMissing,
    /// A block with `/`.
    BlockDelete,
    /// A G code, in tenths, that is not known here.
    UnknownCode(u16),
    /// Tool centre point control is switched on.
    CentrePoint,
    /// Only rotary axes move.
    RotaryAlone,
    /// Text behind M2, M30 or the closing `%`.
    TextBehindEnd,
}

impl fmt::Display for Note {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::FeedMissing => f.write_str("a cutting move before any F; many controls refuse it"),
            Self::BlockDelete => {
                f.write_str("a block with /: the moves behind it are divided for one position of the switch")
            }
            Self::UnknownCode(tenths) => {
                let (whole, tenth) = (tenths / 10, tenths % 10);
                let code = if tenth == 0 { format!("G{whole}") } else { format!("G{whole}.{tenth}") };
                write!(
                    f,
                    "{code} is not known here; it is passed on, and the axes of its block count as unknown behind it"
                )
            }
            Self::CentrePoint => f.write_str("the program switches on tool centre point control"),
            Self::RotaryAlone => f.write_str(
                "a feed move of rotary axes alone: it is taken as meant, turning about the axis, and left as it is",
            ),
            Self::TextBehindEnd => f.write_str("text behind the end of the program: it is passed on unread"),
        }
    }
}

/// The remarks of a program.
#[derive(Clone, Debug, Default)]
pub struct Notes(BTreeMap<Note, (u32, u64)>);

/// Kinds kept; unknown codes could be many.
const KINDS: usize = 64;

impl Notes {
    /// Adds one.
    pub fn add(&mut self, note: Note, line: u32) {
        if let Some(entry) = self.0.get_mut(&note) {
            entry.1 += 1;
        } else if self.0.len() < KINDS {
            self.0.insert(note, (line, 1));
        }
    }
    /// All of them: what, the first line, how often.
    pub fn iter(&self) -> impl Iterator<Item = (Note, u32, u64)> + '_ {
        self.0.iter().map(|(note, (line, count))| (*note, *line, *count))
    }
}
