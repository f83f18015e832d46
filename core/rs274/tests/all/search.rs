//! Which runs of a program make a wall: roughing, levels, spring passes, islands, other tools, leads.

use truepath_rs274::{
    ContourOptions, Criteria, DeviceMemory, Found, Idle, LineRange, Program, Role, RunPart, read_contour, search,
    visit_runs,
};
use truepath_units::Offset;
use truepath_units::geometry::{Block, Side};

const POCKET: &str = include_str!("../../../../host-sim/tests/data/features/pocket.nc");
const ISLAND: &str = include_str!("../../../../host-sim/tests/data/features/island.nc");
const TWO_TOOLS: &str = include_str!("../../../../host-sim/tests/data/features/two-tools.nc");

fn criteria(tool: Option<u32>) -> Criteria {
    Criteria { tool, wall: Some(Side::Right), diameter: Offset::from_um(10_000), named: false }
}

fn searched(program: &str, criteria: &Criteria) -> (u32, Vec<Found>, Vec<Block>) {
    let (mut runs, mut blocks) = (Vec::new(), Vec::new());
    let mut first = 0;
    visit_runs(
        &Program::new(program.as_bytes()),
        &mut DeviceMemory::new().lend(),
        &ContourOptions::default(),
        |b| blocks.push(*b),
        |run| {
            runs.push(Found::new(*run, first));
            first += run.blocks;
        },
    )
    .expect("readable");
    let count = search(&mut runs, &blocks, criteria);
    (count, runs, blocks)
}

fn roles(program: &str, criteria: &Criteria) -> (u32, Vec<Role>) {
    let (count, runs, _) = searched(program, criteria);
    (count, runs.iter().map(|f| f.role).collect())
}

/// Index of the nearer run, gap in mm, whether parallel.
fn rough(role: Role) -> Option<(usize, f64, bool)> {
    match role {
        Role::Rough { nearer, gap, parallel } => Some((nearer, (gap.nm() as f64 / 1e4).round() / 100.0, parallel)),
        _ => None,
    }
}

#[test]
fn a_pocket_with_roughing_two_depths_and_a_spring_pass_has_one_finishing_contour() {
    let (count, runs, blocks) = searched(POCKET, &criteria(Some(1)));
    assert_eq!((count, runs.len()), (1, 9));
    // The innermost ones are farther from the finished wall than the cutter is wide, but not from the next pass.
    for (found, expected) in runs[..6].iter().zip([(2, 10.0), (6, 5.5), (6, 0.5), (2, 10.0), (6, 5.5), (6, 0.5)]) {
        assert_eq!(rough(found.role), Some((expected.0, expected.1, true)), "{:?}", found.run.lines);
    }
    let last: Vec<_> = runs[6..].iter().map(|f| f.role).collect();
    let finish = |level| Role::Finish { contour: 1, level };
    assert_eq!(last, [finish(1), finish(2), Role::Spring { contour: 1, level: 2 }]);
    for (found, first) in runs[6..].iter().zip([71, 86, 101]) {
        let lines = LineRange { first, last: first + 8 };
        assert_eq!((found.run.lines, found.run.closed, found.skipped, found.run.blocks), (lines, true, 1, 9));
        let path = found.blocks(&blocks);
        assert_eq!(path[0].curve.start(), path[8].curve.end());
    }
}

#[test]
fn a_part_of_a_run_is_read_by_number_and_blocks() {
    let (_, runs, blocks) = searched(POCKET, &criteria(Some(1)));
    let found = &runs[7];
    let part = RunPart { run: found.run.number, first: found.skipped as u32, blocks: found.run.blocks as u32 };
    let options = ContourOptions { part: Some(part), ..ContourOptions::default() };
    let mut buffer = vec![Block::BLANK; 64];
    let contour =
        read_contour(&Program::new(POCKET.as_bytes()), &mut DeviceMemory::new().lend(), &mut buffer, &options)
            .expect("the second depth");
    assert_eq!((contour.z.nm(), contour.lines, contour.closed), (-12_000_000, found.run.lines, true));
    assert_eq!((contour.length, buffer[0].s), (found.run.length, Offset::ZERO));
    let curves = |b: &[Block]| b.iter().map(|b| b.curve).collect::<Vec<_>>();
    assert_eq!(curves(&buffer[..contour.blocks]), curves(found.blocks(&blocks)));
    for wrong in [RunPart { run: 40, ..part }, RunPart { blocks: 12, ..part }, RunPart { first: 30, ..part }] {
        let options = ContourOptions { part: Some(wrong), ..ContourOptions::default() };
        let error =
            read_contour(&Program::new(POCKET.as_bytes()), &mut DeviceMemory::new().lend(), &mut buffer, &options)
                .expect_err("no such part");
        assert!(["G076", "G070"].contains(&error.kind.code()), "{error}");
    }
}

