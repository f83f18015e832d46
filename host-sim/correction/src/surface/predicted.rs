//! The wall of one pass, as the identified machine cuts it, with what is not known of it.
//!
//! Limits: what the points leave open is linearised about the identified machine; two hundred places are drawn, of a long contour
//! five hundred, the worst of as many stretches. The ends of an open contour and sharp inside corners are not judged (see [`judged`]).

use rayon::prelude::*;
use truepath_core::correct::{Band, HEIGHTS, Node, commanded};
use truepath_core::cut::{Loop, Path, State, WallError};
use truepath_core::identify::{Fit, Parameter, Parameters, Prior, neighbours, prior_weights};
use truepath_core::units::{Offset, Real};
use truepath_ground::rows::largest;
use truepath_ground::units::{float, mm, real};

use super::draws::{Beside, Uncertain};
use super::expected::Surface;
use super::unmodelled::{SOFTER, lack, unbent, unmodelled};
use super::wall::{WallFigures, judged};
use crate::correction::Identification;
use crate::discrepancy::Along;
use crate::force_tables::force_table;
use crate::parallel_walls::{CutWalls, run, walls_at};

/// Places whose walls are drawn: as many, as long as they are no farther apart than a part of the radius, and at most.
const DRAWN_PLACES: usize = 200;
const MOST_DRAWN_PLACES: usize = 500;
/// Within such a part of the radius a wall hardly changes.
const ALIKE: i64 = 4;
/// Heights of a place.
pub const COUNT: usize = HEIGHTS as usize;

impl Surface {
    /// Of the wall that a machine, which was identified, leaves with a correction, empty for none; `beside` is what is beside it.
    pub fn predicted(machine: &Loop, known: &Identification, beside: &Along, nodes: &[Node]) -> Self {
        let path = machine.path;
        let (first, depth_mm) = (path.first(), float(path.setup().axial_depth));
        let places: Vec<(usize, f64)> = judged(path).collect();
        let indices: Vec<usize> = places.iter().map(|(index, _)| *index).collect();
        let found = &known.fit().parameters;
        let known_states = states(machine, nodes);
        let walls = walls_at(machine, &known_states, heights(), &indices);
        let mut all = in_mm(&walls);
        let load = Load::of(machine, nodes, &all, &indices, found);
        for ((column, per_load), index) in all.chunks_mut(COUNT).zip(load.over_mean()).zip(&indices) {
            let of = |residual: &[Offset]| residual.get(index - first).copied().map_or(0.0, mm);
            let (rest, by_load) = (of(&beside.mean), of(&beside.by_load.mean));
            column.iter_mut().zip(per_load).for_each(|(wall, beyond)| *wall += rest + by_load * beyond);
        }
        let columns: Vec<&[f64]> = all.chunks(COUNT).collect();
        let figures = WallFigures::over(places.iter().zip(&columns).map(|((_, s), c)| (*s, c.to_vec())));

        let (stretch, kept) = drawn_places(path, places.len(), figures.worst / COUNT, |place| largest(columns[place]));
        let drawn: Vec<usize> = kept.iter().map(|at| indices[*at]).collect();
        let base: Vec<f64> = kept.iter().flat_map(|at| columns[*at].iter().copied()).collect();
        let cut_walls =
            CutWalls::of((machine, &known_states), heights(), kept.iter().map(|at| (indices[*at], walls[*at])));

        let tail = in_the_tail(known.prior(), known.fit()).map(|other| (Origin::Points, other, 1.0));
        let noise = neighbours(known.prior(), known.fit()).map(|(other, share)| (Origin::Points, other, float(share)));
        let others = unmodelled(found).enumerate().filter(|(which, _)| *which != SOFTER);
        let lacking = others.map(|(_, other)| (Origin::Model, other, 1.0));
        let machines: Vec<_> = noise.chain(tail).chain(lacking).chain([(Origin::Unbent, unbent(found), 1.0)]).collect();
        let cut = |(origin, other, share): &(Origin, Parameters, f64)| {
            let table = force_table(other);
            let other = other.machine(path, &table);
            // Some columns move nothing but the datum of the part that was probed.
            let moves = !other.cuts_as(machine);
            let moved = moves.then(|| cut_walls.moved_by(&other))?;
            Some((*origin, moved.iter().flatten().map(|change| mm(*change) * share).collect::<Vec<f64>>()))
        };
        let changes: Vec<_> = machines.par_iter().filter_map(cut).collect();
        let softer = kept.iter().flat_map(|at| load.at(*at)).map(|per_load| per_load * lack(Parameter::Compliance));
        let mut uncertain = Uncertain { heights: COUNT, base, lacking: vec![softer.collect()], ..Uncertain::default() };
        for (origin, change) in changes {
            match origin {
                Origin::Points => uncertain.noise.push(change),
                Origin::Model => uncertain.lacking.push(change),
                Origin::Unbent => uncertain.unbent = change,
            }
        }
        let of = |sigmas: &[Offset], index: usize| sigmas.get(index - first).copied().map_or(0.0, mm);
        let loads: Vec<&[f64]> = kept.iter().map(|at| load.at(*at)).collect();
        if !beside.repeat.is_empty() {
            // The level of force is one for the whole part.
            let column = |(index, load): (&usize, &&[f64])| {
                let (mean, repeat) = (mean(load), of(&beside.repeat, *index));
                let even = if mean < 0.0 { -repeat } else { repeat };
                load.iter()
                    .map(|load| not_less(even + beside.by_load.level * (load - mean), even))
                    .collect::<Vec<f64>>()
            };
            uncertain.lacking.push(drawn.iter().zip(&loads).flat_map(column).collect());
        }
        if !beside.sigma.is_empty() {
            let share = |index: usize| beside.by_load.share.get(index - first).copied().unwrap_or_default();
            let by_load = |(index, at): (&usize, &usize)| {
                let sigma = of(&beside.sigma, *index) * share(*index).sqrt();
                load.beyond(*at).map(|beyond| not_less(sigma * (1.0 + beyond), sigma)).collect::<Vec<f64>>()
            };
            let even = |at: &usize| {
                let (index, s) = places[*at];
                (s, of(&beside.sigma, index) * (1.0 - share(index)).max(0.0).sqrt())
            };
            uncertain.beside = Some(Beside {
                places: kept.iter().map(even).collect(),
                load: drawn.iter().zip(&kept).flat_map(by_load).collect(),
                reach_mm: mm(path.setup().radius),
            });
        }
        let worst = figures.worst / COUNT / stretch * COUNT + figures.worst % COUNT;
        let place = (figures.worst_s_mm, figures.worst_fraction * depth_mm);
        Self::of(&uncertain, worst, place).0
    }
}

