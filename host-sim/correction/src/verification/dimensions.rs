//! The choice of dimensions to be taken by hand: the few that tell most of the wall that will be corrected.
//!
//! Candidates are the pairs of walls that face each other along X or Y, on lines spread over the contour, at three heights.
//! The criterion is that of the places of a probe ([`choice`](super::choice)): one after the other, each the one that most
//! lowers the variance of the wall error, summed over the wall and its heights. A hand sets a jaw to half a millimetre: where the
//! wall changes within that, a reading says less.

use truepath_core::cut::Path;
use truepath_core::identify::Observation;
use truepath_core::units::{Offset, Position, Real, hypot_nm};
use truepath_ground::diagnostics::Failure;
use truepath_ground::units::{mm, nm};
use truepath_job::dimension::{Axis, Crossing, Instrument, Kind, Walls};
use truepath_job::pass::{Pass, PathBuffer};

use super::covariance::{Covariance, Row, products};
use super::estimate::Estimate;
use super::plan::name;
use super::reason::{self, Unknown};
use super::sensitivity::{real, rows, wall_row};
use crate::codes::V007;

/// Dimensions, where the user does not say how many.
pub const USUAL_DIMENSIONS: u32 = 8;
/// Lines across each axis that are looked at.
const LINES: usize = 24;
/// Heights of a line, as shares of the engaged depth: the lowest first.
const HEIGHTS: [f64; 3] = [0.15, 0.5, 0.85];
/// Half of the stretch of a wall that a jaw lies against, mm.
const JAW: f64 = 1.5;
/// How far from its line a hand measures, mm.
const BY_HAND: f64 = 0.5;
/// Places of the wall that are to become certain.
const PLACES: usize = 60;

/// A dimension to be taken.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct PlannedDimension {
    /// The contour it is of, where there are several.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub contour: Option<String>,
    /// What is measured.
    pub kind: &'static str,
    /// Along which axis.
    pub along: &'static str,
    /// Coordinate of the line across it, mm.
    pub across_mm: f64,
    /// Z of the jaws, program coordinates, mm.
    pub z_mm: f64,
    /// Coordinates of both walls along the axis, mm.
    pub walls_mm: [f64; 2],
    /// What the program would leave, mm.
    pub nominal_mm: f64,
    /// What it tells.
    pub why: String,
}

impl PlannedDimension {
    /// What to measure, in words.
    pub fn words(&self) -> String {
        let Self { kind, along, across_mm, .. } = self;
        let across = if *along == "x" { "Y" } else { "X" };
        format!("{kind} along {} at {across}{across_mm:.2}", along.to_uppercase())
    }
}

/// A plan of dimensions.
#[derive(Clone, Debug, serde::Serialize)]
pub struct DimensionPlan {
    /// The most telling first.
    pub dimensions: Vec<PlannedDimension>,
    /// What they are taken with.
    pub instrument: &'static str,
    /// What a reading stays within, ± at two standard deviations, mm.
    pub uncertainty_mm: f64,
    /// Standard deviation of the predicted wall, root mean square, mm, before the dimensions and after them.
    pub wall_sigma_mm: [f64; 2],
    /// What they leave of every unknown.
    pub unknowns: Vec<Unknown>,
    /// Outlines of the finished walls, mm.
    #[serde(skip)]
    pub outlines: Vec<Vec<[f64; 2]>>,
}

/// What may be measured.
struct Candidate {
    planned: PlannedDimension,
    row: Row,
}

/// Plans dimensions of the contours of one part, taken with an instrument. `progress` is told the share done, 0…1.
///
/// # Errors
/// `V007` where no two walls face each other along X or Y, and whatever is wrong with a path.
pub fn plan_dimensions(
    passes: &[Pass],
    (count, instrument, uncertainty): (u32, Instrument, Offset),
    progress: &mut dyn FnMut(f64),
) -> Result<DimensionPlan, Failure> {
    let (mut candidates, mut wall, mut outlines) = (Vec::new(), Vec::new(), Vec::new());
    for (at, pass) in passes.iter().enumerate() {
        let told = &mut |share: f64| progress((at as f64 + share) / passes.len().max(1) as f64);
        let walls = Walls::of(pass)?;
        let (own, certain) = of_pass(&walls, passes.len() > 1, uncertainty, told)?;
        candidates.extend(own);
        wall.extend(certain);
        outlines.push(walls.outline().collect());
    }
    let Some(pass) = passes.first().filter(|_| !candidates.is_empty()) else {
        let found = "no two walls of this cut face each other square to X or Y";
        return Err(V007.error(found, "two walls that an instrument fits between, or around").into());
    };
    let prior = pass.core.prior(pass.core.setup.law);
    let total = products(wall.iter());
    let sigma = |known: &Covariance| (known.total(&total).max(0.0) / wall.len().max(1) as f64).sqrt();
    let mut known = Covariance::prior();
    let before = sigma(&known);
    let mut dimensions: Vec<PlannedDimension> = Vec::new();
    while dimensions.len() < count as usize && !candidates.is_empty() {
        let left = |candidate: &Candidate| known.after(&candidate.row).total(&total);
        let left: Vec<f64> = candidates.iter().map(left).collect();
        let Some(best) = (0..left.len()).min_by(|a, b| left[*a].total_cmp(&left[*b])) else { break };
        let Candidate { planned, row } = candidates.swap_remove(best);
        let after = known.after(&row);
        let why = reason::tells([&known, &after], &prior);
        dimensions.push(PlannedDimension { why, ..planned });
        known = after;
    }
    progress(1.0);
    Ok(DimensionPlan {
        dimensions,
        instrument: instrument.name(),
        uncertainty_mm: mm(uncertainty),
        wall_sigma_mm: [before, sigma(&known)],
        unknowns: reason::unknowns(&known, &prior),
        outlines,
    })
}

