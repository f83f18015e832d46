//! The lines that replace the line of a divided move.
//!
//! The first of them is the line itself with other numbers behind its axis letters: N word, modal codes, F, S, T, M
//! codes, comment, letter case and blanks stay where they are. Axes that the line leaves out but that do not stand still
//! any more follow the last axis word. The further lines have the axis words only; the last of them is where the line
//! went. To the last line go the words that act when the move is done: M0, M1, M2, M30, M60 and G9, and M5 and M9 except
//! for LinuxCNC and Mach. A line with `/` is replaced by lines with `/`, since it is switched off as a whole. Under G93
//! every line gets the F of its share: the pieces together take the time of the move.

use truepath_core::gcode::{Decimal, Dialect, FeedMode, Units};

use super::block::{AXES, Block, Word};
use super::codes::{Meaning, meaning};
use super::quantity::{Quantity, Scale};
use super::split::Plan;
use super::state::Place;
use super::step::Move;

/// A line that is replaced, and the modes it is read under.
#[derive(Clone, Copy, Debug)]
pub struct Original<'l> {
    /// Counted from 1.
    pub number: u32,
    /// Its bytes.
    pub text: &'l [u8],
    /// Its words.
    pub block: &'l Block,
    /// What ends a line of the program.
    pub end: &'l [u8],
    /// G20, G21.
    pub units: Units,
    /// G90.
    pub absolute: bool,
    /// G93, G94, G95.
    pub feed_mode: FeedMode,
    /// The control.
    pub dialect: Dialect,
}

/// Appends the lines of a divided move; the last one has no end.
pub fn write(original: &Original<'_>, moved: &Move, plan: &Plan, out: &mut Vec<u8>) {
    let pieces = plan.inserted.len() + 1;
    let place = |k: usize| if k + 1 == pieces { &moved.to } else { &plan.inserted[k] };
    let axes = written_axes(original.block, moved, plan);
    let feeds = original.feed_mode == FeedMode::InverseTime;
    let late: Vec<&Word> = original.block.words.iter().filter(|w| is_late(w, original.dialect)).collect();
    let style = Style::of(original);
    for k in 0..pieces {
        let before = if k == 0 { &moved.from } else { place(k - 1) };
        let value = |axis: usize| word_value(original, before, place(k), axis);
        let feed = || original.block.word(b'F').filter(|_| feeds).map(|f| inverse_time(original, f, plan, k));
        if k == 0 {
            first(original, &axes, &value, feed(), &late, &style, out);
            continue;
        }
        out.extend_from_slice(original.end);
        if let Some(slash) = &original.block.block_delete {
            out.extend_from_slice(&original.text[slash.clone()]);
        }
        let mut begun = false;
        let mut word = |letter: u8, number: &[u8], out: &mut Vec<u8>| {
            if std::mem::replace(&mut begun, true) {
                out.extend_from_slice(style.blank);
            }
            out.push(style.letter(letter));
            out.extend_from_slice(number);
        };
        for &axis in &axes {
            if let Some(text) = value(axis) {
                word(AXES[axis], text.as_bytes(), out);
            }
        }
        if let Some(feed) = feed() {
            word(b'F', &feed, out);
        }
        if k + 1 == pieces {
            for late in &late {
                word(late.letter, &original.text[late.start + 1..late.end], out);
            }
        }
        if k == 1 {
            out.extend_from_slice(format!(" (LINE {} IN {pieces} PIECES)", original.number).as_bytes());
        }
    }
}

/// The first line: the original with other numbers.
fn first(
    original: &Original<'_>,
    axes: &[usize],
    value: &dyn Fn(usize) -> Option<String>,
    feed: Option<Vec<u8>>,
    late: &[&Word],
    style: &Style,
    out: &mut Vec<u8>,
) {
    let last_axis = original.block.axes.iter().flatten().max().copied();
    let mut done = 0;
    for (at, word) in original.block.words.iter().enumerate() {
        let mut replaced = None;
        if let Some(axis) = AXES.iter().position(|&l| l == word.letter) {
            replaced = value(axis).map(String::into_bytes);
        } else if word.letter == b'F' {
            replaced.clone_from(&feed);
        } else if late.iter().any(|l| l.start == word.start) {
            out.extend_from_slice(original.text[done..word.start].trim_ascii_end());
            done = word.end;
            continue;
        }
        if let Some(number) = replaced {
            // The blanks between letter and number stay, so that columns keep their look.
            let blanks = original.text[word.start + 1..word.end].iter().take_while(|b| b.is_ascii_whitespace()).count();
            out.extend_from_slice(&original.text[done..=word.start + blanks]);
            out.extend_from_slice(&number);
            done = word.end;
        }
        if Some(at) == last_axis {
            out.extend_from_slice(&original.text[done..word.end.max(done)]);
            done = done.max(word.end);
            for &axis in axes.iter().filter(|&&axis| original.block.axis(axis).is_none()) {
                if let Some(number) = value(axis) {
                    out.extend_from_slice(style.blank);
                    out.push(style.letter(AXES[axis]));
                    out.extend_from_slice(number.as_bytes());
                }
            }
        }
    }
    out.extend_from_slice(&original.text[done..]);
}

