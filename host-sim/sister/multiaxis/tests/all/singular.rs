//! Moves near the pole: how they are classified, what the orientation error is, and what can be done about it.

use truepath_multiaxis::division::Orientation;
use truepath_multiaxis::machine::{Letter, Machine, Rotary, Sense, Side, Tool};
use truepath_multiaxis::singular::{Class, passage};
use truepath_multiaxis::vector::{Vector, angle, cross, dot, unit};
use truepath_multiaxis::{Joints, Rule, insert};

use crate::machines::{Draw, from_segment, place_by_matrices, tool_to_part, types, with_slack};

fn trunnion(letters: [Letter; 2]) -> Machine {
    let axis =
        |letter| Rotary { letter, side: Side::Table, point_mm: [0.0; 3], sense: Sense::RightHand, limits_deg: None };
    Machine::new(letters.map(axis), Tool::default()).expect("a machine")
}

fn moves(machine: &Machine, words: [[f64; 2]; 2]) -> [Joints; 2] {
    let points = [[30.0, 5.0, -10.0], [32.0, 8.0, -9.0]];
    [0, 1].map(|i| machine.inverse(points[i], words[i].map(f64::to_radians)))
}

/// Angle of a direction from the arc between two others, by rotating one onto the other.
fn from_arc(v: Vector, a: Vector, b: Vector) -> f64 {
    let ends = angle(v, a).min(angle(v, b));
    let Some(normal) = unit(cross(a, b)) else { return ends };
    let off = dot(v, normal).clamp(-1.0, 1.0).asin().abs();
    let (foot, whole) = (dot(cross(a, v), normal).atan2(dot(a, v)), angle(a, b));
    if (0.0..=whole).contains(&foot) { off } else { ends }
}

fn sampled(machine: &Machine, from: &Joints, to: &Joints) -> f64 {
    let axis = |joints: &Joints| {
        let m = tool_to_part(machine, joints);
        [m[0][2], m[1][2], m[2][2]]
    };
    let (a, b) = (axis(from), axis(to));
    (1..400).map(|i| from_arc(axis(&from.towards(to, f64::from(i) / 400.0)), a, b)).fold(0.0, f64::max)
}

#[test]
fn the_orientation_error_is_the_sampled_one() {
    let mut draw = Draw::new(21);
    for (i, kind) in types().into_iter().cycle().take(3_000).enumerate() {
        let machine = draw.machine(kind);
        let words = [0; 2].map(|_| draw.within(-3.0, 3.0));
        let turned = words.map(|word| word + draw.within(-1.0, 1.0));
        let [from, to] = [words, turned].map(|rotary| Joints { xyz: [0.0; 3], rotary });
        let found = passage(&machine, &from, &to);
        let sample = sampled(&machine, &from, &to);
        assert!(sample <= found.orientation_error + 1e-9, "{i} {kind:?} {sample} {found:?}");
        assert!(found.orientation_error <= sample * (1.0 + 1e-3) + 1e-6, "{i} {kind:?} {sample} {found:?}");
    }
}

#[test]
fn moves_are_classified_by_their_distance_from_the_pole_and_their_branches() {
    let machine = trunnion([Letter::A, Letter::C]);
    for (words, class, nearest) in [
        ([[30.0, 0.0], [31.0, 5.0]], Class::Regular, 30.0),
        ([[4.0, 0.0], [6.0, 5.0]], Class::NearPole, 4.0),
        ([[2.0, 0.0], [3.0, 170.0]], Class::NearPole, 2.0),
        ([[2.0, 0.0], [-3.0, 0.0]], Class::BranchChange, 0.0),
        ([[0.0, 0.0], [3.0, 90.0]], Class::NearPole, 0.0),
        ([[178.0, 0.0], [176.0, 0.0]], Class::NearPole, 2.0),
        ([[-30.0, 0.0], [-40.0, 0.0]], Class::Regular, 30.0),
    ] {
        let [from, to] = moves(&machine, words);
        let found = passage(&machine, &from, &to);
        assert_eq!(found.class, class, "{words:?}");
        assert!((found.nearest_pole.to_degrees() - nearest).abs() < 1e-9, "{words:?} {found:?}");
        assert!((found.swing.to_degrees() - (words[1][1] - words[0][1]).abs()).abs() < 1e-9);
    }
    // C turns the part about the upright tool: the axis hardly moves, the rotary axis by 170°.
    let [from, to] = moves(&machine, [[2.0, 0.0], [3.0, 170.0]]);
    assert!(passage(&machine, &from, &to).turn.to_degrees() < 5.0);
    let machine = trunnion([Letter::C, Letter::A]);
    let [from, to] = moves(&machine, [[0.0, 40.0], [10.0, 50.0]]);
    assert_eq!(passage(&machine, &from, &to).class, Class::NoTilt);
}

