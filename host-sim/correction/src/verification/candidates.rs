//! Places of the contour that may be touched, and why the others may not.
//!
//! A place is kept off when its wall is not final (the rest of the path cuts it away, as at outside
//! corners), near the ends of the contour and on its leads (plunge and lift leave marks there), near a sharp inside corner, and
//! where the ball's way is not proved free.
//!
//! Where engagement or deflection changes abruptly, a shift of a tenth of a millimetre along the wall would look like an error of the
//! machine. In a tight corner the load is nowhere steady, though, and only there is it high. So such a place is taken to be less certain,
//! by what the wall changes within that tenth, and kept off only beside a steady one of the same load
//! ([`without_ramps`](super::sensitivity::without_ramps)).

use std::collections::HashMap;
use std::ops::RangeInclusive;

use truepath_core::cut::{Path, Sample, State};
use truepath_core::geometry::{Point, Shape};
use truepath_core::units::{Offset, Real};
use truepath_ground::units::{float, mm};
use truepath_job::pass::Pass;

use super::approach::{Ball, Xy, along, distance};
use super::estimate::Estimate;
use super::leads::milled_once;
use crate::force_tables::force_table;

/// Why a place is not touched.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum KeptOff {
    /// Near an end of the contour, on a lead, or milled twice.
    End,
    /// No final wall there.
    NoWall,
    /// Near a sharp inside corner.
    SharpCorner,
    /// Engagement or deflection changes abruptly, on the way to or from a steady place of the same load.
    Unsteady,
    /// The way of the ball is not proved free.
    Unproved,
}

impl KeptOff {
    /// In words.
    pub const fn words(self) -> &'static str {
        match self {
            Self::End => "near an end of the contour or on its leads, where the cutter plunges, lifts or passes twice",
            Self::NoWall => "without a final wall: the rest of the path cuts it away",
            Self::SharpCorner => "near a sharp inside corner",
            Self::Unsteady => "where the engagement changes abruptly, beside a steady place of the same load",
            Self::Unproved => "where the way of the ball is not proved free",
        }
    }
}

/// The form of the path at a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Form {
    Straight,
    /// Radius of the wall, mm.
    InsideArc(f64),
    /// Radius of the wall, mm.
    OutsideArc(f64),
}

/// A place that may be touched.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Site {
    pub(super) s: Offset,
    pub(super) wall: Xy,
    /// Towards the wall.
    pub(super) normal: Xy,
    pub(super) form: Form,
    pub(super) line: u32,
    /// What a touch a tenth of a millimetre beside the place would read otherwise, where the load is not steady.
    pub(super) unsteady: Offset,
}

/// Distance between places looked at: a fraction of the contour, at least the second number, mm.
const SPACING: (f64, f64) = (1.0 / 240.0, 0.5);
/// How far along the wall a touch may lie from where it is meant to, mm.
const ALONG: Offset = Offset::from_um(500);
/// How far along the wall a touch is taken to lie from where it is meant to, where the load is not steady, mm.
const BESIDE: f64 = 0.1;
/// Change of the engaged angle over twice [`ALONG`] from which it is abrupt, degrees.
const ABRUPT_DEG: f64 = 2.5;
/// Change of the deflection along the normal over twice [`ALONG`] from which it is abrupt, share of the largest one.
const ABRUPT_SHARE: f64 = 0.04;
/// How much nearer than its radius the cutter must come to a wall for it to count as cut away, mm; above what rounded
/// coordinates and facets make.
const CUT_AWAY: f64 = 0.02;

