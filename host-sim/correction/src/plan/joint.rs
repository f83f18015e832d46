//! Machine, material and what no parameter says, from an uncorrected part and the planned ones after it.
//!
//! All contours of a part are fitted together: one machine and one datum made them. The wall that is touched at a
//! height is what the sequence of passes has left there: every part is cut again in the model, all its passes in order,
//! each with its own stock, load and correction. About an estimate of the machine the walls are linear in its
//! parameters; then measured errors, parameters, datums and the [`Field`] beside them are one Gaussian process (Kennedy
//! & O'Hagan, *Bayesian calibration of computer models*, J. R. Stat. Soc. B 63, 2001), solved at once, so that neither
//! is bent by the other:
//!
//! | unknown | of which points | believed in beforehand |
//! |---|---|---|
//! | machine, cutter, material | all | the priors of the job |
//! | what a model lacks, in the directions of the parameters | planned parts: three quarters (of the variance) in common, a quarter each its own | [`lack`] |
//! | shift of the datum | each part its own | the priors of the job |
//! | the field | planned parts | zero, unless the evidence is 7 times larger with one |
//!
//! Deviation of the points and size of the field are chosen by the evidence; points that even the largest field does not
//! explain lose their weight. The walls are linearised anew about what was found, until that stays.

use rayon::prelude::*;
use truepath_core::cut::{Loop, Path, WallLaw};
use truepath_core::identify::{COUNT, Fit, Observation, Parameter, Parameters, Prior, prior_weights};
use truepath_core::job;
use truepath_core::process::{ImmersionGrid, Mill, Slices};
use truepath_core::units::{Offset, Real};
use truepath_ground::cholesky::Cholesky;
use truepath_ground::hypotenuse::hypot;
use truepath_ground::units::{float, mm, nm, real};

use super::bench::{Bench, CutPass};
use super::field::{Engagement, Field, Kernel, Place};
use crate::force_tables::force_table;
use crate::surface::unmodelled::lack;
use crate::surface::wall::at_height;

/// A contour of a part as it was cut and touched.
#[derive(Clone, Debug)]
pub struct CutPart {
    /// Which of the walls it is.
    pub wall: usize,
    /// Number of the part: the contours of one have one datum.
    pub part: u32,
    /// Its passes, in order.
    pub passes: Vec<CutPass>,
    /// Its points.
    pub points: Vec<Observation>,
    /// Whether it was planned; the others were cut in one pass without a correction.
    pub is_planned: bool,
}

/// What all parts together say.
#[derive(Clone, Debug)]
pub struct Joint {
    /// Wall law, machine and material of the next planned part; what a model lacks is part of the covariance.
    pub core: job::Identified,
    /// What planned parts show beside the machine; `None` when their points fit within their noise.
    pub field: Option<Field>,
    /// The points of every contour of every part with predictions, weights and spread.
    pub points: Vec<Vec<Observation>>,
}

/// A wall on which parts are compared.
#[derive(Clone, Copy, Debug)]
pub struct Wall<'a> {
    /// Its path, under the wall law of the machine.
    pub path: &'a Path<'a>,
    /// Its slices.
    pub slices: Slices,
    /// Where engagement is looked at.
    pub grid: &'a ImmersionGrid,
}

/// Parameters that all parts share; the other two are the datum of each.
const SHARED: usize = COUNT - 2;
/// Share of its variance that planned parts have in common.
const LASTING: f64 = 0.75;
/// How often the walls are linearised at most, and the farthest that the machine moves at a time, prior standard deviations.
const ROUNDS: (usize, f64) = (8, 0.7);
/// Where nothing moves farther than this, the walls need not be linearised again.
const SETTLED: f64 = 0.03;
/// Step of the difference quotients, prior standard deviations.
const STEP: Real = Real::ratio(1, 8);
/// Points that are looked at, at most.
const MOST_POINTS: usize = 240;
/// Share of the error of an uncorrected part, and of what was cancelled on a planned one, that a model may miss at a point.
const MODEL_SHARE: f64 = 0.01;
/// Distance, in deviations, from what the other points say of one, from which it is of something else.
const OUTLYING: f64 = 3.0;
/// Weight of a point, at least.
const LEAST_WEIGHT: f64 = 1e-6;
/// A field at which points are asked whether they are of something else, mm.
const WIDE: [f64; 2] = [0.016, 0.008];
/// Standard deviations of a field that are tried, mm.
const SIZES: [f64; 7] = [0.0, 0.001, 0.002, 0.004, 0.008, 0.016, 0.032];
/// Factors on the stated noise that are tried.
const SPREADS: [f64; 8] = [0.35, 0.5, 0.7, 1.0, 1.4, 2.0, 2.8, 4.0];
/// How many points the stated noise is worth.
const STATED: f64 = 4.0;
/// Gain in evidence (natural logarithm) from which a field is believed: 7 : 1.
const DECISIVE: f64 = 2.0;
/// Weight of a point that fits, at least.
const FITTING: Real = Real::ratio(3, 10);
/// Rounds of the weights.
const WEIGHINGS: usize = 4;