/// What may be measured of a pass, and the rows of its wall, which is to become certain.
fn of_pass(
    walls: &Walls<'_>,
    several: bool,
    uncertainty: Offset,
    progress: &mut dyn FnMut(f64),
) -> Result<(Vec<Candidate>, Vec<Row>), Failure> {
    let pass = walls.pass();
    let mut buffer = PathBuffer::default();
    let path = pass.sample(&mut buffer)?;
    let prior = pass.core.prior(path.setup().law);
    let estimate = Estimate::stated(&prior);
    let [tip, top] = walls.heights();
    let contour = several.then(|| name(pass));
    let mut planned = Vec::new();
    let mut touches = Vec::new();
    for along in [Axis::X, Axis::Y] {
        let Some([from, to]) = walls.extent(along.other()) else { continue };
        let middle = 0.5 * (from + to);
        let spread = (0..LINES).map(|line| from + (to - from) * (line as f64 + 0.5) / LINES as f64);
        // Coordinates that a hand can set; round walls are measured through their middle.
        for across in spread.map(|at| (2.0 * at).round() / 2.0).chain([middle]) {
            for share in HEIGHTS {
                let z = tip + nm(share * mm(top - tip));
                let pairs = |at: f64| pairs(walls, along, at, z);
                for pair in pairs(across) {
                    let same = |by: f64| pairs(across + by).into_iter().find(|other| other.is_alike(&pair));
                    // A jaw finds the apex of a round wall by itself.
                    let is_round = pair.kind() == Kind::Diameter;
                    if !is_round && (same(JAW).is_none() || same(-JAW).is_none()) {
                        continue;
                    }
                    let beside = [-BY_HAND, BY_HAND].map(|by| same(by).unwrap_or(pair));
                    let noise = Offset::from_nm(uncertainty.nm() / 4);
                    touches.extend([pair, beside[0], beside[1]].map(|pair| pair.observation(noise)));
                    planned.push(PlannedDimension {
                        contour: contour.clone(),
                        kind: pair.kind().name(),
                        along: along.of(["x", "y"]),
                        across_mm: across,
                        z_mm: (z - Position::ZERO).nm() as f64 / 1e6,
                        walls_mm: [pair.first.at_mm, pair.second.at_mm],
                        nominal_mm: pair.second.at_mm - pair.first.at_mm,
                        why: String::new(),
                    });
                }
            }
        }
    }
    let places = places(&path);
    let count = touches.len();
    touches.extend(places);
    let rows = rows(&path, &estimate, &mut touches, progress);
    let candidates = planned.into_iter().zip(rows.chunks(3).zip(touches.chunks(3)));
    let candidate = |(planned, (rows, touches)): (PlannedDimension, (&[Row], &[Observation]))| {
        let noise = touches[0].deviation();
        let set = hypot_nm(noise, (touches[2].error - touches[1].error).scaled(Real::HALF));
        let scale = mm(noise) / mm(set);
        Candidate { planned, row: rows[0].map(|sensitivity| sensitivity * scale) }
    };
    let certain = rows[count..].iter().zip(&touches[count..]).map(|(row, touch)| wall_row(row, mm(touch.deviation())));
    Ok((candidates.map(candidate).collect(), certain.collect()))
}

/// Two walls that face each other, or away from each other, at a height.
#[derive(Clone, Copy)]
struct Pair {
    first: Crossing,
    second: Crossing,
}

impl Pair {
    fn kind(&self) -> Kind {
        match (self.first.is_round && self.second.is_round, self.first.towards < 0.0) {
            (true, _) => Kind::Diameter,
            (false, true) => Kind::Width,
            (false, false) => Kind::Thickness,
        }
    }

    /// Whether a jaw that lies against one lies against the other.
    fn is_alike(&self, other: &Self) -> bool {
        let off = [self.first.at_mm - other.first.at_mm, self.second.at_mm - other.second.at_mm];
        self.kind() == other.kind() && off.iter().all(|off| off.abs() < 0.002)
    }

    fn observation(&self, noise: Offset) -> Observation {
        let contact = &self.first.nominal;
        Observation::new(contact.s, contact.height, Offset::ZERO, noise, contact.normal)
            .with_across(self.second.nominal.s)
    }
}

/// Cosine of 1°: nearer to square than a reading has to be.
const SQUARE: f64 = 0.999_85;

/// The pairs of walls on a line.
fn pairs(walls: &Walls<'_>, along: Axis, across: f64, z: Position) -> Vec<Pair> {
    let crossings = walls.crossings(along, across, z).unwrap_or_default();
    let square = |c: &Crossing| c.towards.abs() > SQUARE;
    crossings
        .windows(2)
        .filter(|pair| pair[0].towards * pair[1].towards < 0.0 && pair.iter().all(square))
        .map(|pair| Pair { first: pair[0], second: pair[1] })
        .collect()
}

/// Readings of the wall itself, spread along it and over its height.
fn places(path: &Path) -> Vec<Observation> {
    let samples = &path.samples()[path.first()..path.first() + path.count()];
    let stride = samples.len().div_ceil(PLACES).max(1);
    let steady = samples.iter().step_by(stride).filter(|sample| sample.on_wall && !sample.near_corner);
    let at = |share: f64, sample: &truepath_core::cut::Sample| {
        Observation::new(sample.s, real(share), Offset::ZERO, Offset::from_um(1), sample.normal)
    };
    steady.flat_map(|sample| HEIGHTS.map(|share| at(share, sample))).collect()
}
