//! Families that differ by cutter, cut or machine, over corners and pockets of the usual kind.

use truepath_plant::{Side, Spindle};

use crate::contour::Contour;
use crate::draw::Draw;
use crate::part::{CutRange, Material, Part, anywhere};

/// One or two inside corners, or an inside and an outside one.
fn corners(draw: &mut Draw, side: Side, cutter_radius: f64) -> Contour {
    let mut contour = Contour::new(anywhere(draw), draw.between(0.0, 360.0), side);
    contour.straight(draw.round(30.0, 50.0, 1.0));
    contour.inside(draw.round(3.0, 8.0, 0.5), draw.between(60.0, 100.0)).straight(draw.round(30.0, 50.0, 1.0));
    if draw.chance(0.4) {
        let radius = cutter_radius + draw.round(2.0, 8.0, 0.5);
        contour.outside(radius, draw.between(40.0, 90.0)).straight(draw.round(25.0, 40.0, 1.0));
    }
    contour
}

fn either(draw: &mut Draw) -> Side {
    if draw.chance(0.65) { Side::Right } else { Side::Left }
}

fn with(draw: &mut Draw, side: Side, range: &CutRange) -> Part {
    let cut = range.draw(draw);
    Part { material: range.material, ..Part::new(corners(draw, side, cut.radius_mm), cut) }
}

pub(super) fn soft_cross(draw: &mut Draw) -> Part {
    let side = either(draw);
    let part = with(draw, side, &CutRange { radii_mm: &[8.0, 10.0], ..CutRange::default() });
    Part { error_mm: (0.3, 0.7), cross: (0.18, 0.35), ..part }
}

pub(super) fn slender(draw: &mut Draw) -> Part {
    let side = either(draw);
    let range = CutRange {
        radii_mm: &[2.0, 3.0, 4.0],
        teeth: &[2],
        helix_deg: (28.0, 45.0),
        depth: (1.5, 3.0),
        allowance: (0.15, 0.3),
        material: Material::Aluminium,
    };
    Part { error_mm: (0.06, 0.3), bend: (0.2, 0.3), ..with(draw, side, &range) }
}

pub(super) fn helix_high(draw: &mut Draw) -> Part {
    let side = either(draw);
    with(draw, side, &CutRange { teeth: &[4], helix_deg: (45.0, 45.0), depth: (1.0, 2.2), ..CutRange::default() })
}

pub(super) fn helix_low(draw: &mut Draw) -> Part {
    let side = either(draw);
    with(draw, side, &CutRange { helix_deg: (5.0, 15.0), ..CutRange::default() })
}

pub(super) fn allowance_high(draw: &mut Draw) -> Part {
    let side = either(draw);
    with(draw, side, &CutRange { radii_mm: &[8.0, 10.0], allowance: (0.3, 0.5), ..CutRange::default() })
}

pub(super) fn left_hand(draw: &mut Draw) -> Part {
    let side = if draw.chance(0.6) { Side::Left } else { Side::Right };
    Part { spindle: Spindle::CounterClockwise, ..with(draw, side, &CutRange::default()) }
}

pub(super) fn feeds(draw: &mut Draw) -> Part {
    let side = either(draw);
    let cut = CutRange::default().draw(draw);
    let mut contour = Contour::new(anywhere(draw), draw.between(0.0, 360.0), side);
    let slow = draw.round(0.5, 0.8, 0.05);
    contour
        .straight(draw.round(30.0, 50.0, 1.0))
        .feed(slow)
        .inside(draw.round(3.0, 8.0, 0.5), draw.between(60.0, 100.0))
        .feed(draw.round(0.8, 1.3, 0.05))
        .straight(draw.round(35.0, 60.0, 1.0));
    if draw.chance(0.5) {
        contour
            .feed(slow)
            .inside(draw.round(3.0, 8.0, 0.5), draw.between(50.0, 90.0))
            .feed(1.0)
            .straight(draw.round(30.0, 45.0, 1.0));
    }
    Part::new(contour, cut)
}

pub(super) fn finishing(draw: &mut Draw) -> Part {
    let side = either(draw);
    let range = CutRange {
        radii_mm: &[3.0, 4.0, 5.0, 6.0],
        teeth: &[4, 4, 5, 6],
        helix_deg: (30.0, 42.0),
        depth: (1.0, 2.5),
        allowance: (0.07, 0.14),
        material: Material::Steel,
    };
    Part { error_mm: (0.05, 0.12), ..with(draw, side, &range) }
}
