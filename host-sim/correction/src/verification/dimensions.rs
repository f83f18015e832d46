//! The choice of dimensions to be taken by hand: the few that tell most of the wall that will be corrected.
//!
//! Candidates are the pairs of walls that face each other along X or Y, on lines spread over every contour, at three heights: two
//! walls of one contour, or a wall of one and the next wall on the line, of another (a rib, a web, a ring), which is one reading of
//! both. An instrument has to reach them: nothing stands in the room of a width, and beside material is room for a jaw.
//! The criterion is that of the places of a probe ([`choice`](super::choice)): one after the other, each the one that most
//! lowers the variance of the wall error, summed over the wall and its heights. A hand sets a jaw to half a millimetre: where the
//! wall changes within that, a reading says less.

use std::collections::BTreeSet;

use truepath_core::cut::Path;
use truepath_core::identify::Observation;
use truepath_core::units::{Offset, Position};
use truepath_ground::diagnostics::Failure;
use truepath_ground::hypotenuse::hypot;
use truepath_ground::length::Unit;
use truepath_ground::units::{mm, nm, real};
use truepath_job::dimension::{Axis, Crossing, Instrument, Kind, Walls};
use truepath_job::pass::{Pass, PathBuffer};

use super::covariance::{Covariance, Row, products};
use super::estimate::Estimate;
use super::part_program::PartProgram;
use super::plan::name;
use super::reason::{self, Unknown};
use super::sensitivity::{rows, wall_row};
use crate::codes::V007;

/// Dimensions, where the user does not say how many.
pub const USUAL_DIMENSIONS: u32 = 8;
/// Lines across each axis that are looked at.
const LINES: usize = 24;
/// Heights of a line, as shares of the engaged depth: the lowest first.
const HEIGHTS: [f64; 3] = [0.15, 0.5, 0.85];
/// What the jaws of a usual calliper open to, mm.
const CALLIPER: f64 = 150.0;
/// Half of the stretch of a wall that a jaw lies against, mm.
const JAW: f64 = 1.5;
/// How far from its line a hand measures, mm.
const BY_HAND: f64 = 0.5;
/// Room that the outside jaw of a calliper, or the spindle of a micrometer for ribs, needs beside material, mm.
const JAW_ROOM: f64 = 4.0;
/// Places of the wall that are to become certain.
const PLACES: usize = 60;

/// A dimension to be taken.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct PlannedDimension {
    /// The contour it is of, where there are several.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub contour: Option<String>,
    /// That of its second wall, where it is another one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub to_contour: Option<String>,
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
    pub fn words(&self, unit: Unit) -> String {
        let Self { kind, along, across_mm, .. } = self;
        let across = if *along == "x" { "Y" } else { "X" };
        format!("{kind} along {} at {across}{:.2}", along.to_uppercase(), unit.of(*across_mm))
    }

    /// The contour it is of, or both that it is between; empty where there is one alone.
    pub fn of(&self) -> String {
        match (&self.contour, &self.to_contour) {
            (Some(contour), Some(other)) => format!("{contour} to {other}"),
            (Some(contour), None) => contour.clone(),
            _ => String::new(),
        }
    }
}

/// What dimensions are taken with, and how many.
#[derive(Clone, Copy, Debug)]
pub struct DimensionSettings {
    /// How many are chosen.
    pub count: u32,
    /// With what they are taken.
    pub instrument: Instrument,
    /// What a reading stays within, ± at two standard deviations.
    pub uncertainty: Offset,
    /// The largest that the instrument takes, mm; by default 150 of a calliper, and no limit of others.
    pub reach_mm: Option<f64>,
}

impl DimensionSettings {
    fn reach_mm(&self) -> f64 {
        let usual = if self.instrument == Instrument::Calliper { CALLIPER } else { f64::INFINITY };
        self.reach_mm.unwrap_or(usual)
    }
}

