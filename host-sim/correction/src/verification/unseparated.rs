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
use truepath_ground::units::{float, mm};
use truepath_job::dimension::{Axis, Placed};
use truepath_job::measurement::Measurement;

use super::covariance::{Covariance, Row};
use super::estimate::Estimate;
use super::sensitivity::{rows, wall_row};
use crate::correction::Identification;
use crate::discrepancy::{CutPoints, stock_sensitivities};

/// Walls that differ by less, at one standard deviation, are alike for every instrument, mm.
const ALIKE: f64 = 0.002;
/// Share of the allowance by which it differs from wall to wall, one standard deviation.
const UNEVEN: f64 = 0.1;
/// A probe's standard deviation, mm.
const PROBE: Offset = Offset::from_um(2);
/// Cosine of 3 degrees: a wall nearer to square is one that a distance along the axis sees.
const SQUARE: f64 = 0.998_63;

/// A sentence for each axis along which the walls of the widths stay apart; none where one of them was measured by itself. `path`
/// is that of the pass under the identified wall law.
pub fn unseparated(path: &Path, measurement: &Measurement, identified: &Identification) -> Vec<String> {
    let all = measurement.dimensions.iter().flat_map(|dimensions| &dimensions.placed);
    let by_itself = |axis: Axis| {
        let single = |c: &&Contact| measurement.dimension(c.line).is_none_or(|placed| placed.across.is_none());
        let square = |c: &Contact| axis.of([float(c.normal.x), float(c.normal.y)]).abs() > SQUARE;
        measurement.contacts.iter().filter(single).any(square)
    };
    let pairs: Vec<(&Placed, &Contact)> = all
        .filter(|placed| !by_itself(placed.dimension.along))
        .filter_map(|placed| Some((placed, placed.across.as_ref()?)))
        .collect();
    if pairs.is_empty() {
        return Vec::new();
    }
    let touch = |c: &Contact| Observation::new(c.s, c.height, Offset::ZERO, PROBE, c.normal);
    let mut touches: Vec<Observation> =
        pairs.iter().flat_map(|(placed, across)| [touch(&placed.contact), touch(across)]).collect();
    let estimate = Estimate { prior: identified.prior(), theta: identified.fit().theta, nodes: &[] };
    let rows = rows(path, &estimate, &mut touches, &mut |_| ());
    let cut =
        CutPoints { path, contour: 0, parts_ago: 1, nodes: &[], observations: &touches, more: &[], datum: [0.0; 2] };
    let stock = stock_sensitivities(path, &cut, &identified.core);
    let known = Covariance::of(&identified.fit().covariance, false);
    let uneven = UNEVEN * mm(path.setup().allowance);
    let mut worst: Vec<(Axis, f64, String)> = Vec::new();
    for (k, (placed, _)) in pairs.iter().enumerate() {
        let [first, second] = [2 * k, 2 * k + 1];
        let of = |at: usize| wall_row(&rows[at], mm(touches[at].deviation()));
        let (one, other) = (of(first), of(second));
        let difference: Row = std::array::from_fn(|k| one[k] - other[k]);
        let left = known.sigma(&difference).hypot(uneven * stock[first].hypot(stock[second]));
        let along = placed.dimension.along;
        if left < ALIKE || worst.iter().any(|(axis, most, _)| *axis == along && *most >= left) {
            continue;
        }
        let wall = along.of([placed.contact.point.x, placed.contact.point.y]) - Position::ZERO;
        // The difference is twice that of one wall from the mean of both.
        let after = 2.0 * mm(PROBE).hypot(mm(placed.noise));
        let text = format!(
            "the widths along {along} see the sum of two walls: these may differ by {:.3} mm (2 sigma, \"{}\"), where the stock is not the same on both sides, and nothing that was measured tells. A distance from a face (kind = \"distance\") to the wall at {along}{:.2}, or one probe point there, would tell it to {:.3} mm",
            2.0 * left,
            placed.dimension.name,
            mm(wall),
            2.0 * after.min(left)
        );
        worst.retain(|(axis, ..)| *axis != along);
        worst.push((along, left, text));
    }
    worst.into_iter().map(|(.., text)| text).collect()
}
