//! Programs → contours: the paper's program, its variants, and what a real program surrounds a contour with.

use truepath_rs274::{
    Candidate, CompensationBy, ContourOptions, ContourProgram, DeviceMemory, GcodeError, LineRange, Options, Program,
    Spindle, Units, WarningKind, find_contours, read_contour,
};
use truepath_units::geometry::Side;
use truepath_units::geometry::{Block, Contour, Curve, Point, Shape};
use truepath_units::{Offset, Position, Real};

const P18: &[u8] = include_bytes!("../data/p18-corner.nc");
const MM: i64 = 1_000_000;

fn empty_block() -> Block {
    let curve = Curve::line(Point::from_nm(0, 0), Point::from_nm(1, 0)).expect("a line of 1 nm");
    Block { curve, s: Offset::ZERO, feed: Real::ZERO, line: 0 }
}

fn read_with(program: &[u8], options: &ContourOptions) -> Result<(ContourProgram, Vec<Block>), GcodeError> {
    let mut buffer = vec![empty_block(); 512];
    let contour = read_contour(&Program::new(program), &mut DeviceMemory::new().lend(), &mut buffer, options)?;
    buffer.truncate(contour.blocks);
    Ok((contour, buffer))
}

fn read(program: &str) -> (ContourProgram, Vec<Block>) {
    read_with(program.as_bytes(), &ContourOptions::default()).unwrap_or_else(|e| panic!("{e}\n{program}"))
}

fn warnings(contour: &ContourProgram) -> Vec<(WarningKind, u32)> {
    contour.summary.warnings.as_slice().iter().map(|w| (w.kind, w.line)).collect()
}

/// The corner of the paper in whole nanometres.
fn assert_is_the_corner(blocks: &[Block]) {
    let mm = |x, y| Point::from_nm(x * MM, y * MM);
    let ends: Vec<_> = blocks.iter().map(|b| (b.curve.start(), b.curve.end())).collect();
    assert_eq!(ends, [(mm(34, 80), mm(34, 35)), (mm(34, 35), mm(39, 30)), (mm(39, 30), mm(90, 30))]);
    let Shape::Arc { centre, sweep } = blocks[1].curve.shape() else { panic!("the second block is an arc") };
    assert_eq!(centre, mm(39, 35));
    assert!((sweep - Real::FRAC_PI_2).abs() <= Real::STEP);
    assert!(Contour::new(blocks).is_some());
}

#[test]
fn the_program_of_the_2018_paper_reads_as_printed() {
    let (contour, blocks) = read_with(P18, &ContourOptions::default()).expect("the paper's program");
    assert_is_the_corner(&blocks);
    assert_eq!(contour.z, Position::from_nm(-15 * MM));
    assert_eq!(contour.lines, LineRange { first: 11, last: 13 });
    assert_eq!(blocks.iter().map(|b| b.feed.round_to_int()).collect::<Vec<_>>(), [250, 150, 250]);
    assert_eq!((contour.lowest_feed, contour.highest_feed), (Real::from_int(150), Real::from_int(250)));
    assert_eq!((contour.speed, contour.spindle), (Some(Real::from_int(1500)), Spindle::Clockwise));
    assert_eq!((contour.tool, contour.wall, contour.units), (Some(1), None, Units::Millimetres));
    assert_eq!((contour.summary.number, contour.summary.end, contour.closed), (Some(1), Some(30), false));
    // 45 + 5·π/2 + 51 mm.
    assert_eq!(contour.length.nm(), 103_853_982);
    assert_eq!(warnings(&contour), [(WarningKind::BareG53, 3)]);
    assert_eq!(contour.summary.warnings.as_slice()[0].times, 2);
}

