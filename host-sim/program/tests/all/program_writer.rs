//! The corrected program: what moves, what keeps its bytes, and how true the written path is.

use truepath_core::gcode::{ContourOptions, HostMemory, Program, read_contour};
use truepath_core::geometry::{Block, Contour, Curve, Point};
use truepath_core::units::{Offset, Real};
use truepath_ground::diagnostics::{Failure, Source};
use truepath_program::{BlockEdit, RewriteOptions, Rewritten, rewrite_program};

const CORNER: &str = "%\nO0001\nG00 G90 G49 G40 G17 G21\nG54\nT01 M06 (D20)\nS1500 M03\nG00 Z10. X34 Y80 M08\nG01 Z-15. F400\n\
    N10 G01 X34 Y35 F400 (first wall)\nN20 G03 X39 Y30 I5 J0\nN30 G01 X90 Y30 F300\nG00 Z100.\nM09\nM05\nM30\n%\n";

/// The contour of a program.
fn blocks(program: &str) -> Vec<Block> {
    let filler = Block { curve: unit_line(), s: Offset::ZERO, feed: Real::ZERO, line: 0 };
    let mut buffer = vec![filler; 4096];
    let contour = read_contour(
        &Program::new(program.as_bytes()),
        &mut HostMemory::new().lend(),
        &mut buffer,
        &ContourOptions::default(),
    )
    .expect("one contour");
    buffer.truncate(contour.blocks);
    buffer
}

fn unit_line() -> Curve {
    Curve::line(Point::from_nm(0, 0), Point::from_nm(1, 0)).expect("a line")
}

/// The corrected path: the contour displaced by `by(s, left normal)`, sampled every 0.1 mm.
fn edits(program: &str, by: impl Fn(f64, [f64; 2]) -> [f64; 2]) -> Vec<BlockEdit> {
    let blocks = blocks(program);
    let contour = Contour::new(&blocks).expect("a contour");
    let edit = |(index, block): (usize, &Block)| {
        let length = block.curve.length().nm();
        let count = (length / 100_000).max(2);
        let sample = |k: i64| {
            let s = block.s + Offset::from_nm(length * k / count);
            let place = contour.at(s, index).expect("a place");
            let left = place.heading.left();
            let real = |r: Real| r.bits() as f64 / 4_294_967_296.0;
            let d = by(s.nm() as f64 * 1e-6, [real(left.x), real(left.y)]);
            [place.point.x.nm() + (d[0] * 1e6).round() as i64, place.point.y.nm() + (d[1] * 1e6).round() as i64]
        };
        BlockEdit::new(block.line, (0..=count).map(sample).collect())
    };
    let mut edits: Vec<_> = blocks.iter().enumerate().map(edit).collect();
    for i in 1..edits.len() {
        edits[i].samples[0] = *edits[i - 1].samples.last().expect("a sample");
    }
    edits
}

/// A smooth displacement of the size and shape a corner correction has, mm.
fn bump(s: f64, left: [f64; 2]) -> [f64; 2] {
    let size = 0.09 + 0.2 / (1.0 + ((s - 48.0) / 6.0).powi(2));
    [left[0] * size + 0.01, left[1] * size - 0.005]
}

fn options() -> RewriteOptions {
    RewriteOptions { tolerance: Offset::from_um(1), ..RewriteOptions::default() }
}

fn rewrite(program: &str, edits: &[BlockEdit]) -> Rewritten {
    let source = Source::new("corner.nc", program.as_bytes().to_vec());
    rewrite_program(&source, edits, &options()).expect("a corrected program")
}

fn text(rewritten: &Rewritten) -> String {
    String::from_utf8(rewritten.text.clone()).expect("ASCII")
}

/// Lines of the original that are in the new text unchanged.
fn kept(program: &str, text: &str) -> Vec<bool> {
    let new: Vec<&str> = text.lines().collect();
    program.lines().map(|line| new.contains(&line)).collect()
}

/// Where both programs go, apart from the contour: every point that is not part of the corrected run.
fn end_point(program: &str) -> Point {
    blocks(program).last().expect("a block").curve.end()
}

