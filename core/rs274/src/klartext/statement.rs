//! What a conversational block does: block number, `/`, the words at its start, and its comment.

use super::super::lexical::{is_blank, trimmed};
use super::super::{GcodeError, KlartextError, Line, Span, Units};
use super::kind::{Form, Statement};
use super::text::{behind, named, number};
use super::word::KlartextWords;

/// A line taken apart.
#[derive(Clone, Copy, Debug)]
pub struct KlartextBlock<'a> {
    line: Line<'a>,
    /// Its block number.
    pub number: Option<Span>,
    /// `/`.
    pub delete: Option<Span>,
    /// What it does.
    pub statement: Statement,
    /// The words that say so; empty where axis or M words stand alone.
    pub head: Span,
    /// What stands behind them.
    rest: &'a [u8],
    /// Where that ends in the file.
    end: usize,
    /// From `;` or `*` to the end of the line.
    pub comment: Option<Span>,
}

/// Blocks that are known and not read, with how they begin.
const REFUSED: [(&[u8], KlartextError); 24] = [
    (b"PLANE", KlartextError::Plane),
    (b"FUNCTION", KlartextError::Function),
    (b"FPOL", KlartextError::FreeContour),
    (b"FSELECT", KlartextError::FreeContour),
    (b"FL", KlartextError::FreeContour),
    (b"FC", KlartextError::FreeContour),
    (b"FLT", KlartextError::FreeContour),
    (b"FCT", KlartextError::FreeContour),
    (b"SPL", KlartextError::Spline),
    (b"LN", KlartextError::Vector),
    (b"TCH", KlartextError::Touch),
    (b"PATTERN", KlartextError::Pattern),
    (b"CONTOUR", KlartextError::ContourCycle),
    (b"OCM", KlartextError::ContourCycle),
    (b"DECLARE", KlartextError::Text),
    (b"POLARKIN", KlartextError::Function),
    (b"G", KlartextError::Iso),
    (b"N", KlartextError::Iso),
    (b"IF", KlartextError::Structure),
    (b"WHILE", KlartextError::Structure),
    (b"FOR", KlartextError::Structure),
    (b"ELSE", KlartextError::Structure),
    (b"TABDATA", KlartextError::Text),
    (b"OPEN", KlartextError::Text),
];

/// Forms of APPR and DEP, with P for a polar place.
const FORMS: [(&[u8], Form, bool); 8] = [
    (b"LT", Form::Line, false),
    (b"LN", Form::Normal, false),
    (b"CT", Form::Arc, false),
    (b"LCT", Form::LineArc, false),
    (b"PLT", Form::Line, true),
    (b"PLN", Form::Normal, true),
    (b"PCT", Form::Arc, true),
    (b"PLCT", Form::LineArc, true),
];

impl<'a> KlartextBlock<'a> {
    /// Takes a line apart.
    ///
    /// # Errors
    /// A block that is not known, or is refused by its name.
    pub fn of(line: Line<'a>) -> Result<Self, GcodeError> {
        let (text, comment) = without_comment(line);
        let end = line.start.saturating_add(text.len());
        let at = |rest: &[u8]| end.saturating_sub(rest.len());
        let mut rest = trimmed(text);
        let mut delete = None;
        if rest.first() == Some(&b'/') {
            delete = Some(Span { start: at(rest), len: 1 });
            rest = trimmed(behind(rest));
        }
        let digits = rest.iter().take_while(|b| b.is_ascii_digit()).count();
        let number = (digits > 0).then(|| Span { start: at(rest), len: digits });
        rest = trimmed(rest.get(digits..).unwrap_or(&[]));
        if rest.first() == Some(&b'/') && delete.is_none() {
            delete = Some(Span { start: at(rest), len: 1 });
            rest = trimmed(behind(rest));
        }
        match head(rest) {
            Ok((statement, behind)) => {
                let head = Span { start: at(rest), len: rest.len().saturating_sub(behind.len()) };
                Ok(Self { line, number, delete, statement, head, rest: behind, end, comment })
            }
            Err(kind) => {
                let len = rest.iter().take_while(|b| !is_blank(**b)).count().max(1);
                Err(GcodeError::new(kind.into(), &line, Span { start: at(rest), len }))
            }
        }
    }

