//! Programs with G41 or G42 whose radius the control adds: written as the path of the cutter's centre.

use truepath_core::gcode::{CompensationBy, Options};
use truepath_core::units::Offset;
use truepath_program::BlockEdit;

use super::path::{blocks, edits, refusal_of, rewritten};

const RADIUS: Options<'static> = Options { compensation: CompensationBy::Radius(Offset::from_um(4_000)), ..DEFAULT };
const DEFAULT: Options<'static> = Options {
    units: truepath_core::gcode::Units::Millimetres,
    start: truepath_core::gcode::Axes::UNKNOWN,
    skip_block_delete: false,
    dialect: truepath_core::gcode::Dialect::Linuxcnc,
    as_linuxcnc: false,
    decimal: truepath_core::gcode::PointlessLength::Calculator,
    arc_centres: truepath_core::gcode::ArcCentres::Detect,
    block_limit: 1_000_000,
    compensation: CompensationBy::Nothing,
    tools: &[],
    machine: None,
    spline_tolerance: Offset::from_um(1),
    whole_splines: false,
};

const DRAWN: &str = "%\nG21 G90 G17 G40\nT1 M6\nS1500 M3\nG0 X24 Y100 Z50\nG0 Z-10\nN10 G1 G41 D1 X30 Y80 F400 (entry)\nN20 Y35\nN30 G3 X39 Y26 I9\nN40 G1 X60\nN50 Y10\nN60 X90 M8\nN70 G40 X110\nG0 Z50\nG0 X0\nM30\n%\n";

/// The text in which compensation is off, and how far its path is from that of the edits.
fn written(program: &str, edits: &[BlockEdit]) -> String {
    let done = rewritten(program, edits, RADIUS).unwrap_or_else(|e| panic!("{e} in\n{program}"));
    assert!(done.difference.compensation_taken_out && done.difference.largest_deviation_mm <= 0.001);
    let text = String::from_utf8(done.text).expect("ASCII");
    assert!(!text.contains("G41") && !text.contains("G42") && !text.contains(" D1"), "{text}");
    assert!(text.contains("(PATH OF THE CUTTER CENTRE: THE CUTTER RADIUS OF 4 MM IS PART OF IT, D IS NOT USED)\n"));
    text
}

/// The edits on these lines.
fn some(edits: &[BlockEdit], lines: std::ops::RangeInclusive<u32>) -> Vec<BlockEdit> {
    edits.iter().filter(|e| lines.contains(&e.line)).cloned().collect()
}

#[test]
fn the_contour_with_entry_and_exit_becomes_the_path_of_the_centre() {
    let edits = edits(DRAWN, RADIUS);
    assert_eq!(edits.iter().map(|e| e.line).collect::<Vec<_>>(), (7..=13).collect::<Vec<_>>());
    let text = written(DRAWN, &edits);
    for number in ["N10 G1 ", "N20 ", "N30 G", "N40 G", "N50 ", "N60 ", "N70 "] {
        assert_eq!(text.matches(&format!("\n{number}")).count(), 1, "{number} in\n{text}");
    }
    assert!(text.contains(" F400 (entry)\n") && text.contains("N70 G40 ") && text.matches("M8").count() == 1, "{text}");
}

#[test]
fn entry_and_exit_beside_the_contour_lead_to_and_from_the_path_of_the_centre() {
    let all = edits(DRAWN, RADIUS);
    let contour = some(&all, 8..=12);
    let text = written(DRAWN, &contour);
    // The text means the same whatever radius the control has for D.
    let plain = blocks(&text, DEFAULT);
    assert_eq!(plain, blocks(&text, RADIUS));
    let start = contour[0].samples[0];
    let entry = plain[0].curve.end();
    assert!((entry.x.nm() - start[0]).abs() <= 100 && (entry.y.nm() - start[1]).abs() <= 100, "{text}");
    let exit = plain.last().expect("a block").curve.end();
    assert_eq!((exit.x.nm(), exit.y.nm()), (110_000_000, 10_000_000), "{text}");
    assert!(text.contains("N70 G40 X110. Y10.\n"), "{text}");
}

