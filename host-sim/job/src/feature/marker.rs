//! Features marked by comments of the program: `(TRUEPATH BEGIN id)` … `(TRUEPATH END)`, or with `;`.
//!
//! `END` may repeat the name. Markers are found in the text, not in the order of execution, so that a subprogram can
//! hold them; they do not nest, and a name is used once.

use truepath_core::gcode::{KlartextBlock, Line, LineRange, Lines, Span, Token, Words};
use truepath_ground::codes::Row;
use truepath_ground::diagnostics::{InputError, Source};

use crate::codes::{N003, N004, N005, N006};
use crate::job::is_id;

/// A marked feature.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Marked {
    pub(super) id: String,
    /// From the line of BEGIN to that of END.
    pub(super) lines: LineRange,
    /// Bytes of the comment BEGIN.
    pub(super) span: std::ops::Range<usize>,
}

/// What a comment says.
enum Marker {
    Begin(String),
    End(Option<String>),
    Wrong,
}

/// All markers of a program.
pub(super) fn marked(program: &Source) -> Result<Vec<Marked>, InputError> {
    let bytes = program.bytes();
    let mut list: Vec<Marked> = Vec::new();
    let mut open: Option<Marked> = None;
    for line in Lines::new(bytes) {
        for (span, body) in comments(line) {
            let Some(marker) = marker(&String::from_utf8_lossy(body.of(bytes))) else { continue };
            let span = span.start..span.end();
            let error = |row: Row, found: String, expected: &str, help: &str| {
                Err(InputError::new(row, found, expected, help).at(program, span.clone()))
            };
            match (marker, open.take()) {
                (Marker::Wrong, _) => {
                    let expected = "TRUEPATH BEGIN id or TRUEPATH END";
                    let help = "a name has 1 to 64 letters, digits, `-`, `_` or `.`, and nothing follows it";
                    return error(N004, "this comment begins like a marker and is none".to_owned(), expected, help);
                }
                (Marker::Begin(id), Some(before)) => {
                    let (at, _) = program.line_column(before.span.start);
                    let found = format!("\"{id}\" begins inside \"{}\", which began on line {at}", before.id);
                    return error(N003, found, "TRUEPATH END before it", N003.remedy);
                }
                (Marker::Begin(id), None) => {
                    if let Some(first) = list.iter().find(|m| m.id == id) {
                        let found = format!("\"{id}\" is marked twice, first on line {}", first.lines.first);
                        return error(N006, found, "every name once", N006.remedy);
                    }
                    let lines = LineRange { first: line.number, last: line.number };
                    open = Some(Marked { id, lines, span });
                }
                (Marker::End(_), None) => {
                    let found = "TRUEPATH END without TRUEPATH BEGIN before it".to_owned();
                    return error(N004, found, "TRUEPATH BEGIN id before it", "add the beginning, or remove the end");
                }
                (Marker::End(Some(id)), Some(begun)) if id != begun.id => {
                    let found = format!("\"{id}\" ends where \"{}\" of line {} is open", begun.id, begun.lines.first);
                    return error(N004, found, "the end of the feature that is open", "correct one of the two names");
                }
                (Marker::End(_), Some(mut begun)) => {
                    begun.lines.last = line.number;
                    list.push(begun);
                }
            }
        }
    }
    match open {
        None => Ok(list),
        Some(open) => {
            let found = format!("\"{}\" begins here and never ends", open.id);
            Err(N005.error(found, "TRUEPATH END after it").at(program, open.span))
        }
    }
}

/// The comments of a line, with what is inside them; in a line that is no G-code, that of a conversational block.
pub(crate) fn comments(line: Line<'_>) -> Vec<(Span, Span)> {
    let mut found = Vec::new();
    for token in Words::new(line) {
        match token {
            Ok(Token::Comment { span, body }) => found.push((span, body)),
            Ok(_) => {}
            Err(_) => {
                let comment = KlartextBlock::of(line).ok().and_then(|block| block.comment);
                let body = |span: Span| Span { start: span.start + 1, len: span.len - 1 };
                return comment.map_or(found, |span| vec![(span, body(span))]);
            }
        }
    }
    found
}

/// What a comment marks; `None` for a comment about something else.
fn marker(comment: &str) -> Option<Marker> {
    let mut words = comment.split_whitespace();
    let is = |word: Option<&str>, name: &str| word.is_some_and(|w| w.eq_ignore_ascii_case(name));
    if !is(words.next(), "TRUEPATH") {
        return None;
    }
    let verb = words.next();
    let (id, rest) = (words.next(), words.next());
    let named = id.filter(|id| is_id(id)).map(str::to_owned);
    if is(verb, "BEGIN") {
        Some(named.filter(|_| rest.is_none()).map_or(Marker::Wrong, Marker::Begin))
    } else if is(verb, "END") {
        Some(if rest.is_some() || (id.is_some() && named.is_none()) { Marker::Wrong } else { Marker::End(named) })
    } else {
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scan(text: &str) -> Result<Vec<Marked>, InputError> {
        marked(&Source::new("p.nc", text.as_bytes().to_vec()))
    }

    #[test]
    fn both_kinds_of_comment_mark_a_feature() {
        let list =
            scan("G21\n(truepath begin a-1)\nG1 X1\n(TRUEPATH END)\n; TRUEPATH BEGIN b\nG1 X2 ;TRUEPATH END b\n")
                .unwrap();
        let found: Vec<_> = list.iter().map(|m| (m.id.as_str(), m.lines.first, m.lines.last)).collect();
        assert_eq!(found, [("a-1", 2, 4), ("b", 5, 6)]);
        let list = scan("0 BEGIN PGM A MM\n1 ; TRUEPATH BEGIN c\n2 L X+1 F100\n3 L X+2 ; TRUEPATH END\n").unwrap();
        let found: Vec<_> = list.iter().map(|m| (m.id.as_str(), m.lines.first, m.lines.last)).collect();
        assert_eq!(found, [("c", 2, 4)]);
    }

    #[test]
    fn other_comments_are_left_alone() {
        assert_eq!(scan("(TRUEPATH CORRECTED)\n(BEGIN)\n(TRUEPATHBEGIN a)\n(TRUEPATH)\n").unwrap(), []);
    }

    #[test]
    fn every_wrong_marker_has_its_code_and_place() {
        let cases = [
            ("(TRUEPATH BEGIN a)\n(TRUEPATH BEGIN b)\n", "N003", (2, 1)),
            ("G1 X1 (TRUEPATH END)\n", "N004", (1, 7)),
            ("(TRUEPATH BEGIN a)\n(TRUEPATH END b)\n", "N004", (2, 1)),
            ("(TRUEPATH BEGIN)\n", "N004", (1, 1)),
            ("(TRUEPATH BEGIN two words)\n", "N004", (1, 1)),
            ("G21\n  (TRUEPATH BEGIN a)\nG1 X1\n", "N005", (2, 3)),
            ("(TRUEPATH BEGIN a)\n(TRUEPATH END)\n(TRUEPATH BEGIN a)\n", "N006", (3, 1)),
        ];
        for (text, code, place) in cases {
            let error = scan(text).expect_err(text);
            assert_eq!((error.code(), error.line_column()), (code, Some(place)), "{text}");
        }
    }
}