    /// Its words; a statement that has none of its own gives none.
    pub fn words(&self) -> KlartextWords<'a> {
        let none = matches!(
            self.statement,
            Statement::Empty | Statement::Begin(_) | Statement::End | Statement::Passed | Statement::Cycle(..)
        );
        let rest = if none || self.statement.is_control() { &[] } else { self.rest };
        KlartextWords::new(self.line, self.statement, rest, self.end)
    }

    /// What stands behind the statement, without the comment.
    pub(in super::super) const fn rest(&self) -> &'a [u8] {
        self.rest
    }

    /// Where the last bytes of the block, from those of a rest on, stand in the file.
    pub(in super::super) const fn span_of(&self, rest: &[u8]) -> Span {
        Span { start: self.end.saturating_sub(rest.len()), len: rest.len() }
    }
}

/// A line without its comment, and that: from `;` on, or from a `*` at the start. A `~` at the end says that the next line
/// belongs to the same block; every line of such a block is read for itself.
fn without_comment<'a>(line: Line<'a>) -> (&'a [u8], Option<Span>) {
    let text = line.text;
    let mut quoted = false;
    let semicolon = text.iter().position(|b| {
        quoted ^= *b == b'"';
        *b == b';' && !quoted
    });
    let digits = |t: &[u8]| t.iter().take_while(|b| b.is_ascii_digit()).count();
    let start = trimmed(text);
    let start = trimmed(start.get(digits(start)..).unwrap_or(&[]));
    let star = (start.first() == Some(&b'*')).then(|| text.len().saturating_sub(start.len()));
    let from = star.or(semicolon).unwrap_or(text.len());
    let (words, comment) = text.split_at_checked(from).unwrap_or((text, &[]));
    let len = ended(comment).len();
    let comment = (len > 0).then(|| Span { start: line.start.saturating_add(from), len });
    (ended(words), comment)
}

/// Without blanks and `~` at the end.
fn ended(text: &[u8]) -> &[u8] {
    let text = text.trim_ascii_end();
    text.strip_suffix(b"~").map_or(text, <[u8]>::trim_ascii_end)
}

/// The letters and digits at the start of a text, and what follows them.
fn run(text: &[u8]) -> (&[u8], &[u8]) {
    let len = text.iter().take_while(|b| b.is_ascii_alphabetic()).count();
    text.split_at_checked(len).unwrap_or((text, &[]))
}

