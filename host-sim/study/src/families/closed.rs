//! Closed contours: pockets, bosses, bores. They begin in the middle of a straight wall, circles anywhere.

use truepath_plant::{Side, Spindle};

use crate::contour::Contour;
use crate::draw::Draw;
use crate::part::{Cut, CutRange, Part, anywhere, climb, conventional};

/// Cutters of pockets.
fn pocket_cut(draw: &mut Draw) -> Cut {
    CutRange { radii_mm: &[4.0, 5.0, 6.0, 8.0], teeth: &[3, 4, 4], allowance: (0.1, 0.22), ..CutRange::default() }
        .draw(draw)
}

/// Four walls and four like corners, which turn away from the wall or towards it.
fn rectangle(draw: &mut Draw, side: Side, radius: f64, inside: bool) -> Contour {
    let (width, height) = (draw.round(34.0, 70.0, 1.0), draw.round(30.0, 50.0, 1.0));
    let mut contour = Contour::new(anywhere(draw), draw.between(0.0, 360.0), side);
    contour.straight(width / 2.0);
    for length in [height, width, height, width / 2.0] {
        if inside {
            contour.inside(radius, 90.0).straight(length);
        } else {
            contour.outside(radius, 90.0).straight(length);
        }
    }
    contour
}

pub(super) fn pocket_climb(draw: &mut Draw) -> Part {
    let radius = draw.round(3.0, 7.0, 0.5);
    let contour = rectangle(draw, climb(Spindle::Clockwise), radius, true);
    Part::new(contour, pocket_cut(draw))
}

pub(super) fn pocket_conventional(draw: &mut Draw) -> Part {
    let radius = draw.round(3.0, 7.0, 0.5);
    let contour = rectangle(draw, conventional(Spindle::Clockwise), radius, true);
    Part::new(contour, pocket_cut(draw))
}

pub(super) fn pocket_tight(draw: &mut Draw) -> Part {
    let radius = draw.round(1.0, 3.0, 0.25);
    let contour = rectangle(draw, climb(Spindle::Clockwise), radius, true);
    let range =
        CutRange { radii_mm: &[4.0, 5.0, 6.0, 8.0], teeth: &[3, 4, 4], allowance: (0.1, 0.2), ..CutRange::default() };
    Part { error_mm: (0.06, 0.4), ..Part::new(contour, range.draw(draw)) }
}

pub(super) fn pocket_l(draw: &mut Draw) -> Part {
    let cut = pocket_cut(draw);
    let (inner, outer) = (draw.round(2.5, 6.0, 0.5), cut.radius_mm + draw.round(2.0, 6.0, 0.5));
    let (width, step, low) = (draw.round(60.0, 80.0, 1.0), draw.round(26.0, 34.0, 1.0), draw.round(24.0, 30.0, 1.0));
    // Lengths between the arcs of an L of the outer size `width` × `low + outer + inner + step`, closed by construction.
    let side = if draw.chance(0.7) { Side::Right } else { Side::Left };
    let mut contour = Contour::new(anywhere(draw), draw.between(0.0, 360.0), side);
    let upper = width - step - outer + 2.0 * inner;
    contour
        .straight(width / 2.0)
        .inside(inner, 90.0)
        .straight(low)
        .inside(inner, 90.0)
        .straight(step - inner)
        .outside(outer, 90.0)
        .straight(step - inner)
        .inside(inner, 90.0)
        .straight(upper - 2.0 * inner)
        .inside(inner, 90.0)
        .straight(low + outer + step)
        .inside(inner, 90.0)
        .straight(width / 2.0);
    Part::new(contour, cut)
}

pub(super) fn slot(draw: &mut Draw) -> Part {
    let cut = pocket_cut(draw);
    let (length, radius) = (draw.round(34.0, 70.0, 1.0), draw.round(6.0, 16.0, 0.5));
    let side = if draw.chance(0.7) { Side::Right } else { Side::Left };
    let mut contour = Contour::new(anywhere(draw), draw.between(0.0, 360.0), side);
    contour.straight(length / 2.0).inside(radius, 180.0).straight(length).inside(radius, 180.0).straight(length / 2.0);
    Part::new(contour, cut)
}

pub(super) fn boss(draw: &mut Draw) -> Part {
    let cut = CutRange::default().draw(draw);
    let side = if draw.chance(0.5) { Side::Right } else { Side::Left };
    let radius = cut.radius_mm + draw.round(1.5, 8.0, 0.5);
    let contour = rectangle(draw, side, radius, false);
    Part::new(contour, cut)
}

/// A full circle.
fn circle(draw: &mut Draw, side: Side, radius: f64, inside: bool) -> Contour {
    let mut contour = Contour::new(anywhere(draw), draw.between(0.0, 360.0), side);
    if inside {
        contour.inside(radius, 360.0);
    } else {
        contour.outside(radius, 360.0);
    }
    contour
}

pub(super) fn bore(draw: &mut Draw) -> Part {
    let side = if draw.chance(0.7) { Side::Right } else { Side::Left };
    let radius = draw.round(8.0, 30.0, 0.5);
    let contour = circle(draw, side, radius, true);
    Part::new(contour, pocket_cut(draw))
}

pub(super) fn boss_round(draw: &mut Draw) -> Part {
    let cut = CutRange::default().draw(draw);
    let side = if draw.chance(0.5) { Side::Right } else { Side::Left };
    let radius = cut.radius_mm + draw.round(8.0, 25.0, 0.5);
    let contour = circle(draw, side, radius, false);
    Part::new(contour, cut)
}