/// A plan of dimensions.
#[derive(Clone, Debug, serde::Serialize)]
pub struct DimensionPlan {
    /// The most telling first.
    pub dimensions: Vec<PlannedDimension>,
    /// The unit in which they are told of.
    #[serde(skip)]
    pub unit: Unit,
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
    settings: &DimensionSettings,
    progress: &mut dyn FnMut(f64),
) -> Result<DimensionPlan, Failure> {
    let walls = passes.iter().map(Walls::of).collect::<Result<Vec<_>, _>>()?;
    let DimensionSettings { count, instrument, uncertainty, .. } = *settings;
    let reach_mm = settings.reach_mm();
    let taken = |faced: &Faced| instrument.measures(faced.pair.kind()) && faced.pair.nominal_mm() <= reach_mm;
    let faced: Vec<Faced> = faced(&Part::of(&walls)).into_iter().filter(taken).collect();
    let Some(pass) = passes.first().filter(|_| !faced.is_empty()) else {
        let words = instrument.words();
        let unit = passes.first().map(Pass::unit).unwrap_or_default();
        let reach = || format!(" of {} {}", unit.of(reach_mm), unit.name());
        let reach = if reach_mm.is_finite() { reach() } else { String::new() };
        let found = format!("a {words}{reach} reaches no two walls of this cut that face each other square to X or Y");
        return Err(V007.error(found, "two walls that an instrument fits between, or around").into());
    };
    let mut said = Vec::new();
    let mut wall = Vec::new();
    for (at, pass) in passes.iter().enumerate() {
        let told = &mut |share: f64| progress((at as f64 + share) / passes.len() as f64);
        let (own, certain) = readings(pass, at, &faced, uncertainty, told)?;
        said.push(own.into_iter());
        wall.extend(certain);
    }
    let mut candidates: Vec<Candidate> = Vec::new();
    for faced in faced {
        let [first, second] = [faced.pair.first.wall, faced.pair.second.wall];
        let mut next = |wall: usize| said.get_mut(wall).and_then(Iterator::next);
        let own = next(first);
        let other = if first == second { own.clone() } else { next(second) };
        let (Some(own), Some(other)) = (own, other) else {
            return Err(Failure::Internal("a dimension that nothing was predicted of".to_owned()));
        };
        candidates.push(Candidate { row: own.mean(&other).row(), planned: faced.planned(passes) });
    }
    let prior = pass.core.prior(pass.core.setup.law);
    let total = products(wall.iter());
    let sigma = |known: &Covariance| (known.total(&total).max(0.0) / wall.len().max(1) as f64).sqrt();
    let mut known = Covariance::prior();
    let before = sigma(&known);
    let mut dimensions: Vec<PlannedDimension> = Vec::new();
    while dimensions.len() < count as usize && !candidates.is_empty() {
        let left = |candidate: &Candidate| known.after_all(&[candidate.row.into()]).total(&total);
        let left: Vec<f64> = candidates.iter().map(left).collect();
        let Some(best) = (0..left.len()).min_by(|a, b| left[*a].total_cmp(&left[*b])) else { break };
        let Candidate { planned, row } = candidates.swap_remove(best);
        let after = known.after_all(&[row.into()]);
        let why = reason::tells([&known, &after], [0.0; 2], &prior, pass.unit());
        dimensions.push(PlannedDimension { why, ..planned });
        known = after;
    }
    progress(1.0);
    Ok(DimensionPlan {
        dimensions,
        unit: pass.unit(),
        instrument: instrument.name(),
        uncertainty_mm: mm(uncertainty),
        wall_sigma_mm: [before, sigma(&known)],
        unknowns: reason::unknowns(&known, &prior),
        outlines: walls.iter().map(|walls| walls.outline().collect()).collect(),
    })
}

/// A wall on a line, and the contour that it is of.
#[derive(Clone, Copy)]
struct Seen {
    wall: usize,
    crossing: Crossing,
}

/// Two walls that face each other, or away from each other, at a height.
#[derive(Clone, Copy)]
struct Pair {
    first: Seen,
    second: Seen,
}

/// Cosine of 1°: nearer to square than a reading has to be.
const SQUARE: f64 = 0.999_85;
/// Walls nearer to each other than this are alike, mm.
const ALIKE: f64 = 0.002;

impl Pair {
    fn is_between_contours(&self) -> bool {
        self.first.wall != self.second.wall
    }

    fn nominal_mm(&self) -> f64 {
        self.second.crossing.at_mm - self.first.crossing.at_mm
    }

    fn kind(&self) -> Kind {
        let [first, second] = [&self.first.crossing, &self.second.crossing];
        match (first.is_round && second.is_round && !self.is_between_contours(), first.towards < 0.0) {
            (true, _) => Kind::Diameter,
            (false, true) => Kind::Width,
            (false, false) => Kind::Thickness,
        }
    }

    fn ends(&self) -> [&Crossing; 2] {
        [&self.first.crossing, &self.second.crossing]
    }

    /// Whether both are between the same walls, and of one kind.
    fn is_of(&self, other: &Self) -> bool {
        (self.kind(), self.first.wall, self.second.wall) == (other.kind(), other.first.wall, other.second.wall)
    }

    /// Whether the same jaw lies flat against both walls to either side of the line, or at the apex of a round wall, which a hand finds
    /// by itself: the least reading across a web or a ring, the largest across a bore.
    fn is_flat(&self, beside: &[Option<Self>; 2]) -> bool {
        if self.kind() == Kind::Diameter {
            return true;
        }
        let [Some(below), Some(above)] = beside else { return false };
        (0..2).all(|end| {
            let [here, below, above] = [self, below, above].map(|pair| pair.ends()[end]);
            let [from, to] = [below, above].map(|there| there.at_mm - here.at_mm);
            let flat = from.abs() < ALIKE && to.abs() < ALIKE;
            let apex = || [here, below, above].iter().all(|end| end.is_round) && (from - to).abs() < ALIKE;
            flat || self.is_between_contours() && apex()
        })
    }

