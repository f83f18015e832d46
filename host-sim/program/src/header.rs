//! The comment that marks a corrected program, and its place.

use std::ops::Range;

use truepath_core::gcode::{CORRECTED_MARK, Dialect, KlartextBlock, Line, Lines, Statement, Token, Words};

use super::edit::{Purpose, RewriteOptions};

/// How the mark of a first pass begins.
const FIRST_PASS: &str = "TRUEPATH FIRST PASS";
/// What stands before the CRC-32 of the original.
const ORIGINAL: &str = "ORIGINAL CRC32 ";

/// How many lines stand before the mark: `%` and the program's name stay first, because controls look for them there.
/// In a conversational program it stands behind BEGIN PGM.
pub(super) fn place(program: &[u8], dialect: Dialect) -> u32 {
    if dialect.is_klartext() {
        let begins = |line: &Line<'_>| {
            KlartextBlock::of(*line).is_ok_and(|block| matches!(block.statement, Statement::Begin(_)))
        };
        return Lines::new(program).find(begins).map_or(0, |line| line.number);
    }
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
pub(super) fn text(crc: u32, options: &RewriteOptions, line_end: &[u8]) -> Vec<u8> {
    let facts = format!("({ORIGINAL}{crc:08X}, TOLERANCE {} MM)", options.tolerance.nm() as f64 / 1e6);
    let named = |name: &str, crc: Option<u32>| crc.map(|crc| format!("({name} CRC32 {crc:08X})"));
    let origin = [named("JOB", options.origin.job), named("PROBE FILE", options.origin.probe)];
    let tool = format!("(WRITTEN BY TRUEPATH {})", env!("CARGO_PKG_VERSION"));
    let (mark, warning) = match options.purpose {
        Purpose::Correction => {
            (CORRECTED_MARK.to_owned(), "(DO NOT CORRECT AGAIN, DO NOT ARM A COPROCESSOR WITH THIS PROGRAM)".to_owned())
        }
        Purpose::FirstPass { left } => (
            format!("({FIRST_PASS}, LEAVES {} MM)", left.nm() as f64 / 1e6),
            "(PROBE THE WALL BEFORE THE SECOND PASS)".to_owned(),
        ),
        Purpose::Fillets { radius } => (
            format!("(TRUEPATH FILLETS, R {} MM ON THE PATH)", radius.nm() as f64 / 1e6),
            "(NOT CORRECTED YET)".to_owned(),
        ),
    };
    let notes = options.notes.iter().map(|note| format!("({})", plain(note)));
    let mut text = Vec::new();
    let lines = [mark, facts].into_iter().chain(origin.into_iter().flatten());
    for line in lines.chain([tool, warning]).chain(notes) {
        let line = if options.program.dialect.is_klartext() {
            format!("; {}", line.trim_start_matches('(').trim_end_matches(')'))
        } else {
            line
        };
        text.extend_from_slice(line.as_bytes());
        text.extend_from_slice(line_end);
    }
    text
}

/// The CRC-32 of the program whose first pass a program is, and where it is named; `None` for any other program.
pub fn first_pass_of(program: &[u8]) -> Option<(u32, Range<usize>)> {
    let place = |word: &str| program.windows(word.len()).position(|w| w.eq_ignore_ascii_case(word.as_bytes()));
    place(FIRST_PASS)?;
    let start = place(ORIGINAL)? + ORIGINAL.len();
    let digits = std::str::from_utf8(program.get(start..start + 8)?).ok()?;
    Some((u32::from_str_radix(digits, 16).ok()?, start..start + 8))
}

/// What every control accepts inside a comment.
fn plain(note: &str) -> String {
    let allowed = |c: char| c.is_ascii_alphanumeric() || " .,:+-=/".contains(c);
    note.to_uppercase().chars().map(|c| if allowed(c) { c } else { ' ' }).collect()
}