/// The length of the stretches from which one place each is drawn, and these places, counted among all that are judged: where walls are alike
/// within a stretch its middle, else the worst; of the stretch with the worst place of all that one.
fn drawn_places(path: &Path, places: usize, worst: usize, error: impl Fn(usize) -> f64) -> (usize, Vec<usize>) {
    let alike = usize::try_from(path.setup().radius.nm() / ALIKE / path.step().nm().max(1)).unwrap_or(1);
    let stretch = places.div_ceil(DRAWN_PLACES).min(alike).max(places.div_ceil(MOST_DRAWN_PLACES)).max(1);
    let of = |from: usize| {
        let to = (from + stretch).min(places);
        if (from..to).contains(&worst) {
            return Some(worst);
        }
        let middle = (stretch <= alike).then_some(usize::midpoint(from, to - 1));
        middle.or_else(|| (from..to).max_by(|a, b| error(*a).total_cmp(&error(*b))))
    };
    (stretch, (0..places).step_by(stretch).filter_map(of).collect())
}

/// Why another machine is asked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Origin {
    /// The points do not tell it apart.
    Points,
    /// The model is not the cut.
    Model,
    /// Its cutter does not bend.
    Unbent,
}

/// The machine with a cutter of another size that is as far away as the long tails of what is believed of that allow and the points
/// do not forbid, and with all that goes with it: a fit counts a cutter that the points hardly see as if it were known.
fn in_the_tail(prior: &Prior, fit: &Fit) -> Option<Parameters> {
    let size = Parameter::Undersize as usize;
    let covariance = fit.covariance.map(|row| row.map(float));
    let variance = covariance[size][size];
    let weight = float(prior_weights(&fit.theta)[size]);
    let by_points = (1.0 / variance.max(1e-9) - weight).max(0.0);
    let farther = 1.0 / (by_points + TAIL.powi(-2)) - variance;
    (farther > 0.0 && variance > 0.0).then(|| {
        let step = farther.sqrt() / variance;
        let mut theta = fit.theta;
        theta.iter_mut().zip(&covariance).for_each(|(theta, row)| *theta += real(row[size] * step));
        prior.at(&theta)
    })
}

