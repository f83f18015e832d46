//! Whatever stands between G41 and G40: the cutter's path has no gap, keeps its steps in order, and nothing panics.
#![allow(clippy::unwrap_used, clippy::arithmetic_side_effects, clippy::indexing_slicing, clippy::panic)]

use crate::interpret::interpret;
use proptest::prelude::*;
use truepath_rs274::{Axes, Canon, DeviceMemory, GcodeError, GcodeErrorKind, Options};

/// What is seen of a run: moves, comments and feeds in their order.
#[derive(Clone, Debug, PartialEq)]
enum Seen {
    Move { line: u32, from: Axes, to: Axes },
    Comment(String),
    Feed(i64),
}

fn run(program: &str) -> (Vec<Seen>, Result<(), GcodeError>) {
    let mut seen = Vec::new();
    let options = Options { start: Axes::ORIGIN, ..Options::default() };
    let result = interpret(options, program.as_bytes(), &mut DeviceMemory::new().lend(), &mut |event| {
        match *event.canon {
            Canon::Traverse { from, to } | Canon::Feed { from, to } | Canon::Arc { from, to, .. } => {
                seen.push(Seen::Move { line: event.source.line, from, to });
            }
            Canon::Comment(span) => {
                let text = event.text[span.start..span.end()].to_vec();
                seen.push(Seen::Comment(String::from_utf8(text).unwrap()));
            }
            Canon::FeedRate(feed) => seen.push(Seen::Feed(feed.round_to_int())),
            _ => {}
        }
        Ok(())
    });
    (seen, result.map(|_| ()))
}

/// A block inside a compensated contour.
fn block() -> impl Strategy<Value = String> {
    let mm = -60i32..60;
    prop_oneof![
        6 => (mm.clone(), mm.clone()).prop_map(|(x, y)| format!("G1 X{x} Y{y}")),
        1 => (mm.clone(), mm.clone()).prop_map(|(x, y)| format!("G0 X{x} Y{y}")),
        // An arc of any size about a centre right of, or beside, its start.
        3 => (2i32..40, any::<bool>()).prop_map(|(i, ccw)| format!("G91 G{} X{} I{i}\nG90", if ccw { 3 } else { 2 }, 2 * i)),
        1 => (2i32..40, any::<bool>()).prop_map(|(j, ccw)| format!("G{} J{j}", if ccw { 3 } else { 2 })),
        1 => mm.prop_map(|z| format!("G1 Z{z}")),
        1 => (1u32..9).prop_map(|n| format!("F{}", n * 10)),
        1 => (0u32..9).prop_map(|n| format!("(remark {n})")),
        1 => Just("M8".to_owned()),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(3_000))]
    #[test]
    fn the_path_has_no_gap_and_nothing_is_lost_or_overtakes(
        blocks in prop::collection::vec(block(), 1..14), side in 41u8..43, diameter in 1u32..90, exit: bool,
    ) {
        let body = blocks.join("\n");
        let exit = if exit { "G40 G1 X99 Y99\n" } else { "" };
        let head = "G21 G90 G17 F100\nG0 X-200 Y-90 Z1\n";
        let plain = format!("{head}G1 X0 Y0\n{body}\n{exit}M2\n");
        let on = format!("{head}G{side}.1 D{}.{} G1 X0 Y0\n{body}\n{exit}M2\n", diameter / 10, diameter % 10);
        let (programmed, read) = run(&plain);
        prop_assert!(read.is_ok(), "{:?}\n{}", read, plain);
        let (seen, result) = run(&on);
        let mut at = None;
        for step in &seen {
            if let Seen::Move { from, to, .. } = step {
                prop_assert!(at.is_none_or(|at| at == *from), "a gap before {:?} in\n{}", step, on);
                at = Some(*to);
            }
        }
        let order = |steps: &[Seen]| -> Vec<Seen> {
            steps.iter().filter(|s| !matches!(s, Seen::Move { .. })).cloned().collect()
        };
        let lines = |steps: &[Seen]| -> Vec<u32> {
            let mut lines: Vec<u32> =
                steps.iter().filter_map(|s| if let Seen::Move { line, .. } = s { Some(*line) } else { None }).collect();
            lines.dedup();
            lines
        };
        match result {
            Ok(()) => {
                prop_assert_eq!(order(&seen), order(&programmed));
                prop_assert_eq!(lines(&seen), lines(&programmed));
            }
            Err(error) => {
                prop_assert!(matches!(error.kind, GcodeErrorKind::Compensation(_)), "{:?}", error);
                // What was given until then is how the program begins.
                prop_assert!(order(&programmed).starts_with(&order(&seen)));
                prop_assert!(lines(&programmed).starts_with(&lines(&seen)));
            }
        }
    }
}

#[test]
fn more_steps_between_two_moves_than_can_wait_are_an_error_at_the_one_too_many() {
    let program = |remarks: usize| {
        format!(
            "G21 G90 G17 F100\nG0 X0 Y0 Z1\nG41.1 D10 G1 X20\n{}X40\nG40 X60 Y50\nM2\n",
            "(remark)\n".repeat(remarks)
        )
    };
    let most = truepath_rs274::compensation::WAITING - 1;
    assert_eq!(run(&program(most - 1)).1, Ok(()));
    let error = run(&program(most + 1)).1.unwrap_err();
    assert_eq!((error.kind.code(), error.line as usize), ("G131", 4 + most));
}