#[test]
fn the_written_path_is_within_the_tolerance_and_needs_few_blocks() {
    let edits = edits(CORNER, bump);
    for um in [1, 5, 20] {
        let source = Source::new("corner.nc", CORNER.as_bytes().to_vec());
        let options = RewriteOptions { tolerance: Offset::from_um(um), ..RewriteOptions::default() };
        let rewritten = rewrite_program(&source, &edits, &options).expect("a corrected program");
        assert!(
            rewritten.difference.largest_deviation_mm <= um as f64 * 1e-3,
            "{} mm at {um} µm",
            rewritten.difference.largest_deviation_mm
        );
        assert!(
            rewritten.difference.straight_moves + rewritten.difference.arcs <= 40,
            "{} pieces",
            rewritten.difference.straight_moves + rewritten.difference.arcs
        );
    }
}

#[test]
fn only_the_contour_and_its_start_move() {
    let rewritten = rewrite(CORNER, &edits(CORNER, bump));
    let text = text(&rewritten);
    let kept = kept(CORNER, &text);
    let moved: Vec<usize> = (0..kept.len()).filter(|&i| !kept[i]).map(|i| i + 1).collect();
    assert_eq!(moved, [7, 9, 10, 11], "{text}");
    assert!(text.contains("G00 Z10. X34.") && text.contains(" M08\n"), "{text}");
    assert!(text.contains("F400 (first wall)\n"), "{text}");
    for number in ["N10 G", "N20 G", "N30 G"] {
        assert_eq!(text.matches(number).count(), 1, "{text}");
    }
    assert_eq!(text.matches('F').count(), CORNER.matches('F').count(), "each feed once:\n{text}");
}

#[test]
fn an_identical_path_changes_nothing_but_the_mark() {
    let rewritten = rewrite(CORNER, &edits(CORNER, |_, _| [0.0, 0.0]));
    let text = text(&rewritten);
    let unmarked: String = text
        .split_inclusive('\n')
        .filter(|l| {
            !l.starts_with("(TRUEPATH")
                && !l.starts_with("(ORIGINAL")
                && !l.starts_with("(DO NOT")
                && !l.starts_with("(WRITTEN")
        })
        .collect();
    assert_eq!(unmarked, CORNER);
    assert_eq!(
        (rewritten.difference.contour_lines_kept, rewritten.difference.straight_moves, rewritten.difference.arcs),
        (3, 2, 1)
    );
}

#[test]
fn the_mark_follows_the_name_and_a_marked_program_is_refused() {
    let text = text(&rewrite(CORNER, &edits(CORNER, bump)));
    let crc = truepath_core::gcode::program_crc(CORNER.as_bytes());
    let head: Vec<&str> = text.lines().take(5).collect();
    assert_eq!(head[..3], ["%", "O0001", "(TRUEPATH CORRECTED)"]);
    assert_eq!(head[3], format!("(ORIGINAL CRC32 {crc:08X}, TOLERANCE 0.001 MM)"));
    let source = Source::new("corrected.nc", text.clone().into_bytes());
    let refusal = rewrite_program(&source, &edits(&text, bump), &options()).expect_err("a second correction");
    assert_eq!(refusal.exit_code(), 1);
    let Failure::Input(error) = refusal else { panic!("an input error") };
    assert_eq!((error.code(), error.line_column()), ("P001", Some((3, 2))));
}

#[test]
fn consecutive_blocks_share_their_points_to_the_last_digit() {
    let text = text(&rewrite(CORNER, &edits(CORNER, bump)));
    let after = blocks(&text);
    assert!(Contour::new(&after).is_some());
    for block in &after {
        for point in [block.curve.start(), block.curve.end()] {
            assert_eq!((point.x.nm() % 100, point.y.nm() % 100), (0, 0), "written with four decimals");
        }
    }
}

#[test]
fn arc_ends_agree_with_their_centres_to_a_fraction_of_a_micrometre() {
    for block in blocks(&text(&rewrite(CORNER, &edits(CORNER, bump)))) {
        if let truepath_core::geometry::Shape::Arc { centre, .. } = block.curve.shape() {
            let difference = (block.curve.start().distance(centre) - block.curve.end().distance(centre)).nm();
            assert!(difference.abs() <= 300, "{difference} nm");
        }
    }
}

