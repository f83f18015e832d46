//! Means over whole revolutions of a record, with their standard deviations, the drift of the amplifier, and the harmonics of
//! the spindle.
//!
//! A charge amplifier drifts in a line over seconds: where the record holds stretches of air, a line is fitted to those and to
//! the revolutions of the cut together (`air: a + d·t`, `cut: F + a + d·t`), so that the mean is that above the air. Without air
//! the zero is that of the amplifier, and the change of the mean over the cut goes into the standard deviation.

use truepath_ground::rows::ascending;

use std::f64::consts::TAU;

use crate::squares::inverse;

/// A signal in N with its clock.
#[derive(Clone, Debug)]
pub struct Signal {
    /// Samples.
    pub samples: Vec<f64>,
    /// Their rate, Hz.
    pub rate_hz: f64,
}

/// A mean above the air.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Level {
    /// Mean force, in the unit of the signal.
    pub value: f64,
    /// Its standard deviation.
    pub sigma: f64,
    /// Drift per second.
    pub drift_per_s: f64,
    /// Its standard deviation.
    pub drift_sigma: f64,
    /// Mean of the air at the middle of the cut; none without air.
    pub offset: Option<f64>,
}

/// Revolutions over which scatter is taken together: neighbours are not independent.
const BATCHES: usize = 12;
/// A revolution cuts where its scatter is this many times that of the quietest.
const LOUD: f64 = 4.0;

impl Signal {
    /// The integral of the samples from the start to a time, by straight lines between them, N·s.
    fn integral(&self) -> impl Fn(f64) -> f64 {
        let mut sums = Vec::with_capacity(self.samples.len() + 1);
        let mut sum = 0.0;
        sums.push(0.0);
        for sample in &self.samples {
            sum += sample;
            sums.push(sum);
        }
        let rate = self.rate_hz;
        move |time: f64| {
            let at = (time * rate).clamp(0.0, (sums.len() - 1) as f64);
            let k = (at as usize).min(sums.len() - 2);
            (sums[k] + (at - k as f64) * (sums[k + 1] - sums[k])) / rate
        }
    }

    /// Length, s.
    pub fn length_s(&self) -> f64 {
        self.samples.len() as f64 / self.rate_hz
    }

    /// Means of stretches of `period_s` each from `from_s`, as many as fit before `to_s`.
    pub fn means(&self, from_s: f64, to_s: f64, period_s: f64) -> Vec<f64> {
        let integral = self.integral();
        let count = ((to_s - from_s) / period_s + 1e-6).floor().max(0.0) as usize;
        let at = |k: usize| from_s + k as f64 * period_s;
        (0..count).map(|k| (integral(at(k + 1)) - integral(at(k))) / period_s).collect()
    }

    /// Standard deviation of the samples of every revolution about their mean.
    fn loudness(&self, period_s: f64) -> Vec<f64> {
        let each = (period_s * self.rate_hz).round().max(2.0) as usize;
        self.samples
            .chunks_exact(each)
            .map(|chunk| {
                let mean = chunk.iter().sum::<f64>() / each as f64;
                (chunk.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / each as f64).sqrt()
            })
            .collect()
    }
}

/// What a record holds.
#[derive(Clone, Debug, PartialEq)]
pub struct Parts {
    /// The cut, from and to, s, without its first and last twentieth where it has ends.
    pub cut: [f64; 2],
    /// Stretches of air before and after it.
    pub air: Vec<[f64; 2]>,
}

