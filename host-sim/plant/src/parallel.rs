//! The raw surface as a parallel curve of the nominal centre path, at `r − h` towards the wall.
//!
//! On an inside corner or a tight concave arc the curve is longer than the path and gets points of its own; at an outside corner
//! it is cut where its two legs cross. The allowance may vary along the path.

use super::allowance::Allowance;
use super::machine::Machine;
use super::path::{Path, Side};
use super::setup::Cut;
use super::vector::{Point, along, cross, distance, dot, mix, sub, turn, turned};

/// A turn of more than this between two samples is a corner of the path.
const CORNER_RAD: f64 = 0.25;
/// Turn between points of the surface where it is longer than the path.
const FAN_RAD: f64 = 0.01;
/// How far from its ends a curve is looked for crossing itself there, mm.
const ENDS_MM: f64 = 60.0;
/// A curve whose end comes this near to its start runs on into it, mm.
const JOINED_MM: f64 = 0.02;

/// The parallel curve on which the raw surface lies.
pub(super) fn parallel_curve(path: &Path, cut: &Cut, machine: &Machine) -> Vec<Point> {
    let allowance = Allowance::new(path, cut, machine);
    let offset = |i: usize| cut.radius_mm - allowance.at(path.s_mm[i]);
    let mut curve: Vec<Point> = Vec::with_capacity(path.len());
    let count = if path.closed { path.len() - 1 } else { path.len() };
    for i in 0..count {
        let here = path.wall(i, offset(i));
        // At the seam of a closed path the last sample lies where the first does.
        let before = i.checked_sub(1).or(path.closed.then_some(count));
        if let Some(before) = before {
            let angle = turn(path.normal[before], path.normal[i]);
            // A turn away from the wall spreads the parallel curve, unless the curve lies beyond the centre path.
            let spreads = ((angle > 0.0) == (path.side == Side::Right)) == (offset(i) > 0.0);
            let corner = angle.abs() > CORNER_RAD;
            if spreads {
                let fan = (angle.abs() / FAN_RAD).ceil().max(1.0);
                for k in usize::from(!corner)..fan as usize {
                    let u = k as f64 / fan;
                    let centre = if corner { path.centre[i] } else { mix(path.centre[before], path.centre[i], u) };
                    curve.push(along(centre, turned(path.normal[before], angle * u), offset(i)));
                }
            } else if corner && i > 0 {
                let reach = (offset(i).abs() * (0.5 * angle.abs()).tan() * 2.0).max(1.0);
                return_to_crossing(&mut curve, path, i, reach, &offset);
            }
        }
        // After an outside corner the parallel curve runs backwards up to the crossing: such points are left out.
        let forwards = |&last: &Point| dot(sub(here, last), path.tangent[i]) > 0.0;
        if curve.last().is_none_or(forwards) {
            curve.push(here);
        }
    }
    curve
}

/// The curve closed where its end comes back to its start: cut at an outside corner where both run out beyond it, joined
/// where the end runs on into the start or over it. `None` where its ends do not meet so.
pub(super) fn closed_at_its_ends(curve: &[Point], side: Side) -> Option<Vec<Point>> {
    let last = curve.len().checked_sub(1)?;
    let (head, tail) = (pieces_within(curve.iter()), pieces_within(curve.iter().rev()));
    for end in (last - tail + 1..=last).rev() {
        for start in (1..=head).take_while(|start| start + 1 < end) {
            let (out, on) = ([curve[end - 1], curve[end]], [curve[start - 1], curve[start]]);
            let towards_wall = turn(sub(out[1], out[0]), sub(on[1], on[0])) * side.sign();
            if towards_wall > CORNER_RAD
                && let Some(p) = crossing(out[0], out[1], on[0], on[1])
            {
                return Some(std::iter::once(p).chain(curve[start..end].iter().copied()).collect());
            }
        }
    }
    let runs_on = |start: &usize| {
        let (out, on) = (sub(curve[last], curve[last - 1]), sub(curve[*start], curve[start - 1]));
        let (off, square) = (sub(curve[last], curve[start - 1]), dot(on, on));
        let share = dot(off, on) / square;
        let beside = cross(off, on).abs() / square.sqrt();
        (0.0..=1.0).contains(&share) && beside < JOINED_MM && turn(out, on).abs() < CORNER_RAD
    };
    let start = (1..=head).take_while(|start| start + 1 < last).find(runs_on)?;
    Some(curve[start..].to_vec())
}

/// How many pieces of a curve end within [`ENDS_MM`] of its first point, along it.
fn pieces_within<'a>(points: impl Iterator<Item = &'a Point> + Clone) -> usize {
    let mut way = 0.0;
    let lengths = points.clone().zip(points.skip(1)).map(|(a, b)| distance(*a, *b));
    let ends = lengths.map(|length| {
        way += length;
        way
    });
    ends.take_while(|way| *way <= ENDS_MM).count()
}

/// Cuts the end of `curve` back to where the curve after the corner at `i` crosses it.
fn return_to_crossing(curve: &mut Vec<Point>, path: &Path, i: usize, reach: f64, offset: &dyn Fn(usize) -> f64) {
    let ahead: Vec<Point> = (i..path.len())
        .take_while(|&k| path.s_mm[k] - path.s_mm[i] <= reach)
        .map(|k| path.wall(k, offset(k)))
        .collect();
    let back = (reach / path.step_mm).ceil() as usize + 1;
    for end in (curve.len().saturating_sub(back).max(1)..curve.len()).rev() {
        let (a, b) = (curve[end - 1], curve[end]);
        for w in ahead.windows(2) {
            if let Some(p) = crossing(a, b, w[0], w[1]) {
                curve.truncate(end);
                curve.push(p);
                return;
            }
        }
    }
}

fn crossing(a: Point, b: Point, c: Point, d: Point) -> Option<Point> {
    let (u, v, w) = (sub(b, a), sub(d, c), sub(c, a));
    let det = cross(u, v);
    if det.abs() < 1e-18 {
        return None;
    }
    let (x, y) = (cross(w, v) / det, cross(w, u) / det);
    ((0.0..=1.0).contains(&x) && (0.0..=1.0).contains(&y)).then(|| along(a, u, x))
}
