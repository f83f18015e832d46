//! Widths that cannot tell their two walls apart, and the measurement that would.
//!
//! A width sees the sum of two errors. Machine and material make opposite walls nearly alike, whatever they are; what makes
//! them differ is stock that is thicker on one side than on the other, as where roughing and finishing are not about the same
//! middle. Where that, and what the fit leaves open of the machine, is more than an instrument reads, one wall has to be measured from
//! somewhere else.

use truepath_core::cut::Path;
use truepath_core::identify::Observation;
use truepath_core::probe::Contact;
use truepath_core::units::{Offset, Position};
use truepath_ground::hypotenuse::hypot;
use truepath_ground::length::{Remark, Unit};
use truepath_ground::units::{float, mm};
use truepath_job::dimension::{Axis, Half, Placed};
use truepath_job::measurement::Measurement;

use super::covariance::{Covariance, Row};
use super::estimate::Estimate;
use super::sensitivity::{rows, wall_row};
use crate::correction::Identification;
use crate::discrepancy::{CutPoints, Own, stock_sensitivities};

/// Walls that differ by less, at one standard deviation, are alike for every instrument, mm.
const ALIKE: f64 = 0.002;
/// Share of the allowance by which it differs from wall to wall, one standard deviation.
const UNEVEN: f64 = 0.1;
/// A probe's standard deviation, mm.
const PROBE: Offset = Offset::from_um(2);
/// Cosine of 3 degrees: a wall nearer to square is one that a distance along the axis sees.
const SQUARE: f64 = 0.998_63;

/// A dimension between two walls, each with the place of its touch among those of its contour.
struct Between<'a> {
    placed: &'a Placed,
    touches: [(usize, Observation); 2],
}

/// A sentence for each axis along which the walls of the widths of a contour stay apart; none where one of them was measured by
/// itself. `path` is that of the pass under the identified wall law.
pub fn unseparated(path: &Path, measurement: &Measurement, identified: &Identification, unit: Unit) -> Vec<Remark> {
    let all = measurement.dimensions.iter().flat_map(|dimensions| &dimensions.placed);
    let widths: Vec<Between<'_>> = all
        .filter(|placed| placed.half.is_none() && !by_itself(measurement, placed.dimension.along))
        .filter_map(|placed| {
            let touches = [&placed.contact, placed.across.as_ref()?].map(|contact| (0, touch(contact)));
            Some(Between { placed, touches })
        })
        .collect();
    left_open(&[*path], &widths, identified, unit)
}

