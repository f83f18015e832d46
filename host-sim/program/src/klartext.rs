//! Lines of conversational programs (HEIDENHAIN, `.h`), taken apart and put together again with other coordinates.
//!
//! A line of the contour keeps block number, feed, functions, side and comment; its name and its coordinates become `L`, or
//! `CC` and `C`, with absolute places. The pole of a corrected arc stands in a line of its own before it, as posts write it;
//! where a later block counts on the pole of the program, that is written again before it ([`with_poles`]).
//!
//! Block numbers: the control counts blocks itself and shows the numbers that it counts; jumps go to labels, never to
//! numbers. A program whose blocks are numbered is written with consecutive numbers again ([`numbered`]), which is what
//! a control makes of it, and one without numbers gets none: what the control has accepted as original it accepts as
//! corrected.

use truepath_core::gcode::{KlartextBlock, KlartextWord, Line, Lines, Statement, klartext_letter as letter};

/// A line with its words.
pub(super) struct KlartextLine<'a> {
    line: Line<'a>,
    block: Option<KlartextBlock<'a>>,
    words: Vec<KlartextWord>,
}

/// M functions that act when the move is over.
const AFTER_MOVE: [i64; 9] = [0, 1, 2, 5, 9, 30, 89, 99, 140];

impl<'a> KlartextLine<'a> {
    pub(super) fn new(line: Line<'a>) -> Self {
        // A line the interpreter has executed can be read.
        let block = KlartextBlock::of(line).ok();
        let words = block.iter().flat_map(KlartextBlock::words).map_while(Result::ok).collect();
        Self { line, block, words }
    }

    fn statement(&self) -> Statement {
        self.block.map_or(Statement::Empty, |block| block.statement)
    }

    /// Whether it names X (0) or Y (1), in whatever way.
    pub(super) fn names(&self, axis: usize) -> bool {
        let letters = [b"Xx", b"Yy"][axis];
        self.is_polar() || self.words.iter().any(|w| letters.contains(&w.letter))
    }

    /// Whether it leads on from where the tool stands, in X (0) or Y (1).
    pub(super) fn steps(&self, axis: usize) -> bool {
        let letter = b"xy"[axis];
        self.is_polar() || self.words.iter().any(|w| w.letter == letter)
    }

    fn is_polar(&self) -> bool {
        let polar = [letter::POLAR_RADIUS, letter::POLAR_RADIUS_STEP, letter::POLAR_ANGLE, letter::POLAR_ANGLE_STEP];
        self.words.iter().any(|w| polar.contains(&w.letter))
    }

    /// Whether it has a word of F with a number.
    pub(super) fn has_feed(&self) -> bool {
        self.words.iter().any(|w| w.letter == letter::FEED && w.value_span.len > 0)
    }

    /// The number of F.
    pub(super) fn feed(&self) -> Option<String> {
        let word = self.words.iter().find(|w| w.letter == letter::FEED && w.value_span.len > 0)?;
        let start = word.value_span.start - self.line.start;
        Some(String::from_utf8_lossy(self.line.text.get(start..start + word.value_span.len)?).into_owned())
    }

    /// Whether it has RL or RR.
    pub(super) fn switches_compensation_on(&self) -> bool {
        self.words.iter().any(|w| w.letter == letter::SIDE && !self.text(w).ends_with(b"0"))
    }

    /// Whether it is APPR or DEP.
    pub(super) fn is_lead(&self) -> bool {
        matches!(self.statement(), Statement::Approach(..) | Statement::Depart(..))
    }