/// Sorts the places of a pass, for a noise of the readings, mm.
pub(super) fn candidates(
    pass: &Pass,
    path: &Path,
    estimate: &Estimate,
    ball: Ball,
    noise: f64,
) -> (Vec<Site>, Vec<KeptOff>) {
    let samples = &path.samples()[path.first()..path.first() + path.count()];
    let radius = mm(path.setup().radius);
    let walls: Vec<Option<Xy>> = final_walls(path, samples, radius);
    let standing: Vec<Xy> = walls.iter().copied().flatten().collect();
    let states = states(path, estimate);
    let start = path.working().start;
    let state = |sample: usize| states.get(sample.saturating_sub(start)).copied().unwrap_or(State::REST);
    let deflection = |sample: usize| {
        let state = state(sample);
        mm(state.displacement.along(path.samples()[sample].normal))
    };
    let largest = (0..samples.len()).map(|k| deflection(path.first() + k).abs()).fold(0.0, f64::max);
    let abrupt = (ABRUPT_SHARE * largest).max(4.0 * noise);
    let from_ends = radius + ball.radius;
    let (once_from, once_to) = milled_once(samples, Offset::from_nm(4 * path.setup().radius.nm()));
    let (first, last) = (mm(once_from) + from_ends, mm(once_to) - from_ends);

    sorted(pass, path, (&walls, first..=last), |index, normal, wall| {
        let sample = &path.samples()[index];
        let (before, after) = (path.index_at(sample.s - ALONG), path.index_at(sample.s + ALONG));
        let turn = float(state(after).engaged - state(before).engaged).abs().to_degrees();
        let change = (deflection(after) - deflection(before)).abs();
        let is_unsteady = turn > ABRUPT_DEG || change > abrupt;
        if !ball.is_free(wall, normal, &standing) {
            return Err(KeptOff::Unproved);
        }
        let beside = if is_unsteady { change * BESIDE / (2.0 * mm(ALONG)) } else { 0.0 };
        Ok((wall, Offset::from_nm((beside * 1e6).round() as i64)))
    })
}

/// Looks at places along a contour, within a stretch of its length (mm), and sorts them. `touched` says of a sample with its normal
/// and the wall beside it where it is touched and how far off for want of a steady load, or why it is not.
fn sorted(
    pass: &Pass,
    path: &Path,
    (walls, within): (&[Option<Xy>], RangeInclusive<f64>),
    touched: impl Fn(usize, Xy, Xy) -> Result<(Xy, Offset), KeptOff>,
) -> (Vec<Site>, Vec<KeptOff>) {
    let (length, radius) = (mm(path.length()), mm(path.setup().radius));
    let step = (length * SPACING.0).max(SPACING.1);
    let count = (length / step).floor() as u32;
    let (mut sites, mut kept_off) = (Vec::new(), Vec::new());
    for k in 0..=count {
        let s = Offset::from_nm((f64::from(k) * step * 1e6) as i64);
        let index = path.index_at(s).clamp(path.first(), path.first() + path.count() - 1);
        let sample = &path.samples()[index];
        let normal = normal_of(sample);
        let place = match walls[index - path.first()] {
            _ if !within.contains(&mm(sample.s)) => Err(KeptOff::End),
            None => Err(KeptOff::NoWall),
            Some(_) if sample.near_corner => Err(KeptOff::SharpCorner),
            Some(wall) => touched(index, normal, wall),
        };
        match place {
            Err(reason) => kept_off.push(reason),
            Ok((wall, unsteady)) => {
                let block = &pass.blocks[sample.block as usize];
                let form = form(pass, block, radius);
                sites.push(Site { s: sample.s, wall, normal, form, line: block.line, unsteady });
            }
        }
    }
    (sites, kept_off)
}

/// Where the stock is expected, mm before the nominal wall.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct StockWall {
    /// As the job says.
    pub(super) expected: f64,
    /// At most: the ball's way is free of it.
    pub(super) largest: f64,
}

/// How much nearer than the ball to an end of the contour its stock is not touched, mm: the cutter has not been there, but the
/// stock may end.
const FROM_ENDS: f64 = 1.0;

