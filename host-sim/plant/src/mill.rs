//! The pass: the cutter goes along the commanded path, yields, and leaves a wall.
//!
//! Quasi-static march in steps of the path. At each step the loop `a = p + C·F(engagement at a)` is closed: the engaged arc comes
//! from the stock left by everything cut so far, at the place where the cutter really is, and the force is taken in the frame of
//! the nominal place of that actual centre. The mean force decides where the cutter is on average and what it removes; the wall
//! at a height is made by the force at the instant at which a tooth passes there (see [`super::flutes`]).
//!
//! Limits: no vibration; engagement does not vary with height; a tooth's instantaneous displacement does not change its chip.

use super::arcs::EngagedArcs;
use super::driven::driven;
use super::error::PlantError;
use super::flutes::{Flutes, NormalTangential};
use super::follow::Commanded;
use super::machine::{BendLaw, Machine, WallLaw};
use super::path::Path;
use super::setup::Cut;
use super::stock::{Frame, Stock};
use super::swept::Swept;
use super::vector::{Point, add, along, distance, dot, norm, scaled, sub};

/// The elastic loop is closed when the displacement repeats to this, mm.
const CLOSED_MM: f64 = 1e-9;
/// Bound on the steps of the elastic loop.
const LOOP_STEPS: usize = 120;
/// The cutter stays within this of the place where its surroundings were gathered, mm.
const SLACK_MM: f64 = 2.0;
/// Search window for the nominal place of the actual centre, mm of path.
const WINDOW_MM: f64 = 6.0;

/// State of the cut at one commanded sample.
#[derive(Debug, Clone, PartialEq)]
pub struct Sample {
    /// Nominal place of the actual centre along the contour, mm.
    pub s_mm: f64,
    /// Commanded centre, mm, as the drives have followed it.
    pub commanded: Point,
    /// Actual centre under the mean force, mm.
    pub actual: Point,
    /// Unit direction of travel at the nominal place of the actual centre.
    pub tangent: Point,
    /// Unit normal towards the wall there.
    pub normal: Point,
    /// Parts of the circumference in the stock.
    pub engaged: EngagedArcs,
    /// Mean force on the tool, x and y, N.
    pub force_n: Point,
    /// Edge force relative to a sharp cutter.
    pub edge_factor: f64,
    /// Index of the force table (feed) in use.
    flutes: usize,
}

impl Sample {
    /// φ₁, where the circumference leaves the stock, rad.
    pub fn leaving_rad(&self) -> f64 {
        self.engaged.leaving_rad()
    }

    /// A force in (n, t) components as x and y.
    fn in_xy(&self, force: NormalTangential) -> Point {
        add(scaled(self.normal, force[0]), scaled(self.tangent, force[1]))
    }
}

/// Circles that make the wall at one height: those of one tooth.
#[derive(Debug, Clone)]
pub struct Track {
    /// Radius of the tooth, mm.
    pub radius_mm: f64,
    /// Centre at the instant at which the tooth makes the wall, one a commanded sample, mm.
    pub centre: Vec<Point>,
}

/// A finished pass.
#[derive(Debug, Clone)]
pub struct Milled {
    /// The nominal path.
    pub path: Path,
    /// The set-up.
    pub cut: Cut,
    /// The machine.
    pub machine: Machine,
    /// One entry a commanded sample.
    pub samples: Vec<Sample>,
    /// Largest amount by which the elastic loop did not close, mm.
    pub residual_mm: f64,
    flutes: Vec<Flutes>,
}

/// Cuts along `commanded` (a polyline of the cutter's centre, any sampling, with or without leads), or along the nominal path.
///
/// # Errors
/// A value out of range, a bending law that needs the engagement of every height, or a command that does not follow the contour
/// within 3 mm to its end.
pub fn mill(path: &Path, cut: &Cut, machine: &Machine, commanded: Option<&[Point]>) -> Result<Milled, PlantError> {
    cut.check()?;
    machine.check(cut.teeth)?;
    if machine.bend_law != BendLaw::Alike {
        return Err(PlantError::BendLaw);
    }
    let mut commanded = match commanded {
        Some(polyline) => Commanded::following(path, polyline)?,
        None => Commanded::nominal(path),
    };
    let told = commanded.centre.iter().zip(&commanded.nominal).map(|(p, k)| (*p, *k, cut.feed_at(path.s_mm[*k])));
    commanded.centre = driven(&told.collect::<Vec<_>>(), path, machine);
    let mut feeds: Vec<f64> = Vec::new();
    let mut feed_index = |s: f64| {
        let feed = cut.feed_at(s);
        feeds.iter().position(|&f| f == feed).unwrap_or_else(|| {
            feeds.push(feed);
            feeds.len() - 1
        })
    };
    let which: Vec<usize> = commanded.nominal.iter().map(|&k| feed_index(path.s_mm[k])).collect();
    let climb = cut.is_climb(path);
    let flutes: Vec<Flutes> = feeds.iter().map(|&feed| Flutes::new(cut, machine, climb, feed)).collect();

    let mut pass = Pass {
        path,
        machine,
        radius: cut.radius_mm,
        stock: Stock::new(path, cut, machine),
        swept: Swept::new(cut.radius_mm, cut.memory_mm),
        pieces: Vec::new(),
        earlier: Vec::new(),
    };
    let mut samples: Vec<Sample> = Vec::with_capacity(commanded.centre.len());
    let (mut displacement, mut travelled, mut residual_mm) = ([0.0; 2], 0.0, 0.0f64);
    for (i, &p) in commanded.centre.iter().enumerate() {
        if i > 0 {
            travelled += distance(p, commanded.centre[i - 1]);
        }
        let edge_factor = 1.0 + machine.edge_wear_per_m * travelled * 1e-3;
        let step = Step { commanded: p, near: commanded.nominal[i], travelled, edge_factor, flutes: which[i] };
        let (sample, open) = pass.settle(&step, &flutes[which[i]], displacement);
        residual_mm = residual_mm.max(open);
        displacement = sub(sample.actual, p);
        pass.swept.push(sample.actual, travelled);
        samples.push(sample);
    }
    Ok(Milled { path: path.clone(), cut: cut.clone(), machine: machine.clone(), samples, residual_mm, flutes })
}

