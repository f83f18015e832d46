//! The envelope against brute force, on random bores.

use std::f64::consts::TAU;

use proptest::prelude::*;
use truepath_bore::depth::ray;
use truepath_bore::envelope::Profile;
use truepath_bore::motion::Cutter;
use truepath_bore::roots::roots;
use truepath_bore::setup::{FeedAt, Setup};

/// The largest radius on a ray by dense sampling of time: sign changes of the paper's equation, halved to the end. It knows nothing
/// of passes, crests or pieces.
fn by_brute_force(profile: &Profile, phi: f64) -> f64 {
    let passes = &profile.passes;
    let (w1, w2, path) = (passes.motion.omega1, passes.motion.omega2, passes.motion.path_mm);
    let turn = TAU / (w2 - w1).abs();
    let (from, to) = (-turn, TAU * passes.laps / w1 + turn);
    let steps = ((to - from) / turn * 400.0) as usize;
    let mut best = f64::MIN;
    for tooth in &passes.teeth {
        let across = |t: f64| path * (w1 * t - phi).sin() + tooth.radius_mm * (w2 * t + tooth.angle - phi).sin();
        let along = |t: f64| path * (w1 * t - phi).cos() + tooth.radius_mm * (w2 * t + tooth.angle - phi).cos();
        let time = |n: usize| from + (to - from) * n as f64 / steps as f64;
        let mut before = across(time(0));
        for n in 1..=steps {
            let after = across(time(n));
            if (before < 0.0) != (after < 0.0) {
                let (mut a, mut b) = (time(n - 1), time(n));
                for _ in 0..60 {
                    let middle = 0.5 * (a + b);
                    if (across(middle) < 0.0) == (before < 0.0) { a = middle } else { b = middle }
                }
                best = best.max(along(a));
            }
            before = after;
        }
    }
    best
}

