//! What the reference refuses only for a missing end, a missing F or an unknown M, mended so that it reads on.
//!
//! Real programs lack these things and controls run them; ours accepts them with a warning. The mended copy shows that
//! the motion is the same.

use super::outcome::{Bench, End};

/// What was missing or unknown.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Lack {
    /// M2, M30 or the closing `%`.
    End,
    /// F.
    Feed,
    /// An M code of a particular machine.
    UnknownM,
}

impl Lack {
    /// From the reference's message.
    pub fn of(message: &str) -> Option<Self> {
        let says = |text: &str| message.contains(text);
        if says("File ended with no percent sign") {
            Some(Self::End)
        } else if says("zero feed rate") {
            Some(Self::Feed)
        } else if says("Unknown m code") || says("M-code greater than") || says("Unknown M code") {
            Some(Self::UnknownM)
        } else {
            None
        }
    }

    /// Its name in the report.
    pub const fn name(self) -> &'static str {
        match self {
            Self::End => "no program end",
            Self::Feed => "no F",
            Self::UnknownM => "unknown M",
        }
    }
}

/// How often a program is mended at most.
const ATTEMPTS: usize = 60;

/// The text with everything of that kind mended.
pub fn mended(bench: &Bench, file: &str, text: &[u8]) -> Vec<u8> {
    let mut text = String::from_utf8_lossy(text).into_owned();
    for _ in 0..ATTEMPTS {
        let End::Refused { message, line } = bench.theirs(file, text.as_bytes()).end else { break };
        let next = match Lack::of(&message) {
            Some(Lack::End) => format!("{}\nM2\n", text.trim_end()),
            Some(Lack::Feed) => replaced(&text, &line, &format!("F1000\n{line}")),
            Some(Lack::UnknownM) => replaced(&text, &line, &without_unknown(&line, &message)),
            None => break,
        };
        if next == text {
            break;
        }
        text = next;
    }
    text.into_bytes()
}

/// The text with the first line that reads so replaced.
fn replaced(text: &str, line: &str, by: &str) -> String {
    let mut done = false;
    let lines: Vec<&str> = text.split('\n').collect();
    let new = lines.iter().map(|l| {
        let hit = !done && l.trim() == line.trim();
        done |= hit;
        if hit { by } else { l }
    });
    new.collect::<Vec<_>>().join("\n")
}

/// The line without the M word the message names and its P, Q, R, E and L.
fn without_unknown(line: &str, message: &str) -> String {
    let number: String = message.chars().rev().take_while(char::is_ascii_digit).collect();
    let number: String = number.chars().rev().collect();
    let upper = line.to_ascii_uppercase();
    let Some(at) = upper.find(&format!("M{number}")) else { return line.to_owned() };
    let rest = upper[at + 1 + number.len()..].split([';', '(']).next().unwrap_or_default();
    let own: String = rest.chars().filter(|c| !c.is_ascii_whitespace()).collect();
    let alone = own.is_empty() || own.starts_with(['P', 'Q', 'R', 'E', 'L']);
    let kept = if alone { "" } else { &line[at + 1 + number.len()..] };
    format!("{}{kept}", &line[..at])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_unknown_code_goes_with_its_words() {
        assert_eq!(without_unknown("N5 M190 P1 ; material", "Unknown m code used: M190"), "N5 ");
        assert_eq!(without_unknown("m429 g0 x1", "M-code greater than 199: M429"), " g0 x1");
    }

    #[test]
    fn only_the_first_line_that_reads_so_is_replaced() {
        assert_eq!(replaced("G1 X1\r\nG1 X1\n", "G1 X1", "F1\nG1 X1"), "F1\nG1 X1\nG1 X1\n");
    }
}
