//! The shape of a revolution: phase and runout of the cutter from the force over the angle of rotation.
//!
//! Teeth on a helix with an offset of the cutter's axis: tooth j reaches out by `r_j = a cos(2πj/N) + b sin(2πj/N)` more than
//! the mean, and cuts what the teeth before it have left, `h = min over k of (k·f·sin φ + r_j − r_(j−k))` (Altintas, ch. 2.9;
//! Kline and DeVor 1983). Unknown are a, b, the angle at which tooth 0 stands when the record begins, and the four coefficients
//! about those of the mean forces. With two teeth only their difference is seen, b stays at what it was expected.
//!
//! Limit: a dynamometer that rings, as those with a first mode near the tooth frequency do, has another shape than the force;
//! the share of the shape that is explained tells.

use std::f64::consts::TAU;

use crate::cut::Cut;
use crate::revolution::Signal;
use crate::squares::least_squares;

/// Angles of a mean revolution.
const BINS: usize = 120;
/// Slices of the depth.
const SLICES: usize = 16;
/// Runout that is expected of a holder, mm, each of both parts.
const EXPECTED_MM: f64 = 0.03;
/// Share of the fluctuation that a fit has to explain to be believed.
const EXPLAINED: f64 = 0.8;

/// A mean revolution, feed and across, on the tool, N, in even steps of the angle.
#[derive(Clone, Debug)]
pub struct Turn {
    /// As recorded.
    pub recorded: [Vec<f64>; 2],
    /// As fitted, where there is a fit.
    pub fitted: Option<[Vec<f64>; 2]>,
}

/// What the shape tells.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Shape {
    /// Radial offset of the cutter's axis, mm.
    pub runout_mm: f64,
    /// Its standard deviation.
    pub runout_sigma_mm: f64,
    /// Its direction behind tooth 0, degrees.
    pub runout_deg: f64,
    /// The two parts, towards tooth 0 and a quarter behind it, mm, with their standard deviations.
    pub parts_mm: [[f64; 2]; 2],
    /// Immersion of the tip of tooth 0 when the stretch begins, degrees.
    pub phase_deg: f64,
    /// Ktc, Krc, Kte, Kre from this shape and the means.
    pub coefficients: [f64; 4],
    /// Teeth that cut where the chip is thickest.
    pub cutting_teeth: usize,
    /// Share of the fluctuation that is explained.
    pub explained: f64,
    /// Whether that is enough for what is said to be believed.
    pub believed: bool,
}

/// The mean revolution of two signals between two times.
pub fn fold(signals: [&Signal; 2], [from, to]: [f64; 2], period_s: f64) -> Option<[Vec<f64>; 2]> {
    let turns = ((to - from) / period_s + 1e-6).floor();
    let folded = signals.map(|signal| {
        let (mut sum, mut count) = (vec![0.0; BINS], vec![0.0; BINS]);
        let first = (from * signal.rate_hz).ceil() as usize;
        let last = ((from + turns * period_s) * signal.rate_hz).floor() as usize;
        for (n, v) in signal.samples.iter().enumerate().take(last).skip(first) {
            let at = (n as f64 / signal.rate_hz - from) / period_s;
            // Shared between the two nearest bins, whose centres stand at k/BINS.
            let x = at.fract() * BINS as f64;
            let (k, share) = (x as usize, x.fract());
            for (bin, weight) in [(k % BINS, 1.0 - share), ((k + 1) % BINS, share)] {
                sum[bin] += weight * v;
                count[bin] += weight;
            }
        }
        sum.iter().zip(&count).map(|(s, c)| s / c).collect::<Vec<f64>>()
    });
    folded.iter().flatten().all(|v| v.is_finite()).then_some(folded)
}