/// What stays the same within one step.
struct Step {
    commanded: Point,
    near: usize,
    travelled: f64,
    edge_factor: f64,
    flutes: usize,
}

/// The pass under way.
struct Pass<'a> {
    path: &'a Path,
    machine: &'a Machine,
    radius: f64,
    stock: Stock,
    swept: Swept,
    pieces: Vec<u32>,
    earlier: Vec<u32>,
}

impl Pass<'_> {
    /// Closes the elastic loop from the displacement `start`; returns the sample and by how much the loop stayed open.
    ///
    /// Secant steps (Anderson acceleration of depth one) first, because the loop is nearly linear; plain damped steps after
    /// that, for the places where the engagement has a kink.
    fn settle(&mut self, step: &Step, flutes: &Flutes, start: Point) -> (Sample, f64) {
        let around = add(step.commanded, start);
        self.stock.near(around, self.radius, SLACK_MM, &mut self.pieces);
        self.swept.near(around, SLACK_MM, step.travelled, &mut self.earlier);
        let mut d = start;
        let mut before: Option<(Point, Point)> = None;
        let mut best: Option<(Sample, f64)> = None;
        for turn in 0..LOOP_STEPS {
            let sample = self.sample(step, flutes, d);
            let answer = self.machine.deflection(sample.force_n, sample.s_mm, sample.normal);
            let open = sub(answer, d);
            let size = norm(open);
            if best.as_ref().is_none_or(|b| size < b.1) {
                best = Some((sample, size));
            }
            if size < CLOSED_MM {
                break;
            }
            let damping = [0.7, 0.4, 0.15, 0.05][(turn / 30).min(3)];
            let mut next = along(d, open, damping);
            if let (Some((d0, open0)), true) = (before, turn < 15) {
                let change = sub(open, open0);
                let gamma = dot(open, change) / dot(change, change).max(1e-30);
                if gamma.abs() < 3.0 {
                    let back = add(sub(d, d0), change);
                    next = along(answer, back, -gamma);
                }
            }
            before = Some((d, open));
            d = next;
        }
        best.unwrap_or_else(|| (self.sample(step, flutes, start), f64::INFINITY))
    }

    /// Engagement and mean force with the cutter displaced by `d`.
    fn sample(&self, step: &Step, flutes: &Flutes, d: Point) -> Sample {
        let actual = add(step.commanded, d);
        let place = self.path.place(actual, step.near, WINDOW_MM);
        let frame = Frame { centre: actual, tangent: place.tangent, normal: place.normal, radius: self.radius };
        let mut engaged = self.stock.engaged(&frame, &self.pieces);
        self.swept.remove_from(&mut engaged, &frame, step.travelled, &self.earlier);
        let mut sample = Sample {
            s_mm: place.s_mm,
            commanded: step.commanded,
            actual,
            tangent: place.tangent,
            normal: place.normal,
            engaged,
            force_n: [0.0; 2],
            edge_factor: step.edge_factor,
            flutes: step.flutes,
        };
        sample.force_n = sample.in_xy(flutes.mean(&sample.engaged, step.edge_factor));
        sample
    }
}

impl Milled {
    /// Circles that make the wall at the height `level` (0 tip … 1 top of the engaged depth), one track a distinct tooth.
    pub fn tracks(&self, level: f64) -> Vec<Track> {
        let machine = &self.machine;
        match machine.law {
            WallLaw::Mean => vec![Track {
                radius_mm: machine.longest_radius(self.cut.radius_mm),
                centre: self.displaced(level, |s, f| f.mean(&s.engaged, s.edge_factor)),
            }],
            WallLaw::Helical => {
                let height = level * self.cut.axial_depth_mm;
                let teeth = self.flutes.first().map_or(0, Flutes::distinct_teeth);
                (0..teeth)
                    .map(|tooth| Track {
                        radius_mm: machine.tooth_radius(self.cut.radius_mm, tooth),
                        centre: self.displaced(level, |s, f| f.at_wall(tooth, height, &s.engaged, s.edge_factor)),
                    })
                    .collect()
            }
        }
    }

    /// Actual centres at the height `level` at the instant at which the first tooth makes the wall there, mm.
    pub fn centres(&self, level: f64) -> Vec<Point> {
        self.tracks(level).into_iter().next().map_or_else(Vec::new, |t| t.centre)
    }

    fn displaced(&self, level: f64, force: impl Fn(&Sample, &Flutes) -> NormalTangential) -> Vec<Point> {
        let reach = self.machine.reach(level);
        self.samples
            .iter()
            .map(|s| {
                let f = s.in_xy(force(s, &self.flutes[s.flutes]));
                along(s.commanded, self.machine.deflection(f, s.s_mm, s.normal), reach)
            })
            .collect()
    }
}