#[test]
fn a_pocket_and_its_island_are_two_walls() {
    let (count, roles) = roles(ISLAND, &criteria(Some(1)));
    assert_eq!(count, 2);
    assert_eq!(rough(roles[0]), Some((1, 0.5, true)));
    assert_eq!(roles[1..], [Role::Finish { contour: 1, level: 1 }, Role::Finish { contour: 2, level: 1 }]);
}

#[test]
fn runs_of_another_tool_do_not_count() {
    for (tool, finish) in [(1, 1), (2, 3)] {
        let (count, roles) = roles(TWO_TOOLS, &criteria(Some(tool)));
        let other = roles.iter().filter(|r| **r == Role::OtherTool).count();
        assert_eq!((count, other, roles[finish]), (1, 2, Role::Finish { contour: 1, level: 1 }), "tool {tool}");
    }
    assert_eq!(roles(TWO_TOOLS, &criteria(None)).0, 2);
}

/// Kinds of the runs: `t`ravel, `f`acing, `F`inish, `r`ough, `s`pring, `o`ther tool.
fn kinds(program: &str) -> String {
    let kind = |role: &Role| match role {
        Role::Idle(Idle::Travel) => 't',
        Role::Idle(Idle::Facing) => 'f',
        Role::Finish { .. } => 'F',
        Role::Rough { .. } => 'r',
        Role::Spring { .. } => 's',
        Role::OtherTool => 'o',
    };
    roles(program, &criteria(None)).1.iter().map(kind).collect()
}

const SQUARE: &str = "X20 Y-20\nX20 Y20\nX-20 Y20\nX-20 Y-20\n";

#[test]
fn moves_between_cuts_make_no_wall() {
    let head = "G21 G90 F500\nG0 X-60 Y-60\nG0 Z15\n";
    // Feed-rate rapids: between two cuts, and home.
    let links =
        format!("{head}G0 X-20 Y-20\nG1 Z-5\n{SQUARE}G1 Z5\nX60 Y60\nX90\nZ-5\nX90 Y99\nX0\nY80\nG1 Z15\nX0 Y0\nM2\n");
    assert_eq!(kinds(&links), "FtFt");
    // The way home in a program without any rapid.
    let home = format!("G21 G90 F500\nG1 Z2.54\nG1 X-20 Y-20\nG1 Z-5\n{SQUARE}G1 Z2.54\nX0 Y0\nM2\n");
    assert_eq!(kinds(&home), "Ft");
    // The step to a helix, at Z 1.
    let helix = format!("{head}G0 X0 Y0\nG1 Z1\nX3\nG3 X-3 Z-2 I-3\nX3 Z-5 I3\nG1 X-20 Y-20\n{SQUARE}G0 Z15\nM2\n");
    assert_eq!(kinds(&helix), "tF");
    // The same where the part stands on Z 0, so that Z 1 may be a wall.
    assert_eq!(kinds(&helix.replace("Z-2", "Z0.9").replace("Z-5", "Z0.8")), "FF");
}

#[test]
fn what_may_be_a_wall_is_never_taken_for_a_move_between_cuts() {
    let head = "G21 G90 F500\nG0 X-60 Y-60\n";
    // Two shoulders, the lower one reached from the end of the other, beside the part.
    let shoulders = "G0 Z-5\nG1 X60\nG1 Z-10\nG1 X60 Y60\nG0 Z50\nM2\n";
    assert_eq!(kinds(&format!("{head}{shoulders}")), "FF");
    // The part stands on Z 0.
    assert_eq!(kinds(&format!("{head}{}", shoulders.replace("Z-5", "Z25").replace("Z-10", "Z-0.2"))), "FF");
    // A ledge reached from below, the last cut.
    let ledge = format!("{head}G0 Z15\nG1 Z-10\nG1 X-20 Y-20\n{SQUARE}G1 Z-5\nX-20 Y-99\nX99\nG0 Z50\nM2\n");
    assert_eq!(kinds(&ledge), "FF");
    // An edge at two depths, to and fro, plunging in place.
    let edge = "G0 Z15\nG1 Z1\nX60\nG1 Z-5\nX-60\nG1 Z-10\nX60\nG0 Z50\nM2\n";
    assert_eq!(kinds(&format!("{head}{edge}")), "FFF");
    // Above another contour that is as high, and the only run of all.
    assert_eq!(kinds(&format!("{head}G0 Z5\nG1 Z1\nX0\nG1 Z-3\nM2\n")), "F");
    let high = format!("{head}G0 Z15\nG1 Z2\n{SQUARE}G1 Z5\nX0\nG1 Z-5\nX20\nG0 Z50\nM2\n");
    assert_eq!(kinds(&high.replace("Z5\n", "Z2\n")).matches('t').count(), 0);
}