fn random_setup() -> impl Strategy<Value = Setup> {
    let sizes = (2.0..80.0f64, 0.02..3.0f64, 1u32..7, -75.0..75.0f64, 0.0..0.02f64, -180.0..180.0f64);
    let speeds = (0.005..0.05f64, prop::bool::ANY, -180.0..180.0f64, prop::option::of(1.2..3.0f64));
    (sizes, speeds).prop_map(|((radius, ratio, teeth, helix, runout, direction), (advance, climb, phase, laps))| {
        let path = radius * ratio * 4.0;
        let rpm = 1000.0;
        let cutter = Cutter {
            radius_mm: radius,
            teeth,
            helix_deg: helix,
            runout_mm: if runout < 0.005 { 0.0 } else { runout * radius * 0.2 },
            runout_deg: direction,
            phase_deg: phase,
        };
        // Slower where the path is long against the cutter, so that passes meet.
        let omega1 = advance / (1.0 + ratio * 4.0) * rpm * TAU / 60.0;
        Setup {
            hole_mm: path + radius,
            cutter,
            feed_mm_per_min: omega1 * path * 60.0,
            feed_at: FeedAt::Centre,
            rpm: if climb { -rpm } else { rpm },
            laps,
        }
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    #[test]
    #[ignore = "slow: more than nine seconds of processor time"]
    fn the_wall_is_what_dense_sampling_of_time_finds(setup in random_setup(), phis in prop::array::uniform4(0.0..TAU)) {
        let profile = setup.profile(3.0).expect("a wall");
        for phi in phis {
            let (radius, _) = profile.at(phi);
            let brute = by_brute_force(&profile, phi);
            // Ends of the cut: brute force also has the parts of passes whose crest is outside it.
            let near_an_end = !profile.passes.laps.fract().eq(&0.0) && ends(&profile, phi);
            let equal = (radius - brute).abs() < 1e-9;
            prop_assert!(equal || near_an_end && brute > radius, "φ {phi}: {radius} {brute}");
        }
    }

    #[test]
    fn envelope_single_rays_and_roots_agree(setup in random_setup(), phis in prop::array::uniform8(0.0..TAU)) {
        let profile = setup.profile(0.0).expect("a wall");
        for phi in phis {
            let (radius, _) = profile.at(phi);
            prop_assert!((radius - ray(&profile.passes, phi)).abs() < 1e-9);
            let found = roots(&profile.passes, phi);
            let wall = found.iter().find(|r| r.chosen).expect("a root");
            prop_assert!((radius - wall.radius_mm).abs() < 1e-9);
            for root in &found {
                // In the paper's own terms.
                let m = profile.passes.motion;
                let tooth = profile.passes.teeth[root.tooth - 1];
                let (a, b) = (m.omega1 * root.tau_s - phi, m.omega2 * root.tau_s + tooth.angle - phi);
                prop_assert!((m.path_mm * a.sin() + tooth.radius_mm * b.sin()).abs() < 1e-7);
                let radius = m.path_mm * a.cos() + tooth.radius_mm * b.cos();
                prop_assert!((radius - root.radius_mm).abs() < 1e-7);
            }
        }
    }

    #[test]
    fn one_turn_of_the_cutter_holds_the_height_of_the_whole_circle(setup in random_setup()) {
        let setup = Setup { laps: None, ..setup };
        let (steady, whole) = (setup.steady(1.0).expect("a wall"), setup.profile(1.0).expect("a wall").height());
        prop_assert!((steady.height_mm - whole).abs() < 1e-9 * (1.0 + whole), "{steady:?} {whole}");
    }

    #[test]
    fn any_numbers_end_in_a_wall_or_a_refusal(
        sizes in prop::array::uniform3(-4.0..5.0f64), ratio in -5.0..0.5f64, teeth in 0u32..66,
        tilt in prop::array::uniform4(-86.0..86.0f64), laps in prop::option::of(0.9..8.0f64), climb in prop::bool::ANY,
    ) {
        let [hole, cutter, speed] = sizes.map(|e| 10f64.powf(e));
        let rpm = if climb { -speed } else { speed };
        let (hole_mm, radius_mm) = (hole.max(cutter * 1.01), cutter);
        let cutter = Cutter {
            radius_mm, teeth, helix_deg: tilt[0], runout_mm: radius_mm * (tilt[1] / 40.0).max(0.0).powi(4) / 80.0,
            runout_deg: tilt[2], phase_deg: tilt[3],
        };
        let feed_mm_per_min = 10f64.powf(ratio) * speed * TAU * (hole_mm - radius_mm);
        let setup = Setup { hole_mm, cutter, feed_mm_per_min, feed_at: FeedAt::Wall, rpm, laps };
        if let Ok(profile) = setup.profile(2.0) {
            let height = profile.height();
            prop_assert!(height >= 0.0 && profile.lowest() > 0.0 && profile.passes.highest() < 2.0 * hole_mm, "{height}");
            let radius = profile.at(1.0).0;
            prop_assert!(radius >= profile.lowest() * (1.0 - 1e-12) && radius <= profile.passes.highest());
        }
    }

    #[test]
    fn no_ray_lies_below_the_lowest_crest_and_one_reaches_it(setup in random_setup()) {
        let profile = setup.profile(0.0).expect("a wall");
        let sampled = (0..5000).map(|n| profile.at(TAU * f64::from(n) / 5000.0).0);
        let (low, high) = sampled.fold((f64::MAX, f64::MIN), |(l, h), r| (l.min(r), h.max(r)));
        prop_assert!(low >= profile.lowest() - 1e-12 && high <= profile.passes.highest() + 1e-12);
        let cusp = profile.cusps().map(|c| c.1).fold(f64::MAX, f64::min);
        prop_assert!((cusp - profile.lowest()).abs() < 1e-12);
        let turned: f64 = profile.stretches.iter().map(|s| s.to - s.from).sum();
        prop_assert!((turned - TAU).abs() < 1e-9);
    }
}

/// Whether a ray may be reached by a pass that only begins or ends within the cut.
fn ends(profile: &Profile, phi: f64) -> bool {
    let near = profile.passes.arcs.iter().map(|a| a.half_width()).fold(0.0, f64::max) + profile.passes.motion.spacing();
    let end = TAU * profile.passes.laps;
    let apart = |a: f64| (a.rem_euclid(TAU)).min(TAU - a.rem_euclid(TAU));
    apart(phi) < near || apart(phi - end) < near
}