/// A point with what the parameters do to it.
#[derive(Clone, Debug)]
struct Row {
    part: u32,
    is_planned: bool,
    place: Place,
    /// Measured − predicted by a machine of the prior's middle, linearised, without datum, mm.
    unexplained: f64,
    /// Stated standard deviation, mm.
    deviation: f64,
    /// Change of the wall per prior standard deviation, mm: the shared parameters, then the datum of the part.
    sensitivity: [f64; COUNT],
}

/// Covariances of the points that do not depend on weights and sizes.
struct Task<'r> {
    rows: &'r [Row],
    /// Prior variance of the shared parameters, and of what the model lacks, in variances of the prior.
    variance: [f64; SHARED],
    lack: [f64; SHARED],
    parametric: Vec<Vec<f64>>,
    /// By a field of 1 mm: of the same stretch, of places that are engaged alike.
    alike: [Vec<Vec<f64>>; 2],
}

/// The points under a field and a factor on their noise.
struct Factored {
    factor: Cholesky,
    /// Covariance⁻¹ times what is unexplained.
    weights: Vec<f64>,
    evidence: f64,
}

impl Joint {
    /// Fits the parts, all contours of each; the walls are first linearised about `start`, prior standard deviations. `None` without points
    /// that can be read off the walls.
    pub fn of(
        walls: &[Wall<'_>],
        (prior, start): (&Prior, [Real; COUNT]),
        parts: &[CutPart],
        progress: &mut dyn FnMut(f64),
    ) -> Option<Self> {
        let first = walls.first()?.path;
        let kernel = |sizes| Kernel::new(sizes, mm(first.setup().radius));
        let mut theta = start;
        let mut found = None;
        for round in 0..ROUNDS.0 {
            progress(round as f64 / ROUNDS.0 as f64);
            let (rows, kept) = rows(walls, (prior, theta), parts);
            let solved = Task::of(&rows, prior, &theta).solve(&kernel)?;
            let step: Vec<f64> = (0..SHARED).map(|k| float(solved.theta[k] - theta[k])).collect();
            let farthest = step.iter().fold(0.0, |most: f64, by| most.max(by.abs()));
            // Farther away the walls are not what they are linearised to be.
            let share = real((ROUNDS.1 / farthest.max(1e-9)).min(1.0));
            for (theta, found) in theta.iter_mut().zip(solved.theta).take(SHARED) {
                *theta += (found - *theta) * share;
            }
            found = Some((rows, kept, Solved { theta: moved(&solved.theta, &theta), ..solved }));
            if farthest < SETTLED {
                break;
            }
        }
        progress(1.0);
        let (rows, kept, solved) = found?;
        Some(Self::with(parts, (first.setup().law, prior), &rows, &kept, solved))
    }

    /// What the model with the field misses at the points of a planned part, root mean square, mm; points of something else
    /// aside. `is_newest`: the datum is that of the part.
    pub fn missed(&self, walls: &[Wall<'_>], part: &[CutPart], is_newest: bool) -> f64 {
        let table = force_table(&self.core.fit.parameters);
        let machines: Vec<Loop> = walls.iter().map(|wall| self.core.machine(wall.path, &table)).collect();
        let engagements = engagements(&machines);
        let Parameters { datum, .. } = self.core.fit.parameters;
        let left = predicted(walls, &self.core.fit.parameters, part);
        let points =
            part.iter().zip(&left).flat_map(|(cut, left)| cut.points.iter().zip(left).map(|at| (cut.wall, at)));
        let squares = points.filter_map(|(wall, (point, left))| {
            let place = engagements[wall].place(point.s, float(point.height));
            let beside = self.field.as_ref().map_or(0.0, |field| field.at(&place));
            let shift = if is_newest { mm(datum.along(point.normal)) } else { 0.0 };
            (point.weight >= FITTING).then_some((mm(point.error) - ((*left)? + beside - shift)).powi(2))
        });
        let (sum, count) = squares.fold((0.0, 0.0), |(sum, count), square| (sum + square, count + 1.0));
        f64::sqrt(sum / f64::max(count, 1.0))
    }

    fn with(
        parts: &[CutPart],
        (law, prior): (WallLaw, &Prior),
        rows: &[Row],
        kept: &[(usize, usize)],
        solved: Solved,
    ) -> Self {
        let mut points: Vec<Vec<Observation>> = parts.iter().map(|part| part.points.clone()).collect();
        for (((part, at), row), (residual, weight)) in
            kept.iter().zip(rows).zip(solved.residuals.iter().zip(&solved.weights))
        {
            let point = &mut points[*part][*at];
            point.predicted = point.error - nm(*residual);
            (point.weight, point.spread) = (real(*weight), real(solved.spread));
            point.noise = nm(row.deviation);
        }
        let outliers = solved.weights.iter().filter(|w| **w < 0.3).count();
        let fit = Fit {
            parameters: prior.at(&solved.theta),
            theta: solved.theta,
            covariance: solved.covariance,
            cost: Real::ZERO,
            steps: ROUNDS.0 as u32,
            outliers,
            evidence: real(solved.evidence),
        };
        Self { core: job::Identified { law, prior: *prior, fit }, field: solved.field, points }
    }
}

/// The machine of `shared` with the datum of `found`.
fn moved(found: &[Real; COUNT], shared: &[Real; COUNT]) -> [Real; COUNT] {
    std::array::from_fn(|k| if k < SHARED { shared[k] } else { found[k] })
}

/// Engagement along every contour of a part.
fn engagements<'p>(machines: &'p [Loop<'p>]) -> Vec<Engagement<'p>> {
    machines.iter().enumerate().map(|(contour, machine)| Engagement::of(machine, contour)).collect()
}

/// The walls that a machine leaves on all parts, at their points, mm; `None` where no wall is.
pub fn predicted(walls: &[Wall<'_>], parameters: &Parameters, parts: &[CutPart]) -> Vec<Vec<Option<f64>>> {
    let table = force_table(parameters);
    let machines = walls.iter().map(|wall| (wall, parameters.machine(wall.path, &table)));
    let benches: Vec<Bench> =
        machines.map(|(wall, machine)| Bench::new(Mill::new(machine, wall.grid, wall.slices), wall.slices)).collect();
    let of_part = |part: &CutPart| {
        let left = benches[part.wall].follow(&part.passes);
        part.points.iter().map(|point| read(walls[part.wall], &left, point)).collect()
    };
    parts.iter().map(of_part).collect()
}

/// What is left at a point, mm: between the samples beside it and the middles of the slices.
fn read(wall: Wall<'_>, left: &[Offset], point: &Observation) -> Option<f64> {
    let (path, count) = (wall.path, wall.slices.count());
    let of_sample = |index: usize| {
        let sample = path.samples().get(index).filter(|sample| sample.on_wall)?;
        let column = left.get(index * count..(index + 1) * count)?;
        Some((mm(sample.s), at_height(wall.slices, float(point.height), |k| Some(mm(column[k])))?))
    };
    let before = path.index_at(point.s);
    match (of_sample(before), of_sample(before + 1)) {
        (Some((a, ea)), Some((b, eb))) if b > a => Some(ea + (eb - ea) * ((mm(point.s) - a) / (b - a)).clamp(0.0, 1.0)),
        (a, b) => a.or(b).map(|(_, error)| error),
    }
}

/// The points of all parts, linearised about `theta`, and which they are.
fn rows(
    walls: &[Wall<'_>],
    (prior, theta): (&Prior, [Real; COUNT]),
    parts: &[CutPart],
) -> (Vec<Row>, Vec<(usize, usize)>) {
    let moved = |k: usize, by: Real| {
        let mut moved = theta;
        moved[k] += by;
        prior.at(&moved)
    };
    let physical = |k: &usize| Parameter::ALL[*k] != Parameter::Undersize && prior.sigma[*k] != Real::ZERO;
    let mut machines = vec![prior.at(&theta)];
    let asked: Vec<usize> = (0..SHARED).filter(physical).collect();
    machines.extend(asked.iter().flat_map(|k| [moved(*k, STEP), moved(*k, -STEP)]));
    let left: Vec<Vec<Vec<Option<f64>>>> =
        machines.par_iter().map(|parameters| predicted(walls, parameters, parts)).collect();
    let table = force_table(&machines[0]);
    let middle: Vec<Loop> = walls.iter().map(|wall| machines[0].machine(wall.path, &table)).collect();
    let engagements = engagements(&middle);
    let total: usize = parts.iter().map(|part| part.points.len()).sum();
    let each = total.div_ceil(MOST_POINTS).max(1);
    let (mut rows, mut kept) = (Vec::new(), Vec::new());
    for (of, cut) in parts.iter().enumerate() {
        let path = walls[cut.wall].path;
        for (at, point) in cut.points.iter().enumerate().step_by(each) {
            let Some(base) = left[0][of][at] else { continue };
            let mut sensitivity = [0.0; COUNT];
            for (pair, k) in left[1..].chunks(2).zip(&asked) {
                let [Some(above), Some(below)] = [pair[0][of][at], pair[1][of][at]] else { continue };
                sensitivity[*k] = (above - below) / (2.0 * float(STEP));
            }
            let [.., undersize, x, y] = prior.sigma.map(float);
            sensitivity[SHARED - 1] = undersize;
            sensitivity[SHARED] = -x * float(point.normal.x);
            sensitivity[SHARED + 1] = -y * float(point.normal.y);
            let linear: f64 = (0..SHARED).map(|k| sensitivity[k] * float(theta[k])).sum();
            let missed = if cut.is_planned { cancelled(path, cut, point) } else { mm(point.error) };
            rows.push(Row {
                part: cut.part,
                is_planned: cut.is_planned,
                place: engagements[cut.wall].place(point.s, float(point.height)),
                unexplained: mm(point.error) - base + linear,
                deviation: hypot(mm(point.noise), MODEL_SHARE * missed),
                sensitivity,
            });
            kept.push((of, at));
        }
    }
    (rows, kept)
}

/// What the last pass cancels at a point, mm.
fn cancelled(path: &Path, cut: &CutPart, point: &Observation) -> f64 {
    let at = path.index_at(point.s).saturating_sub(path.first());
    let node = cut.passes.last().and_then(|pass| pass.nodes.get(at));
    node.map_or(0.0, |node| mm(node.total().along(point.normal)))
}

/// The solution about an estimate.
struct Solved {
    theta: [Real; COUNT],
    covariance: truepath_core::identify::Matrix,
    field: Option<Field>,
    /// Factor on the stated deviations.
    spread: f64,
    residuals: Vec<f64>,
    weights: Vec<f64>,
    evidence: f64,
}

impl<'r> Task<'r> {
    fn of(rows: &'r [Row], prior: &Prior, theta: &[Real; COUNT]) -> Self {
        let precision = prior_weights(theta);
        let sigma = prior.sigma.map(float);
        let of = |k: usize| if sigma[k] > 0.0 { 1.0 } else { 0.0 };
        let variance = std::array::from_fn(|k| of(k) / float(precision[k]));
        let lack =
            std::array::from_fn(|k| if sigma[k] > 0.0 { (lack(Parameter::ALL[k]) / sigma[k]).powi(2) } else { 0.0 });
        let parametric = |a: &Row, b: &Row| {
            let (planned, same) = (a.is_planned && b.is_planned, a.part == b.part);
            let lasting = if planned { LASTING } else { 0.0 };
            let own = if planned && same { 1.0 - LASTING } else { 0.0 };
            let shared =
                (0..SHARED).map(|k| (variance[k] + (lasting + own) * lack[k]) * (a.sensitivity[k] * b.sensitivity[k]));
            let datum = |k: usize| if same { a.sensitivity[k] * b.sensitivity[k] } else { 0.0 };
            shared.sum::<f64>() + (datum(SHARED) + datum(SHARED + 1))
        };
        let of_all = |entry: &dyn Fn(&Row, &Row) -> f64| -> Vec<Vec<f64>> {
            rows.iter().enumerate().map(|(i, a)| rows[..=i].iter().map(|b| entry(a, b)).collect()).collect()
        };
        let parametric = of_all(&parametric);
        Self { rows, variance, lack, parametric, alike: [Vec::new(), Vec::new()] }
    }

    /// The points under weights, a factor on their noise and the sizes of a field, mm.
    fn factored(&self, weights: &[f64], spread: f64, [stretch, load]: [f64; 2]) -> Option<Factored> {
        let [by_stretch, by_load] = &self.alike;
        let entry = |i: usize, j: usize| {
            let field = stretch.powi(2) * by_stretch[i][j] + load.powi(2) * by_load[i][j];
            let own = if i == j { self.own(weights, spread, i) } else { 0.0 };
            self.parametric[i][j] + field + own
        };
        let matrix: Vec<Vec<f64>> = (0..self.rows.len()).map(|i| (0..=i).map(|j| entry(i, j)).collect()).collect();
        let factor = Cholesky::new(&matrix)?;
        let unexplained: Vec<f64> = self.rows.iter().map(|row| row.unexplained).collect();
        let inverse = factor.solve(&unexplained);
        let explained: f64 = unexplained.iter().zip(&inverse).map(|(y, w)| y * w).sum();
        let square = spread * spread;
        let stated = STATED * (square.ln() + 1.0 / square - 1.0);
        let evidence = -0.5 * (explained + factor.ln_determinant() + stated);
        Some(Factored { factor, weights: inverse, evidence })
    }

    /// Variance of a point of its own, mm².
    fn own(&self, weights: &[f64], spread: f64, row: usize) -> f64 {
        (spread * self.rows[row].deviation).powi(2) / weights[row]
    }

    /// What no unknown explains of the points, mm.
    fn residuals(&self, found: &Factored, weights: &[f64], spread: f64) -> Vec<f64> {
        found.weights.iter().enumerate().map(|(k, inverse)| self.own(weights, spread, k) * inverse).collect()
    }

    /// The weights at which they stay, under a field and a factor on the noise: each point is held against what all the others say
    /// of it (leave-one-out), so that a field cannot hide one that is of something else.
    fn weigh(&self, spread: f64, field: [f64; 2]) -> Option<Vec<f64>> {
        let mut weights = vec![1.0; self.rows.len()];
        for _ in 0..WEIGHINGS {
            let found = self.factored(&weights, spread, field)?;
            let precision = found.factor.inverse_diagonal();
            let left_out = found.weights.iter().zip(&precision);
            for (((inverse, precision), weight), row) in left_out.zip(&mut weights).zip(self.rows) {
                let (residual, deviation) = ((inverse / precision).abs(), spread * row.deviation);
                // Beside its own variance the others leave so much open.
                let open = (1.0 / precision - deviation * deviation / *weight).max(0.0);
                let expected = hypot(open.sqrt(), deviation);
                *weight = if residual <= OUTLYING * expected {
                    1.0
                } else {
                    (OUTLYING * deviation / residual).powi(2).clamp(LEAST_WEIGHT, 1.0)
                };
            }
        }
        Some(weights)
    }

    /// Sizes of the field and factor on the noise by the evidence.
    fn sizes(&self, weights: &[f64]) -> Option<([f64; 2], f64)> {
        let most = |field: [f64; 2]| {
            let each = SPREADS
                .par_iter()
                .filter_map(|spread| Some((self.factored(weights, *spread, field)?.evidence, *spread)));
            each.max_by(|a, b| a.0.total_cmp(&b.0))
        };
        let (plain, spread) = most([0.0; 2])?;
        let mut best = (plain + DECISIVE, [0.0; 2], spread);
        // What a field explains is no noise: with one the factor is at most that without.
        let tried = [spread, (0.5 * spread).max(SPREADS[0]), 1.0f64.min(spread)];
        let fields: Vec<([f64; 2], f64)> = SIZES
            .iter()
            .flat_map(|stretch| SIZES.iter().map(move |load| [*stretch, *load]))
            .filter(|field| field[0] + field[1] > 0.0)
            .flat_map(|field| tried.iter().map(move |spread| (field, *spread)))
            .collect();
        let each = fields
            .par_iter()
            .filter_map(|(field, spread)| Some((self.factored(weights, *spread, *field)?.evidence, *field, *spread)));
        for found in each.collect::<Vec<_>>() {
            if found.0 > best.0 {
                best = found;
            }
        }
        Some((best.1, best.2))
    }

    fn solve(mut self, kernel: &dyn Fn([f64; 2]) -> Kernel) -> Option<Solved> {
        let rows = self.rows;
        self.alike = [[1.0, 0.0], [0.0, 1.0]].map(|size| {
            let kernel = kernel(size);
            let entry = |a: &Row, b: &Row| {
                if a.is_planned && b.is_planned { kernel.of(&a.place, &b.place) } else { 0.0 }
            };
            rows.iter().enumerate().map(|(i, a)| rows[..=i].iter().map(|b| entry(a, b)).collect()).collect()
        });
        let weights = self.weigh(1.0, WIDE)?;
        let (sizes, spread) = self.sizes(&weights)?;
        let weights = self.weigh(spread, sizes)?;
        let found = self.factored(&weights, spread, sizes)?;

        let mut theta = [Real::ZERO; COUNT];
        let lasting = |row: &Row, k: usize| {
            (self.variance[k] + if row.is_planned { LASTING * self.lack[k] } else { 0.0 }) * row.sensitivity[k]
        };
        let with: Vec<Vec<f64>> = (0..SHARED).map(|k| rows.iter().map(|row| lasting(row, k)).collect()).collect();
        for (theta, with) in theta.iter_mut().zip(&with) {
            *theta = real(with.iter().zip(&found.weights).map(|(g, w)| g * w).sum());
        }
        let newest = rows.iter().map(|row| row.part).max().unwrap_or_default();
        for k in [SHARED, SHARED + 1] {
            let own = rows.iter().zip(&found.weights).filter(|(row, _)| row.part == newest);
            theta[k] = real(own.map(|(row, w)| row.sensitivity[k] * w).sum());
        }
        let half: Vec<Vec<f64>> = with.iter().map(|with| found.factor.halfway(with)).collect();
        let mut covariance = [[Real::ZERO; COUNT]; COUNT];
        for (k, row) in covariance.iter_mut().enumerate() {
            row[k] = Real::ONE;
            for (l, entry) in row.iter_mut().enumerate().filter(|(l, _)| k < SHARED && *l < SHARED) {
                let before = if k == l { self.variance[k] + self.lack[k] } else { 0.0 };
                *entry = real(before - half[k].iter().zip(&half[l]).map(|(a, b)| a * b).sum::<f64>());
            }
        }
        let residuals = self.residuals(&found, &weights, spread);
        let evidence = found.evidence;
        let field = (sizes != [0.0; 2]).then(|| {
            let seen = rows.iter().enumerate().filter(|(_, row)| row.is_planned);
            let seen = seen.map(|(at, row)| (at, row.place)).collect();
            Field::new(kernel(sizes), seen, found.factor, found.weights)
        });
        Some(Solved { theta, covariance, field, spread, residuals, weights, evidence })
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use truepath_core::cut::{Coefficients, Compliance};

    use super::*;

    /// A kernel on an open contour.
    fn kernel(sizes: [f64; 2]) -> Kernel {
        Kernel::new(sizes, 10.0)
    }

    fn prior() -> Prior {
        let stated = Coefficients {
            ktc: Real::from_int(1500),
            krc: Real::from_int(500),
            kte: Real::from_int(15),
            kre: Real::from_int(18),
            size_exponent: Real::ZERO,
        };
        Prior::around(stated, Compliance::from_stiffness(Real::from_int(2000), Real::from_int(2000)), WallLaw::Helical)
    }

    /// Eight places at three heights on a part without a correction and on a planned one, of a machine that is `level` prior standard
    /// deviations softer; readings are off by `noise` times a micrometre and by `beside`, mm, on the planned part.
    fn rows(level: f64, noise: &[f64], beside: impl Fn(f64, usize) -> f64) -> Vec<Row> {
        let at = |k: usize| {
            let (part, place, height) = (k / 24, k % 24 / 3, k % 3);
            let corner = place == 3 || place == 4;
            let s = 10.0 * place as f64;
            let mut sensitivity = [0.0; COUNT];
            // A planned wall moves by a tenth of what a full cut does.
            let load = if corner { 0.30 } else { 0.12 } * if part == 0 { 1.0 } else { 0.1 };
            sensitivity[0] = load;
            sensitivity[6] = 0.2 * load * (0.5 - height as f64 / 2.0);
            let engaged = [if corner { 1.4 } else { 0.8 }; 3];
            let off = if part == 1 { beside(s, height) } else { 0.0 };
            Row {
                part: part as u32,
                is_planned: part == 1,
                place: Place::new(s, engaged, 0.1 + 0.4 * height as f64),
                unexplained: level * load + 1e-3 * noise[k] + off,
                deviation: 0.001,
                sensitivity,
            }
        };
        (0..48).map(at).collect()
    }

    fn solved(rows: &[Row]) -> Solved {
        Task::of(rows, &prior(), &[Real::ZERO; COUNT]).solve(&kernel).unwrap()
    }

    fn noises() -> impl Strategy<Value = Vec<f64>> {
        // Sums of twelve even numbers are nearly normal. What is farther off than this is a wild touch, which has a test of its own.
        let noise = |v: Vec<f64>| v.iter().sum::<f64>().clamp(-2.5, 2.5);
        prop::collection::vec(prop::collection::vec(-0.5f64..0.5, 12).prop_map(noise), 48)
    }

    // The bounds are those that 4,000 draws of each keep: what is drawn anew on every run must not fail once in a thousand.
    proptest! {
        #![proptest_config(ProptestConfig { cases: 12, ..ProptestConfig::default() })]

        #[test]
        fn a_machine_is_found_and_a_wall_that_yields_beside_it(level in -0.8f64..0.8, noise in noises()) {
            let found = solved(&rows(level, &noise, |_, _| 0.0));
            let sigma = float(found.covariance[0][0]).sqrt();
            prop_assert!((float(found.theta[0]) - level).abs() < 5.0 * sigma, "{:?} of {level}, {sigma}", found.theta[0]);
            prop_assert!(found.field.is_none_or(|field| field.amplitudes_mm().iter().all(|size| *size <= 0.003)));

            // A stretch of straight wall is off from tip to top: no machine makes that, and the machine stays what it is.
            let yields = |s: f64, _| if (s - 60.0).abs() < 1.0 { 0.012 } else { 0.0 };
            let found = solved(&rows(level, &noise, yields));
            prop_assert!((float(found.theta[0]) - level).abs() < 0.05, "{:?} of {level}", found.theta[0]);
            let field = found.field.expect("a field");
            let at = |s| field.at(&Place::new(s, [0.8; 3], 0.5));
            prop_assert!((at(60.0) - 0.012).abs() < 0.006 && at(20.0).abs() < 0.006, "{} {}", at(60.0), at(20.0));
        }

        #[test]
        fn what_one_contour_shows_beside_the_common_machine_is_not_on_the_other(level in -0.8f64..0.8, noise in noises()) {
            let yields = |s: f64, _| if (s - 60.0).abs() < 1.0 { 0.012 } else { 0.0 };
            let mut both = rows(level, &noise, yields);
            let other = rows(level, &noise, |_, _| 0.0).into_iter();
            both.extend(other.map(|row| Row { place: row.place.on(1, None), ..row }));
            let found = solved(&both);
            prop_assert!((float(found.theta[0]) - level).abs() < 0.05, "{:?} of {level}", found.theta[0]);
            let field = found.field.expect("a field");
            let at = |contour| field.at(&Place::new(60.0, [0.8; 3], 0.5).on(contour, None));
            prop_assert!((at(0) - 0.012).abs() < 0.006 && at(1).abs() < 0.006, "{} {}", at(0), at(1));
        }

        #[test]
        fn a_wild_touch_is_no_field(noise in noises(), wild in 24usize..48) {
            let mut rows = rows(0.3, &noise, |_, _| 0.0);
            rows[wild].unexplained += 0.08;
            let found = solved(&rows);
            prop_assert!(found.weights[wild] < 0.3, "{}", found.weights[wild]);
            prop_assert!((float(found.theta[0]) - 0.3).abs() < 0.05);
            let field = found.field.map_or(0.0, |field| field.at(&rows[wild].place));
            prop_assert!(field.abs() < 0.004, "{field}");
        }
    }
}
