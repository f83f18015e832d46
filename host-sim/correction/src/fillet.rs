//! Small arcs on the sharp inside corners of a path, tangent to both its legs.
//!
//! At a sharp inside corner the load changes the moment the direction does, and the cutter cannot be on both sides of the
//! change: a correction in place leaves half of the error there, and material in the corner. An arc of a third of the cutter's
//! radius or more gives the correction a way to turn on. The price is material: the wall's corner becomes rounder than the
//! cutter, by [`Corner::left_mm`] where most is left, which the drawing has to allow.
//!
//! The centre of an arc lies as far from one leg as from the other; legs that are arcs themselves are followed by Newton's
//! method on both distances. Reckoned in floating point from the corner, so that nothing depends on where the part lies.

use truepath_core::geometry::{Block, Contour, Curve, FACET_TURN_LIMIT, Point, Shape, Side};
use truepath_core::units::{Offset, Real};
use truepath_ground::diagnostics::Failure;
use truepath_ground::hypotenuse::hypot;
use truepath_ground::units::{float, mm, nm};
use truepath_job::pass::Pass;
use truepath_program::{BlockEdit, Purpose, RewriteOptions, Rewritten, rewrite_program};

use crate::codes::P023;
use crate::edits::add;
use crate::first_pass::{Along, every_pass};
use crate::written_out::written_out;

/// An arc of a smaller radius is not worth writing, mm.
const LEAST_MM: f64 = 0.02;
/// How near the program follows its arcs, where the job does not want it nearer.
const FINE: Offset = Offset::from_nm(200);
/// Distance of points along the path, mm; on an arc they stand closer, this far from its chord.
const STEP_MM: f64 = 0.1;
const CHORD_MM: f64 = 2e-5;
/// Steps of Newton's method: two are exact between lines, five between arcs that are no smaller than the fillet.
const NEWTON: usize = 12;
/// Attempts at a radius for which the legs are long enough.
const ATTEMPTS: usize = 40;

/// A sharp inside corner.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Corner {
    /// Line of the program that begins there.
    pub line: u32,
    /// By how much the path turns, degrees.
    pub turn_deg: f64,
    /// Radius of the arc on the cutter's path, mm; 0 where the lines beside the corner are too short for any.
    pub radius_mm: f64,
    /// Material that stays in the corner of the wall where most does, mm.
    pub left_mm: f64,
}

/// The path with its arcs, line by line, and its corners, one for every pass over it, in the order of the program.
#[derive(Clone, Debug, Default)]
struct Filleted {
    edits: Vec<BlockEdit>,
    corners: Vec<Corner>,
}

/// The program with the arcs, its corners, and what has to be said about it: of every contour, in every pass over it, with `radius` on
/// the cutter's path or as much as the lines beside a corner have room for.
///
/// # Errors
/// `P023` where no arc has room, and what is wrong with program or pass.
pub fn rewritten(contours: &[&Pass], radius: Offset) -> Result<(Rewritten, Vec<Corner>, Vec<String>), Failure> {
    match written(contours, radius) {
        Ok((text, corners, said)) => Ok((text, corners, said.into_iter().collect())),
        Err(failure) => {
            let (flat, written_out) = written_out(contours, &failure).ok_or(failure)?;
            let flat: Vec<&Pass> = flat.iter().collect();
            let (text, corners, said) = written(&flat, radius)?;
            Ok((text, corners, said.into_iter().chain([written_out]).collect()))
        }
    }
}

fn written(contours: &[&Pass], radius: Offset) -> Result<(Rewritten, Vec<Corner>, Option<String>), Failure> {
    let pass = contours.first().ok_or_else(|| Failure::Internal("a program of no contour".to_owned()))?;
    let mut passes: Vec<Along> = Vec::new();
    for contour in contours {
        passes.extend(every_pass(contour)?);
    }
    // Several contours may be cut in turn, depth by depth.
    passes.sort_by_key(|(along, _)| along.job.numbers.part.map_or([0, 0], |part| [part.run, part.first_block]));
    let mut filleted = Filleted::default();
    for (along, _) in &passes {
        filleted.add(along, mm(radius));
    }
    let Filleted { edits, corners } = filleted;
    // Where a contour begins there is no room between its moves and those that lead to it.
    let at_start = passes.iter().find_map(|(along, _)| {
        let blocks = &along.blocks;
        let (first, last) = (blocks.first()?, blocks.last()?);
        let closed = Contour::new(blocks)?.is_closed();
        sharp(last, first, along.core.setup.wall).filter(|_| closed).map(|_| first.line)
    });
    let said = at_start.map(|line| {
        format!("the contour begins and ends in a sharp inside corner (line {line}), which stays sharp: begin it on a straight stretch")
    });
    if corners.iter().all(|corner| corner.radius_mm == 0.0) {
        let found = match corners.first() {
            None => "no sharp inside corner on the contour".to_owned(),
            Some(corner) => format!("the lines beside the corner of line {} are too short for an arc", corner.line),
        };
        let line = corners.first().map(|corner| corner.line).or_else(|| pass.blocks.first().map(|block| block.line));
        let expected = "a corner of more than 15 degrees on the side of the wall, between two moves of the contour";
        let error = P023.error(found, expected);
        return Err(match line {
            Some(line) => error.at(&pass.program, pass.program.line_span(line)),
            None => error,
        }
        .into());
    }
    let options = RewriteOptions {
        tolerance: pass.job.tolerance.min(FINE),
        max_arc_radius: pass.job.max_arc_radius,
        max_kink_deg: pass.job.max_kink_deg,
        program: pass.job.numbers.program_options(),
        purpose: Purpose::Fillets { radius },
        ..RewriteOptions::default()
    };
    Ok((rewrite_program(&pass.program, &edits, &options)?, corners, said))
}

