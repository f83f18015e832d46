//! What must not matter, and what must change its sign.

use super::*;

fn mirrored(p: Point) -> Point {
    [-p[0], p[1]]
}

#[test]
fn the_mirrored_program_on_the_mirrored_machine_has_the_mirrored_errors() {
    let mirror: Vec<Segment> = corner()
        .into_iter()
        .map(|s| match s {
            Segment::Line { from, to } => line(mirrored(from), mirrored(to)),
            Segment::Arc { from, to, centre, ccw } => arc(mirrored(from), mirrored(to), mirrored(centre), !ccw),
        })
        .collect();
    let machine = hard();
    let [[xx, xy], [yx, yy]] = machine.compliance_mm_per_n;
    let mirror_machine = Machine { compliance_mm_per_n: [[xx, -xy], [-yx, yy]], ..machine.clone() };
    let mirror_cut = Cut { spindle: Spindle::CounterClockwise, ..d20() };
    let a = pass(&corner(), Side::Right, &d20(), &machine).wall_errors(&[0.1, 0.6]);
    let b = pass(&mirror, Side::Left, &mirror_cut, &mirror_machine).wall_errors(&[0.1, 0.6]);
    for (a, b) in a.iter().flatten().zip(b.iter().flatten()) {
        assert!((a - b).abs() < 1e-9, "{a} {b}");
    }
    assert!(a[0].iter().any(|e| e.abs() > 0.1));
}

#[test]
fn turning_everything_by_a_quarter_turns_the_errors_with_it() {
    let turned = |p: Point| [-p[1] + 7.0, p[0] - 3.0];
    let quarter: Vec<Segment> = corner()
        .into_iter()
        .map(|s| match s {
            Segment::Line { from, to } => line(turned(from), turned(to)),
            Segment::Arc { from, to, centre, ccw } => arc(turned(from), turned(to), turned(centre), ccw),
        })
        .collect();
    let machine = hard();
    let [[xx, xy], [yx, yy]] = machine.compliance_mm_per_n;
    let turned_machine = Machine { compliance_mm_per_n: [[yy, -yx], [-xy, xx]], ..machine.clone() };
    let a = pass(&corner(), Side::Right, &d20(), &machine).mean_errors();
    let b = pass(&quarter, Side::Right, &d20(), &turned_machine).mean_errors();
    for (a, b) in a.iter().zip(&b) {
        assert!((a - b).abs() < 1e-7, "{a} {b}");
    }
}

#[test]
fn climb_leaves_material_and_conventional_milling_gouges() {
    let straight = [line([0.0, 0.0], [60.0, 0.0])];
    let climb = pass(&straight, Side::Right, &d20(), &p23()).score();
    let conventional = pass(&straight, Side::Left, &d20(), &p23()).score();
    assert!(climb.gouge_mm < -0.05, "{climb:?}");
    assert!(conventional.gouge_mm > 0.02, "{conventional:?}");
}