/// Half of the distance within which Student's t with two degrees of freedom is in 95 of 100 cases, in terms of its scale.
pub(crate) const TAIL: f64 = 2.15;

/// What a larger load does to a wall at every height: the helix and the bending cutter make it more at some and less at others, and what
/// differs along a contour or from part to part by the load does so too.
struct Load {
    /// The change per unit of the natural logarithm of the load, mm, place by place, all heights of a place side by side.
    per_load: Vec<f64>,
}

/// A mean over the height that is a smaller share of the largest change at any height is no measure of a load.
const LEAST_MEAN: f64 = 0.3;

impl Load {
    fn of(machine: &Loop, nodes: &[Node], alone: &[f64], indices: &[usize], found: &Parameters) -> Self {
        let softer = unmodelled(found).nth(SOFTER).unwrap_or(*found).machine(machine.path, machine.table);
        let by = lack(Parameter::Compliance);
        let walls = errors(&softer, nodes, indices);
        Self { per_load: walls.iter().zip(alone).map(|(wall, alone)| (wall - alone) / by).collect() }
    }

    /// The change at all heights of a place.
    fn at(&self, place: usize) -> &[f64] {
        self.per_load.get(place * COUNT..(place + 1) * COUNT).unwrap_or_default()
    }

    /// By how much the change at every height of a place is beyond that of the mean over the height, in terms of it.
    fn beyond(&self, place: usize) -> impl Iterator<Item = f64> {
        let column = self.at(place);
        let mean = mean(column);
        let measure = mean.abs().max(LEAST_MEAN * largest(column)).max(1e-9);
        let measure = if mean < 0.0 { -measure } else { measure };
        column.iter().map(move |change| (change - mean) / measure)
    }

    /// The same of all places.
    fn over_mean(&self) -> impl Iterator<Item = impl Iterator<Item = f64>> {
        (0..self.per_load.len() / COUNT).map(|place| self.beyond(place))
    }
}

/// A deviation at a height: where the model expects the load to do next to nothing it does not know that so well.
fn not_less(at_height: f64, even: f64) -> f64 {
    if at_height.abs() < even.abs() { even } else { at_height }
}

fn mean(column: &[f64]) -> f64 {
    column.iter().sum::<f64>() / column.len().max(1) as f64
}

/// The wall errors that a machine leaves with a correction, empty for none, at samples of its path, mm: sample by sample, in each at
/// [`COUNT`] even heights from the tip up; zero where no wall stands.
pub fn errors(machine: &Loop, nodes: &[Node], places: &[usize]) -> Vec<f64> {
    in_mm(&walls_at(machine, &states(machine, nodes), heights(), places))
}

/// The states of a machine that cuts with a correction.
fn states(machine: &Loop, nodes: &[Node]) -> Vec<State> {
    let path = machine.path;
    let mut states = vec![State::REST; path.working().len()];
    run(machine, path.working().start, &mut states, &|index| commanded(path, nodes, index));
    states
}

fn in_mm(walls: &[[Option<WallError>; COUNT]]) -> Vec<f64> {
    walls.iter().flatten().map(|wall| wall.map_or(0.0, |wall| mm(wall.error))).collect()
}

/// The heights of a place.
fn heights() -> [Real; COUNT] {
    std::array::from_fn(|k| Band::WHOLE.at(k as i64))
}

#[cfg(test)]
mod tests {
    use truepath_core::cut::{Coefficients, Compliance, WallLaw};
    use truepath_core::units::Real;

    use super::*;