/// Where signals cut and where there is air: the longest loud stretch, and what is quiet outside of it. All of a record that is as
/// loud everywhere is the cut.
pub fn parts(signals: [&Signal; 2], period_s: f64) -> Option<Parts> {
    let each = (period_s * signals[0].rate_hz).round().max(2.0) / signals[0].rate_hz;
    let [first, second] = signals.map(|s| s.loudness(period_s));
    let loud: Vec<f64> = first.iter().zip(&second).map(|(a, b)| a.hypot(*b)).collect();
    let mut sorted = loud.clone();
    ascending(&mut sorted);
    let (quiet, most) = (*sorted.get(sorted.len() / 50)?, *sorted.get(sorted.len() * 9 / 10)?);
    let whole = Parts { cut: [0.0, signals[0].length_s()], air: Vec::new() };
    if most <= LOUD * quiet {
        return Some(whole);
    }
    let threshold = (quiet * most).sqrt().max(0.3 * most);
    let stretches: Vec<(bool, usize, usize)> = {
        let mut begin = 0;
        loud.chunk_by(|a, b| (*a > threshold) == (*b > threshold))
            .map(|run| {
                begin += run.len();
                (run[0] > threshold, begin - run.len(), begin)
            })
            .collect()
    };
    let &(_, from, to) = stretches.iter().filter(|s| s.0).max_by_key(|s| s.2 - s.1)?;
    let span = |from: usize, to: usize| [from as f64 * each, to as f64 * each];
    let [begin, end] = span(from, to);
    // The cutter enters and leaves: revolutions at the ends are not whole ones.
    let ends = (0.05 * (end - begin)).max(each);
    let air = stretches.iter().filter(|s| !s.0 && (s.2 <= from || s.1 >= to)).map(|s| span(s.1, s.2));
    let air = air.map(|[from, to]| [from + each, to - each]).filter(|[from, to]| to - from > 2.0 * each).collect();
    let cut = [begin + if from == 0 { 0.0 } else { ends }, end - if to == loud.len() { 0.0 } else { ends }];
    Some(Parts { cut, air })
}

/// The mean of a cut above the air, from whole revolutions between two times; `None` for less than one.
pub fn level(signal: &Signal, [from, to]: [f64; 2], air: &[[f64; 2]], period_s: f64) -> Option<Level> {
    let turns = ((to - from) / period_s + 1e-6).floor() as usize;
    if turns == 0 {
        return None;
    }
    let batch = turns.div_ceil(BATCHES).max(1);
    let stretch = batch as f64 * period_s;
    let batches = |[from, to]: [f64; 2]| -> Vec<(f64, f64)> {
        let means = signal.means(from, to, stretch).into_iter().enumerate();
        means.map(|(k, mean)| (from + (k as f64 + 0.5) * stretch, mean)).collect()
    };
    let cut = batches([from, to]);
    let middle = 0.5 * (from + to);
    let quiet: Vec<(f64, f64)> = air.iter().flat_map(|span| batches(*span)).collect();
    if quiet.is_empty() || cut.len() < 3 {
        let whole = signal.means(from, from + turns as f64 * period_s, turns as f64 * period_s);
        let value = whole.first().copied()?;
        let (slope, scatter) = line(&cut, middle)?;
        let count = cut.len() as f64;
        let length = to - from;
        let drift_sigma = scatter * (12.0 / count.powi(3).max(12.0)).sqrt() / stretch;
        let known = if slope.abs() > 2.0 * drift_sigma { 0.5 * slope.abs() * length } else { 0.0 };
        let offset = (!quiet.is_empty()).then(|| quiet.iter().map(|q| q.1).sum::<f64>() / quiet.len() as f64);
        let sigma = (scatter / count.sqrt()).hypot(known);
        return Some(Level { value: value - offset.unwrap_or(0.0), sigma, drift_per_s: slope, drift_sigma, offset });
    }
    // Unknowns: force, offset and drift; the scatter of cut and air differs.
    let spread = |rows: &[(f64, f64)]| line(rows, middle).map_or(0.0, |l| l.1).max(1e-9);
    let (loud, still) = (
        spread(&cut),
        if quiet.len() > 3 { air.iter().map(|s| spread(&batches(*s))).fold(0.0, f64::max) } else { spread(&cut) },
    );
    let rows = cut.iter().map(|r| (1.0, *r, loud)).chain(quiet.iter().map(|r| (0.0, *r, still)));
    let (mut normal, mut right) = (vec![vec![0.0; 3]; 3], [0.0; 3]);
    for (cutting, (time, mean), sigma) in rows {
        let row = [cutting, 1.0, time - middle];
        for i in 0..3 {
            right[i] += row[i] * mean / (sigma * sigma);
            for j in 0..3 {
                normal[i][j] += row[i] * row[j] / (sigma * sigma);
            }
        }
    }
    let covariance = inverse(&normal)?;
    let of = |i: usize| (0..3).map(|j| covariance[i][j] * right[j]).sum::<f64>();
    Some(Level {
        value: of(0),
        sigma: covariance[0][0].sqrt(),
        drift_per_s: of(2),
        drift_sigma: covariance[2][2].sqrt(),
        offset: Some(of(1)),
    })
}

