//! The commonest blocks, which are read and executed by a shorter way: it does what the long one does.
//!
//! A blank between a letter and its number means nothing, and sends a block the long way; so does one before a comment.

use proptest::prelude::*;
use truepath_rs274::{
    Axes, Canon, DeviceMemory, Dialect, GcodeErrorKind, Interpreter, Machine, Modal, Options, PointlessLength, Span,
    Units,
};
use truepath_units::Offset;

/// What a program does, and what is said about it.
#[derive(Debug, PartialEq)]
struct Read {
    steps: Vec<(Canon, Modal, u32)>,
    comments: Vec<String>,
    blocks: Vec<(u32, usize, bool)>,
    warnings: Vec<(String, u32, u32)>,
    end: Result<Option<u32>, (GcodeErrorKind, u32)>,
}

fn read(text: &str, options: Options<'_>) -> Read {
    let (mut steps, mut comments, mut blocks) = (Vec::new(), Vec::new(), Vec::new());
    let mut memory = DeviceMemory::new();
    let run = Interpreter::new(options).run_observed(
        text.as_bytes().into(),
        &mut memory.lend(),
        &mut |event| {
            let canon = match *event.canon {
                Canon::Comment(body) => {
                    comments.push(String::from_utf8_lossy(body.of(event.text)).into_owned());
                    // The other text has it elsewhere.
                    Canon::Comment(Span::default())
                }
                canon => canon,
            };
            steps.push((canon, *event.modal, event.source.line));
            Ok(())
        },
        &mut |block| blocks.push((block.line.number, block.words.len(), block.source.number.is_some())),
    );
    let warnings = run.as_ref().map_or(Vec::new(), |summary| {
        let list = summary.warnings.as_slice().iter();
        list.map(|w| (w.kind.code().to_owned(), w.line, w.times)).collect()
    });
    let end = run.map(|summary| summary.end).map_err(|error| (error.kind, error.line));
    Read { steps, comments, blocks, warnings, end }
}

/// The same text with a blank behind every letter and before every comment, but for what is inside of comments.
fn apart(text: &str) -> String {
    let (mut depth, mut behind_semicolon) = (0u32, false);
    let mut apart = String::new();
    for c in text.chars() {
        match c {
            '\n' => (depth, behind_semicolon) = (0, false),
            ';' if depth == 0 => behind_semicolon = true,
            '(' if !behind_semicolon => {
                apart.push_str(if depth == 0 { " " } else { "" });
                depth += 1;
            }
            ')' => depth = depth.saturating_sub(1),
            _ => {}
        }
        apart.push(c);
        if c.is_ascii_alphabetic() && depth == 0 && !behind_semicolon {
            apart.push(' ');
        }
    }
    apart
}

fn options(machine: bool, least: bool) -> Options<'static> {
    Options {
        start: if machine { Axes::ORIGIN } else { Axes::UNKNOWN },
        machine: machine.then_some(Machine { units: Units::Millimetres, probe_before_end: Offset::ZERO }),
        decimal: if least { PointlessLength::Least } else { PointlessLength::Calculator },
        ..Options::default()
    }
}

#[test]
fn a_profile_is_the_same_by_both_ways() {
    let text = "G21 G90 G17\nG0 X0 Y0 Z5.\nN10 G1 Z-2. F300\nX10.\nG91\nY5.5\nG20\nG1 F10\nG1\nX-.1 Y.25 F12.5\nG0\nG93\nG1 X1 F2\nX2\n";
    let by_short = read(text, options(true, false));
    assert_eq!(by_short, read(&apart(text), options(true, false)));
    assert_eq!(by_short.end.map_err(|(_, line)| line), Err(14));
}

#[test]
fn arcs_and_comments_are_the_same_by_both_ways() {
    let text = "G21 G90 G17 F100\n(start)\nG0 X0 Y0 Z0\nG1 X10.\nN20 G3 X20. I5. J0 F50\nX10. I-5. Z-1.\nI2. (a whole one)\n\
                (a (b) c)\n()\nG2 X12.003 Y10 J5.\nG91\nG2 X2 Y0 I1\n(open\nM2\n";
    let by_short = read(text, options(true, false));
    assert_eq!(by_short, read(&apart(text), options(true, false)));
    let arcs = by_short.steps.iter().filter(|(canon, ..)| matches!(canon, Canon::Arc { .. })).count();
    assert_eq!((arcs, by_short.comments.len()), (3, 4));
    assert_eq!(by_short.end.map_err(|(_, line)| line), Err(10));
}

fn number() -> impl Strategy<Value = &'static str> {
    prop::sample::select(vec!["0", "1", "-2.5", ".125", "10.", "-0", "0.00000005", "99999999999", "300"])
}

fn block() -> impl Strategy<Value = String> {
    let letters = vec!["X", "Y", "Z", "F", "X", "Y", "I", "J", "I", "A", "S", "K", "R", "P"];
    let word = (prop::sample::select(letters), number());
    let code = prop::sample::select(vec![
        "", "", "", "", "G0", "G1", "G1", "G01", "G1.0", "G2", "G3", "G03", "G90", "G91", "G90.1", "G91.1", "G20",
        "G21", "G93", "G94", "G18", "G80", "N5", "G53", "M3", "M72", "M70", "G41 D1", "G40",
    ]);
    (code, prop::collection::vec(word, 0..4)).prop_map(|(code, words)| {
        let words: Vec<String> = words.iter().map(|(letter, number)| format!("{letter}{number}")).collect();
        format!("{code} {}", words.join(" "))
    })
}

/// An arc of half a turn that is one, or nearly; then one of some other kind.
fn arc() -> impl Strategy<Value = String> {
    let code = prop::sample::select(vec!["G2", "G3", "N7 G02", "g3", "F5 G2"]);
    let off = prop::sample::select(vec!["0", "0", "0.", ".01", ".03", "-.2", "5"]);
    let more = prop::sample::select(vec!["", "", "Z-1.5", "Z1", "F20", "P2", "K0", "A1"]);
    let then = prop::sample::select(vec!["", "X1. I.5", "I1", "J-2.", "X1Y1", "I1 J1 X2", "X5 Y5 R5", "I10. J0"]);
    (code, off, more, then, 1u16..3000).prop_map(|(code, off, more, then, radius)| {
        let (r, x) = (f64::from(radius) / 100.0, f64::from(radius) / 50.0);
        format!("G1 X0 Y0\n{code} X{x:.3} Y{off} I{r:.3} J0. {more}\n{then}")
    })
}

fn comment() -> impl Strategy<Value = String> {
    prop::sample::select(vec![
        "(plain)",
        "()",
        "( a) ",
        "(a (b) c)",
        "(a) (b)",
        "(a\r)",
        "(a)\r",
        "(a); b",
        "(a)b)",
        "(MSG, x)",
        "; c",
    ])
    .prop_map(str::to_owned)
}

proptest! {
    #[test]
    fn both_ways_do_the_same(
        blocks in prop::collection::vec(prop_oneof![4 => block(), 2 => arc(), 1 => comment()], 1..12),
        known: bool, machine: bool, least: bool, macros: bool, itself: bool,
    ) {
        let head = if known { "G21 G90 G94 G17\nG0 X0 Y0 Z0\nG1 F100\n" } else { "" };
        let text = format!("{head}{}\n", blocks.join("\n"));
        let dialect = if macros { Dialect::Fanuc } else { Dialect::Linuxcnc };
        let options = Options { dialect, as_linuxcnc: itself, ..options(machine, least) };
        prop_assert_eq!(read(&text, options), read(&apart(&text), options), "{}", text);
    }
}
