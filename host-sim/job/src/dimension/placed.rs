//! Which walls a dimension is between, and what it says of them.

use std::cmp::Ordering;
use std::ops::Range;

use truepath_core::probe::{Contact, Reading, Rejected};
use truepath_core::units::{Offset, Position};
use truepath_ground::diagnostics::{Failure, InputError, Source};
use truepath_ground::length::Unit;
use truepath_ground::units::{mm, nm};

use super::file::{Across, Dimension, Kind, Level};
use super::walls::{Axis, Crossing, Walls, reading};
use crate::codes::{M045, M046, M047, M048, M049, M051};

/// A value farther than this from the nominal one is of something else, mm: twice the reach of a wall.
const FAR: f64 = 2.0;
/// Cosine of 3°: a wall farther from square is not what a jaw lies against.
const SQUARE: f64 = 0.998_63;

/// Lines nearer to each other than this are one, mm: nearer than a hand keeps to it.
const ONE_LINE: f64 = 0.5;

/// A dimension on the walls it was measured between.
#[derive(Clone, Debug, PartialEq)]
pub struct Placed {
    /// The dimension.
    pub dimension: Dimension,
    /// Its line among those of the measurement: the file of dimensions stands behind the probe file.
    pub line: u32,
    /// Its line in its own file.
    pub file_line: u32,
    /// What the program would leave, mm.
    pub nominal_mm: f64,
    /// The first wall, with the error that the dimension shows: of two walls the mean of both.
    pub contact: Contact,
    /// The other wall, nominal; `None` where the dimension is one from a face.
    pub across: Option<Contact>,
    /// Which half it is of a dimension between two contours, each of which has one with the same error.
    pub half: Option<Half>,
    /// How much larger it is for so much material left: −2 of a width, 2 of a thickness, 1 or −1 of a distance.
    pub larger_per_error: f64,
    /// Standard deviation of that error; from a face what the face may be off belongs to it.
    pub noise: Offset,
    /// The same as a reading of a file of points.
    pub reading: Reading,
}

/// A half of a dimension between two contours.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Half {
    /// A number that it shares with the other half alone.
    pub pair: u32,
    /// Whether it is the one at the larger coordinate.
    pub is_second: bool,
}

/// The dimensions of a wall.
#[derive(Clone, Debug)]
pub struct Dimensions {
    /// Their file.
    pub source: Source,
    /// In the order of the file.
    pub placed: Vec<Placed>,
}

impl Dimensions {
    /// The dimension of a line of the measurement.
    pub fn of_line(&self, line: u32) -> Option<&Placed> {
        self.placed.iter().find(|placed| placed.line == line)
    }
}

/// What may be measured on a line.
struct Candidate {
    /// The contour of the first wall, and that of the second.
    walls: [usize; 2],
    z: Position,
    nominal_mm: f64,
    first: Crossing,
    second: Option<Crossing>,
}

/// A wall on the line of a dimension, and the contour that it is of.
#[derive(Clone, Copy)]
struct Seen {
    wall: usize,
    /// Coordinate of the line across its direction, mm.
    across: f64,
    z: Position,
    crossing: Crossing,
}

impl Candidate {
    /// How far a coordinate along the axis is outside of what is measured, 0 within it, and from its middle, mm.
    fn off(&self, at: f64, face: Option<f64>) -> [f64; 2] {
        let end = self.second.map_or(face.unwrap_or(self.first.at_mm), |second| second.at_mm);
        let [middle, half] = [0.5 * (self.first.at_mm + end), 0.5 * (self.first.at_mm - end).abs()];
        let off = (at - middle).abs();
        [(off - half).max(0.0), off]
    }

    fn fits(&self, value: f64) -> bool {
        (self.nominal_mm - value).abs() < FAR
    }

