//! The edge of a ball end and its contact point, and the ball's centre as the point whose chord error counts.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use truepath_multiaxis::ball::{BallEnd, Contacts};
use truepath_multiaxis::machine::{Counted, Machine, Tool};
use truepath_multiaxis::vector::{Vector, add_scaled, angle, norm, sub, unit};
use truepath_multiaxis::{Joints, Pose, chord_error};

use crate::machines::{Draw, types};

#[test]
fn the_edge_lies_on_the_sphere_and_on_the_helicoid() {
    for (radius, helix) in [(3.0, 30.0), (8.0, 45.0), (0.25, 10.0), (10.0, 75.0)] {
        let ball = BallEnd::new(radius, f64::to_radians(helix)).expect("a ball");
        let lead = ball.lead_mm().expect("a helix");
        assert!((f64::to_radians(helix).tan() - TAU * radius / lead).abs() < 1e-12, "tan β₀ = 2πR/P");
        for i in 0..=90 {
            let polar = f64::from(i).to_radians();
            let [x, y, z] = ball.edge(polar);
            // Eq 6: on the sphere that touches the plane z = 0 at the tip.
            assert!((norm([x, y, z - radius]) - radius).abs() < 1e-12 * radius);
            // Eq 5: on the helicoid, z = Pφ/2π at the angle φ about the axis.
            let lag = ball.lag(polar);
            assert!((z - lead * lag / TAU).abs() < 1e-12 * radius);
            assert!((x.hypot(y) - radius * polar.sin()).abs() < 1e-12 * radius);
            if i > 0 {
                assert!(
                    ((y.atan2(x) - lag) / TAU).rem_euclid(1.0).min(((lag - y.atan2(x)) / TAU).rem_euclid(1.0)) < 1e-9
                );
            }
            // Eq 8 as printed.
            assert!((lag - f64::to_radians(helix).tan() * (1.0 - polar.cos())).abs() < 1e-12);
        }
    }
}

#[test]
fn at_the_equator_the_edge_meets_the_shank_at_its_helix_angle() {
    // Slope of the edge there: the way around over the way up, by a difference.
    let ball = BallEnd::new(6.0, 35f64.to_radians()).expect("a ball");
    let h = 1e-6;
    let [a, b] = [FRAC_PI_2 - h, FRAC_PI_2].map(|polar| (6.0 * ball.lag(polar), ball.edge(polar)[2]));
    assert!(((b.0 - a.0) / (b.1 - a.1) - 35f64.to_radians().tan()).abs() < 1e-5);
}

#[test]
fn a_straight_edge_does_not_lag() {
    let ball = BallEnd::new(5.0, 0.0).expect("a ball");
    assert_eq!((ball.lag(1.0), ball.lead_mm()), (0.0, None));
}

#[test]
fn the_contact_point_lies_on_the_ball_where_its_normal_is_the_surfaces() {
    let ball = BallEnd::new(4.0, 0.5).expect("a ball");
    let mut draw = Draw::new(31);
    let mut touched = 0;
    for _ in 0..2_000 {
        let (Some(axis), normal) = (unit(draw.vector(1.0)), draw.vector(2.0)) else { continue };
        let pose = Pose { tip: draw.vector(50.0), axis };
        let shank = angle(axis, normal) > FRAC_PI_2;
        let Some(contact) = ball.contact(&pose, normal) else {
            assert!(shank);
            continue;
        };
        touched += 1;
        assert!(!shank);
        let centre = add_scaled(pose.tip, axis, 4.0);
        let out = sub(centre, contact.place);
        assert!((norm(out) - 4.0).abs() < 1e-12 && angle(out, normal) < 1e-7);
        // The local radius is the distance from the tool axis.
        let along: f64 = (0..3).map(|i| (contact.place[i] - pose.tip[i]) * axis[i]).sum();
        let aside = norm(sub(sub(contact.place, pose.tip), axis.map(|a| a * along)));
        assert!((contact.local_radius_mm - aside).abs() < 1e-9, "{contact:?} {aside}");
        assert!((along - ball.edge(contact.polar)[2]).abs() < 1e-9, "the height of the edge there");
        assert_eq!(contact.lag, ball.lag(contact.polar));
    }
    assert!(touched > 500);
}

