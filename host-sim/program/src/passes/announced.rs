//! What a control has to be told before each pass, between the passes of a program that was written out.

use truepath_core::gcode::{LineRange, Lines, Token, Words, WrittenWord};

use super::Repeated;

/// A program whose passes are announced.
#[derive(Clone, Debug)]
pub struct Announced {
    /// Its bytes.
    pub text: Vec<u8>,
    /// Numbers of the lines before which a line was added, in the program without them.
    before: Vec<u32>,
    /// What lines said that are comments now.
    pub taken_out: Vec<String>,
}

impl Announced {
    /// Where lines of the program without announcements stand.
    pub fn lines(&self, lines: LineRange) -> [u32; 2] {
        let added = |holds: &dyn Fn(u32) -> bool| self.before.iter().filter(|line| holds(**line)).count() as u32;
        [lines.first + added(&|line| line < lines.first), lines.last + added(&|line| line <= lines.last)]
    }
}

impl Repeated {
    /// Writes `words(depth, pass)` on a line of its own where the cutter stands above the start of each pass, which must have been written
    /// out to be announced. A line with `M code` of the program's own becomes a comment, because every pass has one now.
    ///
    /// # Errors
    /// The text of a line that holds the code and more than its P and Q.
    pub fn announced(&self, code: i64, words: impl Fn(usize, usize) -> String) -> Result<Announced, String> {
        let mut told: Vec<(u32, String)> = Vec::new();
        for (at, depth) in self.depths.iter().enumerate() {
            told.extend(depth.passes.iter().enumerate().map(|(k, pass)| (pass.down, words(at, k))));
        }
        told.sort_by_key(|(line, _)| *line);
        let lines: Vec<_> = Lines::new(&self.text).collect();
        let starts: Vec<usize> = lines.iter().map(|l| l.start).chain([self.text.len()]).collect();
        let ends: Vec<&[u8]> =
            lines.iter().zip(starts.iter().skip(1)).map(|(l, &next)| &self.text[l.span().end()..next]).collect();
        let usual = ends.iter().copied().find(|end| !end.is_empty()).unwrap_or(b"\n");
        let (mut text, mut taken_out) = (Vec::new(), Vec::new());
        let mut told = told.into_iter().peekable();
        let mut before = Vec::new();
        for (line, end) in lines.iter().zip(ends) {
            while let Some((at, words)) = told.next_if(|(at, _)| *at == line.number) {
                text.extend_from_slice(words.as_bytes());
                text.extend_from_slice(usual);
                before.push(at);
            }
            let tokens: Vec<Token> = Words::new(*line).map_while(Result::ok).collect();
            let says = tokens.iter().any(|token| matches!(token, Token::Word(word) if is_code(word, code)));
            if says {
                let plain = |token: &Token| match token {
                    Token::Word(word) => is_code(word, code) || matches!(word.letter, b'N' | b'P' | b'Q'),
                    Token::Comment { .. } => true,
                    _ => false,
                };
                if !tokens.iter().all(plain) {
                    return Err(String::from_utf8_lossy(line.text).trim().to_owned());
                }
                let own = String::from_utf8_lossy(line.text).replace(['(', ')', ';'], " ").trim().to_owned();
                text.extend_from_slice(format!("({own}, NOW BEFORE EACH PASS)").as_bytes());
                taken_out.push(own);
            } else {
                text.extend_from_slice(line.text);
            }
            text.extend_from_slice(end);
        }
        Ok(Announced { text, before, taken_out })
    }
}

fn is_code(word: &WrittenWord, code: i64) -> bool {
    word.letter == b'M' && word.value.and_then(|value| value.exactly_times(1)) == Some(code)
}