    fn words(&self, along: Axis, unit: Unit) -> String {
        let from = format!("{along}{:.3}", unit.of(self.first.at_mm));
        let to = self.second.map_or_else(String::new, |second| format!(" to {along}{:.3}", unit.of(second.at_mm)));
        format!("{:.3} {} ({from}{to})", unit.of(self.nominal_mm), unit.name())
    }
}

/// Finds a dimension among the walls of some contours; returns the number of the contour it is of, or of both with its halves.
/// `number` is a number of its own; errors are said in a unit.
///
/// # Errors
/// `M045` to `M049` and `M051`, at the key that is wrong.
pub(crate) fn placed(
    (source, unit): (&Source, Unit),
    walls: &[Walls<'_>],
    dimension: &Dimension,
    lines_before: u32,
    number: u32,
) -> Result<Vec<(usize, Placed)>, Failure> {
    let along = dimension.along;
    let mut candidates = Vec::new();
    let (mut seen, mut heights) = (Vec::new(), Vec::new());
    for (number, wall) in walls.iter().enumerate() {
        let z = match dimension.level {
            Level::Z(z) => z,
            Level::AboveTip(above) => wall.heights()[0] + above,
        };
        let Some(across) = middle(wall, dimension) else { continue };
        match wall.crossings(along, across, z) {
            Ok(crossings) => {
                candidates.extend(among(&crossings, dimension, number, z));
                seen.extend(crossings.into_iter().map(|crossing| Seen { wall: number, across, z, crossing }));
            }
            Err(Rejected::OffHeight { .. }) => heights.push(wall.heights()),
            Err(_) => {}
        }
    }
    if seen.is_empty() {
        return Err(match heights.first() {
            Some(heights) => off_height((source, unit), dimension, *heights),
            None => no_wall((source, unit), walls, dimension),
        }
        .into());
    }
    let all: Vec<Crossing> = seen.iter().map(|seen| seen.crossing).collect();
    let (between, at_other_heights) = between_contours(source, dimension, seen);
    candidates.extend(between);
    let chosen = match chosen((source, unit), dimension, candidates, &all) {
        // What is nothing of one height may be something of two.
        Err(refused) if refused.code() != M049.code => return Err(at_other_heights.unwrap_or(refused).into()),
        chosen => chosen?,
    };
    refuse_oblique((source, unit), dimension, &chosen)?;
    let file_line = source.line_column(dimension.value_span.start).0;
    let file_line = u32::try_from(file_line).unwrap_or(u32::MAX);
    let line = lines_before.saturating_add(file_line);
    let [first, second] = chosen.walls;
    let (Some(wall), Some(other)) = (walls.get(first), walls.get(second)) else {
        return Err(Failure::Internal("a dimension of no contour".to_owned()));
    };
    let whole = of_walls(wall, dimension.clone(), &chosen, [line, file_line])?;
    let Some(crossing) = chosen.second.filter(|_| first != second) else { return Ok(vec![(first, whole)]) };
    let half = |is_second| Some(Half { pair: number, is_second });
    let chosen = Candidate { first: crossing, second: Some(chosen.first), ..chosen };
    let there = of_walls(other, dimension.clone(), &chosen, [line, file_line])?;
    Ok(vec![(first, Placed { half: half(false), ..whole }), (second, Placed { half: half(true), ..there })])
}

/// Whether two walls, one behind the other on a line, face each other as a kind wants it.
fn face(kind: Kind, a: &Crossing, b: &Crossing) -> bool {
    match kind {
        Kind::Thickness => a.towards > 0.0 && b.towards < 0.0,
        Kind::Width => a.towards < 0.0 && b.towards > 0.0,
        _ => a.towards * b.towards < 0.0 && a.is_round && b.is_round,
    }
}

/// What a kind may be between a wall of one contour and the next wall on the line, of another one; and, where its height above
/// the tip is another one for either, what is wrong with that (`M051`).
fn between_contours(
    source: &Source,
    dimension: &Dimension,
    mut seen: Vec<Seen>,
) -> (Vec<Candidate>, Option<InputError>) {
    let (mut candidates, mut at_other_heights) = (Vec::new(), None);
    if dimension.face.is_some() {
        return (candidates, at_other_heights);
    }
    seen.sort_by(|a, b| a.crossing.at_mm.total_cmp(&b.crossing.at_mm));
    for pair in seen.windows(2) {
        let [first, second] = [pair[0].crossing, pair[1].crossing];
        // Through the middle of either is one line only where both middles are.
        let on_one_line = (pair[0].across - pair[1].across).abs() < ONE_LINE;
        if pair[0].wall == pair[1].wall || !on_one_line || !face(dimension.kind, &first, &second) {
            continue;
        }
        let nominal_mm = second.at_mm - first.at_mm;
        if pair[0].z == pair[1].z {
            let walls = [pair[0].wall, pair[1].wall];
            candidates.push(Candidate { walls, z: pair[0].z, nominal_mm, first, second: Some(second) });
        } else if (nominal_mm - mm(dimension.value)).abs() < FAR {
            let found =
                format!("{} lies between two contours whose cutter's tips are not at one height", dimension.name);
            let error = M051.error(found, "z_mm, a height in program coordinates").with_keys_in(dimension.unit);
            at_other_heights = Some(error.at(source, dimension.level_span.clone()));
        }
    }
    (candidates, at_other_heights)
}

/// The coordinate of the line across its direction, mm.
fn middle(wall: &Walls<'_>, dimension: &Dimension) -> Option<f64> {
    match dimension.across {
        Across::At(at) => Some(at),
        Across::Middle => wall.extent(dimension.along.other()).map(|[from, to]| 0.5 * (from + to)),
    }
}

/// What a kind may be on the walls of a line.
fn among(crossings: &[Crossing], dimension: &Dimension, wall: usize, z: Position) -> Vec<Candidate> {
    if let Some(face) = dimension.face {
        // Of a thickness the material lies between face and wall.
        let solid = |c: &&Crossing| dimension.kind != Kind::Thickness || (face - c.at_mm) * c.towards > 0.0;
        let from_face = |c: &Crossing| Candidate {
            walls: [wall; 2],
            z,
            nominal_mm: (c.at_mm - face).abs(),
            first: *c,
            second: None,
        };
        return crossings.iter().filter(solid).map(from_face).collect();
    }
    let pairs = crossings.windows(2).filter(|pair| face(dimension.kind, &pair[0], &pair[1]));
    let pair = |pair: &[Crossing]| Candidate {
        walls: [wall; 2],
        z,
        nominal_mm: pair[1].at_mm - pair[0].at_mm,
        first: pair[0],
        second: Some(pair[1]),
    };
    pairs.map(pair).collect()
}

/// One key behind the other.
fn order<const N: usize>(a: &[f64; N], b: &[f64; N]) -> Ordering {
    a.iter().zip(b).map(|(a, b)| a.total_cmp(b)).find(|order| order.is_ne()).unwrap_or(Ordering::Equal)
}

/// The candidate that is meant: the one around `near_mm`, or the only one that the value fits.
fn chosen(
    (source, unit): (&Source, Unit),
    dimension: &Dimension,
    candidates: Vec<Candidate>,
    seen: &[Crossing],
) -> Result<Candidate, InputError> {
    let (along, value) = (dimension.along, mm(dimension.value));
    if candidates.is_empty() {
        return Err(other_kind((source, unit), dimension, seen));
    }
    let candidates: Vec<Candidate> = match dimension.near {
        None => candidates,
        Some(near) => {
            // Around it lie a pocket and the ring in it: the one that the value fits.
            let key = |c: &Candidate| {
                let [outside, off] = c.off(near, dimension.face);
                [outside, f64::from(u8::from(!c.fits(value))), off]
            };
            let nearest = candidates.into_iter().min_by(|a, b| order(&key(a), &key(b)));
            nearest.into_iter().collect()
        }
    };
    let listed: Vec<String> = candidates.iter().map(|candidate| candidate.words(along, unit)).collect();
    let nominals: Vec<f64> = candidates.iter().map(|candidate| candidate.nominal_mm).collect();
    let mut fitting: Vec<Candidate> = candidates.into_iter().filter(|candidate| candidate.fits(value)).collect();
    match (fitting.pop(), fitting.is_empty()) {
        (Some(only), true) => Ok(only),
        (Some(_), false) => {
            let found = format!("{} fits several places: {}", dimension.name, listed.join(", "));
            let expected = "near_mm, a coordinate between the two walls";
            Err(M049.error(found, expected).with_keys_in(dimension.unit).at(source, dimension.place_span.clone()))
        }
        (None, _) => Err(far((source, unit), dimension, &nominals, &listed)),
    }
}

/// A value that is no deviation of any nominal one.
fn far((source, unit): (&Source, Unit), dimension: &Dimension, nominals: &[f64], listed: &[String]) -> InputError {
    let value = mm(dimension.value);
    let fits = |factor: f64| nominals.iter().any(|nominal| (value * factor - nominal).abs() < FAR.min(0.02 * nominal));
    let help = if fits(25.4) {
        "it looks like inches: type it in millimetres, or write value_in"
    } else if fits(1.0 / 25.4) {
        "it looks like millimetres: write value_mm"
    } else if fits(2.0) {
        "it looks like half of it, a radius: type the whole dimension"
    } else if fits(0.5) {
        "it looks like twice the dimension"
    } else if [0.1, 0.01, 0.001, 10.0, 100.0, 1000.0].into_iter().any(fits) {
        "the decimal point looks misplaced"
    } else if value < FAR {
        "type the whole dimension, not its deviation"
    } else {
        M047.remedy
    };
    let found = format!("{} is {} {}", dimension.name, unit.of(value), unit.name());
    let expected = format!("within {:.1} {} of {}", unit.of(FAR), unit.name(), listed.join(" or "));
    InputError::new(M047, found, expected, help).at(source, dimension.value_span.clone())
}

/// Walls on the line between which no such dimension lies.
fn other_kind((source, unit): (&Source, Unit), dimension: &Dimension, seen: &[Crossing]) -> InputError {
    let along = dimension.along;
    let inside = |pair: &[Crossing]| pair[0].towards < 0.0 && pair[1].towards > 0.0;
    let solid = |pair: &[Crossing]| pair[0].towards > 0.0 && pair[1].towards < 0.0;
    let any = |pairs: fn(&[Crossing]) -> bool| seen.windows(2).any(pairs);
    let help = match dimension.kind {
        Kind::Width if any(solid) => "there is material between the walls on this line: write kind = \"thickness\"",
        Kind::Thickness if any(inside) => "there is no material between the walls on this line: write kind = \"width\"",
        Kind::Diameter => "the walls on this line are straight: write kind = \"width\" or \"thickness\"",
        _ if seen.len() == 1 => {
            "only one wall of this cut lies on the line: measure from a face, kind = \"distance\" with face_mm"
        }
        _ => M045.remedy,
    };
    let at: Vec<String> = seen.iter().map(|crossing| format!("{along}{:.3}", unit.of(crossing.at_mm))).collect();
    let found = format!("no {} of this cut on the line of {}", dimension.kind.name(), dimension.name);
    let expected = format!("one between the walls at {}", at.join(", "));
    InputError::new(M045, found, expected, help).with_keys_in(dimension.unit).at(source, dimension.place_span.clone())
}

fn no_wall((source, unit): (&Source, Unit), walls: &[Walls<'_>], dimension: &Dimension) -> InputError {
    let across = dimension.along.other();
    let extents: Vec<String> = walls
        .iter()
        .filter_map(|wall| wall.extent(across))
        .map(|ends| ends.map(|end| unit.of(end)))
        .map(|[from, to]| format!("{across}{from:.3} to {across}{to:.3}"))
        .collect();
    let found = format!("no wall of this cut lies on the line of {}", dimension.name);
    let expected = format!("a line that meets it: it reaches from {}", extents.join(", or from "));
    M045.error(found, expected).at(source, dimension.place_span.clone())
}

fn off_height((source, unit): (&Source, Unit), dimension: &Dimension, heights: [Position; 2]) -> InputError {
    let [tip, top] = heights.map(|z| (z - Position::ZERO).nm() as f64 / 1e6);
    let found = format!("{} is above or below the cut", dimension.name);
    let name = unit.name();
    let expected = match dimension.level {
        Level::Z(_) => format!("z_mm from {} to {} {name}", unit.of(tip), unit.of(top)),
        Level::AboveTip(_) => format!("height_mm from 0 to {} {name}", unit.of(top - tip)),
    };
    M048.error(found, expected).with_keys_in(dimension.unit).at(source, dimension.level_span.clone())
}

/// Refuses a wall that no jaw lies flat against.
fn refuse_oblique(
    (source, unit): (&Source, Unit),
    dimension: &Dimension,
    chosen: &Candidate,
) -> Result<(), InputError> {
    let along = dimension.along;
    let crossings = std::iter::once(&chosen.first).chain(&chosen.second);
    let Some(oblique) = crossings.into_iter().find(|crossing| crossing.towards.abs() < SQUARE) else { return Ok(()) };
    let angle = oblique.towards.abs().min(1.0).acos().to_degrees();
    let found = format!(
        "the wall at {along}{:.3} on the line of {} is {angle:.0} degrees off square to {along}",
        unit.of(oblique.at_mm),
        dimension.name
    );
    let expected = "a wall square to the direction that is measured along, or the middle of a round one";
    Err(M046.error(found, expected).at(source, dimension.place_span.clone()))
}

/// The dimension as a contact: measured − nominal, shared by its walls.
fn of_walls(
    wall: &Walls<'_>,
    dimension: Dimension,
    chosen: &Candidate,
    [line, file_line]: [u32; 2],
) -> Result<Placed, Failure> {
    let Candidate { z, nominal_mm, first, second, .. } = *chosen;
    let larger = mm(dimension.value) - nominal_mm;
    let deviation = 0.25 * mm(dimension.uncertainty);
    let (larger_per_error, noise) = match (second, dimension.face) {
        // Material left on both walls makes a pocket narrower, a boss wider.
        (Some(second), _) => (2.0 * (first.towards * (second.at_mm - first.at_mm)).signum(), deviation),
        (None, face) => {
            let away = (first.at_mm - face.unwrap_or_default()).signum();
            (-away * first.towards.signum(), 2.0 * deviation)
        }
    };
    let error = larger / larger_per_error;
    // The wall lies so far from its nominal place, away from the material that is left.
    let along = dimension.along;
    let across = middle_of(&first, along);
    let place = along.point(first.at_mm - error * first.towards.signum(), across);
    let off = |_| Failure::Internal("a dimension off its own wall".to_owned());
    let contact = wall.contact(place, z, line).map_err(off)?;
    let contact = Contact { error: nm(error), ..contact };
    Ok(Placed {
        line,
        file_line,
        nominal_mm,
        contact,
        across: second.map(|second| second.nominal),
        half: None,
        larger_per_error,
        noise: nm(noise),
        reading: reading(place, z, line),
        dimension,
    })
}

/// Coordinate of a wall across a line along an axis, mm.
fn middle_of(crossing: &Crossing, along: Axis) -> f64 {
    let point = crossing.nominal.point;
    let [x, y] = [point.x, point.y].map(|p| (p - Position::ZERO).nm() as f64 / 1e6);
    along.other().of([x, y])
}

impl Placed {
    /// As messages name it.
    pub fn words(&self, file: &str) -> String {
        format!("\"{}\" ({file}, line {})", self.dimension.name, self.file_line)
    }

    /// Where its value stands.
    pub fn span(&self) -> Range<usize> {
        self.dimension.value_span.clone()
    }
}