/// Forces over a revolution: coefficients Ktc, Krc, Kte, Kre, parts of the runout (mm), immersion of tooth 0 at the start (rad).
pub fn forces(cut: &Cut, [ktc, krc, kte, kre]: [f64; 4], [a, b]: [f64; 2], phase: f64) -> [Vec<f64>; 2] {
    let teeth = cut.teeth as usize;
    let pitch = TAU / teeth as f64;
    let reach: Vec<f64> = (0..teeth)
        .map(|j| {
            let (s, c) = (pitch * j as f64).sin_cos();
            a * c + b * s
        })
        .collect();
    let [enter, leave] = cut.arc_rad;
    let lag = cut.lag_rad_per_mm();
    let slice = cut.axial_depth_mm / SLICES as f64;
    let mut all = [Vec::with_capacity(BINS), Vec::with_capacity(BINS)];
    for n in 0..BINS {
        let (mut feed, mut across) = (0.0, 0.0);
        for j in 0..teeth {
            let tip = phase + TAU * n as f64 / BINS as f64 - pitch * j as f64;
            for k in 0..SLICES {
                let phi = (tip - lag * slice * (k as f64 + 0.5)).rem_euclid(TAU);
                if phi < enter || phi > leave {
                    continue;
                }
                let (s, c) = phi.sin_cos();
                let advance = cut.feed_per_tooth_mm * s;
                let left = (1..=teeth).map(|m| m as f64 * advance + reach[j] - reach[(j + teeth - m) % teeth]);
                let chip = left.fold(f64::INFINITY, f64::min);
                if chip <= 0.0 {
                    continue;
                }
                let (t, r) = (slice * (ktc * chip + kte), slice * (krc * chip + kre));
                feed += -t * c - r * s;
                across += t * s - r * c;
            }
        }
        all[0].push(feed);
        all[1].push(across);
    }
    all
}

/// The steady answer of a first-order low-pass to a periodic signal.
fn low_passed(values: &[f64], corner_hz: f64, period_s: f64) -> Vec<f64> {
    let keep = (-TAU * corner_hz * period_s / values.len() as f64).exp();
    let mut out = vec![0.0; values.len()];
    let mut state = values.iter().sum::<f64>() / values.len() as f64;
    // Three times around: the first ones settle it.
    for _ in 0..3 {
        for (o, v) in out.iter_mut().zip(values) {
            state = keep * state + (1.0 - keep) * v;
            *o = state;
        }
    }
    out
}