#[test]
fn every_way_to_write_the_corner_gives_the_same_nanometres() {
    let variants = [
        "G21 G90\nG0 X34 Y80 Z-15\nG1 X34 Y35 F250\nG3 X39 Y30 I5 J0\nG1 X90 Y30\nM2",
        "G21 G90\nG0 X34 Y80 Z-15\nG1 Y35 F250\nG3 X39 Y30 R5\nG1 X90\nM2",
        "G21 G90\nG0 X34 Y80 Z-15\nG1 Y35 F250\nG90.1 G3 X39 Y30 I39 J35\nG91.1 G1 X90\nM2",
        "G21 G90\nG0 X34 Y80 Z-15\nG91 G1 Y-45 F250\nG3 X5 Y-5 I5\nG1 X51\nM2",
        "g21g90\r\ng0 x34y80z-15\r\ng1 y3 5.00 f 2 50; \r \r\r\nG3x39 y30 (quarter turn) i5\nx90 g1\nm2",
        "G20 G90\nG0 X1.33858267717 Y3.14960629921 Z-.590551181102\nG1 Y1.37795275591 F10\nG3 X1.53543307087 Y1.1811023622 I.196850393701 J0\nG1 X3.54330708661\nM2",
        "/G21 G90\n:77\nN1 G0 X34 Y80 Z-15\nN1.5 G1 Y35 F250\nY35\nN2 G3 X39 Y30 I5\nN3 G1 X90 Y30\nM30",
    ];
    for program in variants {
        let (contour, blocks) = read(program);
        assert_is_the_corner(&blocks);
        assert_eq!(contour.z.nm(), -15 * MM, "{program}");
    }
}

#[test]
fn a_decimal_inch_is_exact_and_its_feed_is_in_millimetres() {
    let (_, blocks) = read("G20 G0 X0 Y0 Z0\nG1 X0.0001 F10\nM2");
    assert_eq!(blocks[0].curve.end(), Point::from_nm(2540, 0));
    assert_eq!(blocks[0].feed, Real::from_int(254));
}

#[test]
fn radius_words_take_the_short_way_and_negative_ones_the_long_way() {
    let sweep = |arc: &str| {
        let (_, blocks) = read(&format!("G21 G0 X10 Y0 Z0\n{arc} F100\nM2"));
        let Shape::Arc { centre, sweep } = blocks[0].curve.shape() else { panic!("an arc") };
        (centre, (sweep / Real::FRAC_PI_2).round_to_int())
    };
    let mm = |x, y| Point::from_nm(x * MM, y * MM);
    assert_eq!(sweep("G3 X0 Y10 R10"), (mm(0, 0), 1));
    assert_eq!(sweep("G3 X0 Y10 R-10"), (mm(10, 10), 3));
    assert_eq!(sweep("G2 X0 Y10 R10"), (mm(10, 10), -1));
    assert_eq!(sweep("G2 X0 Y10 R-10"), (mm(0, 0), -3));
}

#[test]
fn an_arc_without_an_end_is_a_full_circle() {
    let (contour, blocks) = read("G21 G0 X10 Y0 Z-1\nG2 I-10 F100\nM2");
    assert!(contour.closed);
    assert_eq!(blocks[0].curve.shape(), Shape::Arc { centre: Point::from_nm(0, 0), sweep: -Real::TAU });
}

#[test]
fn a_helix_enters_but_is_not_part_of_the_contour() {
    let (contour, blocks) = read("G21 G0 X10 Y0 Z1\nG2 X10 Y0 Z-2 I-10 F100\nG1 X10 Y30\nG0 Z5\nM2");
    assert_eq!((blocks.len(), contour.z.nm()), (1, -2 * MM));
}

#[test]
fn guidance_left_of_the_contour_puts_the_wall_on_the_right() {
    let side = |g: &str| {
        let (contour, _) = read(&format!("G21 G0 X0 Y0 Z0\n{g} D7 G1 X1 F100\nX20\nG40 X21\nM2"));
        assert!(warnings(&contour).contains(&(WarningKind::CompensationNotApplied, 2)));
        contour.wall
    };
    assert_eq!(side("G41"), Some(Side::Right));
    assert_eq!(side("G42"), Some(Side::Left));
}

