//! The comment that marks a corrected program, and its place.

use truepath_core::gcode::{CORRECTED_MARK, Lines, Token, Words};
use truepath_core::units::Offset;

/// How many lines stand before the mark: `%` and the program's name stay first, because controls look for them there.
pub(super) fn place(program: &[u8]) -> u32 {
    let mut after = 0;
    for line in Lines::new(program) {
        let tokens: Vec<_> = Words::new(line).map_while(Result::ok).collect();
        let names = tokens.iter().any(|t| matches!(t, Token::Word(w) if w.letter == b'O'));
        let percent = tokens.iter().any(|t| matches!(t, Token::Percent(_)));
        if names || percent {
            after = line.number;
        }
        if names || tokens.iter().any(|t| matches!(t, Token::Word(_))) {
            break;
        }
    }
    after
}

/// The lines of the mark.
pub(super) fn text(crc: u32, tolerance: Offset, notes: &[String], line_end: &[u8]) -> Vec<u8> {
    let facts = format!("(ORIGINAL CRC32 {crc:08X}, TOLERANCE {} MM)", tolerance.nm() as f64 / 1e6);
    let warning = "(DO NOT CORRECT AGAIN, DO NOT ARM A COPROCESSOR WITH THIS PROGRAM)".to_owned();
    let notes = notes.iter().map(|note| format!("({})", plain(note)));
    let mut text = Vec::new();
    for line in [CORRECTED_MARK.to_owned(), facts, warning].into_iter().chain(notes) {
        text.extend_from_slice(line.as_bytes());
        text.extend_from_slice(line_end);
    }
    text
}

/// What every control accepts inside a comment.
fn plain(note: &str) -> String {
    let allowed = |c: char| c.is_ascii_alphanumeric() || " .,:+-=/".contains(c);
    note.to_uppercase().chars().map(|c| if allowed(c) { c } else { ' ' }).collect()
}