    fn text(&self, word: &KlartextWord) -> &'a [u8] {
        self.line.text.get(word.span.start - self.line.start..word.span.end() - self.line.start).unwrap_or_default()
    }

    /// What stands before the name of the block: block number and `/`.
    fn start(&self) -> &'a [u8] {
        let end = self.block.map_or(0, |b| b.head.start - self.line.start);
        self.line.text.get(..end).unwrap_or_default()
    }

    /// What stands before the name of a further block of the same line: `/` and indent, no number.
    fn start_of_more(&self) -> Vec<u8> {
        let start = self.start();
        match self.block.and_then(|b| b.number) {
            Some(number) => {
                let (from, to) = (number.start - self.line.start, number.end() - self.line.start);
                [&start[..from.min(start.len())], &start[to.min(start.len())..]].concat().trim_ascii_start().to_vec()
            }
            None => start.to_vec(),
        }
    }

    fn comment(&self) -> &'a [u8] {
        let Some(comment) = self.block.and_then(|b| b.comment) else { return &[] };
        self.line.text.get(comment.start - self.line.start..).unwrap_or_default()
    }

    /// The words of a move that stay: of axes beside X and Y, R0 RL RR, F and M, in their order.
    fn kept(&self, more: bool, last: bool, feed: Option<&str>) -> Vec<Vec<u8>> {
        let mut texts = Vec::new();
        let mut named = false;
        for word in &self.words {
            let drawn = [
                b'X',
                b'Y',
                b'x',
                b'y',
                letter::POLAR_RADIUS,
                letter::POLAR_RADIUS_STEP,
                letter::POLAR_ANGLE,
                letter::POLAR_ANGLE_STEP,
                letter::RADIUS,
                letter::TURN,
                letter::LENGTH,
                letter::ANGLE,
            ];
            let after = word.letter == letter::FUNCTION && self.acts_after(word);
            if drawn.contains(&word.letter) || (after && more) || (last && !after) {
                continue;
            }
            match feed {
                Some(feed) if word.letter == letter::FEED => {
                    named = true;
                    texts.push(format!("F{feed}").into_bytes());
                }
                _ => texts.push(self.text(word).to_vec()),
            }
        }
        if let Some(feed) = feed.filter(|_| !named && !last) {
            texts.push(format!("F{feed}").into_bytes());
        }
        texts
    }

    fn acts_after(&self, word: &KlartextWord) -> bool {
        let digits: String = self.text(word).iter().filter(|b| b.is_ascii_digit()).map(|b| char::from(*b)).collect();
        digits.parse::<i64>().is_ok_and(|m| AFTER_MOVE.contains(&m))
    }

    /// The line as a move to other coordinates, and the line of its pole before it; `more` lines of the same move follow.
    pub(super) fn moved(&self, drawn: &Drawn, more: bool, feed: Option<&str>) -> Vec<Vec<u8>> {
        let move_text = drawn.words(self.kept(more, false, feed));
        let mut line = [self.start(), &move_text].concat();
        let comment = self.comment();
        if !comment.is_empty() {
            line.push(b' ');
            line.extend_from_slice(comment);
        }
        match drawn.pole() {
            // The number stays on the first line.
            Some(pole) => vec![[self.start(), &pole].concat(), self.unnumbered(&line)],
            None => vec![line],
        }
    }

    /// The first move of APPR or DEP, or another move written out; `centre` where it is the path of the cutter's centre, and
    /// RL and RR are left out.
    pub(super) fn lead(&self, drawn: &Drawn, rapid: bool, centre: bool, feed: Option<&str>) -> Vec<Vec<u8>> {
        let stripped = if centre { self.without_compensation() } else { self.line.text.to_vec() };
        let line = KlartextLine::new(Line { number: self.line.number, start: 0, text: &stripped });
        let mut texts = line.moved(drawn, false, feed);
        // The way to a lead is one of FMAX where the block before was; its own F counts behind it.
        if rapid && let Some(text) = texts.last_mut() {
            let comment = line.comment();
            let words = text.strip_suffix(comment).unwrap_or(text).trim_ascii_end();
            let kept = words.split(|b| *b == b' ').filter(|w| !w.starts_with(b"F")).collect::<Vec<_>>().join(&b' ');
            *text = [&kept[..], b" FMAX", if comment.is_empty() { b"" } else { b" " }, comment].concat();
        }
        texts
    }

    fn unnumbered(&self, line: &[u8]) -> Vec<u8> {
        let rest = line.get(self.start().len()..).unwrap_or_default();
        [&self.start_of_more()[..], rest].concat()
    }

    /// A further line of the same move; the last one has the functions that act behind it.
    pub(super) fn further(&self, drawn: &Drawn, last: bool, feed: Option<&str>) -> Vec<Vec<u8>> {
        let mut kept = if last { self.kept(false, true, None) } else { Vec::new() };
        if let Some(feed) = feed {
            kept.insert(0, format!("F{feed}").into_bytes());
        }
        let line = [&self.start_of_more()[..], &drawn.words(kept)].concat();
        drawn.pole().map(|pole| [&self.start_of_more()[..], &pole].concat()).into_iter().chain([line]).collect()
    }

    /// A line with nothing but these words.
    pub(super) fn alone(&self, words: &str) -> Vec<u8> {
        [&self.start_of_more()[..], words.as_bytes()].concat()
    }

    /// The line with other values of X and Y where they are `Some`; the rest of its bytes stay.
    pub(super) fn repositioned(&self, values: [Option<String>; 2]) -> Vec<u8> {
        if self.is_polar() {
            let [Some(x), Some(y)] = values else { return self.line.text.to_vec() };
            let drawn = Drawn { to: [x, y], arc: None };
            return self.moved(&drawn, false, None).concat();
        }
        let mut edits = Vec::new();
        let mut added = Vec::new();
        for (axis, value) in values.into_iter().enumerate() {
            let Some(value) = value else { continue };
            let letters = [b"Xx", b"Yy"][axis];
            let text = format!("{}{}", ["X", "Y"][axis], signed(&value));
            match self.words.iter().find(|w| letters.contains(&w.letter)) {
                Some(word) => edits.push((word.span.start - self.line.start..word.span.end() - self.line.start, text)),
                None => added.push(text),
            }
        }
        if !added.is_empty() {
            let beside = self.words.iter().rev().find(|w| b"XxYy".contains(&w.letter)).map(|w| w.span.end());
            let head = self.block.map_or(0, |b| b.head.end());
            let at = beside.unwrap_or(head) - self.line.start;
            edits.push((at..at, format!(" {}", added.join(" "))));
        }
        self.edited(edits)
    }

    /// The line with R0 in place of RL and RR.
    pub(super) fn without_compensation(&self) -> Vec<u8> {
        let sides = self.words.iter().filter(|w| w.letter == letter::SIDE);
        let edit = |w: &KlartextWord| (w.span.start - self.line.start..w.span.end() - self.line.start, "R0".to_owned());
        self.edited(sides.map(edit).collect())
    }

    /// The line as a comment: what it said is part of the path now.
    pub(super) fn commented(&self) -> Vec<u8> {
        let rest = self.line.text.get(self.start().len()..).unwrap_or_default();
        [self.start(), b"; ", rest].concat()
    }

    fn edited(&self, mut edits: Vec<(std::ops::Range<usize>, String)>) -> Vec<u8> {
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
}