#[test]
fn inches_incremental_moves_and_absolute_centres_give_the_same_path() {
    let reference = blocks(&text(&rewrite(CORNER, &edits(CORNER, bump))));
    let inch = |mm: f64| format!("{:.6}", mm / 25.4);
    let inches = format!(
        "%\nG20 G90\nM3 S1500\nG0 X{} Y{}\nG1 Z-.5 F15\nG1 X{} Y{}\nG3 X{} Y{} I{} J0\nG1 X{} Y{}\nG0 Z4\nM30\n%\n",
        inch(34.0),
        inch(80.0),
        inch(34.0),
        inch(35.0),
        inch(39.0),
        inch(30.0),
        inch(5.0),
        inch(90.0),
        inch(30.0)
    );
    let incremental = "%\nG21 G90\nM3 S1500\nG0 X34 Y80\nG1 Z-15 F400\nG91\nG1 Y-45\nG3 X5 Y-5 I5 J0\nG1 X51\nG0 Z115\nG0 X10 Y5\nM30\n%\n";
    let centres = "%\nG21 G90 G90.1\nM3 S1500\nG0 X34 Y80\nG1 Z-15 F400\nG1 X34 Y35\nG3 X39 Y30 I39 J35\nG1 X90 Y30\nG0 Z100\nM30\n%\n";
    for program in [inches.as_str(), incremental, centres] {
        let rewritten = rewrite(program, &edits(program, bump));
        assert!(
            rewritten.difference.largest_deviation_mm <= 0.001,
            "{} mm in\n{program}",
            rewritten.difference.largest_deviation_mm
        );
        let after = blocks(&text(&rewritten));
        let (a, b) = (after.last().expect("a block").curve.end(), reference.last().expect("a block").curve.end());
        assert!(a.distance(b).nm() <= 150, "ends {} nm apart in\n{program}", a.distance(b).nm());
        let start = after[0].curve.start().distance(reference[0].curve.start()).nm();
        assert!(start <= 150, "starts {start} nm apart in\n{program}");
    }
}

#[test]
fn an_incremental_program_returns_to_its_own_places_after_the_contour() {
    let program = "G21 G90\nM3 S1500\nG0 X34 Y80\nG1 Z-15 F400\nG91\nG1 Y-45\nG3 X5 Y-5 I5 J0\nG1 X51\nG0 Z115\nG0 X10\nG0 Y5\nM30\n";
    let text = text(&rewrite(program, &edits(program, bump)));
    let end = |program: &str| {
        let mut at = None;
        truepath_core::gcode::Interpreter::new(Default::default())
            .run(program.as_bytes(), &mut HostMemory::new().lend(), &mut |event| {
                if let truepath_core::gcode::Canon::Traverse { to, .. } = *event.canon {
                    at = to.point();
                }
                Ok(())
            })
            .expect("a readable program");
        at.expect("a last position")
    };
    assert!(end(&text).distance(end(program)).nm() <= 60, "{text}");
    assert!(end_point(&text).distance(end_point(program)).nm() > 50_000, "the contour itself has moved");
}

#[test]
fn line_ends_spelling_and_code_pages_are_kept() {
    let mut program = CORNER.replace('\n', "\r\n").replace("first wall", "h\u{1}hle").into_bytes();
    for byte in &mut program {
        if *byte == 1 {
            *byte = 0xF6;
        }
    }
    let source = Source::new("corner.nc", program.clone());
    let edits = edits(CORNER, bump);
    let text = rewrite_program(&source, &edits, &options()).expect("a corrected program").text;
    assert!(text.windows(4).any(|w| w == b"(h\xF6h"));
    let bare = text.iter().enumerate().filter(|&(i, &b)| b == b'\n' && text[i - 1] != b'\r').count();
    assert_eq!(bare, 0, "every line end is CR LF");

    let tight = "g21g90m3s1500\ng0x34y80\ng1z-15f400\nn1g1x34y35\nn2g3x39y30r5\nn3g1x90y30m9\ng0z100\nm2\n";
    let written = self::text(&rewrite(tight, &self::edits(tight, bump)));
    assert!(
        written.lines().filter(|l| !l.starts_with('(')).all(|l| !l.contains(' ') && l == l.to_lowercase()),
        "{written}"
    );
    assert!(!written.contains('r'), "no radius is left on a line:\n{written}");
    let last = written
        .lines()
        .rfind(|l| l.starts_with("g1") || l.starts_with("g2") || l.starts_with("g3") || l.starts_with('n'));
    assert!(last.is_some_and(|l| l.ends_with("m9")), "the coolant stays on to the end of the contour:\n{written}");
    assert_eq!(written.matches("m9").count(), 1);
}

