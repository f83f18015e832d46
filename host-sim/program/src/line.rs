//! One line of a program, taken apart into words and put together again with other coordinates.
//!
//! What is not a coordinate keeps its bytes: block number, comments, feed, spaces, case, `G01` or `G1`.

use std::ops::Range;

use truepath_core::gcode::{Line, Motion, Token, Words, WrittenWord};

use super::klartext::KlartextLine;

/// A line with its tokens.
pub(super) struct Block<'a> {
    line: Line<'a>,
    tokens: Vec<Token>,
    style: Style,
    klartext: Option<KlartextLine<'a>>,
}

/// How the lines of a program are written.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Manner {
    /// `G01` rather than `G1`, where a line has no G word of its own.
    pub(super) two_digits: bool,
    /// Conversational blocks instead of words of G-code.
    pub(super) klartext: bool,
}

/// How the words of a line are spelt.
#[derive(Clone, Copy)]
struct Style {
    /// Between two words.
    gap: &'static str,
    lower: bool,
    /// `G01` rather than `G1`.
    two_digits: bool,
    /// The line ends with `;`.
    ends_with_semicolon: bool,
}

/// Words that say where a move goes.
const GEOMETRY: &[u8] = b"XYIJR";
/// Ten times the G codes that only say how a path is written: motion, G40 to G42.1, G90, G91.
const PATH_CODES: [i64; 11] = [0, 10, 20, 30, 400, 410, 411, 420, 421, 900, 910];
/// M codes that act when the move is over: stops, end, spindle and coolant off.
const AFTER_MOVE: [i64; 7] = [0, 1, 2, 5, 9, 30, 60];

impl<'a> Block<'a> {
    /// Takes a line apart.
    pub(super) fn new(line: Line<'a>, manner: Manner) -> Self {
        let Manner { two_digits, klartext } = manner;
        // A line the interpreter has executed has no unreadable token.
        let tokens: Vec<Token> = if klartext { Vec::new() } else { Words::new(line).map_while(Result::ok).collect() };
        let style = Style { gap: " ", lower: false, two_digits, ends_with_semicolon: false };
        let mut block = Self { line, tokens, style, klartext: klartext.then(|| KlartextLine::new(line)) };
        block.style = block.spelling();
        block
    }

    fn spelling(&self) -> Style {
        let text = |range: Range<usize>| self.line.text.get(range).unwrap_or_default();
        let spans: Vec<Range<usize>> = self.tokens.iter().map(|t| self.range(t)).collect();
        let touching = spans.windows(2).any(|pair| pair[0].end == pair[1].start);
        let apart = spans.windows(2).any(|pair| pair[0].end < pair[1].start);
        let letters = || self.words().map(|w| text(self.word_range(w))[0]);
        let motion =
            self.motion_word().map(|w| text(self.word_range(w)).iter().filter(|b| b.is_ascii_digit()).count() > 1);
        Style {
            gap: if touching && !apart { "" } else { " " },
            lower: letters().next().is_some() && letters().all(|l| l.is_ascii_lowercase()),
            two_digits: motion.unwrap_or(self.style.two_digits),
            ends_with_semicolon: matches!(self.tokens.last(), Some(Token::Comment { body, span }) if body.len == 0 && span.len == 1),
        }
    }