#[test]
fn nothing_cuts_at_the_tip_and_everything_at_the_equator() {
    let ball = BallEnd::new(5.0, 0.5).expect("a ball");
    let upright = Pose { tip: [0.0; 3], axis: [0.0, 0.0, 1.0] };
    let flat = ball.contact(&upright, [0.0, 0.0, 2.0]).expect("a floor");
    assert_eq!((flat.local_radius_mm, ball.speed_m_per_min(flat.polar, 10_000.0)), (0.0, 0.0));
    let wall = ball.contact(&upright, [1.0, 0.0, 0.0]).expect("a wall");
    assert!((ball.speed_m_per_min(wall.polar, 10_000.0) - PI * 10.0 * 10.0).abs() < 1e-9, "πDn");
    assert_eq!(wall.place, [-5.0, 0.0, 5.0]);
    // Tilted by 30° on a floor, the working radius is half the ball's.
    let tilted = Pose { tip: [0.0; 3], axis: [0.5, 0.0, 0.75f64.sqrt()] };
    assert!((ball.contact(&tilted, [0.0, 0.0, 1.0]).expect("a floor").local_radius_mm - 2.5).abs() < 1e-12);
    assert_eq!(ball.contact(&upright, [0.0; 3]), None);
    assert_eq!(ball.contact(&upright, [f64::NAN, 0.0, 1.0]), None);
    for radius in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert_eq!(BallEnd::new(radius, 0.5), None);
    }
    assert_eq!(BallEnd::new(1.0, 1.5), None);
}

/// Turning the tool about the centre of its ball moves the tip by millimetres and the centre not at all.
#[test]
fn the_centre_of_the_ball_stands_where_the_tip_swings() {
    let mut draw = Draw::new(32);
    for kind in types() {
        let axes = *draw.machine(kind).rotary();
        let tool = Tool { length_mm: 100.0, ball_radius_mm: Some(5.0), helix_deg: 0.0, counted: Counted::BallCentre };
        let machine = Machine::new(axes, tool).expect("a machine");
        let centre: Vector = draw.vector(50.0);
        let words = [[0.1, 0.2], [0.1 + 1e-4, 0.2 - 2e-4]];
        let [from, to]: [Joints; 2] = words.map(|rotary| machine.inverse_counted(centre, rotary));
        let tips = [from, to].map(|joints| machine.forward(&joints).tip);
        assert!(norm(sub(machine.counted(&from), machine.counted(&to))) < 1e-9);
        assert!(norm(sub(tips[0], add_scaled(centre, machine.axis(from.rotary), -5.0))) < 1e-9);
        assert!(chord_error(&machine, &from, &to).exact < 1e-4);
    }
}

#[test]
fn the_span_of_contacts_is_that_of_its_positions() {
    let axes = *Draw::new(33).machine(types()[0]).rotary();
    let tool = Tool { length_mm: 0.0, ball_radius_mm: Some(4.0), helix_deg: 30.0, counted: Counted::Tip };
    let machine = Machine::new(axes, tool).expect("a machine");
    let normal = machine.axis([0.0; 2]);
    let mut contacts = Contacts::new(&machine, normal).expect("a ball and a normal");
    assert_eq!(contacts.span(), None);
    let words = [[0.0, 0.0], [0.3, 0.1], [-0.7, 0.4], [3.0, 0.0]];
    let polar = words.map(|rotary| angle(machine.axis(rotary), normal).to_degrees());
    words.iter().for_each(|&rotary| contacts.add(&machine, &Joints { xyz: [0.0; 3], rotary }));
    let span = contacts.span().expect("contacts");
    let touching = polar.iter().filter(|&&polar| polar <= 90.0).count() as u64;
    assert_eq!((span.places, span.on_shank), (touching, 4 - touching));
    assert!(touching == 3, "the last one lies on its back: {polar:?}");
    let most = polar[..3].iter().fold(0.0f64, |a, &b| a.max(b));
    assert!(span.polar_deg[0] == 0.0 && (span.polar_deg[1] - most).abs() < 1e-9);
    assert!((span.cutting_radius_mm[1] - 4.0 * most.to_radians().sin()).abs() < 1e-9);
    for normal in [[0.0; 3], [f64::NAN, 0.0, 1.0]] {
        assert!(Contacts::new(&machine, normal).is_none());
    }
}