#[test]
fn the_pole_of_a_machine_without_c_lies_along_its_polar_axis() {
    // B carries A: the axis nearest to the part is A, and its line is reached at B = ±90°.
    let machine = trunnion([Letter::B, Letter::A]);
    let [from, to] = moves(&machine, [[80.0, 0.0], [88.0, 60.0]]);
    let found = passage(&machine, &from, &to);
    assert_eq!(found.class, Class::NearPole);
    assert!((found.nearest_pole.to_degrees() - 2.0).abs() < 1e-9);
    assert!((found.swing.to_degrees() - 60.0).abs() < 1e-9);
    let over = moves(&machine, [[80.0, 0.0], [100.0, 0.0]]);
    assert_eq!(passage(&machine, &over[0], &over[1]).class, Class::BranchChange);
}

#[test]
fn insertion_without_an_orientation_tolerance_holds_the_chord_and_reports_the_orientation() {
    let machine = trunnion([Letter::A, Letter::C]);
    let [from, to] = moves(&machine, [[2.0, 0.0], [3.0, 170.0]]);
    let done = insert(&machine, &from, &to, 0.005, Rule::Fewest).expect("an insertion");
    assert_eq!(done.orientation, Orientation::Kept);
    assert!(done.after <= with_slack(0.005) && done.before.exact > 1.0, "{done:?}");
    assert!(done.passage.orientation_error.to_degrees() > 1.5, "{:?}", done.passage);
}

#[test]
fn with_an_orientation_tolerance_the_axis_follows_the_great_circle_and_the_tip_the_chord() {
    let mut draw = Draw::new(22);
    let mut followed = 0;
    for kind in types().into_iter().cycle().take(1_800) {
        let tolerance = draw.decades(0.05, 2.0).to_radians();
        let machine = draw.machine(kind).with_orientation_tolerance(Some(tolerance));
        // Words that both solutions of the orientation permit, near the pole as well as away from it.
        let first = [0; 2].map(|_| draw.within(-1.5, 1.5));
        let turned = first.map(|word| word + draw.within(-0.3, 0.3));
        let Some(solutions) = machine.orient(machine.axis(turned), first) else { continue };
        let tip = draw.vector(100.0);
        let way = draw.vector(10.0);
        let end = [tip[0] + way[0], tip[1] + way[1], tip[2] + way[2]];
        let (from, to) = (machine.inverse_counted(tip, first), machine.inverse_counted(end, solutions[0]));
        let done = insert(&machine, &from, &to, 0.01, Rule::Fewest).expect("an insertion");
        assert!(done.after <= with_slack(0.01));
        let height = machine.counted_height_mm();
        let mut last = from;
        let arc = [machine.axis(from.rotary), machine.axis(to.rotary)];
        let mut worst = 0.0f64;
        for joints in done.inserted.iter().chain([&to]) {
            assert!(from_segment(place_by_matrices(&machine, joints, height), tip, end) < 1e-9);
            for i in 0..=20 {
                let m = tool_to_part(&machine, &last.towards(joints, f64::from(i) / 20.0));
                worst = worst.max(from_arc([m[0][2], m[1][2], m[2][2]], arc[0], arc[1]));
            }
            last = *joints;
        }
        match done.orientation {
            Orientation::Followed => {
                followed += 1;
                assert!(worst <= tolerance + 1e-7, "{worst} {tolerance} {done:?}");
                assert!(done.orientation_after <= tolerance);
            }
            Orientation::Kept => assert!(worst <= tolerance + 1e-7),
            Orientation::CannotFollow => assert!(done.orientation_after > tolerance),
        }
    }
    assert!(followed > 200, "{followed}");
}

#[test]
fn a_branch_the_inverse_does_not_lead_to_is_reported_and_not_rerouted() {
    let machine = trunnion([Letter::A, Letter::C]).with_orientation_tolerance(Some(0.1f64.to_radians()));
    // The same orientation as A 20, C 10, written on the other branch.
    let [from, to] = moves(&machine, [[20.0, 0.0], [-20.0, 190.0]]);
    let done = insert(&machine, &from, &to, 0.01, Rule::Fewest).expect("an insertion");
    assert_eq!((done.orientation, done.passage.class), (Orientation::CannotFollow, Class::BranchChange));
    // The rotary words are as programmed: linear from one end to the other.
    for joints in &done.inserted {
        let s = joints.rotary_deg()[1] / 190.0;
        assert!((joints.rotary_deg()[0] - (20.0 - 40.0 * s)).abs() < 1e-9);
    }
    assert!(done.orientation_after.to_degrees() > 5.0);
}