impl Filleted {
    fn add(&mut self, pass: &Pass, radius: f64) {
        let blocks = &pass.blocks;
        let corners: Vec<Option<(Arc, f64)>> =
            blocks.iter().zip(blocks.iter().skip(1)).map(|(a, b)| sharp(a, b, pass.core.setup.wall)).collect();
        // A line between two corners is shared by their arcs.
        let room = |block: usize, other: Option<&Option<(Arc, f64)>>| {
            let whole = length_mm(&blocks[block].curve);
            if other.is_some_and(Option::is_some) { whole / 2.0 } else { whole }
        };
        let mut arcs: Vec<Option<Arc>> = Vec::new();
        for (at, corner) in corners.iter().enumerate() {
            let arc = corner.as_ref().and_then(|(corner, turn)| {
                let before = room(at, at.checked_sub(1).and_then(|before| corners.get(before)));
                let behind = room(at + 1, corners.get(at + 1));
                let arc = corner.fitted(radius, [before, behind]);
                self.corners.push(Corner {
                    line: blocks[at + 1].line,
                    turn_deg: turn.to_degrees(),
                    radius_mm: arc.map_or(0.0, |arc| arc.radius),
                    left_mm: arc.map_or(0.0, |arc| arc.left()),
                });
                arc
            });
            arcs.push(arc);
        }
        for (at, block) in blocks.iter().enumerate() {
            let begins = at.checked_sub(1).and_then(|before| arcs[before]);
            let ends = arcs.get(at).copied().flatten();
            let [from, to] = [begins.map_or(0.0, |arc| arc.trims[1]), ends.map_or(0.0, |arc| arc.trims[0])];
            let mut points = Vec::new();
            points.extend(begins.iter().flat_map(|arc| arc.half(1)));
            points.extend(inner(&block.curve, from, to));
            points.extend(ends.iter().flat_map(|arc| arc.half(0)));
            points.dedup();
            add(&mut self.edits, block.line, points, Vec::new());
        }
    }
}

fn length_mm(curve: &Curve) -> f64 {
    mm(curve.length())
}

/// The points of a curve without `from` at its start and `to` at its end, mm.
fn inner(curve: &Curve, from: f64, to: f64) -> Vec<[i64; 2]> {
    let length = length_mm(curve);
    let step = match curve.signed_radius() {
        Some(radius) => fine(mm(radius.abs())),
        None => STEP_MM,
    };
    let pieces = ((length - from - to).max(0.0) / step).ceil().max(1.0) as i64;
    let point = |k: i64| {
        let fraction = match k {
            0 if from == 0.0 => Real::ZERO,
            _ if k == pieces && to == 0.0 => Real::ONE,
            _ => nm(from + (length - from - to) * k as f64 / pieces as f64).over(curve.length()),
        };
        let Point { x, y } = curve.point(fraction.max(Real::ZERO).min(Real::ONE));
        [x.nm(), y.nm()]
    };
    (0..=pieces).map(point).collect()
}

/// Distance of points on an arc, mm.
fn fine(radius: f64) -> f64 {
    (8.0 * radius * CHORD_MM).sqrt().min(STEP_MM)
}

type Place = [f64; 2];

fn dot(a: Place, b: Place) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

fn cross(a: Place, b: Place) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

/// One leg of a corner, from the corner: a straight line or a circle.
#[derive(Clone, Copy, Debug)]
struct Leg {
    /// Heading of the path in the corner.
    heading: Place,
    /// Signed radius and centre; positive to the left.
    circle: Option<(f64, Place)>,
}

impl Leg {
    fn of(curve: &Curve, at: Point, heading: Place) -> Self {
        let circle = curve.signed_radius().and_then(|radius| match curve.shape() {
            Shape::Arc { centre, .. } => {
                let from = [centre.x - at.x, centre.y - at.y].map(|v| v.nm() as f64 / 1e6);
                Some((mm(radius), from))
            }
            Shape::Line => None,
        });
        Self { heading, circle }
    }

    /// How far a place lies to the left, the direction to the left at its foot, and the way along the path from the corner to that
    /// foot, positive with the travel.
    fn foot(&self, place: Place) -> (f64, Place, f64) {
        let left = [-self.heading[1], self.heading[0]];
        let Some((radius, centre)) = self.circle else {
            return (dot(left, place), left, dot(self.heading, place));
        };
        let from = [place[0] - centre[0], place[1] - centre[1]];
        let distance = hypot(from[0], from[1]);
        let outwards = from.map(|v| v / distance);
        let corner = centre.map(|v| -v / radius.abs());
        // Turning to the left, the path goes round its centre with the angle.
        let angle = cross(corner, outwards).atan2(dot(corner, outwards));
        if radius > 0.0 {
            (radius - distance, outwards.map(|v| -v), angle * radius)
        } else {
            (distance + radius, outwards, angle * radius)
        }
    }
}

