//! Dimensions that a QIF document places itself, by the nominal features of its lengths.
//!
//! | characteristic | features | dimension |
//! |---|---|---|
//! | width, thickness, distance between | two points, or two planes | width where the normals face each other, else thickness; by its name where there are none |
//! | distance between | a plane and a point | distance from the face that the plane is |
//! | diameter | a circle or a cylinder along Z | diameter, along X |
//!
//! Each is placed at the mean of its two places, in the coordinates of the program. Other lengths, of other features, are passed over;
//! a document with nothing else is refused.

use std::ops::Range;

use truepath_core::units::{Offset, Position};
use truepath_ground::decimal::Decimal;
use truepath_ground::diagnostics::{InputError, Source};
use truepath_ground::length::Unit;
use truepath_ground::units::{mm, nm};

use super::file::{Across, Dimension, FACE, INSTRUMENTS, Instrument, Kind, Level};
use super::walls::Axis;
use crate::codes::M053;
use crate::qif::{Feature, Length, Qif, Shape};

/// Two places are along an axis of each other when they are off it by less than this, mm.
const OFF: f64 = 0.5;
/// Cosine of 5°: how square to its direction a face has to be.
const SQUARE: f64 = 0.996;

/// The dimensions of a document.
///
/// # Errors
/// `M052` for what is no QIF 3 document, `M053` for one without a length that can be placed.
pub(super) fn read(source: &Source) -> Result<Vec<Dimension>, InputError> {
    let lengths = Qif::read(source)?.lengths()?;
    let placed: Vec<Dimension> = lengths.iter().filter_map(dimension).collect();
    if placed.is_empty() {
        let found =
            format!("none of the {} lengths in {} says between which walls it is", lengths.len(), source.name());
        let expected =
            "widths, thicknesses or distances of two points or planes square to X or Y, diameters of circles";
        return Err(M053.error(found, expected).at(source, 0..0));
    }
    Ok(placed)
}

fn dimension(length: &Length) -> Option<Dimension> {
    let device = |name: &String| INSTRUMENTS.iter().find(|(own, _)| own == name).map(|(_, instrument)| *instrument);
    let instrument = length.devices.iter().find_map(device).unwrap_or(Instrument::Cmm);
    let stated = length.uncertainty.map(|sigma| nm(2.0 * sigma.as_f64())).filter(|stated| *stated > Offset::ZERO);
    let place = place(length)?;
    // To the nanometre, as a file of dimensions has it.
    let whole = |at: f64| mm(nm(at));
    let [x, y, z] = place.middle.map(whole);
    let name = length.names.first().cloned().unwrap_or_else(|| format!("{} of X{x:.2} Y{y:.2}", length.kind));
    let span: Range<usize> = length.span.clone();
    Some(Dimension {
        name,
        kind: place.kind,
        along: place.along,
        across: Across::At(place.along.other().of([x, y])),
        near: Some(place.along.of([x, y])),
        face: place.face.map(whole),
        face_uncertainty: FACE,
        level: Level::Z(Position::ZERO + nm(z)),
        instrument,
        uncertainty: stated.unwrap_or(instrument.uncertainty()),
        value: length.value.as_mm(),
        unit: Unit::Millimetre,
        value_span: span.clone(),
        place_span: span.clone(),
        level_span: span,
    })
}

/// Where a length was measured, mm.
struct Place {
    kind: Kind,
    along: Axis,
    middle: [f64; 3],
    face: Option<f64>,
}

