//! Curves: in short lines, as a CAM system writes them, and as tangent arcs.

use std::f64::consts::{PI, TAU};

use truepath_plant::Side;

use crate::contour::{Contour, Kind};
use crate::draw::Draw;
use crate::part::{Cut, CutRange, Part, anywhere};

fn either(draw: &mut Draw) -> Side {
    if draw.chance(0.6) { Side::Right } else { Side::Left }
}

pub(super) fn wave(draw: &mut Draw) -> Part {
    let cut = CutRange { radii_mm: &[4.0, 5.0, 6.0, 8.0], ..CutRange::default() }.draw(draw);
    let (wave, waves) = (draw.round(40.0, 70.0, 1.0), draw.between(1.25, 2.5));
    // The outside of a wave is never more curved than 1.4 cutter radii.
    let steepest = wave * wave / (TAU * TAU * 1.4 * cut.radius_mm);
    let amplitude = draw.between(0.3, 1.0) * steepest.min(0.16 * wave);
    let phase = draw.between(0.0, TAU);
    let side = either(draw);
    let mut contour = Contour::new(anywhere(draw), draw.between(0.0, 360.0), side);
    let at = |u: f64| amplitude * ((TAU * waves * u + phase).sin() - phase.sin());
    contour.curve(draw.between(0.2, 0.7), wave * waves, |u| [wave * waves * u, at(u)]);
    Part::new(contour, cut)
}

pub(super) fn corner_in_lines(draw: &mut Draw) -> Part {
    let side = either(draw);
    let mut contour = Contour::new(anywhere(draw), draw.between(0.0, 360.0), side);
    let (radius, degrees) = (draw.round(4.0, 12.0, 0.5), draw.between(50.0, 100.0));
    contour.straight(draw.round(30.0, 50.0, 1.0));
    // At most 10 degrees a line.
    contour.in_lines(Kind::Inside, radius, degrees, draw.between(0.2, 0.6).min(radius * PI / 18.0));
    contour.straight(draw.round(30.0, 50.0, 1.0));
    Part::new(contour, CutRange::default().draw(draw))
}

pub(super) fn ellipse(draw: &mut Draw) -> Part {
    let cut = CutRange { radii_mm: &[4.0, 5.0, 6.0, 8.0], allowance: (0.1, 0.22), ..CutRange::default() }.draw(draw);
    let (a, b) = (draw.round(22.0, 36.0, 0.5), draw.round(12.0, 20.0, 0.5));
    let side = either(draw);
    // Begins at the flat side, travels with the pocket away from the wall.
    let away = -side.sign();
    let mut contour = Contour::new(anywhere(draw), draw.between(0.0, 360.0), side);
    let length = PI * (3.0 * (a + b) - ((3.0 * a + b) * (a + 3.0 * b)).sqrt());
    contour.curve(draw.between(0.25, 0.6), length, |u| {
        let t = TAU * u;
        [a * t.sin(), away * b * (1.0 - t.cos())]
    });
    Part::new(contour, cut)
}

/// A tangent S: an inside arc, an outside arc, straight ends.
fn s_contour(draw: &mut Draw, cut: &Cut) -> Contour {
    let side = either(draw);
    let mut contour = Contour::new(anywhere(draw), draw.between(0.0, 360.0), side);
    let inside = draw.round(8.0, 20.0, 0.5);
    let outside = cut.radius_mm + draw.round(5.0, 16.0, 0.5);
    let turns = (draw.between(40.0, 90.0), draw.between(40.0, 90.0));
    contour.straight(draw.round(18.0, 30.0, 1.0));
    if draw.chance(0.5) {
        contour.inside(inside, turns.0).outside(outside, turns.1);
    } else {
        contour.outside(outside, turns.0).inside(inside, turns.1);
    }
    contour.straight(draw.round(18.0, 30.0, 1.0));
    contour
}

pub(super) fn s_two_teeth(draw: &mut Draw) -> Part {
    let range = CutRange {
        radii_mm: &[3.0, 4.0, 5.0, 6.0],
        teeth: &[2],
        depth: (1.2, 2.2),
        allowance: (0.15, 0.3),
        ..CutRange::default()
    };
    let cut = range.draw(draw);
    Part { error_mm: (0.06, 0.35), ..Part::new(s_contour(draw, &cut), cut) }
}

pub(super) fn s_arcs(draw: &mut Draw) -> Part {
    let cut = CutRange { teeth: &[3, 4, 6], ..CutRange::default() }.draw(draw);
    Part::new(s_contour(draw, &cut), cut)
}

pub(super) fn profile(draw: &mut Draw) -> Part {
    let cut = CutRange { radii_mm: &[4.0, 5.0, 6.0, 8.0], ..CutRange::default() }.draw(draw);
    let side = either(draw);
    let mut contour = Contour::new(anywhere(draw), draw.between(0.0, 360.0), side);
    contour.straight(draw.round(20.0, 40.0, 1.0));
    let mut inside = draw.chance(0.5);
    for _ in 0..4 {
        let degrees = draw.between(20.0, 70.0);
        if inside {
            contour.inside(draw.round(2.0, 25.0, 0.5), degrees);
        } else {
            contour.outside(cut.radius_mm + draw.round(2.0, 25.0, 0.5), degrees);
        }
        inside = !inside;
        if draw.chance(0.6) {
            contour.straight(draw.round(12.0, 30.0, 1.0));
        }
    }
    contour.straight(draw.round(20.0, 40.0, 1.0));
    Part::new(contour, cut)
}