#[test]
fn without_a_correction_the_path_is_the_one_the_control_would_have_made() {
    let original = blocks(DRAWN, RADIUS);
    let still: Vec<BlockEdit> = edits(DRAWN, RADIUS)
        .iter()
        .map(|e| {
            let own: Vec<_> = original.iter().filter(|b| b.line == e.line).collect();
            let mut samples = vec![[own[0].curve.start().x.nm(), own[0].curve.start().y.nm()]];
            for block in own {
                let count = (block.curve.length().nm() / 100_000).max(2);
                let at = |k| block.curve.point(truepath_core::units::Real::ratio(k, count));
                samples.extend((1..=count).map(at).map(|p| [p.x.nm(), p.y.nm()]));
            }
            BlockEdit::new(e.line, samples)
        })
        .collect();
    let after = blocks(&written(DRAWN, &still), DEFAULT);
    assert_eq!(original.len(), after.len());
    for (a, b) in original.iter().zip(&after) {
        assert!(a.curve.end().distance(b.curve.end()).nm() <= 100, "line {}", a.line);
        let radii = [a, b].map(|x| x.curve.signed_radius().map_or(0, |r| r.nm()));
        assert!((radii[0] - radii[1]).abs() <= 500, "line {}: {radii:?}", a.line);
    }
}

#[test]
fn a_side_on_a_line_of_its_own_an_exit_without_words_and_steps_are_written_too() {
    let own_line = DRAWN.replace("N10 G1 G41 D1 X30", "G41 D1\nN10 G1 X30").replace("N70 G40 X110", "G40\nN70 X110");
    let incremental = DRAWN
        .replace("N10 G1 G41 D1 X30 Y80", "N10 G91 G1 G41 D1 X6 Y-20")
        .replace("Y35", "Y-45")
        .replace("X39 Y26", "X9 Y-9")
        .replace("G1 X60", "G1 X21")
        .replace("Y10", "Y-16")
        .replace("X90 M8", "X30 M8")
        .replace("X110\nG0 Z50", "X20\nG90 G0 Z50");
    let right = DRAWN.replace("G41", "G42").replace("X24 Y100", "X36 Y100");
    for program in [own_line, incremental, right] {
        let all = edits(&program, RADIUS);
        written(&program, &all);
        let inner = &all[1..all.len() - 1];
        written(&program, inner);
    }
}

#[test]
fn a_side_that_is_only_told_stays() {
    let edits = edits(DRAWN, DEFAULT);
    let done = rewritten(DRAWN, &edits, DEFAULT).unwrap_or_else(|e| panic!("{e}"));
    assert!(!done.difference.compensation_taken_out);
    assert!(String::from_utf8_lossy(&done.text).contains("N10 G1 G41 D1 X"));
}

#[test]
fn another_compensated_stretch_keeps_its_bytes() {
    let other = "G0 X200 Y100\nG0 Z-5\nG1 G41 D1 X210 Y80\nY40\nG40 X220\nG0 Z50\nM30\n";
    let program = DRAWN.replace("M30\n", other);
    let text = {
        let done = rewritten(&program, &edits(DRAWN, RADIUS), RADIUS).unwrap_or_else(|e| panic!("{e}"));
        String::from_utf8(done.text).expect("ASCII")
    };
    assert!(text.contains("\nG1 G41 D1 X210 Y80\nY40\nG40 X220\n") && text.matches("G41").count() == 1, "{text}");
}

#[test]
fn what_cannot_be_written_without_compensation_is_refused_with_what_to_do() {
    // The line before the contour turns an outside corner: it would become a line and an arc.
    let all = edits(DRAWN, RADIUS);
    let lines: Vec<u32> = blocks(DRAWN, RADIUS).iter().map(|b| b.line).collect();
    let twice = lines.windows(2).find(|w| w[0] == w[1]).expect("an outside corner")[0];
    let error = refusal_of(rewritten(DRAWN, &some(&all, twice + 1..=13), RADIUS));
    assert_eq!((error.code(), error.line_column()), ("P007", Some((twice as usize, 1))), "{error}");
    assert!(format!("{error:?}").contains("--route coprocessor"), "{error:?}");
}
