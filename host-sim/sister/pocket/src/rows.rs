//! The tables: one row a section, and one row a station.

use truepath_ground::diagnostics::Failure;
use truepath_ground::rows::median as middle;
use truepath_ground::table::table;
use truepath_ground::units::rounded;
use truepath_job::job::{Mode, PerSection};

use super::design::{Designed, worst};
use super::process::Cutting;
use super::section::{Kind, Section};
use super::station::Station;

/// One section, and what was done with it.
#[derive(Clone, Debug, serde::Serialize)]
pub struct SectionRow {
    /// S1, C1 …
    pub section: String,
    /// Straight, corner or sharp.
    pub kind: Kind,
    /// Start along the contour, mm.
    pub from_mm: f64,
    /// Length, mm.
    pub length_mm: f64,
    /// Smallest engaged angle, degrees.
    pub engaged_min_deg: f64,
    /// Largest.
    pub engaged_max_deg: f64,
    /// Mean over the section of the mean force over a revolution, N.
    pub force_n: f64,
    /// Largest mean deflection towards or from the wall, mm.
    pub deflection_mm: f64,
    /// Largest deflection of the tip, mm.
    pub tip_mm: f64,
    /// Error before: that of the largest magnitude on the near wall, positive: material left, mm.
    pub error_before_mm: f64,
    /// The same on the other wall of a slot.
    pub far_error_before_mm: Option<f64>,
    /// Whether the errors before are within the band.
    pub in_band_before: bool,
    /// Whether the section is shifted.
    pub shifted: bool,
    /// Smallest shift towards the near wall, mm.
    pub shift_min_mm: f64,
    /// Largest.
    pub shift_max_mm: f64,
    /// Error after, as before.
    pub error_after_mm: f64,
    /// The same on the other wall of a slot.
    pub far_error_after_mm: Option<f64>,
    /// Whether the errors after are within the band.
    pub in_band_after: bool,
    /// Largest difference between two heights of one wall after, mm: no shift in X and Y removes it.
    pub height_error_mm: f64,
    /// How much narrower than the cutter the slot is, mm, in the middle of the values along the section; no shift changes
    /// it.
    pub narrower_mm: Option<f64>,
    /// What was done and why.
    pub reason: String,
}

fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.filter(|v| v.is_finite()).fold(0.0, |m: f64, v| if v.abs() > m.abs() { v } else { m })
}

/// The value in the middle; 0 where there is none.
fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut known: Vec<f64> = values.filter(|v| v.is_finite()).collect();
    middle(&mut known)
}

/// The rows of a compensated pocket.
pub fn section_rows(stations: &[Station], designed: &Designed, mode: Mode, tolerance_mm: f64) -> Vec<SectionRow> {
    let rows = designed.sections.iter().zip(&designed.shifted);
    rows.map(|(section, shifted)| row(stations, designed, mode, tolerance_mm, section, *shifted)).collect()
}

fn row(
    stations: &[Station],
    designed: &Designed,
    mode: Mode,
    tolerance_mm: f64,
    section: &Section,
    shifted: bool,
) -> SectionRow {
    let range = section.from..section.to;
    let (before, after) = (&designed.before[range.clone()], &designed.after[range.clone()]);
    let shift = &designed.shift_mm[range];
    let extremes = |values: &mut dyn Iterator<Item = f64>| {
        values.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)))
    };
    let engaged = extremes(&mut before.iter().map(|c| c.engaged_rad.to_degrees()));
    let (shift_min, shift_max) = extremes(&mut shift.iter().copied());
    let near = |cut: &[Cutting]| largest(cut.iter().map(|c| c.walls.near));
    let far = |cut: &[Cutting]| (mode == Mode::Slot).then(|| largest(cut.iter().map(|c| c.walls.far)));
    let inside = |cut: &[Cutting]| worst(section, cut) <= tolerance_mm;
    let [in_band_before, in_band_after] = [inside(&designed.before), inside(&designed.after)];
    let force: f64 = before.iter().map(|c| c.force_n[0].hypot(c.force_n[1])).sum::<f64>() / before.len() as f64;
    let narrower = (mode == Mode::Slot).then(|| median(before.iter().map(|c| c.walls.narrow())));
    let row = SectionRow {
        section: section.name.clone(),
        kind: section.kind,
        from_mm: rounded(stations[section.from].s_mm, 6),
        length_mm: rounded(stations[section.to - 1].s_mm - stations[section.from].s_mm, 6),
        engaged_min_deg: rounded(engaged.0, 4),
        engaged_max_deg: rounded(engaged.1, 4),
        force_n: rounded(force, 3),
        deflection_mm: rounded(largest(before.iter().map(|c| c.deflection_mm)), 6),
        tip_mm: rounded(largest(before.iter().map(|c| c.tip_mm)), 6),
        error_before_mm: rounded(near(before), 6),
        far_error_before_mm: far(before).map(|v| rounded(v, 6)),
        in_band_before,
        shifted,
        shift_min_mm: rounded(shift_min, 6),
        shift_max_mm: rounded(shift_max, 6),
        error_after_mm: rounded(near(after), 6),
        far_error_after_mm: far(after).map(|v| rounded(v, 6)),
        in_band_after,
        height_error_mm: rounded(largest(after.iter().map(|c| c.height_mm)), 6),
        narrower_mm: narrower.map(|v| rounded(v, 6)),
        reason: String::new(),
    };
    SectionRow { reason: reason(&row, tolerance_mm, designed.per_section), ..row }
}

