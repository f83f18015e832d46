//! Widths between two walls in place of points on them.
use crate::corner;
use corner::*;
use truepath_model::cut::*;
use truepath_model::identify::{Cut, Observation, Parameters, PredictionWorkspace, Prior, identify, predict};
use truepath_units::geometry::Vector;
use truepath_units::{Offset, Real};

const LEGS_MM: [i64; 2] = [20, 80];

/// What a machine of these parameters leaves of points on both legs of the corner and of widths between them.
fn left(path: &Path, parameters: &Parameters, workspace: &mut PredictionWorkspace) -> [Observation; 6] {
    let at = |mm: i64, quarters: i64| {
        let s = Offset::from_um(1_000 * mm);
        let normal = path.samples()[path.index_at(s)].normal;
        Observation::new(s, Real::ratio(quarters, 4), Offset::ZERO, Offset::from_um(2), normal)
    };
    let [a, b] = LEGS_MM;
    let width = |quarters| at(a, quarters).with_across(Offset::from_um(1_000 * b));
    let mut readings = [at(a, 1), at(a, 3), width(1), width(3), at(b, 1), at(b, 3)];
    let table = ForceTable::new(parameters.coefficients.size_exponent);
    predict(path, &table, parameters, |_| Vector::ZERO, &mut readings, workspace);
    readings
}

#[test]
fn a_width_is_the_mean_of_its_walls_and_sees_no_shift_of_the_datum() {
    let blocks = corner();
    let path = path(&blocks, &setup(WallLaw::Helical), 200);
    let prior = Prior::around(coefficients(), Compliance::from_stiffness(real(1150.0), real(1150.0)), WallLaw::Helical);
    let needed = PredictionWorkspace::needed(&path);
    let (mut states, mut displacements) = (vec![State::REST; needed], vec![Vector::ZERO; needed]);
    let mut workspace = PredictionWorkspace { states: &mut states, displacements: &mut displacements };
    let still = left(&path, &prior.mean, &mut workspace);
    let datum = Vector { x: Offset::from_um(30), y: Offset::from_um(-50) };
    let moved = left(&path, &Parameters { datum, undersize: Offset::from_um(7), ..prior.mean }, &mut workspace);
    for [a, width, b] in [[0, 2, 4], [1, 3, 5]] {
        let mean = (still[a].predicted.nm() + still[b].predicted.nm()) as f64 / 2.0;
        assert!((still[width].predicted.nm() as f64 - mean).abs() <= 1.0, "{:?} {mean}", still[width].predicted);
        assert!(mean.abs() > 20_000.0, "the machine yields: {mean} nm");
        // A smaller cutter leaves every wall farther out; the datum moves points only.
        assert_eq!(moved[width].predicted.nm() - still[width].predicted.nm(), 7_000);
        assert_ne!(moved[a].predicted.nm() - still[a].predicted.nm(), 7_000);
    }
    assert_eq!((still[2].by_datum(), still[0].by_datum()), ([Real::ZERO; 2], [-still[0].normal.x, -still[0].normal.y]));
}

#[test]
fn widths_alone_find_how_stiff_the_machine_is() {
    let blocks = corner();
    let path = path(&blocks, &setup(WallLaw::Mean), 200);
    let believed = Prior::around(coefficients(), Compliance::from_stiffness(real(1150.0), real(1150.0)), WallLaw::Mean);
    let stiff = Prior::around(coefficients(), Compliance::from_stiffness(real(1700.0), real(1700.0)), WallLaw::Mean);
    let needed = PredictionWorkspace::needed(&path);
    let (mut states, mut displacements) = (vec![State::REST; needed], vec![Vector::ZERO; needed]);
    let mut workspace = PredictionWorkspace { states: &mut states, displacements: &mut displacements };
    let mut widths: Vec<Observation> =
        left(&path, &stiff.mean, &mut workspace).into_iter().filter(|reading| reading.across().is_some()).collect();
    for width in &mut widths {
        width.error = width.predicted;
    }
    let cuts = [Cut { path, points: widths.len(), part: 0 }];
    let fit =
        identify(&cuts, (&believed, None), &mut [], &mut widths, |_, _| Vector::ZERO, &mut workspace, &mut |_| ());
    let [found, truth] = [fit.parameters, stiff.mean].map(|p| p.compliance.mean.bits() as f64);
    assert!((found / truth - 1.0).abs() < 0.02, "{}", found / truth);
    // Two legs of equal widths leave open which of them yields.
    assert!(fit.remaining(1) > Real::ratio(8, 10) && fit.remaining(0) < Real::ratio(3, 10));
    assert!((fit.remaining(9), fit.remaining(10)) == (Real::ONE, Real::ONE), "nothing is known of the datum");
}

#[test]
fn two_halves_on_two_cuts_say_what_one_width_says() {
    let blocks = corner();
    let path = path(&blocks, &setup(WallLaw::Mean), 200);
    let around = |stiffness| {
        Prior::around(coefficients(), Compliance::from_stiffness(real(stiffness), real(stiffness)), WallLaw::Mean)
    };
    let (believed, stiff) = (around(1150.0), around(1700.0));
    let needed = PredictionWorkspace::needed(&path);
    let (mut states, mut displacements) = (vec![State::REST; needed], vec![Vector::ZERO; needed]);
    let mut workspace = PredictionWorkspace { states: &mut states, displacements: &mut displacements };
    let all = left(&path, &stiff.mean, &mut workspace);
    let mut widths = vec![all[2], all[3]];
    widths.iter_mut().for_each(|width| width.error = width.predicted);
    // The same two readings as halves: those of one wall, then those of the other one, which another cut has made.
    let noise = Offset::from_nm(2_828);
    let half = |wall: usize, of: usize| {
        let (wall, error) = (all[wall], all[of].predicted);
        Observation::new(wall.s, wall.height, error, noise, wall.normal).paired(of as u32)
    };
    let halves = vec![half(0, 2), half(1, 3), half(4, 2), half(5, 3)];
    let mut fitted = |mut readings: Vec<Observation>, points: &[usize]| {
        let cuts: Vec<Cut> = points.iter().map(|points| Cut { path, points: *points, part: 0 }).collect();
        let fit = identify(
            &cuts,
            (&believed, None),
            &mut [],
            &mut readings,
            |_, _| Vector::ZERO,
            &mut workspace,
            &mut |_| (),
        );
        (fit, readings)
    };
    let ((of_widths, widths), (of_halves, halves)) = (fitted(widths, &[2]), fitted(halves, &[2, 2]));
    let bits = |real: Real| real.bits() as f64 / (1u64 << 32) as f64;
    for k in 0..of_widths.theta.len() {
        assert!((bits(of_widths.theta[k]) - bits(of_halves.theta[k])).abs() < 2e-3, "theta {k}");
        assert!((bits(of_widths.remaining(k)) - bits(of_halves.remaining(k))).abs() < 2e-3, "remaining {k}");
    }
    for (k, half) in halves.iter().enumerate() {
        assert!((half.predicted.nm() - widths[k % 2].predicted.nm()).abs() < 20, "{:?}", half.predicted);
        assert_eq!((half.pair(), half.across(), half.by_datum()), (Some(2 + k as u32 % 2), None, [Real::ZERO; 2]));
    }
    assert_eq!((widths[0].pair(), widths[0].across().is_some()), (None, true));
    let found = bits(of_halves.parameters.compliance.mean) / bits(stiff.mean.compliance.mean);
    assert!((found - 1.0).abs() < 0.02, "{found}");
}
