//! The proof must fail for every kind of change, or it proves nothing.

use super::*;

const ORIGINAL: &str = "%\nG21 G90\nM3 S1500\nG0 X0 Y0 Z10\nG1 Z-5 F300\nN10 G1 X10 Y0 (wall)\nN20 X20 F250\nG0 Z10\nG0 X50 Y50\nG4 P2\nM9\nM30\n%\n";
const WRITTEN: &str = "%\nG21 G90\nM3 S1500\nG0 X0.1 Y0.2 Z10\nG1 Z-5 F300\nN10 G1 X5. Y0.2 (wall)\nG1 X10. Y0.3\nN20 X20. Y0.3 F250\nG0 Z10\nG0 X50 Y50\nG4 P2\nM9\nM30\n%\n";

fn edits() -> Vec<BlockEdit> {
    let wall = |x: i64| [x * 100_000, 200_000 + (x - 50).max(0) * 2_000];
    let first = (1..=100).map(wall);
    let second = (101..=200).map(|x| [x * 100_000, 300_000]);
    vec![BlockEdit::new(6, first.collect()), BlockEdit::new(7, std::iter::once(wall(100)).chain(second).collect())]
}

fn verdict(original: &str, written: &str) -> Result<Proof, String> {
    verdict_of(original, written, &edits(), [2, 1])
}

/// `parts` are the lines that each of the two edits has become.
fn verdict_of(original: &str, written: &str, edits: &[BlockEdit], parts: [usize; 2]) -> Result<Proof, String> {
    let touched = BTreeMap::from([(4, 1), (6, parts[0]), (7, parts[1])]);
    prove(&Claim {
        original: original.as_bytes(),
        written: written.as_bytes(),
        touched: &touched,
        head: (0, b""),
        edits,
        program: Options::default(),
        tolerance: 1_000.0,
        step: 100.0,
        centre_path: false,
    })
}

#[test]
fn a_faithful_text_is_proved_and_counted() {
    let proof = verdict(ORIGINAL, WRITTEN).expect("nothing else has changed");
    assert_eq!((proof.lines, proof.arcs, proof.feeds), (3, 0, 1));
    assert!(proof.deviation_nm < 1.0 && proof.moves_outside >= 4, "{proof:?}");
    let kink = proof.kinks.iter().map(|k| k.degrees).fold(0.0, f64::max);
    assert!((kink - 0.02f64.atan().to_degrees()).abs() < 1e-3, "{kink} degrees");
}

#[test]
fn every_other_change_is_found() {
    for (what, with) in [
        ("S1500", "S1501"),
        ("M3", "M4"),
        ("G1 Z-5 F300", "G1 Z-5.001 F300"),
        ("Z-5 F300", "Z-5 F301"),
        ("(wall)", "(Wall)"),
        ("N10", "N11"),
        ("N20 X20.", "X20."),
        ("F250", "F251"),
        ("N10 G1 X5. Y0.2", "N10 G1 X5. Y0.2011"),
        ("G1 X10. Y0.3", "G1 X10. Y0.3 F200"),
        ("G1 X10. Y0.3", "G1 X10. Y0.3 Z-5.1"),
        ("G1 X10. Y0.3", "G1 X10. Y0.3\nG1 X10.1 Y0.3"),
        ("G1 X10. Y0.3\n", ""),
        ("G0 X0.1 Y0.2", "G0 X0.1 Y0.21"),
        ("G0 X50 Y50", "G0 X50.01 Y50"),
        ("G0 X50 Y50", "G1 X50 Y50"),
        ("Y0.3 F250\nG0 Z10", "Y0.3 F250\nG0 Z11"),
        ("P2", "P3"),
        ("M30", "M2"),
        ("M9\n", "M8\nM9\n"),
        ("G21 G90\n", "G21 G90\nG64\n"),
    ] {
        let tampered = WRITTEN.replacen(what, with, 1);
        assert_ne!(tampered, WRITTEN);
        assert!(verdict(ORIGINAL, &tampered).is_err(), "{what} -> {with} was not noticed");
    }
}

#[test]
fn a_changed_byte_on_a_line_said_to_be_untouched_is_found() {
    let blank = WRITTEN.replacen("G0 X50 Y50", "G0  X50 Y50", 1);
    assert!(verdict(ORIGINAL, &blank).is_err_and(|e| e.contains("line 9")));
}

/// The first wall from its middle and the start of the second at four fifths of their feeds.
const FED: &str = "%\nG21 G90\nM3 S1500\nG0 X0.1 Y0.2 Z10\nG1 Z-5 F300\nN10 G1 X5. Y0.2 (wall)\nG1 X10. Y0.3 F240.\nN20 X15. Y0.3 F200.\nG1 X20. Y0.3 F225.\nF250.\nG0 Z10\nG0 X50 Y50\nG4 P2\nM9\nM30\n%\n";

fn fed(written: &str, second_from: usize) -> Result<Proof, String> {
    let mut edits = edits();
    let from = |sample, percent| super::super::edit::FeedFrom { sample, percent };
    edits[0].feeds = vec![from(0, 100), from(49, 80)];
    edits[1].feeds = vec![from(0, 80), from(second_from, 90)];
    verdict_of(ORIGINAL, written, &edits, [2, 3])
}

#[test]
fn scheduled_feeds_are_proved_to_be_the_wanted_ones_at_their_places_and_to_be_put_back() {
    let proof = fed(FED, 50).expect("as wanted");
    assert_eq!((proof.lines, proof.feeds), (4, 4));
    for (what, with) in [
        ("F240.", "F240.2"),
        (" F240.", ""),
        ("F200.", "F250."),
        (" F225.", ""),
        ("\nF250.\n", "\n\n"),
        ("\nF250.\n", "\nF251.\n"),
        ("N10 G1 X5.", "N10 G1 X5. F301"),
        ("S1500", "S1501"),
        ("(wall)", "(Wall)"),
    ] {
        let tampered = FED.replacen(what, with, 1);
        assert_ne!(tampered, FED);
        assert!(fed(&tampered, 50).is_err(), "{what} -> {with} was not noticed");
    }
    assert!(fed(FED, 60).is_err_and(|e| e.contains("the feed") || e.contains("the place of a feed")));
}