#[test]
fn arc_length_adds_up_and_moves_without_length_are_dropped() {
    let (contour, blocks) = read("G21 G0 X0 Y0 Z0\nG1 X3 F100\nX3 Y0\nG1 Z0\nY4\nM2");
    assert_eq!(blocks.iter().map(|b| (b.s.nm(), b.line)).collect::<Vec<_>>(), [(0, 2), (3 * MM, 5)]);
    assert_eq!(contour.length.nm(), 7 * MM);
}

const TWO: &str = "G21 G0 X0 Y0 Z5\nT2 M6\nG0 Z5\nG1 Z-1 F50\nX10\nY10\nG0 Z5\nG0 X0 Y0\nG1 Z-2\nG41 D1 X30\nX0\nM2";

#[test]
fn several_contours_are_listed_and_one_is_chosen_by_its_lines() {
    let mut found: Vec<Candidate> = Vec::new();
    find_contours(&Program::new(TWO.as_bytes()), &mut DeviceMemory::new().lend(), &ContourOptions::default(), |c| {
        found.push(*c)
    })
    .expect("readable");
    let lines: Vec<_> = found.iter().map(|c| (c.lines.first, c.lines.last, c.blocks)).collect();
    assert_eq!(lines, [(5, 6, 2), (10, 11, 2)]);
    assert_eq!((found[1].z, found[1].length.nm()), (Some(Position::from_nm(-2 * MM)), 60 * MM));
    assert_eq!((found[1].tool, found[1].closed, found[1].wall), (Some(2), true, Some(Side::Right)));

    let within = Some(LineRange { first: 9, last: 11 });
    let (contour, _) =
        read_with(TWO.as_bytes(), &ContourOptions { within, ..Default::default() }).expect("one contour");
    assert_eq!((contour.blocks, contour.lines), (2, found[1].lines));
}

#[test]
fn rapids_machine_moves_tools_and_spindle_changes_end_a_contour() {
    for interruption in
        ["G0 X1 Y0", "G53 G0 Z0\nG0 X1 Y0 Z0", "G28 Z0\nG0 X1 Y0 Z0", "T3 M6\nG0 Z0", "S900", "M4", "G43 H1\nG0 Z0"]
    {
        let program = format!("G21 S500 M3 G0 X0 Y0 Z0\nG1 X1 F100\n{interruption}\nG1 X2\nM2");
        let mut count = 0;
        find_contours(
            &Program::new(program.as_bytes()),
            &mut DeviceMemory::new().lend(),
            &ContourOptions::default(),
            |_| count += 1,
        )
        .expect("readable");
        assert_eq!(count, 2, "{interruption}");
    }
}

#[test]
fn dwells_coolant_stops_and_remarks_do_not_end_a_contour() {
    for between in ["G4 P0.5", "G4 X2.", "M8", "M9", "M0", "M1", "(remark)", "G54", "G64 P0.01", "M64 P0", "F80", ""] {
        let (contour, _) = read(&format!("G21 G0 X0 Y0 Z0\nG1 X1 F100\n{between}\nG1 X2\nM2"));
        assert_eq!(contour.blocks, 2, "{between}");
    }
}