/// Slope of values over time, and their scatter about the line.
fn line(rows: &[(f64, f64)], middle: f64) -> Option<(f64, f64)> {
    let n = rows.len() as f64;
    let (mt, mv) = (rows.iter().map(|r| r.0 - middle).sum::<f64>() / n, rows.iter().map(|r| r.1).sum::<f64>() / n);
    let stt: f64 = rows.iter().map(|r| (r.0 - middle - mt).powi(2)).sum();
    let slope = if stt > 0.0 { rows.iter().map(|r| (r.0 - middle - mt) * (r.1 - mv)).sum::<f64>() / stt } else { 0.0 };
    let rest: f64 = rows.iter().map(|r| (r.1 - mv - slope * (r.0 - middle - mt)).powi(2)).sum();
    (n > 0.0).then(|| (slope, (rest / (n - 2.0).max(1.0)).sqrt()))
}

/// Complex amplitudes of the harmonics 0…`most` of the revolution over whole revolutions, and the mean square of all that is
/// on none of them.
pub struct Harmonics {
    /// `F(t) ≈ Re Σ c·e^{ikωt}`, t from the start of the stretch.
    pub amplitude: Vec<[f64; 2]>,
    /// Standard deviation of the two parts of an amplitude, from what is between the harmonics.
    pub sigma: f64,
    /// Mean square on harmonics of the teeth, on other harmonics of the revolution, and between all.
    pub shares: [f64; 3],
}

/// Harmonics of a stretch; the line of drift should be taken off before.
pub fn harmonics(signal: &Signal, [from, to]: [f64; 2], period_s: f64, teeth: u32, most: usize) -> Option<Harmonics> {
    let turns = ((to - from) / period_s + 1e-6).floor();
    let begin = (from * signal.rate_hz).ceil();
    let end = ((begin / signal.rate_hz + turns * period_s) * signal.rate_hz).floor().min(signal.samples.len() as f64);
    let samples = signal.samples.get(begin as usize..end as usize)?;
    let count = samples.len() as f64;
    if turns < 1.0 || count < 8.0 {
        return None;
    }
    let mean = samples.iter().sum::<f64>() / count;
    let all = samples.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / count;
    let most = most.min((0.45 * signal.rate_hz * period_s) as usize);
    let mut amplitude = vec![[mean, 0.0]];
    for k in 1..=most {
        let turn = TAU * k as f64 / (period_s * signal.rate_hz);
        let (mut re, mut im) = (0.0, 0.0);
        for (n, v) in samples.iter().enumerate() {
            let (s, c) = (turn * n as f64).sin_cos();
            re += (v - mean) * c;
            im -= (v - mean) * s;
        }
        amplitude.push([2.0 * re / count, 2.0 * im / count]);
    }
    let power = |of_teeth: bool| -> f64 {
        let on = amplitude.iter().enumerate().skip(1).filter(|(k, _)| (*k as u32).is_multiple_of(teeth) == of_teeth);
        on.map(|(_, a)| 0.5 * (a[0] * a[0] + a[1] * a[1])).sum()
    };
    let (teeth, other) = (power(true), power(false));
    let between = (all - teeth - other).max(0.0);
    let bins = (0.5 * count - most as f64).max(1.0);
    Some(Harmonics { amplitude, sigma: (2.0 * between / bins).sqrt() / 2f64.sqrt(), shares: [teeth, other, between] })
}
