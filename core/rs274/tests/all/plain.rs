//! The commonest blocks, which are read and executed by a shorter way: it does what the long one does.
//!
//! A blank between a letter and its number means nothing, and sends a block the long way.

use proptest::prelude::*;
use truepath_rs274::{
    Axes, Canon, DeviceMemory, GcodeErrorKind, Interpreter, Machine, Modal, Options, PointlessLength, Units,
};
use truepath_units::Offset;

/// What a program does, and what is said about it.
#[derive(Debug, PartialEq)]
struct Read {
    steps: Vec<(Canon, Modal, u32)>,
    blocks: Vec<(u32, usize, bool)>,
    warnings: Vec<(String, u32, u32)>,
    end: Result<Option<u32>, (GcodeErrorKind, u32)>,
}

fn read(text: &str, options: Options<'_>) -> Read {
    let (mut steps, mut blocks) = (Vec::new(), Vec::new());
    let mut memory = DeviceMemory::new();
    let run = Interpreter::new(options).run_observed(
        text.as_bytes().into(),
        &mut memory.lend(),
        &mut |event| {
            if !matches!(event.canon, Canon::Comment(_)) {
                steps.push((*event.canon, *event.modal, event.source.line));
            }
            Ok(())
        },
        &mut |block| blocks.push((block.line.number, block.words.len(), block.source.number.is_some())),
    );
    let warnings = run.as_ref().map_or(Vec::new(), |summary| {
        let list = summary.warnings.as_slice().iter();
        list.map(|w| (w.kind.code().to_owned(), w.line, w.times)).collect()
    });
    let end = run.map(|summary| summary.end).map_err(|error| (error.kind, error.line));
    Read { steps, blocks, warnings, end }
}

/// The same text with a blank behind every letter.
fn apart(text: &str) -> String {
    text.chars().flat_map(|c| [Some(c), c.is_ascii_alphabetic().then_some(' ')]).flatten().collect()
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

fn block() -> impl Strategy<Value = String> {
    let number =
        || prop::sample::select(vec!["0", "1", "-2.5", ".125", "10.", "-0", "0.00000005", "99999999999", "300"]);
    let word = (prop::sample::select(vec!["X", "Y", "Z", "F", "X", "Y", "I", "A", "S"]), number());
    let code = prop::sample::select(vec![
        "", "", "", "", "G0", "G1", "G1", "G01", "G1.0", "G2", "G90", "G91", "G20", "G21", "G93", "G94", "G18", "G80",
        "N5", "G53", "M3", "M72", "M70", "G41 D1", "G40",
    ]);
    (code, prop::collection::vec(word, 0..4)).prop_map(|(code, words)| {
        let words: Vec<String> = words.iter().map(|(letter, number)| format!("{letter}{number}")).collect();
        format!("{code} {}", words.join(" "))
    })
}

proptest! {
    #[test]
    fn both_ways_do_the_same(blocks in prop::collection::vec(block(), 1..12), known: bool, machine: bool, least: bool) {
        let head = if known { "G21 G90 G94 G17\nG0 X0 Y0 Z0\nG1 F100\n" } else { "" };
        let text = format!("{head}{}\n", blocks.join("\n"));
        prop_assert_eq!(read(&text, options(machine, least)), read(&apart(&text), options(machine, least)), "{}", text);
    }
}