/// What the words at the start of a block say, and what stands behind them.
fn head(text: &[u8]) -> Result<(Statement, &[u8]), KlartextError> {
    let (first, rest) = run(text);
    let is = |name: &[u8]| first.eq_ignore_ascii_case(name);
    let second = |name: &[u8]| named(trimmed(rest), name).filter(|r| !r.first().is_some_and(u8::is_ascii_alphabetic));
    let simple = |statement| Ok((statement, rest));
    if text.is_empty() {
        return simple(Statement::Empty);
    }
    for (name, statement) in [
        (&b"L"[..], Statement::Line),
        (b"C", Statement::Arc),
        (b"CR", Statement::RadiusArc),
        (b"CT", Statement::TangentArc),
        (b"LP", Statement::PolarLine),
        (b"CP", Statement::PolarArc),
        (b"CTP", Statement::PolarTangentArc),
        (b"CC", Statement::Pole),
        (b"RND", Statement::Rounding),
        (b"CHF", Statement::Chamfer),
        (b"STOP", Statement::Stop),
        (b"LBL", Statement::Label),
    ] {
        if is(name) {
            return simple(statement);
        }
    }
    if is(b"BEGIN") || is(b"END") {
        let Some(rest) = second(b"PGM") else { return Err(KlartextError::Block) };
        if is(b"END") {
            return Ok((Statement::End, rest));
        }
        let last = rest.trim_ascii_end().rsplit(|b| is_blank(*b)).next().unwrap_or(&[]);
        return if last.eq_ignore_ascii_case(b"MM") {
            Ok((Statement::Begin(Units::Millimetres), rest))
        } else if last.eq_ignore_ascii_case(b"INCH") {
            Ok((Statement::Begin(Units::Inches), rest))
        } else {
            Err(KlartextError::Unit)
        };
    }
    if is(b"TOOL") {
        return match (second(b"CALL"), second(b"DEF")) {
            (Some(rest), _) => Ok((Statement::ToolCall, rest)),
            (None, Some(rest)) => Ok((Statement::Passed, rest)),
            (None, None) => Err(KlartextError::Block),
        };
    }
    if is(b"CALL") {
        return match second(b"LBL") {
            Some(rest) => Ok((Statement::Call, rest)),
            None => Err(KlartextError::OtherProgram),
        };
    }
    if is(b"CYCL") {
        return match (second(b"DEF"), second(b"CALL")) {
            (Some(rest), _) => cycle(rest),
            (None, Some(rest)) if named(trimmed(rest), b"PAT").is_some() => Err(KlartextError::Pattern),
            (None, Some(rest)) => Ok((Statement::CycleCall, named(trimmed(rest), b"POS").unwrap_or(rest))),
            (None, None) => Err(KlartextError::Block),
        };
    }
    if is(b"APPR") || is(b"DEP") {
        let (form, rest) = run(trimmed(rest));
        let Some((_, form, polar)) = FORMS.into_iter().find(|(name, ..)| form.eq_ignore_ascii_case(name)) else {
            return Err(KlartextError::Form);
        };
        return Ok((if is(b"APPR") { Statement::Approach(form, polar) } else { Statement::Depart(form, polar) }, rest));
    }
    if is(b"FN") {
        let (behind_number, number) = number(trimmed(rest));
        let number = number.ok().and_then(|n| n.exactly_times(1)).and_then(|n| u8::try_from(n).ok());
        return match (number, trimmed(behind_number).split_first()) {
            (Some(15 | 16 | 19 | 20 | 27 | 29 | 37 | 38), _) => Ok((Statement::Passed, behind_number)),
            (Some(number @ (0..=13)), Some((b':', rest))) => Ok((Statement::Function(number), rest)),
            _ => Err(KlartextError::SystemFunction),
        };
    }
    if is(b"Q") || is(b"QL") || is(b"QR") {
        return Ok((Statement::Assignment, text));
    }
    let reset = second(b"RESET").or_else(|| second(b"MODE"));
    if is(b"BLK")
        || is(b"SEL") && second(b"TABLE").is_some()
        || is(b"QS")
        || (is(b"PLANE") || is(b"FUNCTION")) && reset.is_some()
    {
        return simple(Statement::Passed);
    }
    if let Some((_, refused)) = REFUSED.iter().find(|(name, _)| is(name)) {
        return Err(*refused);
    }
    if is(b"SEL") {
        return Err(KlartextError::OtherProgram);
    }
    // `X+10 R0 FMAX`; `M3`; `F500`.
    if [&b"X"[..], b"Y", b"Z", b"IX", b"IY", b"IZ", b"A", b"B", b"IA", b"IB", b"IC"].into_iter().any(is) {
        return Ok((Statement::Line, text));
    }
    if is(b"M") || is(b"F") || is(b"FMAX") {
        return Ok((Statement::Functions, text));
    }
    Err(KlartextError::Block)
}

/// Number and part of CYCL DEF, and what follows them.
fn cycle(text: &[u8]) -> Result<(Statement, &[u8]), KlartextError> {
    let text = trimmed(text);
    let digits = text.iter().take_while(|b| b.is_ascii_digit()).count();
    let value = |text: &[u8]| core::str::from_utf8(text).ok().and_then(|t| t.parse::<u16>().ok());
    let (number, rest) = text.split_at_checked(digits).unwrap_or((text, &[]));
    let number = value(number).ok_or(KlartextError::CycleNumber)?;
    let Some((b'.', rest)) = trimmed(rest).split_first() else { return Ok((Statement::Cycle(number, 0), rest)) };
    let digits = rest.iter().take_while(|b| b.is_ascii_digit()).count();
    let (part, rest) = rest.split_at_checked(digits).unwrap_or((rest, &[]));
    let part = value(part).and_then(|part| u8::try_from(part).ok()).ok_or(KlartextError::CycleNumber)?;
    Ok((Statement::Cycle(number, part), rest))
}
