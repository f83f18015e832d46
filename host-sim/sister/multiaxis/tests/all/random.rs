//! Random five-axis programs: nothing panics, what is passed on is passed on whole, and a second pass changes nothing.

use std::cell::Cell;

use proptest::prelude::*;
use proptest::test_runner::TestRunner;
use truepath_core::gcode::{Dialect, PointlessLength, Units};
use truepath_ground::diagnostics::Source;
use truepath_multiaxis::machine::Coordinates;
use truepath_multiaxis::program::{
    CentrePoint, Digits, Outcome, Reading, Report, Settings, Sinks, Splitter, UnrollOptions, run, unroll,
};
use truepath_multiaxis::{Machine, Rule};

const MACHINE: &str = "version = 1\nkind = \"table-table\"\n[[rotary]]\naxis = \"A\"\npoint_mm = [0.0, 0.0, -30.0]\n\
                       [[rotary]]\naxis = \"C\"\n";

/// A pass: the report and the text; `None` when the program is refused or steered.
fn pass(text: &[u8], coordinates: Coordinates) -> Option<(Report, Vec<u8>)> {
    let machine = Machine::from_toml(&Source::new("m.toml", MACHINE.into())).expect("a machine");
    let settings = Settings {
        reading: Reading {
            dialect: Dialect::Linuxcnc,
            decimal: PointlessLength::Calculator,
            rotary: [true, false, true],
            one_tool: false,
            skip_block_delete: false,
        },
        units: Units::Millimetres,
        coordinates,
        centre_point: CentrePoint::Ends,
        splitter: Splitter {
            machine: &machine,
            tolerance: 0.01,
            rule: Rule::Fewest,
            max_pieces: 1000,
            digits: Digits::default(),
        },
        normal: None,
    };
    let mut out = Vec::new();
    let sinks = Sinks { text: &mut out, row: &mut |_| Ok(()), progress: &mut |_| () };
    match run(text, "in.nc", &settings, None, sinks) {
        Ok(Outcome::Done(report)) => Some((*report, out)),
        _ => None,
    }
}

fn number() -> impl Strategy<Value = String> {
    prop_oneof![
        (-80_000i32..80_000).prop_map(|n| format!("{:.3}", f64::from(n) / 1000.0)),
        (-90i32..90).prop_map(|n| n.to_string()),
        (-9_999i32..9_999).prop_map(|n| format!("{:.5}", f64::from(n) / 1000.0)),
    ]
}

/// A line of words that mostly make sense together.
fn line() -> impl Strategy<Value = String> {
    let code = prop::sample::select(vec![
        "",
        "",
        "",
        "",
        "G1",
        "g1",
        "G0",
        "G90",
        "G91",
        "G20",
        "G21",
        "G93",
        "G94",
        "G54",
        "G55",
        "G92",
        "G92.1",
        "G52",
        "G43 H1",
        "G49",
        "G41",
        "G40",
        "G28",
        "G53",
        "M428",
        "M429",
        "G68.2",
        "G69",
        "G2",
        "G80",
        "M6 T1",
        "G4 P1",
        "G61",
        "#1=5",
        "/",
        "(remark)",
        "G10 L2 P1",
        "M0",
        "G81 R1",
        "G17",
        "G999",
        "G9 O1",
        "M2",
    ]);
    let words = prop::collection::vec((prop::sample::select(vec!["X", "Y", "Z", "A", "C"]), number()), 0..6);
    let feed = prop::sample::select(vec!["", "F100", " F0.5", "F#1"]);
    (code, words, feed).prop_map(|(code, words, feed)| {
        let mut line = code.to_owned();
        let mut seen = String::new();
        for (letter, number) in words {
            if !seen.contains(letter) {
                line += &format!(" {letter}{number}");
                seen += letter;
            }
        }
        format!("{line} {feed}")
    })
}

#[test]
fn a_second_pass_over_a_rewritten_program_changes_nothing() {
    let endings = prop::sample::select(vec!["\n", "\r\n", "\r"]);
    let programs = (prop::collection::vec(line(), 1..9), endings, any::<bool>());
    let mut runner = TestRunner::new(ProptestConfig::with_cases(4000));
    let rewritten = Cell::new(0);
    let outcome = runner.run(&programs, |(lines, ending, tip)| {
        let text = format!("G21 G90 G94 F200{ending}G0 X1 Y2 Z3 A4 C5{ending}{}", lines.join(ending));
        let coordinates = if tip { Coordinates::Tip } else { Coordinates::Joints };
        if let Some((report, first)) = pass(text.as_bytes(), coordinates) {
            let (again, second) = pass(&first, coordinates).expect("what is written is read");
            prop_assert_eq!(again.inserted, 0);
            prop_assert_eq!(again.left.count, report.left.count);
            prop_assert_eq!(&second, &first);
            if report.inserted == 0 {
                prop_assert_eq!(first, text.into_bytes());
            } else {
                rewritten.set(rewritten.get() + 1);
            }
        }
        Ok(())
    });
    outcome.expect("no counter-example");
    assert!(rewritten.get() > 100, "{} programs of 4000 were rewritten", rewritten.get());
}

#[test]
fn a_program_number_within_a_divided_line_is_one_as_if_it_stood_first() {
    // Divided, G9 and M2 go to the last piece, and what stood behind them begins the first.
    let with = |line: &str| format!("G21 G90 G94 M3 F200\nG0 X1 Y2 Z3 A4 C5\nG1 X60 Y20 A30 C6\n{line}\nM30\n");
    for line in ["O1 X-2 A-3 C1", "G9 O1 X-2 A-3 C1", "G9 M2 O1 X-2 A-3 C1", "N5 O1 X-2 A-3 C1"] {
        assert!(pass(with(line).as_bytes(), Coordinates::Joints).is_none(), "{line}");
    }
    assert!(pass(with("G9 M2 X-2 A-3 C1").as_bytes(), Coordinates::Joints).is_some());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn no_bytes_make_it_panic(bytes in prop::collection::vec(any::<u8>(), 0..400), text in "[XYZACGMF0-9. #\\[\\]%/\n()<>=o-]{0,200}") {
        for input in [bytes.as_slice(), text.as_bytes()] {
            let _ = pass(input, Coordinates::Joints);
            let options = UnrollOptions {
                dialect: Dialect::Linuxcnc,
                decimal: PointlessLength::Calculator,
                units: Units::Millimetres,
                skip_block_delete: false,
            };
            let _ = unroll(&Source::new("in.nc", input.to_vec()), options);
        }
    }
}