#[test]
fn a_move_straight_back_over_the_contour_is_a_lead() {
    let program = "G21 G90 F500\nG0 X-30 Y-25\nG0 Z-5\nG1 X-20\nY20\nX20\nY-20\nX-15\nX-5\nG0 Z50\nM2\n";
    let (count, runs, _) = searched(program, &criteria(None));
    assert_eq!((count, runs[0].run.lines), (1, LineRange { first: 4, last: 8 }));
    // An outline in a subprogram that goes back to where it begins again.
    let program = "G21 G90 F500\nG0 X-20 Y-30\nG0 Z-5\nG1 Y20\nX20\nY-20\nX-20\nY-30\nG0 Z50\nM2\n";
    let (count, runs, _) = searched(program, &criteria(None));
    assert_eq!((count, runs[0].run.lines), (1, LineRange { first: 4, last: 7 }));
    let program = program.replace("X-20\nY-30\nG0", "X-12\nG2 X-20 Y-12 J8\nG1 Y-30\nG0");
    let (count, runs, _) = searched(&program, &criteria(None));
    assert_eq!((count, runs[0].run.lines, runs[0].run.closed), (1, LineRange { first: 4, last: 8 }, false));
    // The same with a straight move to it and away from it.
    let program = program.replace("Y-30\nG0 Z50", "Y-30\nX-30\nG0 Z50");
    let program = program.replace("X-20 Y-30\nG0 Z-5\n", "X-30 Y-30\nG0 Z-5\nG1 X-20\n");
    let (count, runs, _) = searched(&program, &criteria(None));
    assert_eq!((count, runs[0].run.lines), (1, LineRange { first: 5, last: 9 }));
}

#[test]
fn facing_to_and_fro_above_all_else_makes_no_wall() {
    let head = "G21 G90 F500\nG0 X-60 Y-40\nG0 Z15\n";
    let zigzag: String = (0..9)
        .map(|k| {
            format!(
                "G1 X{} Y{}\nG1 X{}\n",
                if k % 2 == 0 { -50 } else { 50 },
                8 * k - 32,
                if k % 2 == 0 { 50 } else { -50 }
            )
        })
        .collect();
    let contour = format!("G0 Z15\nG0 X-20 Y-20\nG1 Z-8\n{SQUARE}G0 Z15\nM2\n");
    assert_eq!(kinds(&format!("{head}G1 Z0\n{zigzag}{contour}")), "fF");
    // Deeper than the contour it may be the floor of a pocket with a wall, and farther apart each line has its own.
    assert_eq!(kinds(&format!("{head}G1 Z-9\n{zigzag}{contour}")), "FF");
    let apart = zigzag.replace("Y-32", "Y-132").replace("Y-24", "Y-110").replace("Y-16", "Y-90").replace("Y-8", "Y-70");
    let apart = apart.replace("Y8", "Y70").replace("Y16", "Y90").replace("Y24", "Y110").replace("Y32", "Y132");
    assert_eq!(kinds(&format!("{head}G1 Z0\n{apart}{contour}")), "FF");
    // A wider cutter than the job's, which is known by equal steps where the part's top is Z 0.
    let wide = format!("{head}G1 Z0\nG1 X50\nY-8\nX-50\nY24\nX50\nY56\nX-50\n{contour}");
    assert_eq!(kinds(&wide), "fF");
    assert_eq!(kinds(&wide.replace("Z0\n", "Z9\n").replace("Z-8", "Z1")), "FF");
    assert_eq!(kinds(&wide.replace("Y24", "Y22")), "FF");
}

