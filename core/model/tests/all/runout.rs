//! Teeth that do not reach equally far, against sums over thin slices of every flute.

use crate::corner;
use corner::*;
use proptest::prelude::*;
use std::f64::consts::{PI, TAU};
use truepath_model::cut::{Coefficients, Compliance, CutSetup, ForceTable, Milling, Runout, State, Teeth, WallLaw};
use truepath_units::Offset;
use truepath_units::geometry::Vector;

/// A millimetre of deflection for a kilonewton, in every direction and at every height.
fn compliance() -> Compliance {
    Compliance::from_stiffness(real(1000.0), real(1000.0))
}

fn edged() -> Coefficients {
    Coefficients { kte: real(12.0), kre: real(16.0), ..coefficients() }
}

fn cutter(teeth: u8, milling: Milling, (offset_um, behind): (f64, f64)) -> CutSetup {
    let runout = Runout { offset: Offset::from_nm((offset_um * 1000.0).round() as i64), behind: real(behind) };
    CutSetup { teeth, milling, runout, ..setup(WallLaw::Helical) }
}

/// Where the wall at a height ends, along the normal and in travel, mm: as the model says it.
fn made(setup: &CutSetup, coefficients: Coefficients, engaged: f64, feed: f64, fraction: f64) -> Vector {
    let path = path(&corner(), setup, 1000);
    let table = ForceTable::new(coefficients.size_exponent);
    let machine = truepath_model::cut::Loop { coefficients, ..machine(&path, &table, compliance()) };
    let normal = path.samples()[path.first()].normal;
    let chip_scale = coefficients.chip_scale(real(feed));
    let state = State { engaged: real(engaged), normal, chip_scale, ..State::REST };
    let mut teeth = Teeth::BLANK;
    let at = machine.at_height(&mut teeth, &state, real(fraction));
    Vector { x: at.along(normal), y: at.along(setup.wall.heading(normal)) }
}

/// The same from slices of 1/4000 of the depth: (along the normal with the reach, in travel) of the tooth that ends deepest,
/// and how much deeper it ends than the next one.
fn by_slices(setup: &CutSetup, k: Coefficients, engaged: f64, feed: f64, fraction: f64) -> ([f64; 2], f64) {
    const SLICES: usize = 4000;
    let teeth = i64::from(setup.teeth);
    let pitch = TAU / teeth as f64;
    let reach = |j: i64| {
        setup.runout.offset.nm() as f64 / 1e6 * (pitch * j.rem_euclid(teeth) as f64 - float(setup.runout.behind)).cos()
    };
    let depth = float(setup.axial_depth);
    let lag = float(setup.helix_deg).to_radians().tan() / (setup.radius.nm() as f64 / 1e6);
    let sense = if setup.milling == Milling::Climb { -1.0 } else { 1.0 };
    let [ktc, krc, kte, kre] = [k.ktc, k.krc, k.kte, k.kre].map(float);
    let m = float(k.size_exponent);
    let mut ends: Vec<[f64; 2]> = (0..teeth)
        .map(|maker| {
            let mut force = [0.0; 2];
            for turn in 0..teeth {
                // The tooth that passes `turn` pitches behind the maker.
                let tooth = maker + turn;
                for slice in 0..SLICES {
                    let z = (slice as f64 + 0.5) / SLICES as f64 * depth;
                    // Of the cutter's rotation: an edge lags over the height, later teeth by pitches.
                    let phi = (sense * (lag * (fraction * depth - z) - pitch * turn as f64)).rem_euclid(TAU);
                    if phi > engaged.min(PI) {
                        continue;
                    }
                    let (s, c) = phi.sin_cos();
                    let left = (1..=teeth).map(|k| k as f64 * feed * s + reach(tooth) - reach(tooth - k));
                    let chip = left.fold(f64::INFINITY, f64::min);
                    if chip <= 0.0 {
                        continue;
                    }
                    let chip = chip.powf(1.0 - m) * 0.05f64.powf(m);
                    let slice = depth / SLICES as f64;
                    let (t, r) = (slice * (ktc * chip + kte), slice * (krc * chip + kre));
                    force[0] += sense * t * s - r * c;
                    force[1] += -sense * t * c - r * s;
                }
            }
            [force[0] / 1000.0 + reach(maker), force[1] / 1000.0]
        })
        .collect();
    ends.sort_by(|a, b| b[0].total_cmp(&a[0]));
    (ends[0], ends[0][0] - ends[1][0])
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn the_tooth_that_ends_deepest_makes_the_wall_with_the_force_of_its_own_chips(
        teeth in 2u8..=8,
        climb in any::<bool>(),
        offset_um in 0.5f64..60.0,
        behind in 0.0f64..TAU,
        engaged in 0.2f64..3.1,
        feed in 0.02f64..0.15,
        fraction in 0.0f64..=1.0,
    ) {
        let milling = if climb { Milling::Climb } else { Milling::Conventional };
        let setup = cutter(teeth, milling, (offset_um, behind));
        let (expected, ahead) = by_slices(&setup, edged(), engaged, feed, fraction);
        let got = made(&setup, edged(), engaged, feed, fraction);
        let got = [got.x, got.y].map(|v| v.nm() as f64 / 1e6);
        // Slices see the ends of an arc to a slice: 0.1 N of edge, 0.1 µm.
        prop_assert!((got[0] - expected[0]).abs() < 4e-4, "{got:?} {expected:?}");
        prop_assert!(ahead < 8e-4 || (got[1] - expected[1]).abs() < 4e-4, "{got:?} {expected:?}");
    }

    #[test]
    fn a_cutter_without_runout_makes_the_same_wall_to_the_last_bit(
        teeth in 1u8..=12,
        climb in any::<bool>(),
        behind in 0.0f64..TAU,
        engaged in 0.0f64..3.1,
        feed in 0.01f64..0.3,
        fraction in 0.0f64..=1.0,
        size in 0.0f64..0.4,
    ) {
        let milling = if climb { Milling::Climb } else { Milling::Conventional };
        let k = Coefficients { size_exponent: real(size), ..edged() };
        let [none, nothing] = [(0.0, 0.0), (0.0, behind)].map(|runout| made(&cutter(teeth, milling, runout), k, engaged, feed, fraction));
        prop_assert_eq!(none, nothing);
    }

    #[test]
    fn a_pitch_more_is_the_same_cutter(
        teeth in 2u8..=6,
        offset_um in 1.0f64..30.0,
        behind in 0.0f64..1.0,
        engaged in 0.3f64..2.0,
        fraction in 0.0f64..=1.0,
    ) {
        let pitch = TAU / f64::from(teeth);
        let at = |behind| made(&cutter(teeth, Milling::Climb, (offset_um, behind)), edged(), engaged, 0.05, fraction);
        let (here, there) = (at(behind), at(behind + pitch));
        prop_assert!((here.x - there.x).abs() <= Offset::from_nm(20), "{here:?} {there:?}");
    }
}

