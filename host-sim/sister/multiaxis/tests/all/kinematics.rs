//! The kinematics against a second formulation, against the published ones of LinuxCNC, and against their own inverse.

use truepath_multiaxis::Joints;
use truepath_multiaxis::kinematics::{Branch, Course};
use truepath_multiaxis::machine::{Letter, Machine, Rotary, Sense, Side, Tool};
use truepath_multiaxis::vector::{Vector, norm, sub};

use crate::machines::{Draw, place_by_matrices, tool_to_part, types};

fn near(a: Vector, b: Vector, allowance: f64) -> bool {
    norm(sub(a, b)) <= allowance
}

#[test]
fn the_chain_is_the_product_of_its_matrices() {
    let mut draw = Draw::new(1);
    for kind in types() {
        for _ in 0..200 {
            let machine = draw.machine(kind);
            let [joints, _] = draw.ends(&machine);
            let matrix = tool_to_part(&machine, &joints);
            let pose = machine.forward(&joints);
            assert!(near(pose.tip, std::array::from_fn(|i| matrix[i][3]), 1e-9), "{kind:?}");
            assert!(near(pose.axis, std::array::from_fn(|i| matrix[i][2]), 1e-12), "{kind:?}");
            let height = machine.counted_height_mm();
            assert!(near(machine.counted(&joints), place_by_matrices(&machine, &joints, height), 1e-9), "{kind:?}");
        }
    }
}

#[test]
fn the_inverse_leads_back() {
    let mut draw = Draw::new(2);
    for kind in types() {
        for _ in 0..200 {
            let machine = draw.machine(kind);
            let (tip, rotary) = (draw.vector(300.0), [0; 2].map(|_| draw.within(-7.0, 7.0)));
            assert!(near(machine.forward(&machine.inverse(tip, rotary)).tip, tip, 1e-9), "{kind:?}");
            assert!(near(machine.counted(&machine.inverse_counted(tip, rotary)), tip, 1e-9), "{kind:?}");
        }
    }
}

#[test]
fn at_rotary_zero_the_linear_words_are_the_tip() {
    let mut draw = Draw::new(3);
    for kind in types() {
        let machine = draw.machine(kind);
        let joints = Joints { xyz: draw.vector(300.0), rotary: [0.0; 2] };
        let pose = machine.forward(&joints);
        assert!(near(pose.tip, joints.xyz, 1e-9) && near(pose.axis, [0.0, 0.0, 1.0], 1e-15), "{kind:?}");
    }
}

fn trunnion(letter: Letter, offset: Vector, rot_point: Vector) -> Machine {
    let axis =
        |letter, point_mm| Rotary { letter, side: Side::Table, point_mm, sense: Sense::RightHand, limits_deg: None };
    let carried = std::array::from_fn(|i| offset[i] + rot_point[i]);
    Machine::new([axis(letter, carried), axis(Letter::C, rot_point)], Tool::default()).expect("a machine")
}

/// LinuxCNC's "5-Axis Kinematics" chapter: the tip Q of a trunnion A, C whose A axis lies Dy, Dz off the rotation point.
#[test]
fn a_trunnion_ac_is_linuxcncs_xyzac_trt() {
    let mut draw = Draw::new(4);
    for _ in 0..500 {
        let (d, rot) = (draw.vector(50.0), draw.vector(200.0));
        let machine = trunnion(Letter::A, [0.0, d[1], d[2]], rot);
        let joints = Joints { xyz: draw.vector(300.0), rotary: [draw.within(-2.0, 2.0), draw.within(-7.0, 7.0)] };
        let ((sa, ca), (sc, cc)) = (joints.rotary[0].sin_cos(), joints.rotary[1].sin_cos());
        let [px, py, pz] = sub(joints.xyz, rot);
        let tilted = [px, ca * (py - d[1]) + sa * (pz - d[2]) + d[1], ca * (pz - d[2]) - sa * (py - d[1]) + d[2]];
        let q = [cc * tilted[0] + sc * tilted[1], cc * tilted[1] - sc * tilted[0], tilted[2]];
        let tip = machine.forward(&joints).tip;
        assert!(near(sub(tip, rot), q, 1e-9), "{tip:?} {q:?}");
    }
}