/// Axes whose words every line has: those the line names, and those that do not stand still.
fn written_axes(block: &Block, moved: &Move, plan: &Plan) -> Vec<usize> {
    let moves = |axis: usize| plan.inserted.iter().chain([&moved.to]).any(|p| p[axis] != moved.from[axis]);
    (0..6).filter(|&axis| moved.from[axis].is_some() && (block.axis(axis).is_some() || moves(axis))).collect()
}

fn word_value(original: &Original<'_>, before: &Place, to: &Place, axis: usize) -> Option<String> {
    let scale = Scale::of_axis(axis, original.units);
    let to = to[axis]?;
    let value: Quantity = if original.absolute { to } else { to.minus(before[axis]?) };
    Some(value.text(scale))
}

/// F of a piece under G93: the time of the move, shared out.
fn inverse_time(original: &Original<'_>, word: &Word, plan: &Plan, piece: usize) -> Vec<u8> {
    let pieces = plan.shares.len();
    let share = plan.shares.get(piece).copied().unwrap_or(1.0);
    let equal = plan.shares.iter().all(|s| (s * pieces as f64 - 1.0).abs() < 1e-9);
    let written = &original.text[word.start + 1..word.end];
    let times = if equal { format!("{pieces}.0") } else { number(1.0 / share) };
    match word.value {
        None => [b"[", written.trim_ascii(), b"*", times.as_bytes(), b"]"].concat(),
        Some(feed) if equal => {
            match feed.mantissa().checked_mul(pieces as i64).and_then(|m| Decimal::new(m, feed.decimals())) {
                Some(product) => exact(product).into_bytes(),
                None => number(feed.value() * pieces as f64).into_bytes(),
            }
        }
        Some(feed) => number(feed.value() / share).into_bytes(),
    }
}

fn exact(value: Decimal) -> String {
    let decimals = usize::from(value.decimals());
    if decimals == 0 { format!("{}", value.mantissa()) } else { format!("{:.decimals$}", value.value()) }
}

/// At least seven significant digits, and a point.
fn number(value: f64) -> String {
    let whole = value.abs().max(1.0).log10().floor() as usize;
    let decimals = 7usize.saturating_sub(whole).max(1);
    let text = format!("{value:.decimals$}");
    let kept = text.trim_end_matches('0');
    if kept.ends_with('.') { format!("{kept}0") } else { kept.to_owned() }
}

/// Words that act when the move is done.
fn is_late(word: &Word, dialect: Dialect) -> bool {
    match word.letter {
        b'M' => match word.whole() {
            Some(0 | 1 | 2 | 30 | 60 | 99) => true,
            // LinuxCNC and Mach stop spindle and coolant before the move of the block (NIST 6556, table 8).
            Some(5 | 9) => !matches!(dialect, Dialect::Linuxcnc | Dialect::Mach),
            _ => false,
        },
        b'G' => word.tenths().is_some_and(|t| meaning(t, dialect) == Meaning::ExactStop),
        _ => false,
    }
}

/// How the line is written.
struct Style {
    blank: &'static [u8],
    lower: bool,
}

impl Style {
    fn of(original: &Original<'_>) -> Self {
        let words = &original.block.words;
        let spaced = words.windows(2).any(|pair| pair[1].start > pair[0].end);
        let axis = original.block.axes.iter().flatten().next().and_then(|&at| words.get(at));
        let lower = axis.and_then(|w| original.text.get(w.start)).is_some_and(u8::is_ascii_lowercase);
        Self { blank: if spaced { b" " } else { b"" }, lower }
    }
    const fn letter(&self, letter: u8) -> u8 {
        if self.lower { letter.to_ascii_lowercase() } else { letter }
    }
}