/// A line or an arc as it is written: the values of its words.
#[derive(Clone, Debug)]
pub(super) struct Drawn {
    pub(super) to: [String; 2],
    /// The pole, and whether it turns counter-clockwise.
    pub(super) arc: Option<([String; 2], bool)>,
}

impl Drawn {
    fn words(&self, kept: Vec<Vec<u8>>) -> Vec<u8> {
        let [x, y] = self.to.each_ref().map(|v| signed(v));
        let mut parts = match self.arc {
            None => vec![format!("L X{x} Y{y}").into_bytes()],
            Some((_, counter)) => vec![format!("C X{x} Y{y} DR{}", if counter { '+' } else { '-' }).into_bytes()],
        };
        parts.extend(kept);
        parts.join(&b' ')
    }

    fn pole(&self) -> Option<Vec<u8>> {
        let ([x, y], _) = self.arc.as_ref()?;
        Some(format!("CC X{} Y{}", signed(x), signed(y)).into_bytes())
    }
}

/// A number as a TNC shows it: with its sign, without an idle point.
fn signed(value: &str) -> String {
    let value = value.trim_end_matches('.');
    if value.starts_with('-') { value.to_owned() } else { format!("+{value}") }
}

/// Whether a block counts on the pole of an earlier one.
fn uses_pole(line: &KlartextLine<'_>) -> bool {
    matches!(line.statement(), Statement::Arc | Statement::PolarArc | Statement::PolarLine | Statement::PolarTangentArc)
        || line.is_polar()
}

