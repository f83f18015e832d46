//! Open contours of straight walls and corner arcs.

use truepath_plant::{Side, Spindle, WallLaw};

use crate::contour::Contour;
use crate::draw::Draw;
use crate::part::{Cut, CutRange, Part, anywhere, climb, conventional};

/// The papers' corner and cut (P18, P23) with F400.
fn papers() -> (Contour, Cut) {
    let mut contour = Contour::new([34.0, 80.0], -90.0, Side::Right);
    contour.straight(45.0).inside(5.0, 90.0).straight(51.0);
    let cut = Cut {
        radius_mm: 10.0,
        teeth: 6,
        helix_deg: 30.0,
        depth_mm: 10.0,
        allowance_mm: 3.0,
        rpm: 1500.0,
        feed_mm_per_min: 400.0,
    };
    (contour, cut)
}

pub(super) fn papers_mean(draw: &mut Draw) -> Part {
    let (contour, cut) = papers();
    let places = vec![draw.round(22.0, 32.0, 1.0), draw.round(72.0, 86.0, 1.0)];
    Part {
        law: WallLaw::Mean,
        model: "mean",
        plain: true,
        error_mm: (0.15, 0.45),
        cross: (0.0, 0.0),
        bend: (0.0, 0.0),
        levels: &[0.5],
        places_mm: places,
        ..Part::new(contour, cut)
    }
}

pub(super) fn papers_helix(draw: &mut Draw) -> Part {
    let (contour, cut) = papers();
    let places = [18.0, 31.0, 67.0, 80.0].map(|s| s + draw.round(-2.0, 2.0, 0.5)).to_vec();
    Part { error_mm: (0.15, 0.5), places_mm: places, ..Part::new(contour, cut) }
}

/// Two walls and an inside corner, anywhere and at any angle.
fn corner(draw: &mut Draw, side: Side, radius: (f64, f64), degrees: (f64, f64)) -> Contour {
    let mut contour = Contour::new(anywhere(draw), draw.between(0.0, 360.0), side);
    contour
        .straight(draw.round(32.0, 55.0, 1.0))
        .inside(draw.round(radius.0, radius.1, 0.25), draw.between(degrees.0, degrees.1))
        .straight(draw.round(32.0, 55.0, 1.0));
    contour
}

fn either(draw: &mut Draw) -> Side {
    if draw.chance(0.65) { Side::Right } else { Side::Left }
}

pub(super) fn mean_auto(draw: &mut Draw) -> Part {
    let contour = corner(draw, Side::Right, (3.0, 8.0), (75.0, 100.0));
    let cut = CutRange { teeth: &[4, 6], ..CutRange::default() }.draw(draw);
    Part { law: WallLaw::Mean, bend: (0.0, 0.1), ..Part::new(contour, cut) }
}

pub(super) fn far(draw: &mut Draw) -> Part {
    let side = either(draw);
    let contour = corner(draw, side, (3.0, 8.0), (60.0, 110.0));
    Part::new(contour, CutRange::default().draw(draw))
}

pub(super) fn wide(draw: &mut Draw) -> Part {
    let side = either(draw);
    let contour = corner(draw, side, (4.0, 12.0), (25.0, 60.0));
    Part::new(contour, CutRange::default().draw(draw))
}

pub(super) fn acute(draw: &mut Draw) -> Part {
    let side = either(draw);
    let contour = corner(draw, side, (3.0, 6.0), (110.0, 140.0));
    Part::new(contour, CutRange { allowance: (0.1, 0.22), ..CutRange::default() }.draw(draw))
}

pub(super) fn two(draw: &mut Draw) -> Part {
    let side = either(draw);
    let mut contour = corner(draw, side, (3.0, 8.0), (60.0, 95.0));
    contour.inside(draw.round(2.5, 10.0, 0.25), draw.between(40.0, 90.0)).straight(draw.round(28.0, 45.0, 1.0));
    Part::new(contour, CutRange::default().draw(draw))
}

/// Walls that meet at outside corners of wall radius 1…10 mm.
fn outside(draw: &mut Draw, side: Side, corners: usize) -> Part {
    let cut = CutRange::default().draw(draw);
    let mut contour = Contour::new(anywhere(draw), draw.between(0.0, 360.0), side);
    contour.straight(draw.round(30.0, 50.0, 1.0));
    for _ in 0..corners {
        let radius = cut.radius_mm + draw.round(1.0, 10.0, 0.5);
        contour.outside(radius, draw.between(45.0, 100.0)).straight(draw.round(28.0, 50.0, 1.0));
    }
    Part::new(contour, cut)
}

pub(super) fn outside_conventional(draw: &mut Draw) -> Part {
    outside(draw, conventional(Spindle::Clockwise), 1)
}

pub(super) fn outside_climb(draw: &mut Draw) -> Part {
    outside(draw, climb(Spindle::Clockwise), 2)
}

pub(super) fn wall(draw: &mut Draw) -> Part {
    let side = either(draw);
    let mut contour = Contour::new(anywhere(draw), draw.between(0.0, 360.0), side);
    contour.straight(draw.round(90.0, 160.0, 1.0));
    Part::new(contour, CutRange::default().draw(draw))
}