#[test]
fn a_move_that_relied_on_the_code_of_the_last_line_gets_its_own() {
    let program = "G21 G90 M3 S1500\nG0 X34 Y80\nG1 Z-15 F400\nX34 Y35\nG3 X39 Y30 I5 J0\nG1 X90 Y30\nZ10\nX0 Y0\nM2\n";
    let round = |s: f64, left: [f64; 2]| {
        let size = 0.1 + 0.3 * ((s - 50.0) * std::f64::consts::TAU / 20.0).cos();
        [left[0] * size, left[1] * size]
    };
    let contour = "G21 G90 M3 S1500\nG0 X34 Y80\nG1 Z-15 F400\nX34 Y35\nG3 X39 Y30 I5 J0\nG1 X90 Y30\nG0 Z10\nM2\n";
    let text = text(&rewrite(program, &edits(contour, round)));
    assert!(text.contains("\nG1 Z10\nX0 Y0\nM2"), "{text}");
    assert!(text.lines().any(|l| l.starts_with("G3 ") || l.starts_with("G2 ")), "the walls are bent:\n{text}");
}

#[test]
fn repeated_points_follow_the_corrected_path() {
    let program = "G21 G90 M3 S1500\nG0 X34 Y80 Z10\nG1 Z-15 F400\nG1 X34 Y80\nG1 X34 Y35\nX34 Y35\nG3 X39 Y30 I5 J0\nG1 X90 Y30\nG1 X90 Y30 Z5\nM2\n";
    let text = text(&rewrite(
        program,
        &edits(CORNER, bump).into_iter().zip([5, 7, 8]).map(|(e, line)| BlockEdit { line, ..e }).collect::<Vec<_>>(),
    ));
    for place in ["X34 ", "Y80", "Y35", "X90 ", "Y30\n"] {
        assert!(!text.contains(place), "{place} is left in\n{text}");
    }
    assert_eq!(blocks(&text).first().expect("a block").curve.start(), start(&text));
}

fn start(program: &str) -> Point {
    let mut at = None;
    truepath_core::gcode::Interpreter::new(Default::default())
        .run(program.as_bytes(), &mut HostMemory::new().lend(), &mut |event| {
            if let truepath_core::gcode::Canon::Traverse { to, .. } = *event.canon {
                at = at.or(to.point());
            }
            Ok(())
        })
        .expect("a readable program");
    at.expect("a traverse")
}

#[test]
fn block_delete_and_semicolon_ends_are_repeated_on_every_piece() {
    let program =
        "G21 G90 M3 S1500;\nG0 X34 Y80;\nG1 Z-15 F400;\n/G1 X34 Y35;\n/G3 X39 Y30 I5 J0;\n/G1 X90 Y30;\nG0 Z9;\nM2;\n";
    let text = text(&rewrite(program, &edits(program, bump)));
    assert!(text.lines().filter(|l| !l.starts_with('(')).all(|l| l.ends_with(';')), "{text}");
    let pieces = text.lines().filter(|l| l.contains("G1 X") || l.contains("G3 X") || l.contains("G2 X"));
    assert!(pieces.clone().count() > 6 && pieces.into_iter().all(|l| l.starts_with('/')), "{text}");
}

#[test]
fn a_lead_out_arc_is_displaced_as_a_whole_and_the_next_line_returns() {
    for (centre, after) in [("I0 J10", "G1 X120 Y50"), ("R10", "G1 X120"), ("R10", "G0 Z5\nY50")] {
        let program = format!(
            "G21 G90 M3 S1500\nG0 X34 Y80\nG1 Z-15 F400\nG1 X34 Y35\nG3 X39 Y30 I5 J0\nG1 X90 Y30\nG1 Z-10\nG3 X100 Y40 {centre}\n{after}\nG0 X1 Y1\nM2\n"
        );
        let contour: Vec<_> =
            edits(CORNER, bump).into_iter().zip([4, 5, 6]).map(|(e, line)| BlockEdit { line, ..e }).collect();
        let [x, y] = *contour[2].samples.last().expect("a sample");
        let text = text(&rewrite(&program, &contour));
        let place = |nm: i64| (nm as f64 / 1e2).round() / 1e4;
        let arc = format!("G3 X{} Y{} {centre}\n", place(x + 10_000_000), place(y + 10_000_000));
        assert!(text.contains(&arc), "no {arc} in\n{text}");
        let home = match after {
            "G1 X120" => "G1 X120 Y40.\n",
            "G0 Z5\nY50" => "G0 Z5\nX100. Y50\n",
            both => both,
        };
        assert!(text.contains(home) || text.contains("Y50 X100."), "{text}");
    }
}