/// What was done with a section, and why.
fn reason(row: &SectionRow, tolerance_mm: f64, per_section: PerSection) -> String {
    let narrow = row.narrower_mm.map_or(0.0, |v| 0.5 * v.abs());
    match (row.kind, row.shifted, row.in_band_after) {
        (Kind::Sharp, _, _) => {
            "no arc: the load jumps with the direction, no shift follows; that of the walls beside it is held"
                .to_owned()
        }
        (_, false, true) => "within the band: untouched".to_owned(),
        (_, false, false) => "was within the band, but its neighbour's shift reaches into it".to_owned(),
        (_, true, true) => "out of the band: shifted".to_owned(),
        (_, true, false) if narrow > tolerance_mm => {
            format!(
                "out of the band: shifted; the slot is {:.4} mm off in width, which no shift corrects",
                2.0 * narrow
            )
        }
        (_, true, false) if per_section == PerSection::Constant => {
            "out of the band: shifted, but one value is not enough for its change: per_section = \"profile\" follows it"
                .to_owned()
        }
        (_, true, false) => "out of the band: shifted, but the cutter cannot follow the change within it".to_owned(),
    }
}

/// `sections.csv`.
///
/// # Errors
/// Internal, when memory cannot be written.
pub fn sections_csv(rows: &[SectionRow]) -> Result<Vec<u8>, Failure> {
    table(rows.iter())
}

/// One station.
#[derive(Clone, Debug, serde::Serialize)]
pub struct CorrectionRow {
    s_mm: f64,
    x_mm: f64,
    y_mm: f64,
    dx_mm: f64,
    dy_mm: f64,
    shift_mm: f64,
    engaged_deg: f64,
    force_n: f64,
    /// Empty where there is no wall.
    predicted_error_before_mm: Option<f64>,
    predicted_error_after_mm: Option<f64>,
    far_error_before_mm: Option<f64>,
    far_error_after_mm: Option<f64>,
    section: String,
}

/// `correction.csv`.
///
/// # Errors
/// Internal, when memory cannot be written.
pub fn correction_csv(stations: &[Station], designed: &Designed) -> Result<Vec<u8>, Failure> {
    let known = |v: f64| v.is_finite().then(|| rounded(v, 6));
    let rows = designed.sections.iter().flat_map(|section| {
        (section.from..section.to).map(move |i| {
            let (station, before, after) = (&stations[i], &designed.before[i], &designed.after[i]);
            CorrectionRow {
                s_mm: rounded(station.s_mm, 6),
                x_mm: rounded(station.point[0], 6),
                y_mm: rounded(station.point[1], 6),
                dx_mm: rounded(designed.vectors[i][0], 6),
                dy_mm: rounded(designed.vectors[i][1], 6),
                shift_mm: rounded(designed.shift_mm[i], 6),
                engaged_deg: rounded(before.engaged_rad.to_degrees(), 4),
                force_n: rounded(before.force_n[0].hypot(before.force_n[1]), 3),
                predicted_error_before_mm: known(before.walls.near),
                predicted_error_after_mm: known(after.walls.near),
                far_error_before_mm: known(before.walls.far),
                far_error_after_mm: known(after.walls.far),
                section: section.name.clone(),
            }
        })
    });
    table(rows)
}
