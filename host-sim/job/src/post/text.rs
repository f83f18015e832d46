//! Lines of a program, apart into words and comments, whatever dialect they are written in.

use truepath_core::gcode::{KlartextBlock, KlartextValue, Line, Lines, Statement, Units, klartext_letter as letter};

/// One line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct TextLine {
    /// From 1.
    pub(super) number: u32,
    /// Words in upper case, without blanks and comments.
    pub(super) code: String,
    /// Comments, and texts between quotation marks.
    pub(super) remarks: Vec<String>,
    /// Whether a comment holds another one.
    pub(super) nested: bool,
}

impl TextLine {
    /// Whether a code such as `G20` is among the words, with or without leading zeros.
    pub(super) fn has(&self, code: &str) -> bool {
        let (letter, number) = code.split_at(1);
        let mut rest = self.code.as_str();
        while let Some(at) = rest.find(letter) {
            rest = &rest[at + 1..];
            let digits = rest.find(|c: char| !c.is_ascii_digit() && c != '.').unwrap_or(rest.len());
            if rest[..digits].trim_start_matches('0') == number {
                return true;
            }
        }
        false
    }

    /// The whole number behind a letter, `T1`; the first one that is not inside an expression.
    pub(super) fn word(&self, letter: char) -> Option<u32> {
        let at = self.code.find(letter)? + 1;
        let digits: String = self.code[at..].chars().take_while(char::is_ascii_digit).collect();
        digits.parse().ok()
    }
}

/// All lines.
pub(super) fn lines(bytes: &[u8]) -> Vec<TextLine> {
    let begins =
        |line: Line<'_>| KlartextBlock::of(line).is_ok_and(|block| matches!(block.statement, Statement::Begin(_)));
    if Lines::new(bytes).any(begins) {
        return Lines::new(bytes).map(|line| conversational(line, bytes)).collect();
    }
    Lines::new(bytes).map(|line| apart(line.number, &decoded(line.text))).collect()
}

/// A line of a conversational program: its comment, and in place of its words what they would be in G-code where that is
/// asked for, the unit and the tool.
fn conversational(line: Line<'_>, bytes: &[u8]) -> TextLine {
    let mut text = TextLine { number: line.number, code: String::new(), remarks: Vec::new(), nested: false };
    let Ok(block) = KlartextBlock::of(line) else { return text };
    let remark = block.comment.map(|span| decoded(span.of(bytes)));
    text.remarks.extend(remark.map(|remark| remark.trim_start_matches([';', '*', ' ', '-']).trim().to_owned()));
    match block.statement {
        Statement::Begin(Units::Inches) => text.code = format!("{BEGIN_PGM}G20"),
        Statement::Begin(Units::Millimetres) => text.code = format!("{BEGIN_PGM}G21"),
        Statement::ToolCall => {
            for word in block.words().map_while(Result::ok) {
                let written = word.span.of(bytes);
                match (word.letter, word.value) {
                    (letter::TOOL, KlartextValue::Number(number)) => {
                        if let Some(number) = number.exactly_times(1) {
                            text.code = format!("T{number}M6");
                        }
                    }
                    (letter::TOOL_NAME, _) => text.remarks.push(decoded(written).trim_matches('"').to_owned()),
                    _ => {}
                }
            }
        }
        _ => {}
    }
    text
}

/// How the first block of a conversational program begins.
pub(super) const BEGIN_PGM: &str = "BEGINPGM";

/// A text in UTF-8, or as the code page of western Europe has it.
fn decoded(bytes: &[u8]) -> String {
    std::str::from_utf8(bytes).map_or_else(|_| bytes.iter().copied().map(char::from).collect(), str::to_owned)
}

/// Upper case, umlauts written out.
pub(crate) fn plain(text: &str) -> String {
    text.to_uppercase().replace('Ä', "AE").replace('Ö', "OE").replace('Ü', "UE")
}

fn apart(number: u32, text: &str) -> TextLine {
    let mut line = TextLine { number, code: String::new(), remarks: Vec::new(), nested: false };
    let (mut depth, mut remark, mut quoted) = (0u32, String::new(), false);
    let mut letters = text.chars();
    while let Some(letter) = letters.next() {
        match (letter, depth) {
            ('"', 0) => {
                quoted = !quoted;
                if !quoted {
                    line.remarks.push(std::mem::take(&mut remark));
                }
                line.code.push('"');
            }
            (_, 0) if quoted => remark.push(letter),
            ('(', 0) => depth = 1,
            ('(', _) => {
                line.nested = true;
                depth += 1;
                remark.push(letter);
            }
            (')', 1) => {
                depth = 0;
                line.remarks.push(std::mem::take(&mut remark));
            }
            (')', 2..) => {
                depth -= 1;
                remark.push(letter);
            }
            (';', 0) => {
                line.remarks.push(letters.by_ref().collect());
            }
            (_, 0) if letter.is_whitespace() => {}
            (_, 0) => line.code.extend(letter.to_uppercase()),
            _ => remark.push(letter),
        }
    }
    if !remark.is_empty() {
        line.remarks.push(remark);
    }
    line.remarks.iter_mut().for_each(|remark| *remark = remark.trim().to_owned());
    line
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comments_of_every_manner_are_taken_off_the_words() {
        let line = apart(3, "g0 x1 (a (b) c) t=\"mill_8\" ; d");
        assert_eq!((line.code.as_str(), line.nested), ("G0X1T=\"\"", true));
        assert_eq!(line.remarks, ["a (b) c", "mill_8", "d"]);
        assert_eq!(apart(1, "G1 (never closed").remarks, ["never closed"]);
    }

    #[test]
    fn a_conversational_program_says_its_unit_and_its_tools() {
        let read = lines(b"0 BEGIN PGM A INCH\n1 ; T5 D=10\n2 TOOL CALL 5 Z S100 ; here\n3 * - Wall\n4 L X+5 R0\n");
        let codes: Vec<_> = read.iter().map(|l| l.code.as_str()).collect();
        assert_eq!(codes, ["BEGINPGMG20", "", "T5M6", "", ""]);
        let remarks: Vec<_> = read.iter().flat_map(|l| l.remarks.iter().map(String::as_str)).collect();
        assert_eq!(remarks, ["T5 D=10", "here", "Wall"]);
        assert!(read[0].has("G20"));
    }

    #[test]
    fn a_code_is_found_with_leading_zeros_and_not_inside_another() {
        assert!(apart(1, "N1G00G021").has("G21"));
        assert!(!apart(1, "G210 X21").has("G21"));
        assert_eq!(apart(1, "N40 T05 M06").word('T'), Some(5));
    }
}