#[test]
fn a_lead_in_arc_is_displaced_with_the_start_and_the_move_before_it_too() {
    let program = "G21 G90 M3 S1500\nG0 X24 Y90\nG1 Z-10 F400\nG2 X34 Y80 I0 J-10 Z-15\nG1 X34 Y35\nG3 X39 Y30 I5 J0\nG1 X90 Y30\nG0 Z9\nM2\n";
    let contour: Vec<_> =
        edits(CORNER, bump).into_iter().zip([5, 6, 7]).map(|(e, line)| BlockEdit { line, ..e }).collect();
    let rewritten = rewrite(program, &contour);
    let text = text(&rewritten);
    let [x, y] = contour[0].samples[0].map(|nm| (nm as f64 / 1e2).round() / 1e4);
    assert!(text.contains(&format!("G2 X{x} Y{y} I0 J-10 Z-15\n")), "{text}");
    assert!(text.contains(&format!("G0 X{:.4} Y{:.3}\n", x - 10.0, y + 10.0)), "{text}");
    assert_eq!(rewritten.difference.other_lines_changed, [2, 4]);
}

#[test]
fn an_axis_that_the_line_after_the_contour_does_not_name_returns_to_its_place() {
    let program = CORNER.replace("G00 Z100.\n", "G00 Z100.\nG00 X0\nG00 Y0\n");
    let text = text(&rewrite(&program, &edits(CORNER, bump)));
    assert!(text.contains("\nG00 X0 Y30.\nG00 Y0\n"), "{text}");
}

#[test]
fn a_contour_whose_start_no_move_sets_is_refused() {
    let program = "G21 G90 M3 S1500\nG0 X34 Y80\nG28\nG1 X34 Y35 F400\nG1 Z-15\nG1 X34 Y80\nG1 X0 Y80\nM2\n";
    let at = |y: i64| [34_000_000, y];
    let edit = BlockEdit::new(6, vec![at(35_100_000), at(60_000_000), at(80_000_000)]);
    let second = BlockEdit::new(7, vec![at(80_000_000), [0, 80_000_000]]);
    let source = Source::new("corner.nc", program.as_bytes().to_vec());
    // The start is set by a plain G1 here, which may move.
    assert!(rewrite_program(&source, &[edit, second], &options()).is_ok());
    // Here the contour begins where the machine happens to stand.
    let program = "G21 G90 M3 S1500\nG1 Z-15 F400\nG1 X34\nG1 Y80\nM2\n";
    let edits = [
        BlockEdit::new(3, vec![[0, 100_000], [34_000_000, 100_000]]),
        BlockEdit::new(4, vec![[34_000_000, 100_000], at(80_000_000)]),
    ];
    let source = Source::new("corner.nc", program.as_bytes().to_vec());
    let mut options = options();
    options.program.start = truepath_core::gcode::Axes::ORIGIN;
    let Err(Failure::Input(error)) = rewrite_program(&source, &edits, &options) else { panic!("an input error") };
    assert_eq!((error.code(), error.line_column()), ("P002", Some((3, 1))));
}

#[test]
fn the_program_of_a_mirrored_path_is_the_mirrored_program() {
    let mirrored = CORNER.replace('X', "X-").replace("I5", "I-5").replace("G03", "G02");
    let upright = edits(CORNER, bump);
    let mirror = |e: &BlockEdit| BlockEdit::new(e.line, e.samples.iter().map(|s| [-s[0], s[1]]).collect());
    let reference = blocks(&text(&rewrite(CORNER, &upright)));
    let flipped = blocks(&text(&rewrite(&mirrored, &upright.iter().map(mirror).collect::<Vec<_>>())));
    assert_eq!(reference.len(), flipped.len());
    for (a, b) in reference.iter().zip(&flipped) {
        assert_eq!((a.curve.end().x.nm(), a.curve.end().y.nm()), (-b.curve.end().x.nm(), b.curve.end().y.nm()));
        assert_eq!(a.curve.signed_radius().map(|r| -r), b.curve.signed_radius());
    }
}
