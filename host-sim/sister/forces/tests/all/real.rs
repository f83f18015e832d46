//! Real means against the laws: slots of a flat end mill with two teeth, 3 mm deep at 6000 rev/min, recorded by the authors of
//! the public repository leekunhwee/ForceCalculation, one second of each at 10 kHz.

use truepath_forces::cut::Cut;
use truepath_forces::fit::{Along, Fitted, Mean, Measured, REPEATABILITY, average, fit, fit_every};
use truepath_forces::law::Law;

/// Feed per tooth, mm; Fx and Fy of the file, N. In the file the axes are swapped: Fx is across the feed.
const MEANS: [[f64; 3]; 5] = [
    [0.025, 63.02, -39.80],
    [0.050, 107.14, -60.05],
    [0.075, 137.67, -71.60],
    [0.100, 171.27, -76.75],
    [0.125, 210.74, -78.49],
];

fn measured(row: usize) -> Measured {
    let [feed_per_tooth_mm, across, feed] = MEANS[row];
    let cut = Cut {
        diameter_mm: 25.0,
        teeth: 2,
        helix_deg: 45.0,
        axial_depth_mm: 3.0,
        arc_rad: [0.0, std::f64::consts::PI],
        feed_per_tooth_mm,
        spindle_rpm: 6000.0,
    };
    let of = |along, value: f64| Mean { along, value, sigma: REPEATABILITY * value.abs() };
    Measured { cut, means: vec![of(Along::Feed, feed), of(Along::Across, across)] }
}

/// Errors of the second and the fourth feed, across and along the feed, percent: the larger of both.
fn predicted(laws: &[Fitted]) -> [f64; 2] {
    [Along::Across, Along::Feed].map(|along| {
        let off = |row: usize| {
            let measured = measured(row);
            let value = measured.means.iter().find(|m| m.along == along).expect("a mean").value;
            100.0 * (average(laws, &measured.cut, along).0 / value - 1.0).abs()
        };
        off(1).max(off(3))
    })
}

#[test]
fn three_feeds_predict_the_two_between_within_five_percent() {
    let every = fit_every(&[measured(0), measured(2), measured(4)]);
    let errors = predicted(&every);
    assert!(errors.into_iter().all(|e| e < 5.0), "{errors:?}");
    // The radial force saturates; which law the tangential one follows, three feeds do not tell.
    let saturating = |f: &&Fitted| f.model.laws[1] == Law::Saturating;
    assert!(every.iter().filter(saturating).map(|f| f.weight).sum::<f64>() > 0.98);
    let [first, second] = [&every[0], &every[1]];
    assert!(first.weight < 0.6 && second.weight > 0.3, "{} {}", first.weight, second.weight);
    // The table of docs/forces.md: errors of pairs by themselves.
    let alone = |laws: [Law; 2]| {
        let one = every.iter().find(|f| f.model.laws == laws).expect("a pair");
        predicted(std::slice::from_ref(&Fitted { weight: 1.0, ..one.clone() })).map(|e| (10.0 * e).round() / 10.0)
    };
    assert_eq!(alone([Law::Power, Law::Saturating]), [2.4, 0.7]);
    assert_eq!(alone([Law::Edge, Law::Saturating]), [6.5, 0.7]);
    assert_eq!(alone([Law::EdgePower, Law::Saturating]), [3.9, 0.7]);
    assert_eq!(alone([Law::Power, Law::Power]), [2.4, 8.2]);
    assert_eq!(alone([Law::Edge, Law::Edge]), [6.5, 13.6]);
}

#[test]
fn the_linear_law_misses_what_it_was_not_shown() {
    let linear = fit(&[measured(0), measured(2), measured(4)], [Law::Edge; 2], false).expect("a fit");
    let [across, feed] = predicted(std::slice::from_ref(&linear));
    assert!((4.0..9.0).contains(&across) && (7.0..14.0).contains(&feed), "{across} {feed}");
    // Its coefficients over all five are those published for them.
    let all: Vec<Measured> = (0..5)
        .map(|row| {
            let mut one = measured(row);
            one.means.iter_mut().for_each(|m| m.sigma = 1.0);
            one
        })
        .collect();
    let linear = fit(&all, [Law::Edge; 2], false).expect("a fit");
    for (found, published) in linear.model.unknowns.iter().zip([958.86, 15.758, 250.863, 19.434]) {
        assert!((found / published - 1.0).abs() < 1e-3, "{found} {published}");
    }
    // And it says that it is wrong by more than it was told.
    assert!(linear.chi2 > 3.0 * linear.freedom as f64, "{}", linear.chi2);
}