    /// Half of the reading, or all of it, that is of a contour.
    fn observation(&self, of: usize, number: u32, noise: Offset) -> Observation {
        let own = if self.first.wall == of { &self.first } else { &self.second };
        let contact = &own.crossing.nominal;
        let point = Observation::new(contact.s, contact.height, Offset::ZERO, noise, contact.normal);
        if self.is_between_contours() {
            point.paired(number)
        } else {
            point.with_across(self.second.crossing.nominal.s)
        }
    }
}

/// A pair of walls on a line that may be measured, and what is measured half a millimetre to either side of it.
struct Faced {
    pair: Pair,
    beside: [Pair; 2],
    along: Axis,
    across_mm: f64,
    z: Position,
}

impl Faced {
    /// Where it is: its axis, line, height and walls, nm.
    fn place(&self) -> (bool, [i64; 4]) {
        let [from, to] = self.pair.ends().map(|end| nm(end.at_mm).nm());
        (self.along == Axis::X, [nm(self.across_mm).nm(), (self.z - Position::ZERO).nm(), from, to])
    }

    fn planned(&self, passes: &[Pass]) -> PlannedDimension {
        let Pair { first, second } = self.pair;
        let name = |seen: Seen| passes.get(seen.wall).filter(|_| passes.len() > 1).map(name);
        let [from, to] = [first, second].map(|seen| seen.crossing.at_mm);
        PlannedDimension {
            contour: name(first),
            to_contour: name(second).filter(|_| self.pair.is_between_contours()),
            kind: self.pair.kind().name(),
            along: self.along.of(["x", "y"]),
            across_mm: self.across_mm,
            z_mm: (self.z - Position::ZERO).nm() as f64 / 1e6,
            walls_mm: [from, to],
            nominal_mm: self.pair.nominal_mm(),
            why: String::new(),
        }
    }
}

/// The walls of some contours.
struct Part<'w, 'a> {
    walls: &'w [Walls<'a>],
    /// The work offset of each; `None` where the program has shifted it, and all of one contour alone.
    offsets: Vec<Option<u16>>,
}

impl<'w, 'a> Part<'w, 'a> {
    fn of(walls: &'w [Walls<'a>]) -> Self {
        let offset = |walls: &Walls<'_>| PartProgram::read(walls.pass()).ok().map(|program| program.work_offset);
        let offsets = if walls.len() > 1 { walls.iter().map(offset).collect() } else { vec![None] };
        Self { walls, offsets }
    }

    /// Whether the coordinates of two contours are of one origin.
    fn share_origin(&self, a: usize, b: usize) -> bool {
        let offset = |wall: usize| self.offsets.get(wall).copied().flatten();
        a == b || offset(a).is_some() && offset(a) == offset(b)
    }
}

/// All that may be measured on the walls of a part.
fn faced(part: &Part<'_, '_>) -> Vec<Faced> {
    let mut found: Vec<Faced> = Vec::new();
    // One between two contours is seen from both.
    let mut known = BTreeSet::new();
    for (own, wall) in part.walls.iter().enumerate() {
        let [tip, top] = wall.heights();
        for along in [Axis::X, Axis::Y] {
            let Some([from, to]) = wall.extent(along.other()) else { continue };
            let middle = 0.5 * (from + to);
            let spread = (0..LINES).map(|line| from + (to - from) * (line as f64 + 0.5) / LINES as f64);
            // Coordinates that a hand can set; round walls are measured through their middle.
            for across_mm in spread.map(|at| (2.0 * at).round() / 2.0).chain([middle]) {
                for share in HEIGHTS {
                    let z = tip + nm(share * mm(top - tip));
                    let pairs = |at: f64| pairs(part, own, along, at, z);
                    let here = pairs(across_mm);
                    if here.is_empty() {
                        continue;
                    }
                    let [jaw, hand] = [JAW, BY_HAND].map(|by| [-by, by].map(|by| pairs(across_mm + by)));
                    for pair in here {
                        let same = |there: &Vec<Pair>| there.iter().find(|other| other.is_of(&pair)).copied();
                        if !pair.is_flat(&jaw.each_ref().map(same)) {
                            continue;
                        }
                        let beside = hand.each_ref().map(|there| same(there).unwrap_or(pair));
                        let faced = Faced { pair, beside, along, across_mm, z };
                        if known.insert(faced.place()) {
                            found.push(faced);
                        }
                    }
                }
            }
        }
    }
    found
}

