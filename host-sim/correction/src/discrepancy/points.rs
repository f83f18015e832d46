//! The points of all parts, as parameters and discrepancy explain them together.

use truepath_core::correct::{Node, commanded};
use truepath_core::cut::{Path, State};
use truepath_core::geometry::Vector;
use truepath_core::identify::{COUNT, Observation, Parameter, PredictionWorkspace, predict};
use truepath_core::job;
use truepath_ground::units::{float, mm, real};

use super::feature::{Engagement, Feature, Sensitivity};
use super::kernel::{Extent, Kernel, Pair};
use super::nominal::moved_stock;
use super::pairs::Pairs;
use crate::force_tables::force_table;

/// Points that are looked at one by one; of more the mean over the heights of a place is.
const MOST_POINTS: usize = 120;
/// Places that are looked at, the newest parts first.
const MOST_PLACES: usize = 160;
/// Parameters that all parts share; the other two are the datum of each.
pub(super) const SHARED: usize = COUNT - 2;

/// What a part has of its own.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Own {
    /// Its datum, prior standard deviations.
    pub datum: [f64; 2],
    /// Its level of force over that of the last part, natural logarithm, where it is fitted: that of the last part is not.
    pub level: f64,
}

/// The points of one contour of one part, as a fit has left them.
#[derive(Clone, Copy, Debug)]
pub struct CutPoints<'a> {
    /// Its path, whatever its law, with the stock that is expected along it.
    pub path: &'a Path<'a>,
    /// Its number among the contours of the part.
    pub contour: usize,
    /// How many parts before the next one it was cut: 1 for the newest.
    pub parts_ago: u32,
    /// The correction it was cut with; empty for none.
    pub nodes: &'a [Node],
    /// The points.
    pub observations: &'a [Observation],
    /// By how much the allowance of that stock is larger than the job says at the points, mm; empty for nowhere.
    pub more: &'a [f64],
    /// What the part has of its own.
    pub own: Own,
}

/// A point, or the mean of the points of a place.
#[derive(Clone, Debug)]
pub(super) struct Row {
    pub(super) feature: Feature,
    /// The wall across, where the point is a width: the mean of both. It may be on another contour.
    pub(super) across: Option<Feature>,
    pub(super) parts_ago: u32,
    /// Measured − predicted where no parameter is known better than before, the stock is even and all parts have one level of force,
    /// mm: the residual of the fit and what all of these have explained.
    pub(super) unexplained: f64,
    /// Variance of each of its points by the stated noise, mm².
    pub(super) noise: f64,
    /// Points that it is the mean of.
    pub(super) count: f64,
    /// Change of the prediction per prior standard deviation of every parameter, mm.
    pub(super) sensitivity: [f64; COUNT],
    /// The places of the points among those given.
    pub(super) points: std::ops::Range<usize>,
    /// The place of its other half, where it is one of a pair.
    pub(super) other_half: Option<usize>,
}

impl Row {
    /// Covariance with a place, as far as it repeats on the next part, mm².
    pub(super) fn lasting(&self, kernel: &Kernel, extents: &[Extent], place: &Feature) -> f64 {
        self.with(extents, place).lasting(kernel)
    }

    /// It with a place that several kernels are asked about.
    pub(super) fn with<'p>(&'p self, extents: &'p [Extent], place: &'p Feature) -> WithPlace<'p> {
        let pair = |own| Pair::of(extents, own, place);
        WithPlace { here: pair(&self.feature), across: self.across.as_ref().map(pair) }
    }
}

/// A row and a place.
#[derive(Clone, Debug)]
pub(super) struct WithPlace<'p> {
    here: Pair<'p>,
    across: Option<Pair<'p>>,
}

impl WithPlace<'_> {
    /// As [`Row::lasting`].
    pub(super) fn lasting(&mut self, kernel: &Kernel) -> f64 {
        let here = kernel.lasting_of(&mut self.here);
        self.across.as_mut().map_or(here, |across| 0.5 * (here + kernel.lasting_of(across)))
    }
}

/// Points of all parts.
#[derive(Clone, Debug)]
pub struct Points {
    pub(super) rows: Vec<Row>,
    pub(super) extents: Vec<Extent>,
    /// Prior precision of the shared parameters: 1, less far from the middle of one with long tails.
    pub(super) precision: [f64; SHARED],
    /// Points in all, used or not.
    pub(super) given: usize,
}