    fn prior() -> Prior {
        let coefficients = Coefficients {
            ktc: Real::from_int(1000),
            krc: Real::from_int(300),
            kte: Real::from_int(12),
            kre: Real::from_int(14),
            size_exponent: Real::ZERO,
        };
        Prior::around(
            coefficients,
            Compliance::from_stiffness(Real::from_int(3000), Real::from_int(3000)),
            WallLaw::Helical,
        )
    }

    /// A fit whose points have left so much of the cutter's size open, a variance in prior standard deviations, and found it with the
    /// compliance.
    fn fit(prior: &Prior, variance: Real, with_compliance: Real) -> Fit {
        let (size, compliance) = (Parameter::Undersize as usize, Parameter::Compliance as usize);
        let theta = [Real::ZERO; Parameter::ALL.len()];
        let mut covariance = [theta; Parameter::ALL.len()];
        covariance[size][size] = variance;
        (covariance[size][compliance], covariance[compliance][size]) = (with_compliance, with_compliance);
        let (cost, evidence) = (Real::ZERO, Real::ZERO);
        Fit { parameters: prior.at(&theta), theta, covariance, cost, steps: 0, outliers: 0, evidence }
    }

    #[test]
    fn a_cutter_that_the_points_hardly_see_may_be_as_far_off_as_its_long_tail_and_takes_along_what_goes_with_it() {
        let prior = prior();
        let off = |variance: Real, with| {
            let other = in_the_tail(&prior, &fit(&prior, variance, with))?;
            Some((mm(other.undersize), float(other.compliance.mean) * 3.0))
        };
        // Believed in with a scale of 2 µm, of which the points take a tenth: 1/1.1 of 2/3, the variance that the fit counts.
        let unseen = Real::ONE / (Real::ratio(3, 2) + Real::ratio(1, 10));
        let (size, compliance) = off(unseen, Real::ZERO).expect("a tail");
        let whole = 1.0 / (0.1 + TAIL.powi(-2));
        assert!((size - 0.002 * (whole - 1.0 / 1.6).sqrt()).abs() < 1e-5, "{size}");
        assert!((compliance - 1.0).abs() < 1e-6, "{compliance}");
        // Half as much of the compliance, in its 50 % of the logarithm, goes the same way.
        let (size, compliance) = off(unseen, unseen * Real::HALF).expect("a tail");
        assert!((compliance.ln() - 0.5 * 0.5 * size / 0.002).abs() < 1e-4, "{size} {compliance}");
        // Points that see it ten times as sharply leave next to nothing, and one that is held has no tail.
        let (size, _) = off(Real::ratio(1, 100), Real::ZERO).expect("a little");
        assert!(size < 0.0003, "{size}");
        assert_eq!(off(Real::ZERO, Real::ZERO), None);
    }

    #[test]
    fn what_a_load_does_at_a_height_is_told_beyond_its_mean() {
        let columns = |heights: &dyn Fn(usize) -> f64| (0..COUNT).map(heights).collect::<Vec<f64>>();
        let even = columns(&|_| 0.3);
        let ramp = columns(&|k| 0.21 - 0.4 * k as f64 / (COUNT - 1) as f64);
        let more = columns(&|k| -0.1 - 0.2 * k as f64 / (COUNT - 1) as f64);
        let load = Load { per_load: [even, ramp, more, vec![0.0; COUNT]].concat() };
        let of = |place| load.beyond(place).collect::<Vec<f64>>();
        assert!(of(0).iter().chain(&of(3)).all(|beyond| beyond.abs() < 1e-12));
        // Its mean is next to nothing: the largest change is the measure.
        let (ramp, more) = (of(1), of(2));
        assert!((ramp[0] - 0.2 / (0.21 * LEAST_MEAN)).abs() < 1e-9, "{ramp:?}");
        assert!((ramp[0] + ramp[COUNT - 1]).abs() < 1e-9, "{ramp:?}");
        // A load that cuts deeper: half less and half more than the mean of −0.2 mm.
        assert!((more[0] + 0.5).abs() < 1e-9 && (more[COUNT - 1] - 0.5).abs() < 1e-9, "{more:?}");
        assert_eq!(load.over_mean().count(), 4);
    }
}