/// Fits phase, runout and coefficients to a mean revolution; coefficients are held near those of the means by their standard
/// deviations.
pub fn shape(
    cut: &Cut,
    recorded: &[Vec<f64>; 2],
    coefficients: [[f64; 2]; 4],
    low_pass_hz: Option<f64>,
) -> Option<(Shape, [Vec<f64>; 2])> {
    let period = cut.revolution_s();
    let model = |k: [f64; 4], runout: [f64; 2], phase: f64| {
        let all = forces(cut, k, runout, phase);
        match low_pass_hz {
            Some(corner) => all.map(|v| low_passed(&v, corner, period)),
            None => all,
        }
    };
    let expected = coefficients.map(|c| c[0]);
    let off = |modelled: &[Vec<f64>; 2]| -> Vec<f64> {
        (0..2).flat_map(|d| modelled[d].iter().zip(&recorded[d]).map(|(m, r)| m - r).collect::<Vec<_>>()).collect()
    };
    let square = |values: &[f64]| values.iter().map(|v| v * v).sum::<f64>();
    let fluctuation: f64 = recorded
        .iter()
        .map(|v| {
            let mean = v.iter().sum::<f64>() / v.len() as f64;
            v.iter().map(|x| (x - mean).powi(2)).sum::<f64>()
        })
        .sum();
    // The phase of a cutter that runs true, within a pitch.
    let pitch = TAU / f64::from(cut.teeth);
    let phases = (0..48).map(|k| pitch * f64::from(k) / 48.0);
    let begin = phases.min_by(|a, b| {
        square(&off(&model(expected, [0.0; 2], *a))).total_cmp(&square(&off(&model(expected, [0.0; 2], *b))))
    })?;
    let level = (0.05 * fluctuation / (2 * BINS) as f64).sqrt().max(1e-9);
    let scale = [expected[0].max(50.0), expected[1].max(50.0), 10.0, 10.0, 0.01, 0.01, 0.3];
    let range = [[-1e5, 1e5], [-1e5, 1e5], [-1e4, 1e4], [-1e4, 1e4], [-1.0, 1.0], [-1.0, 1.0], [-1e3, 1e3]];
    let with = |sigma: f64| {
        move |p: &[f64]| -> Vec<f64> {
            let misses = off(&model([p[0], p[1], p[2], p[3]], [p[4], p[5]], p[6])).into_iter().map(|v| v / sigma);
            let held = (0..4).map(|k| (p[k] - coefficients[k][0]) / coefficients[k][1].max(1e-6));
            misses.chain(held).chain([p[4] / EXPECTED_MM, p[5] / EXPECTED_MM]).collect()
        }
    };
    // The runout that explains most of what is left, in coarse steps.
    let directions = (0..8).flat_map(|k| [0.1, 0.4].map(|by| (by * cut.feed_per_tooth_mm, TAU * f64::from(k) / 8.0)));
    let missed = |runout: &[f64; 2]| square(&off(&model(expected, *runout, begin)));
    let coarse = directions.map(|(size, at)| [size * at.cos(), size * at.sin()]);
    let [a, b] = coarse.min_by(|x, y| missed(x).total_cmp(&missed(y)))?;
    let start = [expected[0], expected[1], expected[2], expected[3], a, b, begin];
    let first = least_squares(&start, &scale, &range, &with(level))?;
    let fitted_of = |p: &[f64]| model([p[0], p[1], p[2], p[3]], [p[4], p[5]], p[6]);
    // Again with the scatter that is left; neighbouring angles are not independent.
    let rest = off(&fitted_of(&first.theta));
    let variance = square(&rest) / (2 * BINS - 7) as f64;
    let next: f64 = rest.windows(2).map(|w| w[0] * w[1]).sum::<f64>() / square(&rest).max(1e-12);
    let alike = next.clamp(0.0, 0.95);
    let sigma = (variance * (1.0 + alike) / (1.0 - alike)).sqrt().max(1e-9);
    let found = least_squares(&first.theta, &scale, &range, &with(sigma))?;
    let p = &found.theta;
    let fitted = fitted_of(p);
    let explained = 1.0 - square(&off(&fitted)) / fluctuation.max(1e-12);
    let runout = p[4].hypot(p[5]);
    let along = if runout > 0.0 { [p[4] / runout, p[5] / runout] } else { [1.0, 0.0] };
    let c = &found.covariance;
    let runout_sigma =
        (along[0].powi(2) * c[4][4] + 2.0 * along[0] * along[1] * c[4][5] + along[1].powi(2) * c[5][5]).max(0.0).sqrt();
    let teeth = cut.teeth as usize;
    let reach = |j: usize| {
        let (s, c) = (pitch * j as f64).sin_cos();
        p[4] * c + p[5] * s
    };
    let top = if cut.arc_rad[0] < TAU / 4.0 && cut.arc_rad[1] > TAU / 4.0 {
        1.0
    } else {
        cut.arc_rad[0].sin().max(cut.arc_rad[1].sin())
    };
    let cuts = |j: &usize| {
        let left =
            (1..=teeth).map(|m| m as f64 * cut.feed_per_tooth_mm * top + reach(*j) - reach((j + teeth - m) % teeth));
        left.fold(f64::INFINITY, f64::min) > 0.0
    };
    let shape = Shape {
        runout_mm: runout,
        runout_sigma_mm: runout_sigma,
        runout_deg: p[5].atan2(p[4]).to_degrees().rem_euclid(360.0),
        parts_mm: [[p[4], c[4][4].sqrt()], [p[5], c[5][5].sqrt()]],
        phase_deg: p[6].to_degrees().rem_euclid(360.0),
        coefficients: [p[0], p[1], p[2], p[3]],
        cutting_teeth: (0..teeth).filter(cuts).count(),
        explained,
        believed: explained > EXPLAINED,
    };
    Some((shape, fitted))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runout_and_phase_of_a_made_revolution_are_found() {
        let cut = Cut {
            diameter_mm: 12.0,
            teeth: 3,
            helix_deg: 30.0,
            axial_depth_mm: 4.0,
            arc_rad: [2.0, std::f64::consts::PI],
            feed_per_tooth_mm: 0.06,
            spindle_rpm: 4000.0,
        };
        let (k, runout, phase) = ([800.0, 250.0, 15.0, 18.0], [0.008, -0.005], 0.7);
        let recorded = forces(&cut, k, runout, phase);
        let (shape, _) = shape(&cut, &recorded, k.map(|v| [v, 0.05 * v]), None).expect("a shape");
        assert!(shape.explained > 0.999 && shape.believed && shape.cutting_teeth == 3, "{shape:?}");
        // Which of the teeth is the first is open: the amount is not.
        assert!((shape.runout_mm - 0.008f64.hypot(0.005)).abs() < 2e-4, "{shape:?}");
        // A long tooth takes all where the other two are far too short.
        let long = forces(&cut, k, [0.2, 0.0], phase);
        assert!(
            long[1].iter().fold(0.0f64, |m, v| m.max(*v)) > 1.5 * recorded[1].iter().fold(0.0f64, |m, v| m.max(*v))
        );
    }
}