/// Puts the pole of the program before the blocks that count on it behind corrected arcs. `replaced` gives the new text of
/// lines.
pub(super) fn with_poles(lines: &[Line<'_>], replaced: &mut std::collections::BTreeMap<u32, Vec<Vec<u8>>>) {
    let mut pole: Option<Vec<u8>> = None;
    let mut moved = false;
    for line in lines {
        let original = KlartextLine::new(*line);
        let is_pole = |text: &[u8]| {
            let line = KlartextLine::new(Line { number: 1, start: 0, text });
            line.statement() == Statement::Pole
        };
        if let Some(parts) = replaced.get_mut(&line.number) {
            let last = parts.last().cloned().unwrap_or_default();
            if parts.iter().any(|part| is_pole(part)) {
                moved = true;
            } else if moved
                && uses_pole(&KlartextLine::new(Line { number: 1, start: 0, text: &last }))
                && let Some(pole) = &pole
            {
                parts.insert(0, pole.clone());
                moved = false;
            }
            continue;
        }
        if original.statement() == Statement::Pole {
            let whole = original.words.iter().filter(|w| matches!(w.letter, b'X' | b'Y')).count() == 2;
            pole = whole.then(|| original.alone(&String::from_utf8_lossy(original.statement_text())));
            moved = false;
        } else if moved
            && uses_pole(&original)
            && let Some(pole) = &pole
        {
            replaced.insert(line.number, vec![pole.clone(), line.text.to_vec()]);
            moved = false;
        }
    }
}

impl<'a> KlartextLine<'a> {
    /// The block without number and comment.
    fn statement_text(&self) -> &'a [u8] {
        let rest = self.line.text.get(self.start().len()..).unwrap_or_default();
        rest.strip_suffix(self.comment()).unwrap_or(rest).trim_ascii_end()
    }
}

/// A line without its block number.
pub(super) fn without_number(text: &[u8]) -> &[u8] {
    let start = text.trim_ascii_start();
    let digits = start.iter().take_while(|b| b.is_ascii_digit()).count();
    if digits == 0 { text } else { start.get(digits..).unwrap_or_default() }
}

/// The number of the first block, where blocks have numbers.
pub(super) fn first_number(program: &[u8]) -> Option<u32> {
    let mut lines = Lines::new(program).filter(|line| !line.text.trim_ascii().is_empty());
    let start = lines.next()?.text.trim_ascii_start();
    let digits = start.iter().take_while(|b| b.is_ascii_digit()).count();
    std::str::from_utf8(start.get(..digits)?).ok()?.parse().ok()
}

/// The lines of a program with consecutive block numbers from `first` on. `continued` tells which belong to the block before
/// them and have none.
pub(super) fn numbered(text: &[u8], first: u32, continued: impl Fn(&[u8]) -> bool) -> Vec<u8> {
    let mut number = first;
    let mut written = Vec::new();
    let mut open = false;
    let starts: Vec<Line<'_>> = Lines::new(text).collect();
    let ends = starts.iter().skip(1).map(|l| l.start).chain([text.len()]);
    written.extend_from_slice(&text[..starts.first().map_or(0, |l| l.start)]);
    for (line, end) in starts.iter().zip(ends) {
        let bare = without_number(line.text);
        let had = bare.len() < line.text.len();
        if !had && (open && continued(line.text) || line.text.trim_ascii().is_empty()) {
            written.extend_from_slice(line.text);
        } else {
            written.extend_from_slice(number.to_string().as_bytes());
            if !bare.starts_with(b" ") && !bare.starts_with(b"\t") {
                written.push(b' ');
            }
            written.extend_from_slice(bare);
            number += 1;
        }
        open = true;
        written.extend_from_slice(&text[line.span().end()..end]);
    }
    written
}

