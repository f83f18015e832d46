//! What a law leaves, in numbers.

use std::ops::RangeInclusive;

use truepath_core::units::Offset;
use truepath_correction::surface::causes::MeasuredCauses;
use truepath_correction::surface::expected::Surface;
use truepath_ground::length::Unit;
use truepath_ground::rows::p95;
use truepath_ground::units::mm;

use super::Candidate;

/// The wall beside one place of the contour.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Along the contour, mm.
    pub s_mm: f64,
    /// Error of the target quantity, mm: positive, material left; not a number where no wall stands.
    pub error_mm: f64,
    /// Smallest error at any height of the engaged depth, mm.
    pub lowest_mm: f64,
    /// Largest error at any height, mm.
    pub highest_mm: f64,
}

/// A wall along the contour.
#[derive(Clone, Debug, PartialEq)]
pub struct Walls {
    /// In the order of the contour.
    pub places: Vec<Place>,
    /// The errors over the height of every place, mm; not a number where no wall stands.
    pub over_height_mm: Vec<Vec<f64>>,
    /// What is expected of the whole wall, with what the points leave open; absent on a virtual machine.
    pub expected: Option<Surface>,
}

/// One line of the comparison.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Row {
    /// Name of the law.
    pub law: &'static str,
    /// What it is.
    pub title: &'static str,
    /// Largest error of the target quantity, mm; absent when the machine could not cut it.
    pub max_error_mm: Option<f64>,
    /// Its root mean square, mm.
    pub rms_error_mm: Option<f64>,
    /// Largest error at any height of the engaged depth, mm.
    pub worst_height_mm: Option<f64>,
    /// Deepest cut at any height, mm (positive; 0 where material is left everywhere).
    pub gouge_mm: Option<f64>,
    /// Largest error without correction over that with it.
    pub factor: Option<f64>,
    /// Largest correction along an axis, mm.
    pub max_correction_mm: f64,
    /// Whether that is beyond the clamp of the job: `correct` would refuse it.
    pub beyond_clamp: bool,
    /// 95 of 100 places of the wall, at any height, are nearer to the nominal wall than this, mm.
    pub p95_mm: Option<f64>,
    /// What is expected of the whole wall, with what the points leave open; absent on a virtual machine.
    pub expected: Option<Surface>,
    /// What makes the largest error at any height on a virtual machine; absent on the identified one, of which `expected` says it.
    pub causes: Option<MeasuredCauses>,
    /// What is to be known about it.
    pub remark: String,
}

impl Walls {
    /// The places that are judged: away from the ends where the contour is long enough to have a middle.
    pub fn judged(&self, trim_mm: f64) -> impl Iterator<Item = &Place> {
        let stretch = judged(self.places.last().map_or(0.0, |p| p.s_mm), trim_mm);
        self.places.iter().filter(move |p| stretch.contains(&p.s_mm) && p.error_mm.is_finite())
    }
    /// 95 of 100 of the errors at every height of the places that are judged are at most this, the sign aside, mm.
    fn p95_mm(&self, trim_mm: f64) -> f64 {
        p95(&mut self.columns(trim_mm).flatten().map(|error| error.abs()).collect::<Vec<f64>>())
    }
    /// What makes the largest error at any height of the places that are judged; `None` where none is.
    fn causes(&self, trim_mm: f64) -> Option<MeasuredCauses> {
        let of = |column: Vec<f64>| Some((column.iter().copied().max_by(|a, b| a.abs().total_cmp(&b.abs()))?, column));
        let (worst, column) = self.columns(trim_mm).filter_map(of).max_by(|a, b| a.0.abs().total_cmp(&b.0.abs()))?;
        Some(MeasuredCauses::of(&column, worst, 0.0))
    }
    /// The errors over the height of each place that is judged, mm.
    fn columns(&self, trim_mm: f64) -> impl Iterator<Item = Vec<f64>> {
        let stretch = judged(self.places.last().map_or(0.0, |p| p.s_mm), trim_mm);
        let stands = move |place: &Place| stretch.contains(&place.s_mm) && place.error_mm.is_finite();
        let places = self.places.iter().zip(&self.over_height_mm).filter(move |(place, _)| stands(place));
        places.map(|(_, errors)| errors.iter().copied().filter(|error| error.is_finite()).collect())
    }
}

/// The stretch of a contour of a length that is judged, mm.
pub fn judged(length_mm: f64, trim_mm: f64) -> RangeInclusive<f64> {
    let trim = if length_mm > 2.5 * trim_mm { trim_mm } else { 0.0 };
    trim..=length_mm - trim
}

/// The line of a law. `walls` is what it leaves, or why that is not known; `none_mm` is the largest error without
/// correction, `trim_mm` what is left out at the ends.
pub fn row(
    candidate: &Candidate,
    walls: Result<&Walls, &str>,
    none_mm: Option<f64>,
    trim_mm: f64,
    (clamp, unit): (Offset, Unit),
) -> Row {
    let largest = truepath_core::job::largest(&candidate.nodes);
    let beyond_clamp = largest > clamp;
    let mut remarks = vec![candidate.remark.clone()];
    if beyond_clamp {
        remarks.push(format!("beyond the clamp of {} {}: correct would refuse it", unit.of(mm(clamp)), unit.name()));
    }
    let mut row = Row {
        law: candidate.law,
        title: candidate.title,
        max_error_mm: None,
        rms_error_mm: None,
        worst_height_mm: None,
        gouge_mm: None,
        factor: None,
        max_correction_mm: mm(largest),
        beyond_clamp,
        p95_mm: None,
        expected: None,
        causes: None,
        remark: String::new(),
    };
    match walls {
        Err(reason) => remarks.push(format!("the machine could not cut it: {reason}")),
        Ok(walls) => {
            let most =
                |f: fn(&Place) -> f64| walls.judged(trim_mm).map(f).filter(|v| v.is_finite()).fold(0.0, f64::max);
            let (squares, count) = walls.judged(trim_mm).fold((0.0, 0u32), |(s, n), p| (s + p.error_mm.powi(2), n + 1));
            if count > 0 {
                let max = most(|p| p.error_mm.abs());
                row.max_error_mm = Some(max);
                row.rms_error_mm = Some((squares / f64::from(count)).sqrt());
                row.worst_height_mm = Some(most(|p| p.lowest_mm.abs().max(p.highest_mm.abs())));
                row.gouge_mm = Some(most(|p| -p.lowest_mm));
                row.p95_mm = Some(walls.p95_mm(trim_mm));
                row.expected = walls.expected;
                row.causes = walls.causes(trim_mm).filter(|_| walls.expected.is_none());
                row.factor = Some(none_mm.unwrap_or(max) / max.max(1e-6));
            }
        }
    }
    remarks.retain(|text| !text.is_empty());
    row.remark = remarks.join("; ");
    row
}