#[test]
fn what_deserves_a_look_is_told_with_its_line() {
    use WarningKind as W;
    let cases: [(&str, &[(WarningKind, u32)]); 12] = [
        ("%\nG21 G0 X0 Y0 Z0\nG1 X1 F9\nM30\n%", &[]),
        // Without any it is complete with its end, as LinuxCNC has it; with one a part of it may be lost.
        ("G21 G0 X0 Y0 Z0\nG1 X1 F9\nM30", &[]),
        ("G21 G0 X0 Y0 Z0\nG1 X1 F9", &[(W::EndMissing, 2)]),
        ("%\nG21 G0 X0 Y0 Z0\nG1 X1 F9\nM30", &[(W::PercentMissing, 4)]),
        ("G21 G0 X0 Y0 Z0\nG1 X1 F9\nM30\n%", &[(W::PercentMissing, 4)]),
        ("%\nG21 G0 X0 Y0 Z0\nG1 X1 F9\n%\n", &[(W::EndMissing, 4)]),
        ("name\n%\nG21 G0 X0 Y0 Z0\nG1 X1 F9\nM2\n%", &[(W::OutsidePercent, 1)]),
        ("%\nG21 G0 X0 Y0 Z0\nG1 X1 F9\nM2\nG0 Z5\n%", &[(W::TextAfterEnd, 5)]),
        ("%\nG21 G0 X0 Y0 Z0\nG1 X1\nM2\n%", &[(W::FeedMissing, 3)]),
        ("%\nG0 X0 Y0 Z0\nG1 X1 F9\nM2\n%", &[(W::UnitsAssumed, 2)]),
        (
            "%\nG21 G0 X0 Y0 Z0 H3\n/M123\nG1 X1 F9\nM2\n%",
            &[(W::UnusedOffsetNumber { letter: b'H' }, 2), (W::BlockDeleteExecuted, 3), (W::UnknownM { m: 123 }, 3)],
        ),
        ("%\nG20 F9 G0 X0 Y0 Z0\nG1 X1\nM2\n%", &[(W::UnitsWithFeed, 2)]),
    ];
    for (program, expected) in cases {
        assert_eq!(warnings(&read(program).0), expected, "{program}");
    }
}

#[test]
fn a_switched_off_block_is_skipped_on_request() {
    let mut options = ContourOptions::default();
    options.program.skip_block_delete = true;
    let program = b"G21 G0 X0 Y0 Z0\nG1 X1 F9\n/G1 X7\nG1 X2\nM2";
    let (contour, blocks) = read_with(program, &options).expect("readable");
    assert_eq!((contour.blocks, blocks[1].curve.end()), (2, Point::from_nm(2 * MM, 0)));
}

#[test]
fn the_contour_may_fill_the_buffer_but_not_exceed_it() {
    let mut buffer = [empty_block(); 3];
    assert!(
        read_contour(&Program::new(P18), &mut DeviceMemory::new().lend(), &mut buffer, &ContourOptions::default())
            .is_ok()
    );
    let error =
        read_contour(&Program::new(P18), &mut DeviceMemory::new().lend(), &mut buffer[..2], &ContourOptions::default())
            .expect_err("three blocks in two places");
    assert_eq!((error.kind.code(), error.line), ("G072", 13));
}

/// A wall as drawn, cut by a cutter of 10 mm on its left.
const DRAWN: &str = "G0 X-20 Y-30\nG1 Z-5 F200\nG41 D1 X0 Y-20\nY40\nX50\nG40 X80 Y60\nM30\n";

#[test]
fn under_compensation_the_contour_is_the_path_of_the_centre_and_the_wall_is_known() {
    let program = Options { compensation: CompensationBy::Radius(Offset::from_um(5_000)), ..Options::default() };
    let (contour, blocks) =
        read_with(DRAWN.as_bytes(), &ContourOptions { program, ..Default::default() }).expect("one contour");
    assert_eq!(contour.wall, Some(Side::Right));
    let ends: Vec<_> = blocks.iter().map(|b| (b.curve.end().x.nm(), b.curve.end().y.nm())).collect();
    // The entry ends beside its end; then the wall, with an arc round its corner, and the way out.
    let entry = (-5_000_000, -16_909_830);
    assert_eq!(ends, [entry, (-5 * MM, 40 * MM), (0, 45 * MM), (50 * MM, 45 * MM), (80 * MM, 60 * MM)]);
    // Without a radius the same program is read as the path of the centre, with the warning that says so.
    let (contour, blocks) = read_with(DRAWN.as_bytes(), &ContourOptions::default()).expect("one contour");
    assert_eq!((contour.wall, blocks.len()), (Some(Side::Right), 4));
}