#[test]
fn a_shallower_wall_round_a_deeper_one_is_no_roughing_of_it() {
    // A counterbore: the inner, deeper wall is still there when the outer one is milled.
    let square = |half: i32, z: i32| {
        format!("G0 X0 Y-{half}\nG1 Z{z} F100\nG1 X{half}\nY{half}\nX-{half}\nY-{half}\nX0\nG0 Z5\n")
    };
    let program = format!("G21 G90\nG0 Z5\n{}{}M2\n", square(10, -9), square(14, -4));
    assert_eq!(roles(&program, &criteria(None)).0, 2);
    // The other way round the outer one takes the inner one's wall away.
    let program = format!("G21 G90\nG0 Z5\n{}{}M2\n", square(10, -4), square(14, -9));
    assert_eq!(roles(&program, &criteria(None)).0, 1);
}

#[test]
fn zigzag_roughing_inside_a_pocket_is_roughing() {
    let mut program = "G21 G90\nG0 Z5\nG0 X-15 Y-9\nG1 Z-4 F100\n".to_owned();
    for row in 0..7 {
        let (y, x) = (-9 + 3 * row, if row % 2 == 0 { 15 } else { -15 });
        program += &format!("G1 Y{y}\nG1 X{x}\n");
    }
    program += "G0 Z5\nG0 X0 Y-10\nG1 Z-4\nG1 X16\nY10\nX-16\nY-10\nX0\nG0 Z5\nM2\n";
    let (count, roles) = roles(&program, &criteria(None));
    assert_eq!(count, 1);
    assert!(matches!(roles[0], Role::Rough { nearer: 1, parallel: false, .. }), "{roles:?}");
}

#[test]
fn a_spring_pass_may_go_round_the_other_way() {
    let program = "G21 G90\nG0 X0 Y0 Z5\nG1 Z-4 F100\nX10\nY10\nX0\nY0\nG0 Z5\nG0 X10 Y10\nG1 Z-4\nX10 Y0\nX0\nY10\nX10\nG0 Z5\nM2\n";
    let (count, roles) = roles(program, &criteria(None));
    assert_eq!((count, roles[1]), (1, Role::Spring { contour: 1, level: 1 }));
}

#[test]
fn parallel_open_walls_are_roughing_and_finishing() {
    let corner = |off: f64| {
        let (x, y) = (34.0 + off, 30.0 + off);
        format!("G0 X{x} Y80\nG1 Z-10 F200\nG1 Y35\nG3 X39 Y{y} R{}\nG1 X90\nG0 Z5\n", 5.0 - off)
    };
    let program = format!("G21 G90\nG0 Z5\n{}{}M2\n", corner(0.5), corner(0.0));
    let (count, roles) = roles(&program, &criteria(None));
    assert_eq!(count, 1, "{roles:?}");
    assert!(matches!(roles[0], Role::Rough { nearer: 1, parallel: true, .. }), "{roles:?}");
}

#[test]
fn a_loop_gives_a_run_each_time_only_when_it_is_left_in_between() {
    // Twice round without a break is one run of two turns; with a retract between it is two.
    let turn = "X10\nY10\nX0\nY0\n";
    let program = format!("G21 G90\nG0 X0 Y0 Z5\nG1 Z-4 F100\n{turn}{turn}G0 Z5\nG1 Z-4\n{turn}G0 Z5\nM2\n");
    let (_, runs, _) = searched(&program, &criteria(None));
    assert_eq!(runs.iter().map(|f| f.run.blocks).collect::<Vec<_>>(), [8, 4]);
}

#[test]
fn moves_before_the_offset_is_taken_and_after_it_is_given_up_are_leads() {
    // An open wall: nothing but G41 and G40 tells its leads.
    let wall = |y: i32| {
        format!("G0 X0 Y20\nG1 Z-4 F100\nG1 X2\nG41 D1 G1 X5 Y{y}\nG1 X40\nG1 X60 Y{}\nG40 G1 X70 Y30\nG0 Z5\n", y - 9)
    };
    let program = format!("G21 G90\nG0 Z5\n{}{}M2\n", wall(1), wall(0));
    let (count, runs, _) = searched(&program, &criteria(None));
    assert_eq!(count, 1);
    for (found, first) in runs.iter().zip([7, 15]) {
        assert_eq!((found.skipped, found.run.blocks), (2, 2));
        assert_eq!(found.run.lines, LineRange { first, last: first + 1 });
    }
}