impl Points {
    /// Of a fit of the points; every cut's observations hold the predictions and sensitivities it ended with.
    pub fn of(cuts: &[CutPoints<'_>], core: &job::Identified) -> Self {
        let theta: [f64; COUNT] = core.fit.theta.map(float);
        let level = float(core.prior.sigma[0]).max(1e-9);
        let table = force_table(&core.fit.parameters);
        let many = cuts.iter().map(|cut| cut.observations.len()).sum::<usize>() > MOST_POINTS;
        let (mut rows, mut extents): (Vec<Row>, Vec<Option<Extent>>) = (Vec::new(), Vec::new());
        let paths: Vec<Path> = cuts.iter().map(|cut| cut.path.with_law(core.law)).collect();
        let (mut engagements, mut stock) = (Vec::new(), Vec::new());
        for (cut, path) in cuts.iter().zip(&paths) {
            if extents.len() <= cut.contour {
                extents.resize(cut.contour + 1, None);
            }
            extents[cut.contour] = Some(Extent::of(path));
            let working = path.working();
            let mut states = vec![State::REST; working.len()];
            let parameters = core.fit.parameters.with_force(real(cut.own.level));
            parameters.machine(path, &table).run(working.start, &mut states, |i| commanded(path, cut.nodes, i));
            engagements.push(Engagement::of(path, cut.contour, working.start, &states));
            stock.extend(stock_sensitivities(path, cut, core));
        }
        let pairs = Pairs::of(cuts.iter().flat_map(|cut| cut.observations));
        pairs.join(&mut stock);
        let place = |cut: usize| move |o: &Observation| (cut, o.s, o.normal);
        let places: Vec<_> =
            cuts.iter().enumerate().flat_map(|(cut, of)| of.observations.iter().map(place(cut))).collect();
        let mut before = 0;
        for (cut, engagement) in cuts.iter().zip(&engagements) {
            let from = before;
            let same = |a: &Observation, b: &Observation| {
                many && a.s == b.s && a.across() == b.across() && a.pair() == b.pair()
            };
            for group in cut.observations.chunk_by(same) {
                let own = before..before + group.len();
                before = own.end;
                let more = cut.more.get(own.start - from..own.end - from).unwrap_or_default();
                let row = row(cut, (group, &stock[own.clone()], more), engagement, (&theta, level));
                let row = Row { points: own.clone(), ..row };
                if group[0].pair().is_none() {
                    rows.push(row);
                    continue;
                }
                // A pair is one reading, and stands where its first half does.
                let Some(other) = pairs.other(own.start).filter(|other| *other > own.start) else { continue };
                let (cut, s, normal) = places[other];
                let of_load = Sensitivity { load: row.feature.load, stock: row.feature.stock };
                let across = Some(engagements[cut].at(s, normal, of_load));
                rows.push(Row { across, noise: 0.5 * row.noise, other_half: Some(other), ..row });
            }
        }
        // The newest parts tell most of the next one.
        rows.sort_by_key(|row| row.parts_ago);
        rows.truncate(MOST_PLACES);
        let is_long = |k: usize| matches!(Parameter::ALL[k], Parameter::ComplianceCross | Parameter::Undersize);
        let precision: [f64; SHARED] =
            std::array::from_fn(|k| if is_long(k) { 3.0 / (2.0 + theta[k] * theta[k]) } else { 1.0 });
        let blank = Extent { length: 1.0, closed: false, radius: 1.0, allowance: 0.0 };
        let extents = extents.into_iter().map(|extent| extent.unwrap_or(blank)).collect();
        Self { rows, extents, precision, given: before }
    }
}

fn row(
    cut: &CutPoints<'_>,
    (group, stock, more): (&[Observation], &[f64], &[f64]),
    engagement: &Engagement<'_>,
    (theta, level): (&[f64; COUNT], f64),
) -> Row {
    let count = group.len() as f64;
    let mean = |f: &dyn Fn(&Observation) -> f64| group.iter().map(f).sum::<f64>() / count;
    let sensitivity: [f64; COUNT] = std::array::from_fn(|k| mean(&|o| float(o.sensitivity[k]) * mm(o.deviation())));
    let fitted = |k: usize| if k < SHARED { theta[k] } else { cut.own.datum[k - SHARED] };
    let shared: f64 = (0..SHARED).map(|k| sensitivity[k] * fitted(k)).sum();
    // The two components of a vector are added first: their order is lost.
    let datum = sensitivity[SHARED] * fitted(SHARED) + sensitivity[SHARED + 1] * fitted(SHARED + 1);
    let by_stock = stock.iter().zip(more).map(|(per, more)| per * more).sum::<f64>() / count;
    let of_load = Sensitivity { load: sensitivity[0] / level, stock: stock.iter().sum::<f64>() / count };
    let by_level = of_load.load * cut.own.level;
    let unexplained = mean(&|o| mm(o.error - o.predicted)) + (shared + datum) + by_stock + by_level;
    let stated = mean(&|o| (mm(o.deviation()) / float(o.spread)).powi(2));
    let feature = engagement.at(group[0].s, group[0].normal, of_load);
    // Each of two walls bears as much of the load as both do in the mean.
    let across = group[0].across().map(|s| engagement.at(s, group[0].normal.reversed(), of_load));
    let (parts_ago, noise) = (cut.parts_ago, stated);
    Row { feature, across, parts_ago, unexplained, noise, count, sensitivity, points: 0..0, other_half: None }
}

/// Change of the error at the points of a cut per allowance, mm per mm.
pub fn stock_sensitivities(path: &Path, cut: &CutPoints<'_>, core: &job::Identified) -> Vec<f64> {
    let parameters = core.fit.parameters.with_force(real(cut.own.level));
    let predicted = |path: &Path| {
        let room = path.working().len() + 1;
        let (mut states, mut displacements) = (vec![State::REST; room], vec![Vector::ZERO; room]);
        let mut workspace = PredictionWorkspace { states: &mut states, displacements: &mut displacements };
        let mut points = cut.observations.to_vec();
        let asked = |i: usize| commanded(path, cut.nodes, i);
        predict(path, &force_table(&parameters), &parameters, asked, &mut points, &mut workspace);
        points
    };
    let [more, less] = moved_stock(path).map(|(mut buffer, shift)| {
        let moved = path.with_stock_moved(&mut buffer, |_| shift);
        (shift, predicted(&moved))
    });
    let per = mm(less.0 - more.0);
    let change = |(more, less): (&Observation, &Observation)| mm(more.predicted - less.predicted) / per;
    if per > 0.0 { more.1.iter().zip(&less.1).map(change).collect() } else { vec![0.0; cut.observations.len()] }
}