/// The same chapter: a trunnion B, C whose B axis lies Dx, Dz off the rotation point.
#[test]
fn a_trunnion_bc_is_linuxcncs_xyzbc_trt() {
    let mut draw = Draw::new(5);
    for _ in 0..500 {
        let (d, rot) = (draw.vector(50.0), draw.vector(200.0));
        let machine = trunnion(Letter::B, [d[0], 0.0, d[2]], rot);
        let joints = Joints { xyz: draw.vector(300.0), rotary: [draw.within(-2.0, 2.0), draw.within(-7.0, 7.0)] };
        let ((sb, cb), (sc, cc)) = (joints.rotary[0].sin_cos(), joints.rotary[1].sin_cos());
        let [px, py, pz] = sub(joints.xyz, rot);
        let tilted = [cb * (px - d[0]) - sb * (pz - d[2]) + d[0], py, cb * (pz - d[2]) + sb * (px - d[0]) + d[2]];
        let q = [cc * tilted[0] + sc * tilted[1], cc * tilted[1] - sc * tilted[0], tilted[2]];
        let tip = machine.forward(&joints).tip;
        assert!(near(sub(tip, rot), q, 1e-9), "{tip:?} {q:?}");
    }
}

/// The bridge mill of LinuxCNC's 5axiskins: the tip hangs below the pivot on a sphere of the pivot length, B counted
/// from straight down. Its B turns left-handedly in our terms.
#[test]
fn a_head_cb_is_linuxcncs_five_axis_bridge_mill() {
    let axis = |letter, sense| Rotary { letter, side: Side::Head, point_mm: [0.0; 3], sense, limits_deg: None };
    let length = 250.0;
    let tool = Tool { length_mm: length, ..Tool::default() };
    let rotary = [axis(Letter::C, Sense::RightHand), axis(Letter::B, Sense::LeftHand)];
    let machine = Machine::new(rotary, tool).expect("a machine");
    let mut draw = Draw::new(6);
    for _ in 0..500 {
        let joints = Joints { xyz: draw.vector(300.0), rotary: [draw.within(-7.0, 7.0), draw.within(-2.0, 2.0)] };
        let ((sc, cc), (sb, cb)) = (joints.rotary[0].sin_cos(), joints.rotary[1].sin_cos());
        let hang = [length * sb * cc, length * sb * sc, length - length * cb];
        assert!(near(sub(machine.forward(&joints).tip, joints.xyz), hang, 1e-9));
    }
}

#[test]
fn the_derivatives_are_the_limits_of_differences_and_keep_within_their_bounds() {
    let mut draw = Draw::new(7);
    for kind in types() {
        for _ in 0..50 {
            let machine = draw.machine(kind);
            let [from, to] = draw.ends(&machine);
            for course in [Course::of_point(&machine, &from, &to), Course::of_axis(&machine, &from, &to)] {
                let bounds = course.bounds();
                let h = 1e-4;
                for i in 1..20 {
                    let t = f64::from(i) / 20.0;
                    let [a, m, b] = [t - h, t, t + h].map(|t| course.jet(t));
                    let scale = 1e-6 * (1.0 + bounds.third);
                    let first: Vector = std::array::from_fn(|i| (b.place[i] - a.place[i]) / (2.0 * h));
                    let second: Vector = std::array::from_fn(|i| (b.first[i] - a.first[i]) / (2.0 * h));
                    let third: Vector = std::array::from_fn(|i| (b.second[i] - a.second[i]) / (2.0 * h));
                    assert!(near(first, m.first, scale) && near(second, m.second, scale * 10.0), "{kind:?}");
                    assert!(norm(m.first) <= bounds.first * (1.0 + 1e-12), "{kind:?}");
                    assert!(norm(m.second) <= bounds.second * (1.0 + 1e-12), "{kind:?}");
                    assert!(norm(third) <= bounds.third * (1.0 + 1e-6) + 1e-6, "{kind:?}");
                }
            }
        }
    }
}

#[test]
fn both_solutions_of_the_orientation_give_the_axis_and_the_nearer_comes_first() {
    let mut draw = Draw::new(8);
    let mut tilting = 0;
    for kind in types() {
        for _ in 0..200 {
            let machine = draw.machine(kind);
            let near_words = [0; 2].map(|_| draw.within(-9.0, 9.0));
            let axis = machine.axis([0; 2].map(|_| draw.within(-9.0, 9.0)));
            let Some(solutions) = machine.orient(axis, near_words) else {
                assert!(!machine.tilts());
                continue;
            };
            tilting += 1;
            let way = |words: [f64; 2]| (words[0] - near_words[0]).abs() + (words[1] - near_words[1]).abs();
            assert!(way(solutions[0]) <= way(solutions[1]), "{kind:?}");
            for words in solutions {
                assert!(near(machine.axis(words), axis, 1e-9), "{kind:?}");
                assert!((0..2).all(|i| (words[i] - near_words[i]).abs() <= std::f64::consts::PI + 1e-9));
            }
            let branches = solutions.map(|words| machine.branch(words));
            assert!(branches.contains(&Branch::Pole) || branches[0] != branches[1], "{kind:?} {branches:?}");
        }
    }
    assert_eq!(tilting, 12 * 200, "of 18 types 12 tilt");
}