#[test]
fn a_size_exponent_costs_a_fifteenth_of_what_runout_changes() {
    let k = Coefficients { size_exponent: real(0.18), ..edged() };
    let (mut worst, mut largest) = (0.0f64, 0.0f64);
    for n in 0..40 {
        let (engaged, fraction) = (0.5 + 0.025 * f64::from(n), f64::from(n % 10) / 9.0);
        let run = cutter(6, Milling::Climb, (10.0, 0.2));
        let with = by_slices(&run, k, engaged, 0.0444, fraction).0[0];
        let without = by_slices(&cutter(6, Milling::Climb, (0.0, 0.0)), k, engaged, 0.0444, fraction).0[0];
        let got = made(&run, k, engaged, 0.0444, fraction).x.nm() as f64 / 1e6;
        (worst, largest) = (worst.max((got - with).abs()), largest.max((with - without).abs()));
    }
    println!("off by {:.2} of {:.2} um", 1e3 * worst, 1e3 * largest);
    assert!(worst < 0.066 * largest, "{worst} of {largest}");
}

#[test]
fn under_the_mean_law_the_longest_tooth_moves_the_wall_by_its_reach() {
    for (teeth, behind, reach_um) in [(6, 0.0, 10.0), (6, PI / 6.0, 8.660), (2, PI / 2.0, 0.0), (1, 0.0, 10.0)] {
        let mean = |runout| CutSetup { law: WallLaw::Mean, ..cutter(teeth, Milling::Climb, runout) };
        let [with, without] = [(10.0, behind), (0.0, 0.0)].map(|runout| made(&mean(runout), edged(), 0.8, 0.05, 0.5));
        let moved = (with.x - without.x).nm() as f64 / 1e3;
        assert!((moved - reach_um).abs() < 0.002 && with.y == without.y, "{teeth} {behind}: {moved}");
    }
}

#[test]
fn a_feed_of_nothing_asks_for_nothing() {
    let setup = cutter(6, Milling::Climb, (10.0, 0.0));
    let without = cutter(6, Milling::Climb, (0.0, 0.0));
    // Edges rub, and the longest tooth reaches as far as it does.
    let [with, without] = [setup, without].map(|setup| made(&setup, edged(), 0.8, 0.0, 0.5));
    assert_eq!((with.x - without.x, with.y - without.y), (Offset::from_um(10), Offset::ZERO));
}