/// Whether a line without number goes on with the block before it: the values of a cycle.
pub(super) fn continues(text: &[u8]) -> bool {
    let start = text.trim_ascii_start();
    start.len() < text.len() || matches!(start.first(), Some(b'Q' | b'q'))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(text: &str) -> KlartextLine<'_> {
        KlartextLine::new(Line { number: 1, start: 0, text: text.as_bytes() })
    }

    fn drawn(arc: Option<(f64, f64, bool)>) -> Drawn {
        let arc = arc.map(|(x, y, ccw)| ([format!("{x}"), format!("{y}")], ccw));
        Drawn { to: ["12.5".to_owned(), "-3.".to_owned()], arc }
    }

    fn text(lines: Vec<Vec<u8>>) -> Vec<String> {
        lines.into_iter().map(|l| String::from_utf8(l).unwrap()).collect()
    }

    #[test]
    fn a_move_keeps_what_is_no_coordinate() {
        let block = line("14 L IX+10 Z-5 RL F500 M8 M9 ; wall");
        assert_eq!(text(block.moved(&drawn(None), false, None)), ["14 L X+12.5 Y-3 Z-5 RL F500 M8 M9 ; wall"]);
        assert_eq!(text(block.moved(&drawn(None), true, None)), ["14 L X+12.5 Y-3 Z-5 RL F500 M8 ; wall"]);
        assert_eq!(text(block.further(&drawn(None), true, None)), ["L X+12.5 Y-3 M9"]);
        let arc = line("CR X+1 Y+2 R+10 DR- F200");
        assert_eq!(
            text(arc.moved(&drawn(Some((1.0, 2.0, false))), false, Some("150."))),
            ["CC X+1 Y+2", "C X+12.5 Y-3 DR- F150."]
        );
    }

    #[test]
    fn only_the_places_of_a_move_beside_the_contour_change() {
        let values = |x: Option<&str>, y: Option<&str>| [x.map(str::to_owned), y.map(str::to_owned)];
        assert_eq!(
            line("7 L  IX+10 R0 FMAX").repositioned(values(Some("4."), Some("-2.5"))),
            b"7 L  X+4 Y-2.5 R0 FMAX"
        );
        assert_eq!(line("L Z+5 FMAX").repositioned(values(Some("4."), None)), b"L X+4 Z+5 FMAX");
        assert_eq!(line("L X+1 Y+2 RR F9").without_compensation(), b"L X+1 Y+2 R0 F9");
        assert_eq!(line("5 RND R2").commented(), b"5 ; RND R2");
    }

    #[test]
    fn numbered_programs_stay_numbered_and_poles_come_back() {
        let text = b"5 BEGIN PGM A MM\r\nL X+1\r\n6 CYCL DEF 200 ~\r\n  Q200=1 ~\r\n7 END PGM A MM\r\n";
        let expected = b"5 BEGIN PGM A MM\r\n6 L X+1\r\n7 CYCL DEF 200 ~\r\n  Q200=1 ~\r\n8 END PGM A MM\r\n";
        assert_eq!(first_number(text), Some(5));
        assert_eq!(numbered(text, 5, continues), expected);

        let program = b"CC X+0 Y+0 ; middle\nC X+1 Y+0 DR+\nC X+2 Y+0 DR+\nLP PR+3 PA+4\n";
        let lines: Vec<_> = Lines::new(program).collect();
        let mut replaced =
            std::collections::BTreeMap::from([(2, vec![b"CC X+9 Y+9".to_vec(), b"C X+1 Y+1 DR+".to_vec()])]);
        with_poles(&lines, &mut replaced);
        assert_eq!(replaced[&3], [b"CC X+0 Y+0".to_vec(), b"C X+2 Y+0 DR+".to_vec()]);
        assert!(!replaced.contains_key(&4));
    }
}