    fn range(&self, token: &Token) -> Range<usize> {
        let span = token.span();
        span.start - self.line.start..span.end() - self.line.start
    }
    fn word_range(&self, word: &WrittenWord) -> Range<usize> {
        word.span.start - self.line.start..word.span.end() - self.line.start
    }
    fn words(&self) -> impl Iterator<Item = &WrittenWord> {
        self.tokens.iter().filter_map(|t| if let Token::Word(w) = t { Some(w) } else { None })
    }
    /// The word of a letter, if the line has it.
    pub(super) fn word(&self, letter: u8) -> Option<&WrittenWord> {
        self.words().find(|w| w.letter == letter)
    }
    /// The line as a conversational block.
    pub(super) const fn klartext(&self) -> Option<&KlartextLine<'a>> {
        self.klartext.as_ref()
    }
    /// Whether it names X (0) or Y (1).
    pub(super) fn names_axis(&self, axis: usize) -> bool {
        match &self.klartext {
            Some(line) => line.names(axis),
            None => self.word([b'X', b'Y'][axis]).is_some(),
        }
    }
    /// Whether it has a word of F.
    pub(super) fn has_feed(&self) -> bool {
        self.klartext.as_ref().map_or_else(|| self.word(b'F').is_some(), KlartextLine::has_feed)
    }
    /// G0, G1, G2 or G3, if the line has it.
    pub(super) fn motion_word(&self) -> Option<&WrittenWord> {
        self.words().find(|w| w.letter == b'G' && whole(w).is_some_and(|n| (0..=3).contains(&n)))
    }
    /// Whether the line says itself how it moves. A G word that is computed counts: what it names is not known here.
    pub(super) fn names(&self, motion: Motion) -> bool {
        if self.klartext.is_some() {
            return true;
        }
        let tenths = Some(i64::from(motion.code().tenths()));
        let names = |w: &WrittenWord| w.value.is_none() || w.value.and_then(|v| v.exactly_times(10)) == tenths;
        self.motion_word().is_some() || self.words().any(|w| w.letter == b'G' && names(w))
    }
    /// Whether a G word of the line is a parameter or an expression.
    pub(super) fn has_computed_code(&self) -> bool {
        self.words().any(|w| w.letter == b'G' && w.value.is_none())
    }
    /// Whether the control cuts the corner to the next line (`,R`, `,C`).
    pub(super) fn has_corner(&self) -> bool {
        self.tokens.iter().any(|t| matches!(t, Token::Corner(_)))
    }
    /// Whether it steers the program, sets a parameter, or computes what is more than a place or a feed.
    pub(super) fn computes(&self) -> bool {
        self.tokens.iter().any(|token| match token {
            Token::Assignment(_) | Token::Control(_) => true,
            Token::Word(word) => word.value.is_none() && b"GMSTDHPLO".contains(&word.letter),
            _ => false,
        })
    }
    /// Its N word as it is written.
    pub(super) fn number(&self) -> Option<&'a [u8]> {
        self.line.text.get(self.word_range(self.word(b'N')?))
    }
    /// Its D word as it is written.
    pub(super) fn offset_word(&self) -> Option<&'a [u8]> {
        self.line.text.get(self.word_range(self.word(b'D')?))
    }
    /// Its comments as they are written; `;` alone is none.
    pub(super) fn comments(&self) -> impl Iterator<Item = &'a [u8]> {
        let text = self.line.text;
        self.tokens.iter().filter_map(move |token| match token {
            Token::Comment { body, .. } if body.len > 0 => text.get(self.range(token)),
            _ => None,
        })
    }
    /// The words that neither lead along a path nor say how it is written, as they are written: those that act when the move
    /// is over, or the others.
    pub(super) fn functions(&self, behind: bool) -> Vec<&'a [u8]> {
        let switches = self.switches_compensation_on();
        let leads = |word: &&WrittenWord| match word.letter {
            b'G' => word.value.and_then(|v| v.exactly_times(10)).is_some_and(|code| PATH_CODES.contains(&code)),
            b'D' => switches,
            letter => b"NXYZIJKRF".contains(&letter),
        };
        let others = self.words().filter(|word| !leads(word) && acts_after_move(word) == behind);
        others.filter_map(|word| self.line.text.get(self.word_range(word))).collect()
    }
    /// The words of a line that goes up by Z alone, to a place of the machine, whatever was in force before it.
    pub(super) fn way_up(&self) -> Option<String> {
        let has = |code: i64| {
            let is = |word: &&WrittenWord| word.value.and_then(|v| v.exactly_times(1)) == Some(code);
            self.words().filter(|word| word.letter == b'G').any(|word| is(&word))
        };
        let alone = self.words().all(|word| b"NGZ".contains(&word.letter)) && self.word(b'Z').is_some();
        let certain = (has(91) && (has(28) || has(30))) || (has(53) && has(0));
        let words = self.words().filter(|word| word.letter != b'N');
        let words = words.filter_map(|word| self.line.text.get(self.word_range(word)));
        let words: Vec<_> = words.map(String::from_utf8_lossy).collect();
        (alone && certain).then(|| words.join(" ").to_ascii_uppercase())
    }
    /// Whether the line begins with `/`.
    pub(super) fn may_be_skipped(&self) -> bool {
        matches!(self.tokens.first(), Some(Token::BlockDelete { .. }))
    }
    /// Whether it has G41, G42, G41.1 or G42.1.
    pub(super) fn switches_compensation_on(&self) -> bool {
        if let Some(line) = &self.klartext {
            return line.switches_compensation_on();
        }
        self.words().any(compensates)
    }
    /// The line without the words that switch compensation on, and without D.
    pub(super) fn without_compensation(&self) -> Vec<u8> {
        if let Some(line) = &self.klartext {
            return line.without_compensation();
        }
        let words = self.words().filter(|w| compensates(w) || w.letter == b'D');
        let edits = words.map(|w| (self.with_blanks_before(self.word_range(w)), String::new()));
        self.edited(edits.collect())
    }
    /// Whether its G words are written with two digits.
    pub(super) const fn two_digits(&self) -> bool {
        self.style.two_digits
    }

    /// The line with its coordinates replaced by `coordinates` (words separated by one space) and its motion by
    /// `motion`, which is written only where the line names one or `needed`. Codes that act after the move are left
    /// out when `more` lines of the same move follow; they belong to the last one. `feed` is the value of its F word,
    /// where that becomes another one.
    pub(super) fn moved(
        &self,
        motion: Motion,
        needed: bool,
        coordinates: &str,
        more: bool,
        feed: Option<&str>,
    ) -> Vec<u8> {
        let mut edits: Vec<(Range<usize>, String)> = Vec::new();
        let mut coordinates = coordinates.to_owned();
        match (feed, self.word(b'F')) {
            (Some(feed), Some(word)) => edits.push((self.word_range(word), self.spelt(&format!("F{feed}")))),
            (Some(feed), None) => coordinates += &format!(" F{feed}"),
            (None, _) => {}
        }
        let named = self.motion_word();
        if let Some(word) = named
            && word.value.and_then(|v| v.exactly_times(10)) != Some(i64::from(motion.code().tenths()))
        {
            edits.push((self.word_range(word), self.spelt(&self.motion_text(motion))));
        }
        let mut text = self.spelt(&coordinates);
        if named.is_none() && needed {
            text = format!("{}{}{text}", self.spelt(&self.motion_text(motion)), self.style.gap);
        }
        for word in self.words() {
            let range = self.word_range(word);
            if GEOMETRY.contains(&word.letter) {
                // The first one gives its place to all of them.
                match std::mem::take(&mut text) {
                    new if new.is_empty() => edits.push((self.with_blanks_before(range), String::new())),
                    new => edits.push((range, new)),
                }
            } else if more && acts_after_move(word) {
                edits.push((self.with_blanks_before(range), String::new()));
            }
        }
        // A corner that the control was to round is part of the path now.
        for token in &self.tokens {
            if let Token::Corner(_) = token {
                edits.push((self.with_blanks_before(self.range(token)), String::new()));
            }
        }
        self.edited(edits)
    }

    /// A further line of the same move.
    pub(super) fn further(&self, motion: Motion, coordinates: &str, last: bool) -> Vec<u8> {
        let mut text = self.start();
        text.extend_from_slice(self.spelt(&format!("{} {coordinates}", self.motion_text(motion))).as_bytes());
        if last {
            for word in self.words().filter(|w| acts_after_move(w)) {
                text.extend_from_slice(self.style.gap.as_bytes());
                text.extend_from_slice(self.line.text.get(self.word_range(word)).unwrap_or_default());
            }
        }
        self.end(text)
    }

    /// A line with nothing but these words.
    pub(super) fn alone(&self, words: &str) -> Vec<u8> {
        if let Some(line) = &self.klartext {
            return line.alone(words);
        }
        let mut text = self.start();
        text.extend_from_slice(self.spelt(words).as_bytes());
        self.end(text)
    }

    /// What stands before the words of a further line: indent and `/`.
    fn start(&self) -> Vec<u8> {
        let indent = self.line.text.iter().take_while(|b| matches!(b, b' ' | b'\t')).count();
        let mut text = self.line.text.get(..indent).unwrap_or_default().to_vec();
        if let Some(token @ Token::BlockDelete { .. }) = self.tokens.first() {
            text.extend_from_slice(self.line.text.get(self.range(token)).unwrap_or_default());
        }
        text
    }
    fn end(&self, mut text: Vec<u8>) -> Vec<u8> {
        if self.style.ends_with_semicolon {
            text.push(b';');
        }
        text
    }

    /// The line with the values of X and Y replaced where they are `Some`; a missing word is added beside the other.
    pub(super) fn repositioned(&self, values: [Option<String>; 2]) -> Vec<u8> {
        if let Some(line) = &self.klartext {
            return line.repositioned(values);
        }
        let mut edits = Vec::new();
        let mut added = String::new();
        for (letter, value) in [b'X', b'Y'].into_iter().zip(values) {
            let Some(value) = value else { continue };
            let text = format!("{}{value}", char::from(letter));
            match self.word(letter) {
                Some(word) => edits.push((self.word_range(word), self.spelt(&text))),
                None => added = format!("{}{}", self.style.gap, self.spelt(&text)),
            }
        }
        if let Some(beside) = self.words().find(|w| matches!(w.letter, b'X' | b'Y'))
            && !added.is_empty()
        {
            let end = self.word_range(beside).end;
            edits.push((end..end, added));
        }
        self.edited(edits)
    }

    /// The line with the values of some of its words replaced; words it does not have are not added.
    pub(super) fn with_values<const N: usize>(&self, values: [(u8, String); N]) -> Vec<u8> {
        let edit = |(letter, value): (u8, String)| {
            let range = self.word_range(self.word(letter)?);
            Some((range, self.spelt(&format!("{}{value}", char::from(letter)))))
        };
        self.edited(values.into_iter().filter_map(edit).collect())
    }

    /// Its bytes.
    pub(super) const fn text(&self) -> &'a [u8] {
        self.line.text
    }

    /// The line with a motion code before its first axis or centre word.
    pub(super) fn with_motion(&self, motion: Motion) -> Vec<u8> {
        let first = self.words().find(|w| b"XYZIJR".contains(&w.letter));
        let edits = first.map(|word| {
            let at = self.word_range(word).start;
            (at..at, format!("{}{}", self.spelt(&self.motion_text(motion)), self.style.gap))
        });
        self.edited(edits.into_iter().collect())
    }

    fn edited(&self, mut edits: Vec<(Range<usize>, String)>) -> Vec<u8> {
        edits.sort_by_key(|(range, _)| (range.start, range.end));
        let (mut text, mut at) = (Vec::new(), 0);
        for (range, new) in edits {
            text.extend_from_slice(self.line.text.get(at..range.start).unwrap_or_default());
            text.extend_from_slice(new.as_bytes());
            at = range.end;
        }
        text.extend_from_slice(self.line.text.get(at..).unwrap_or_default());
        text
    }

    fn with_blanks_before(&self, range: Range<usize>) -> Range<usize> {
        let before = self.line.text.get(..range.start).unwrap_or_default();
        let blanks = before.iter().rev().take_while(|b| matches!(b, b' ' | b'\t')).count();
        range.start - blanks..range.end
    }

    fn motion_text(&self, motion: Motion) -> String {
        let code = motion.code();
        let zero = if self.style.two_digits && code.tenths() < 100 { "0" } else { "" };
        code.to_string().replacen('G', &format!("G{zero}"), 1)
    }

    /// In the line's case and with its gaps.
    fn spelt(&self, words: &str) -> String {
        let words = words.replace(' ', self.style.gap);
        if self.style.lower { words.to_lowercase() } else { words }
    }
}

fn compensates(word: &WrittenWord) -> bool {
    let tenths = word.value.and_then(|v| v.exactly_times(10));
    word.letter == b'G' && matches!(tenths, Some(410 | 411 | 420 | 421))
}

fn acts_after_move(word: &WrittenWord) -> bool {
    word.letter == b'M' && whole(word).is_some_and(|m| AFTER_MOVE.contains(&m))
}

/// The number of a word, when it is written and whole.
fn whole(word: &WrittenWord) -> Option<i64> {
    word.value?.exactly_times(1)
}