/// An arc in a corner, or the corner alone while its radius is 0.
#[derive(Clone, Copy, Debug)]
struct Arc {
    at: Point,
    legs: [Leg; 2],
    /// 1 for a path that turns to the left.
    sense: f64,
    radius: f64,
    /// Centre, from the corner.
    centre: Place,
    /// How much of either leg it takes, mm.
    trims: [f64; 2],
}

/// The sharp inside corner between two blocks, and by how much it turns.
fn sharp(before: &Block, behind: &Block, wall: Side) -> Option<(Arc, f64)> {
    let (from, to) = (before.curve.end_heading(), behind.curve.start_heading());
    // Turning away from the wall is an inside corner of the part.
    let inside = |turns_left: bool| turns_left == (wall == Side::Right);
    let turn = from.cross(to);
    if from.dot(to) >= FACET_TURN_LIMIT || !inside(turn > Real::ZERO) {
        return None;
    }
    let at = behind.curve.start();
    let headings = [from, to].map(|heading| [float(heading.x), float(heading.y)]);
    let legs = [Leg::of(&before.curve, at, headings[0]), Leg::of(&behind.curve, at, headings[1])];
    let sense = if turn > Real::ZERO { 1.0 } else { -1.0 };
    let angle = cross(headings[0], headings[1]).atan2(dot(headings[0], headings[1]));
    Some((Arc { at, legs, sense, radius: 0.0, centre: [0.0; 2], trims: [0.0; 2] }, angle.abs()))
}

impl Arc {
    /// With the radius, or the largest one for which the legs are as long as it takes.
    fn fitted(&self, radius: f64, room: [f64; 2]) -> Option<Self> {
        let mut radius = radius;
        for _ in 0..ATTEMPTS {
            if radius < LEAST_MM {
                return None;
            }
            let arc = self.of_radius(radius);
            let share = arc.map_or(0.5, |arc| {
                let one = |leg: usize| if arc.trims[leg] > room[leg] { room[leg] / arc.trims[leg] } else { 1.0 };
                one(0).min(one(1))
            });
            if share >= 1.0 {
                return arc;
            }
            radius *= share.clamp(0.1, 0.95);
        }
        None
    }

    fn of_radius(&self, radius: f64) -> Option<Self> {
        let mut centre = [0.0; 2];
        for _ in 0..NEWTON {
            let feet = self.legs.map(|leg| leg.foot(centre));
            let [(d0, g0, _), (d1, g1, _)] = feet;
            let lacks = [self.sense * radius - d0, self.sense * radius - d1];
            let determinant = cross(g0, g1);
            if determinant.abs() < 1e-6 {
                return None;
            }
            centre[0] += (lacks[0] * g1[1] - lacks[1] * g0[1]) / determinant;
            centre[1] += (lacks[1] * g0[0] - lacks[0] * g1[0]) / determinant;
        }
        let feet = self.legs.map(|leg| leg.foot(centre));
        let misses = feet.iter().map(|(d, ..)| (d - self.sense * radius).abs()).fold(0.0, f64::max);
        let trims = [-feet[0].2, feet[1].2];
        let settles = misses < 1e-6 && trims.iter().all(|trim| *trim > 0.0);
        settles.then_some(Self { radius, centre, trims, ..*self })
    }

    /// Where it touches a leg, from its centre.
    fn spoke(&self, leg: usize) -> Place {
        self.legs[leg].foot(self.centre).1.map(|v| -v * self.sense * self.radius)
    }

    /// How far its middle stays away from the corner.
    fn left(&self) -> f64 {
        hypot(self.centre[0], self.centre[1]) - self.radius
    }

    /// The points of the half beside a leg, in the direction of travel; both end in its middle.
    fn half(&self, leg: usize) -> Vec<[i64; 2]> {
        let spokes = [self.spoke(0), self.spoke(1)];
        let angle = cross(spokes[0], spokes[1]).atan2(dot(spokes[0], spokes[1]));
        let pieces = (angle.abs() / 2.0 * self.radius / fine(self.radius)).ceil().max(2.0) as i64;
        let point = |k: i64| {
            let turn = angle / 2.0 * (k as f64 / pieces as f64 + leg as f64);
            let (sine, cosine) = turn.sin_cos();
            let [x, y] = spokes[0];
            let place = [x * cosine - y * sine, x * sine + y * cosine];
            [self.at.x.nm(), self.at.y.nm()]
                .into_iter()
                .zip([0, 1])
                .map(|(at, axis)| at + ((self.centre[axis] + place[axis]) * 1e6).round() as i64)
                .collect::<Vec<i64>>()
        };
        (0..=pieces).map(point).map(|p| [p[0], p[1]]).collect()
    }
}
