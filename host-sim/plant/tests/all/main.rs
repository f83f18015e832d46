//! The plant against the closed forms, the published corner and the symmetries of the physics.

mod effects;
mod nuisances;
mod part;
mod reference;
mod symmetry;

use truepath_plant::{BendLaw, Cut, Machine, Milled, Path, PlantError, Point, Segment, Side, Spindle, WallLaw, mill};

fn line(from: Point, to: Point) -> Segment {
    Segment::Line { from, to }
}

fn arc(from: Point, to: Point, centre: Point, ccw: bool) -> Segment {
    Segment::Arc { from, to, centre, ccw }
}

/// The corner of P18 and P23; the arc starts at s = 45 mm.
fn corner() -> Vec<Segment> {
    vec![
        line([34.0, 80.0], [34.0, 35.0]),
        arc([34.0, 35.0], [39.0, 30.0], [39.0, 35.0], true),
        line([39.0, 30.0], [90.0, 30.0]),
    ]
}

fn d20() -> Cut {
    Cut {
        radius_mm: 10.0,
        teeth: 6,
        helix_deg: 30.0,
        axial_depth_mm: 10.0,
        feed_mm_per_min: 400.0,
        feed_changes: vec![],
        spindle_rpm: 1500.0,
        spindle: Spindle::Clockwise,
        allowance_mm: 3.0,
        surface: None,
        memory_mm: None,
    }
}

/// The machine of P23: mean law, no edge force.
fn p23() -> Machine {
    Machine {
        ktc_n_per_mm2: 1147.7,
        krc_n_per_mm2: 0.3 * 1147.7,
        compliance_mm_per_n: Machine::compliance_of_stiffness(1150.0, 1150.0),
        law: WallLaw::Mean,
        ..Machine::rigid()
    }
}

/// Everything at once.
fn hard() -> Machine {
    Machine {
        ktc_n_per_mm2: 1000.0,
        krc_n_per_mm2: 330.0,
        kte_n_per_mm: 12.0,
        kre_n_per_mm: 16.0,
        size_exponent: 0.2,
        compliance_mm_per_n: [[1.0 / 1150.0, 1.0 / 9000.0], [1.0 / 9000.0, 1.0 / 900.0]],
        bend: 0.15,
        runout_mm: vec![0.002, -0.001, 0.003, 0.0, -0.002, 0.001],
        edge_wear_per_m: 0.5,
        stock_variation_mm: 0.05,
        probe_noise_mm: 0.002,
        seed: 3,
        ..Machine::rigid()
    }
}

fn pass(segments: &[Segment], side: Side, cut: &Cut, machine: &Machine) -> Milled {
    let path = Path::new(segments, side, 0.1).expect("valid path");
    let milled = mill(&path, cut, machine, None).expect("valid set-up");
    assert!(milled.residual_mm < 1e-6, "the elastic loop stayed open by {} mm", milled.residual_mm);
    milled
}

/// Engaged arc at the place s of a nominal pass, degrees, between samples by proportion.
fn arc_deg(milled: &Milled, s: f64) -> f64 {
    let k = milled.samples.partition_point(|x| x.s_mm < s).max(1);
    let (a, b) = (&milled.samples[k - 1], &milled.samples[k]);
    let u = (s - a.s_mm) / (b.s_mm - a.s_mm);
    (a.leaving_rad() * (1.0 - u) + b.leaving_rad() * u).to_degrees()
}