/// Sorts the places where the stock before a pass may be touched, the ball's clearance counted from the largest stock. The load
/// does not matter: nothing has been cut.
pub(super) fn before_the_pass(pass: &Pass, path: &Path, ball: Ball, stock: StockWall) -> (Vec<Site>, Vec<KeptOff>) {
    let samples = &path.samples()[path.first()..path.first() + path.count()];
    let radius = mm(path.setup().radius);
    let walls = final_walls(path, samples, radius);
    let both = walls.iter().zip(samples).filter_map(|(wall, sample)| wall.map(|wall| (wall, normal_of(sample))));
    let standing: Vec<Xy> = both.map(|(wall, normal)| along(wall, normal, -stock.largest)).collect();
    let (once_from, once_to) = milled_once(samples, Offset::from_nm(4 * path.setup().radius.nm()));
    let (first, last) = (mm(once_from) + ball.radius + FROM_ENDS, mm(once_to) - ball.radius - FROM_ENDS);
    sorted(pass, path, (&walls, first..=last), |_, normal, wall| {
        let free = ball.is_free(along(wall, normal, -stock.largest), normal, &standing);
        if free { Ok((along(wall, normal, -stock.expected), Offset::ZERO)) } else { Err(KeptOff::Unproved) }
    })
}

/// The states of the elastic loop along the path, at the estimate of machine and material.
fn states(path: &Path, estimate: &Estimate) -> Vec<State> {
    let parameters = estimate.parameters();
    let table = force_table(&parameters);
    let machine = parameters.machine(path, &table);
    let working = path.working();
    let mut states = vec![State::REST; working.len()];
    machine.run(working.start, &mut states, |i| estimate.commanded(path, i));
    states
}

/// The wall beside each sample, where no other part of the path cuts it away.
fn final_walls(path: &Path, samples: &[Sample], radius: f64) -> Vec<Option<Xy>> {
    let cell = |p: Xy| ((p[0] / radius).floor() as i64, (p[1] / radius).floor() as i64);
    let mut cells: HashMap<(i64, i64), Vec<Xy>> = HashMap::new();
    for sample in samples {
        let p = coordinates(sample.point);
        cells.entry(cell(p)).or_default().push(p);
    }
    let cut_away = |wall: Xy| {
        let (x, y) = cell(wall);
        let around = (-1..=1).flat_map(|i| (-1..=1).map(move |j| (x + i, y + j)));
        around.filter_map(|c| cells.get(&c)).flatten().any(|p| distance(*p, wall) < radius - CUT_AWAY)
    };
    let wall = |sample: &Sample| {
        let wall = along(coordinates(sample.point), normal_of(sample), radius);
        (sample.on_wall && !cut_away(wall)).then_some(wall)
    };
    debug_assert_eq!(samples.len(), path.count());
    samples.iter().map(wall).collect()
}

/// Whether another contour takes away the wall at a place.
pub(super) fn cut_away_by(other: &Pass, wall: Xy) -> bool {
    let mut nearest = f64::INFINITY;
    let at = Point::from_nm((wall[0] * 1e6).round() as i64, (wall[1] * 1e6).round() as i64);
    other.path_contour().feet(at, |foot| nearest = nearest.min(mm(foot.left.abs())));
    nearest < mm(other.core.setup.radius) - CUT_AWAY
}

fn form(pass: &Pass, block: &truepath_core::geometry::Block, radius: f64) -> Form {
    let Shape::Arc { sweep, .. } = block.curve.shape() else { return Form::Straight };
    let turns_left = sweep > Real::ZERO;
    let towards_wall = turns_left == (pass.core.setup.wall == truepath_core::geometry::Side::Left);
    let path_radius = block.curve.signed_radius().map_or(0.0, |r| mm(r.abs()));
    if towards_wall { Form::OutsideArc(path_radius - radius) } else { Form::InsideArc(path_radius + radius) }
}

/// Towards the wall.
fn normal_of(sample: &Sample) -> Xy {
    [float(sample.normal.x), float(sample.normal.y)]
}

fn coordinates(p: Point) -> Xy {
    [p.x.nm() as f64 / 1e6, p.y.nm() as f64 / 1e6]
}