/// The only finishing contour of a program with the wall on the right of a cutter of 10 mm: its lines, and whether it is
/// closed.
fn only(moves: &str) -> (u32, u32, bool) {
    let program = format!("G21 G90 G17\nT1 M6\nS3000 M3\nG0 X0 Y0 Z10\n{moves}\nG0 Z10\nM2\n");
    let (count, runs, _) = searched(&program, &criteria(None));
    assert_eq!(count, 1, "{moves}");
    let found = runs.iter().find(|f| matches!(f.role, Role::Finish { .. })).unwrap();
    (found.run.lines.first, found.run.lines.last, found.run.closed)
}

#[test]
fn leads_without_cutter_compensation_are_no_wall() {
    // Line 5 is the first move. Tangent quarter circles on either side of an open wall.
    assert_eq!(only("G3 X5 Y-5 I5 J0 F500\nG1 X60\nG3 X65 Y0 I0 J5"), (6, 6, false));
    // Of 1 mm, in the manner of CAM systems.
    assert_eq!(only("G3 X1 Y-1 I1 J0 F500\nG1 X60\nG2 X65 Y-6 I0 J-5\nG3 X66 Y-7 I1 J0"), (6, 7, false));
    // A line and an arc on both sides.
    assert_eq!(only("G1 Y-2 F500\nG3 X5 Y-7 I5 J0\nG1 X60\nG3 X65 Y-2 I0 J5\nG1 Y3"), (7, 7, false));
    // Straight and short, straight and slanted.
    assert_eq!(only("G1 Y-4 F500\nG1 X60\nG1 Y0"), (6, 6, false));
    assert_eq!(only("G1 X8 Y-8 F500\nG1 X60\nG1 X68 Y0"), (6, 6, false));
    // What may be a wall stays: a leg, a quarter circle and a leg; a long leg; an arc that turns towards the wall.
    assert_eq!(only("G1 Y-20 F500\nG3 X5 Y-25 I5 J0\nG1 X60"), (5, 7, false));
    assert_eq!(only("G1 Y-20 F500\nG1 X60\nG1 Y0"), (5, 7, false));
    assert_eq!(only("G2 X5 Y5 I5 J0 F500\nG1 X60"), (5, 6, false));
}

#[test]
fn a_loop_that_misses_its_start_by_a_rounded_digit_is_whole() {
    // A pocket from the middle of a wall: the first and the last corner look like arcs of leads.
    let pocket = |x: &str, y: &str| {
        only(&format!(
            "G0 Y-20\nG1 X8 F500\nG3 X13 Y-15 I0 J5\nG1 Y15\nG3 X8 Y20 I-5 J0\nG1 X-8\nG3 X-13 Y15 I0 J-5\nG1 Y-15\n\
             G3 X-8 Y{y} I5 J0\nG1 X{x} Y{y}"
        ))
    };
    assert_eq!(pocket("0", "-20"), (6, 14, true));
    assert_eq!(pocket("-0.0001", "-20"), (6, 14, false));
    assert_eq!(pocket("0.004", "-20.003"), (6, 14, false));
    // Farther off it is no loop, and the ends are leads.
    assert_eq!(pocket("-0.1", "-20"), (8, 12, false));
}

#[test]
fn a_lap_that_runs_over_its_own_start_is_one_contour_without_its_leads() {
    let pocket = "G1 X40\nG1 Y30\nG1 X-40\nG1 Y-20";
    // From line 6: 2 mm milled twice, leads of quarter circles; the same without overlap.
    let arcs = |end: &str| format!("G0 Y-17\nG3 X3 Y-20 I3 J0 F500\n{pocket}\n{end}");
    assert_eq!(only(&arcs("G1 X5\nG3 X8 Y-17 I0 J3")), (7, 11, false));
    assert_eq!(only(&arcs("G1 X3\nG3 X6 Y-17 I0 J3")), (7, 11, true));
    // Where a loop closes at the ends of blocks, what is beside it is lead: an overlap of its own, or round a corner.
    assert_eq!(only(&arcs("G1 X3\nG1 X5\nG3 X8 Y-17 I0 J3")), (7, 11, true));
    let corner =
        "G0 X35 Y-17\nG3 X38 Y-20 I3 J0 F500\nG1 X40\nG1 Y30\nG1 X-40\nG1 Y-20\nG1 X40\nG1 Y-15\nG3 X37 Y-12 I-3 J0";
    assert_eq!(only(corner), (8, 11, true));
}