/// The pairs of walls on a line that an instrument reaches, of which at least one is of a contour.
fn pairs(part: &Part<'_, '_>, own: usize, along: Axis, across: f64, z: Position) -> Vec<Pair> {
    let on_line = |(wall, walls): (usize, &Walls<'_>)| {
        let reaches = walls.extent(along.other()).is_some_and(|[from, to]| from <= across && across <= to);
        let crossings = if reaches && part.share_origin(own, wall) {
            walls.crossings(along, across, z).unwrap_or_default()
        } else {
            Vec::new()
        };
        crossings.into_iter().map(move |crossing| Seen { wall, crossing })
    };
    let mut seen: Vec<Seen> = part.walls.iter().enumerate().flat_map(on_line).collect();
    seen.sort_by(|a, b| a.crossing.at_mm.total_cmp(&b.crossing.at_mm));
    let of_one: Vec<Seen> = seen.iter().filter(|seen| seen.wall == own).copied().collect();
    let pair = |pair: &[Seen]| Pair { first: pair[0], second: pair[1] };
    let between = seen
        .windows(2)
        .map(pair)
        .filter(|pair| pair.is_between_contours() && (pair.first.wall == own || pair.second.wall == own));
    let faces = |pair: &Pair| {
        let [first, second] = pair.ends().map(|end| end.towards);
        first * second < 0.0 && first.abs() > SQUARE && second.abs() > SQUARE
    };
    let reached = |pair: &Pair| {
        let [from, to] = pair.ends().map(|end| end.at_mm);
        let mut others = seen.iter().map(|seen| seen.crossing.at_mm);
        match pair.first.crossing.towards < 0.0 {
            true => others.all(|at| at <= from || to <= at),
            false => others.all(|at| (from..=to).contains(&at) || at < from - JAW_ROOM || to + JAW_ROOM < at),
        }
    };
    of_one.windows(2).map(pair).chain(between).filter(faces).filter(reached).collect()
}

/// What is expected of a reading: on its line and to either side of it.
#[derive(Clone)]
struct Said {
    /// Change per prior standard deviation, mm.
    change: Row,
    /// Standard deviation of the reading, mm.
    deviation_mm: f64,
    /// Errors half a millimetre below and above the line, mm.
    beside_mm: [f64; 2],
}

impl Said {
    /// Of the readings on its line and beside it.
    fn of(rows: &[Row], touches: &[Observation]) -> Self {
        let deviation_mm = mm(touches[0].deviation());
        Self {
            change: rows[0].map(|sensitivity| sensitivity * deviation_mm),
            deviation_mm,
            beside_mm: [mm(touches[1].error), mm(touches[2].error)],
        }
    }

    /// Of a reading of two walls.
    fn mean(&self, other: &Self) -> Self {
        let mean = |a: f64, b: f64| 0.5 * (a + b);
        Self {
            change: std::array::from_fn(|k| mean(self.change[k], other.change[k])),
            deviation_mm: mean(self.deviation_mm, other.deviation_mm),
            beside_mm: [0, 1].map(|k| mean(self.beside_mm[k], other.beside_mm[k])),
        }
    }

    /// Sensitivities: what a hand that sets the jaw beside the line adds belongs to the noise.
    fn row(&self) -> Row {
        let set = 0.5 * (self.beside_mm[1] - self.beside_mm[0]);
        let deviation = hypot(self.deviation_mm, set);
        self.change.map(|change| change / deviation)
    }
}

/// What is expected of all that may be measured on a contour, in their order, and the rows of its wall, which is to become certain.
fn readings(
    pass: &Pass,
    of: usize,
    faced: &[Faced],
    uncertainty: Offset,
    progress: &mut dyn FnMut(f64),
) -> Result<(Vec<Said>, Vec<Row>), Failure> {
    let mut buffer = PathBuffer::default();
    let path = pass.sample(&mut buffer)?;
    let prior = pass.core.prior(path.setup().law);
    let estimate = Estimate::stated(&prior);
    let noise = Offset::from_nm(uncertainty.nm() / 4);
    let mut touches = Vec::new();
    for (number, faced) in (0u32..).zip(faced) {
        if [faced.pair.first.wall, faced.pair.second.wall].contains(&of) {
            let [below, above] = &faced.beside;
            touches.extend([&faced.pair, below, above].map(|pair| pair.observation(of, number, noise)));
        }
    }
    let count = touches.len();
    touches.extend(places(&path));
    let rows = rows(&path, &estimate, &mut touches, progress);
    let (expected, wall) = (rows[..count].chunks(3), &rows[count..]);
    let said = expected.zip(touches.chunks(3)).map(|(rows, touches)| Said::of(rows, touches));
    let certain = wall.iter().zip(&touches[count..]).map(|(row, touch)| wall_row(row, mm(touch.deviation())));
    Ok((said.collect(), certain.collect()))
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
