//! One example of each kind of joint; the numbers follow from the drawing.

use super::*;

const LEFT: Cutter = Cutter { side: Side::Left, radius: Offset::from_nm(5 * MM) };
const RIGHT: Cutter = Cutter { side: Side::Right, radius: Offset::from_nm(5 * MM) };

fn ends(pieces: &[Piece]) -> Vec<(i64, i64)> {
    pieces.iter().map(|p| (p.to.x.nm() / 1_000, p.to.y.nm() / 1_000)).collect()
}

#[test]
fn inside_corners_of_lines_end_where_the_paths_meet() {
    let corners = [at(0, 0), at(20_000, 0), at(50_000, 0), at(50_000, 30_000), at(20_000, 30_000)];
    let lines: Vec<Piece> = corners.windows(2).map(|w| line(w[0], w[1])).collect();
    let out = path(LEFT, &lines).unwrap();
    assert_eq!(ends(&out), [(20_000, 5_000), (45_000, 5_000), (45_000, 25_000), (20_000, 25_000)]);
}

#[test]
fn outside_corners_get_an_arc_about_the_corner() {
    let out = path(
        RIGHT,
        &[line(at(0, 0), at(20_000, 0)), line(at(20_000, 0), at(50_000, 0)), line(at(50_000, 0), at(50_000, 30_000))],
    )
    .unwrap();
    assert_eq!(ends(&out), [(20_000, -5_000), (50_000, -5_000), (55_000, 0), (55_000, 30_000)]);
    assert_eq!(out[2].shape, Shape::Arc { centre: at(50_000, 0), counter_clockwise: true, turns: 0 });
}

#[test]
fn a_reversal_is_an_outside_corner_of_half_a_turn() {
    let out = path(LEFT, &[line(at(0, 0), at(50_000, 0)), line(at(50_000, 0), at(20_000, 0))]).unwrap();
    assert_eq!(ends(&out), [(50_000, 5_000), (50_000, -5_000), (20_000, -5_000)]);
}

#[test]
fn tangent_arcs_keep_their_centre_and_change_their_radius() {
    let quarter = arc(at(50_000, 0), at(70_000, 20_000), at(50_000, 20_000), true);
    let out = path(LEFT, &[line(at(0, 0), at(50_000, 0)), quarter]).unwrap();
    assert_eq!(ends(&out), [(50_000, 5_000), (65_000, 20_000)]);
    let out = path(RIGHT, &[line(at(0, 0), at(50_000, 0)), quarter]).unwrap();
    assert_eq!(ends(&out), [(50_000, -5_000), (75_000, 20_000)]);
    assert_eq!(out[1].shape, quarter.shape);
}

#[test]
fn a_line_meets_an_arc_before_an_inside_corner() {
    // From the programs that the reference interpreter ran: (45.5051, 5) and (26.6667, 16.2732).
    let first = [line(at(0, 0), at(50_000, 0)), arc(at(50_000, 0), at(70_000, 20_000), at(70_000, 0), false)];
    let out = path(LEFT, &first).unwrap();
    assert_eq!(ends(&out), [(45_505, 5_000), (70_000, 25_000)]);
    let quarter = arc(at(50_000, 0), at(70_000, 20_000), at(50_000, 20_000), true);
    let out = path(RIGHT, &[line(at(0, 0), at(50_000, 0)), quarter, line(at(70_000, 20_000), at(90_000, 20_000))]);
    assert_eq!(ends(&out.unwrap())[1], (74_494, 15_000));
}

#[test]
fn a_full_circle_loses_what_the_corners_take() {
    let circle = arc(at(50_000, 0), at(50_000, 0), at(50_000, 15_000), false);
    let out = path(LEFT, &[line(at(0, 0), at(50_000, 0)), circle, line(at(50_000, 0), at(0, 0))]).unwrap();
    assert_eq!(ends(&out), [(32_679, 5_000), (50_000, -5_000), (0, -5_000)]);
    assert_eq!(out[1].shape, circle.shape);
}

#[test]
fn an_entry_along_an_arc_arrives_in_the_same_direction() {
    let quarter = arc(at(0, 0), at(20_000, 20_000), at(20_000, 0), false);
    let out = path(RIGHT, &[quarter]).unwrap();
    assert_eq!(ends(&out), [(20_000, 15_000)]);
    let Shape::Arc { centre, counter_clockwise: false, turns: 0 } = out[0].shape else { panic!("{out:?}") };
    assert_eq!((centre.x.nm(), centre.y.nm()), (20 * MM, -5_833_333));
}

#[test]
fn what_the_cutter_cannot_do_is_refused() {
    let radius = Offset::from_nm(5 * MM);
    let length = Offset::from_nm(5 * MM);
    let short = path(LEFT, &[line(at(0, 0), at(5_000, 0))]);
    assert_eq!(short, Err(CompensationError::EntryTooShort { length, radius }));
    let tight = arc(at(50_000, 0), at(55_000, 5_000), at(50_000, 5_000), true);
    let tight = path(LEFT, &[line(at(0, 0), at(50_000, 0)), tight]);
    assert_eq!(tight, Err(CompensationError::ArcTooSmall { arc: length, radius }));
    let step = [(0, 0), (50_000, 0), (50_000, 3_000), (90_000, 3_000)].map(|(x, y)| at(x, y));
    let step: Vec<Piece> = step.windows(2).map(|w| line(w[0], w[1])).collect();
    let length = Offset::from_nm(3 * MM);
    assert_eq!(path(LEFT, &step), Err(CompensationError::MoveUnreachable { length, radius }));
    let nook = arc(at(50_000, 0), at(40_000, 0), at(45_000, 3_000), true);
    let nook = path(LEFT, &[line(at(0, 0), at(50_000, 0)), nook]);
    assert_eq!(nook, Err(CompensationError::CornerUnreachable { radius }));
    let circle = arc(at(0, 0), at(0, 0), at(0, 20_000), true);
    assert!(matches!(path(RIGHT, &[circle]), Err(CompensationError::EntryArcTooSmall { .. })));
}

#[test]
fn a_slot_exactly_as_wide_as_the_cutter_is_cut() {
    let slot = [(0, 0), (50_000, 0), (50_000, 10_000), (20_000, 10_000)].map(|(x, y)| at(x, y));
    let slot: Vec<Piece> = slot.windows(2).map(|w| line(w[0], w[1])).collect();
    assert_eq!(ends(&path(LEFT, &slot).unwrap()), [(45_000, 5_000), (45_000, 5_000), (20_000, 5_000)]);
}