fn place(length: &Length) -> Option<Place> {
    let at = |feature: &Feature| feature.place.map(|place| place.map(Decimal::as_f64));
    match length.features.as_slice() {
        [round] if round.shape == Shape::Round && length.kind == "Diameter" => {
            let upright = round.normal.is_none_or(|[_, _, z]| z.abs() > SQUARE);
            let middle = at(round).filter(|_| upright)?;
            Some(Place { kind: Kind::Diameter, along: Axis::X, middle, face: None })
        }
        [a, b] if matches!(length.kind, "Width" | "Thickness" | "DistanceBetween") => {
            let (first, second) = (at(a)?, at(b)?);
            let apart = [0, 1, 2].map(|axis| (second[axis] - first[axis]).abs());
            // A plane may be placed anywhere on itself: only its own direction counts.
            let points = [(a, first), (b, second)].into_iter().filter(|(feature, _)| feature.shape == Shape::Point);
            let points: Vec<[f64; 3]> = points.map(|(_, place)| place).collect();
            let along = along(a.normal.or(b.normal), apart)?;
            let own = along.of([0, 1]);
            if points.len() == 2 && [0, 1, 2].into_iter().any(|axis| axis != own && apart[axis] > OFF) {
                return None;
            }
            let mut middle = [0, 1, 2].map(|axis| 0.5 * (first[axis] + second[axis]));
            if let [only] = points.as_slice() {
                let plane = if a.shape == Shape::Point { second } else { first };
                middle = *only;
                middle[own] = 0.5 * (only[own] + plane[own]);
                let other = if a.shape == Shape::Point { b } else { a };
                let face = (other.shape == Shape::Plane).then_some(plane[own])?;
                return Some(Place { kind: Kind::Distance, along, middle, face: Some(face) });
            }
            if [a, b].iter().any(|feature| !matches!(feature.shape, Shape::Point | Shape::Plane)) {
                return None;
            }
            let towards = a.normal.map(|normal| normal[own] * (second[own] - first[own]));
            let kind = match towards {
                Some(towards) if towards > 0.0 => Kind::Width,
                Some(_) => Kind::Thickness,
                None if length.kind == "Thickness" => Kind::Thickness,
                None => Kind::Width,
            };
            Some(Place { kind, along, middle, face: None })
        }
        _ => None,
    }
}

/// The axis that two faces are measured along: that of a normal, else that of the way between them.
fn along(normal: Option<[f64; 3]>, apart: [f64; 3]) -> Option<Axis> {
    let [x, y, z] = normal.map_or(apart, |normal| normal.map(f64::abs));
    let size = x.hypot(y).hypot(z);
    match () {
        () if x > SQUARE * size => Some(Axis::X),
        () if y > SQUARE * size => Some(Axis::Y),
        () => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn feature(shape: Shape, place: [&str; 3], normal: Option<[f64; 3]>) -> Feature {
        Feature { shape, place: Some(place.map(|text| Decimal::parse(text).unwrap())), normal }
    }

    fn of(kind: &'static str, features: Vec<Feature>) -> Option<Dimension> {
        let value = Decimal::parse("69.87").unwrap();
        let (names, devices) = (vec!["pocket X".to_owned()], Vec::new());
        dimension(&Length { kind, names, value, uncertainty: None, devices, features, span: 0..1 })
    }

    #[test]
    fn two_points_are_a_room_or_material_by_their_normals() {
        let point = |x, normal| feature(Shape::Point, [x, "12.5", "-6"], normal);
        let room = of("Width", vec![point("-35", Some([1.0, 0.0, 0.0])), point("35", None)]).unwrap();
        assert_eq!(
            (room.kind, room.along, room.across, room.near),
            (Kind::Width, Axis::X, Across::At(12.5), Some(0.0))
        );
        assert_eq!((room.level, mm(room.value)), (Level::Z(Position::ZERO + nm(-6.0)), 69.87));
        let rib = of("DistanceBetween", vec![point("-35", Some([-1.0, 0.0, 0.0])), point("35", None)]).unwrap();
        assert_eq!(rib.kind, Kind::Thickness);
        assert_eq!(of("Thickness", vec![point("-35", None), point("35", None)]).unwrap().kind, Kind::Thickness);
        // Not one behind the other along an axis, and not along Z.
        let beside = feature(Shape::Point, ["35", "20", "-6"], None);
        assert_eq!(of("Width", vec![point("-35", Some([1.0, 0.0, 0.0])), beside]), None);
        let below = feature(Shape::Point, ["-35", "12.5", "-9"], None);
        assert_eq!(of("Width", vec![point("-35", None), below]), None);
    }

    #[test]
    fn a_plane_and_a_point_are_a_distance_from_a_face_and_a_circle_is_a_diameter() {
        let face = feature(Shape::Plane, ["-50", "3", "0"], Some([-1.0, 0.0, 0.0]));
        let wall = feature(Shape::Point, ["-35", "4", "-6"], Some([1.0, 0.0, 0.0]));
        for pair in [vec![face.clone(), wall.clone()], vec![wall, face]] {
            let found = of("DistanceBetween", pair).unwrap();
            assert_eq!((found.kind, found.face, found.across), (Kind::Distance, Some(-50.0), Across::At(4.0)));
        }
        let bore = |axis| vec![feature(Shape::Round, ["10", "20", "-5"], Some(axis))];
        let found = of("Diameter", bore([0.0, 0.0, -1.0])).unwrap();
        assert_eq!((found.kind, found.across, found.near), (Kind::Diameter, Across::At(20.0), Some(10.0)));
        assert_eq!(of("Diameter", bore([1.0, 0.0, 0.0])), None);
    }
}
