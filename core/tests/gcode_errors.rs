//! Wrong programs with the exact message each must give.

use std::collections::BTreeMap;

use truepath_core::gcode::{ContourOptions, read_contour};
use truepath_core::geometry::{Block, Curve, Point};
use truepath_core::units::{Offset, Real};

fn message(program: &[u8]) -> String {
    let curve = Curve::line(Point::from_nm(0, 0), Point::from_nm(1, 0)).expect("a line of 1 nm");
    let mut buffer = [Block { curve, s: Offset::ZERO, feed: Real::ZERO, line: 0 }; 4];
    match read_contour(program, &mut buffer, &ContourOptions::default()) {
        Ok(_) => panic!("accepted: {}", String::from_utf8_lossy(program)),
        Err(error) => error.to_string(),
    }
}

/// Program, message. `S` stands for a start that is in order: units, distances and a known place on line 1.
const TABLE: &[(&[u8], &str)] = &[
@@TABLE@@
];

fn with_start(program: &[u8]) -> Vec<u8> {
    match program.strip_prefix(b"S\n") {
        Some(rest) => [b"G21 G90 G17 G0 X0 Y0 Z0 F100\n", rest].concat(),
        None => program.to_vec(),
    }
}

#[test]
fn every_wrong_program_gives_its_message() {
    for (program, expected) in TABLE {
        assert_eq!(message(&with_start(program)), *expected, "for {}", String::from_utf8_lossy(program));
    }
}

#[test]
fn a_code_means_one_thing() {
    let mut meaning: BTreeMap<&str, &str> = BTreeMap::new();
    for (_, text) in TABLE {
        let (_, rest) = text.split_once(": G").expect("a code");
        let (code, sentence) = rest.split_once(": ").expect("a sentence");
        // The end of the sentence says what to do and does not depend on the program, except where it quotes it.
        let advice = sentence.rsplit_once(['?', ';', ':']).map_or(sentence, |(_, advice)| advice);
        let first = *meaning.entry(code).or_insert(advice);
        assert!(first == advice || ["G009", "G024", "G025", "G030"].contains(&format!("G{code}").as_str()), "G{code}: {first} / {advice}");
    }
    // Every kind of error except the full block of M codes' own limit is in the table.
    assert_eq!(meaning.len(), 51);
}