/// The same of the widths between two contours, which is a sentence for each axis along which neither of the contours was measured by
/// itself.
pub fn unseparated_contours(
    walls: &[(Path<'_>, &Measurement)],
    identified: &Identification,
    unit: Unit,
) -> Vec<Remark> {
    let halves = |wall: usize| {
        let dimensions = walls.get(wall).and_then(|(_, measurement)| measurement.dimensions.as_ref());
        dimensions.into_iter().flat_map(|dimensions| &dimensions.placed)
    };
    let mut widths: Vec<Between<'_>> = Vec::new();
    for first in 0..walls.len() {
        for placed in halves(first) {
            let Some(half) = placed.half.filter(|half| !half.is_second) else { continue };
            let other = Some(Half { is_second: true, ..half });
            let there =
                (0..walls.len()).find_map(|at| Some((at, halves(at).find(|other_half| other_half.half == other)?)));
            let Some((second, there)) = there else { continue };
            if [first, second].iter().any(|at| by_itself(walls[*at].1, placed.dimension.along)) {
                continue;
            }
            let touches = [(first, touch(&placed.contact)), (second, touch(&there.contact))];
            widths.push(Between { placed, touches });
        }
    }
    let paths: Vec<Path<'_>> = walls.iter().map(|(path, _)| *path).collect();
    left_open(&paths, &widths, identified, unit)
}

/// Whether a wall square to an axis was measured by itself.
fn by_itself(measurement: &Measurement, axis: Axis) -> bool {
    let single = |c: &&Contact| measurement.dimension(c.line).is_none_or(|placed| placed.across.is_none());
    let square = |c: &Contact| axis.of([float(c.normal.x), float(c.normal.y)]).abs() > SQUARE;
    measurement.contacts.iter().filter(single).any(square)
}

fn touch(contact: &Contact) -> Observation {
    Observation::new(contact.s, contact.height, Offset::ZERO, PROBE, contact.normal)
}

/// What a touch tells of its wall, mm, and what the allowance there does to it, mm per mm.
fn wall_rows(path: &Path, mut touches: Vec<Observation>, identified: &Identification) -> Vec<(Row, f64)> {
    let estimate = Estimate { prior: identified.prior(), theta: identified.fit().theta, nodes: &[] };
    let rows = rows(path, &estimate, &mut touches, &mut |_| ());
    let own = Own::default();
    let cut = CutPoints { path, contour: 0, parts_ago: 1, nodes: &[], observations: &touches, more: &[], own };
    let stock = stock_sensitivities(path, &cut, &identified.core);
    let rows = rows.iter().zip(&touches).map(|(row, touch)| wall_row(row, mm(touch.deviation())));
    rows.zip(stock).collect()
}

/// A sentence for each axis along which what is between walls leaves their difference open.
fn left_open(paths: &[Path<'_>], widths: &[Between<'_>], identified: &Identification, unit: Unit) -> Vec<Remark> {
    let told = |(at, path): (usize, &Path<'_>)| {
        let touches = widths.iter().flat_map(|width| width.touches).filter(|(wall, _)| *wall == at);
        let touches: Vec<Observation> = touches.map(|(_, touch)| touch).collect();
        if touches.is_empty() { Vec::new() } else { wall_rows(path, touches, identified) }.into_iter()
    };
    let mut told: Vec<_> = paths.iter().enumerate().map(told).collect();
    let known = Covariance::of(&identified.fit().covariance, false);
    let mut worst: Vec<(Axis, f64, Remark)> = Vec::new();
    for Between { placed, touches } in widths {
        let [first, second] = touches.map(|(wall, _)| told.get_mut(wall).and_then(Iterator::next));
        let (Some((one, by_stock)), Some((other, by_other_stock))) = (first, second) else { continue };
        let [uneven, other_uneven] = touches.map(|(wall, _)| UNEVEN * mm(paths[wall].setup().allowance));
        let difference: Row = std::array::from_fn(|k| one[k] - other[k]);
        let left = hypot(known.sigma(&difference.into()), hypot(uneven * by_stock, other_uneven * by_other_stock));
        let along = placed.dimension.along;
        if left < ALIKE || worst.iter().any(|(axis, most, _)| *axis == along && *most >= left) {
            continue;
        }
        let wall = along.of([placed.contact.point.x, placed.contact.point.y]) - Position::ZERO;
        // The difference is twice that of one wall from the mean of both.
        let after = 2.0 * hypot(mm(PROBE), mm(placed.noise));
        let what = if placed.half.is_some() { "widths between two contours" } else { "widths" };
        let text = unit.remark(|unit| {
            format!(
                "the {what} along {along} see the sum of two walls: these may differ by {:.3} {name} (2 sigma, \"{}\"), where the stock is not the same on both sides, and nothing that was measured tells. A distance from a face (kind = \"distance\") to the wall at {along}{:.2}, or one probe point there, would tell it to {:.3} {name}",
                unit.of(2.0 * left),
                placed.dimension.name,
                unit.of(mm(wall)),
                unit.of(2.0 * after.min(left)),
                name = unit.name()
            )
        });
        worst.retain(|(axis, ..)| *axis != along);
        worst.push((along, left, text));
    }
    worst.into_iter().map(|(.., text)| text).collect()
}
