//! Tables. Column names carry their units; their order is part of the contract.

use truepath_core::cut::{Loop, State, chip_area};
use truepath_correction::rows::{CorrectionRow, wall_mm};
use truepath_correction::surface::expected;
use truepath_ground::diagnostics::Failure;
use truepath_ground::table::table;
use truepath_ground::units::{float, mm, rounded};
use truepath_plant::Surface;
use truepath_trial::compare::{Row, Walls};

/// One place of a simulated pass.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct TraceRow {
    /// Arc length of the contour.
    pub s_mm: f64,
    /// Nominal centre.
    pub x_mm: f64,
    /// Nominal centre.
    pub y_mm: f64,
    /// Engagement angle.
    pub arc_deg: f64,
    /// P23's analogue of the removal rate, b·f·(1 − cos φ₁), per tooth.
    pub chip_area_mm2: f64,
    /// Mean force over a revolution.
    pub force_n: f64,
    /// Its component along x, on the tool.
    pub fx_n: f64,
    /// Its component along y, on the tool.
    pub fy_n: f64,
    /// Mean deflection along x.
    pub dx_mm: f64,
    /// Mean deflection along y.
    pub dy_mm: f64,
    /// Wall error, mean over the height: positive, material left; not a number where no wall stands.
    pub error_mm: f64,
    /// Nominal wall beside it; in `wall.csv`.
    #[serde(skip)]
    pub wall_x_mm: f64,
    /// Nominal wall beside it; in `wall.csv`.
    #[serde(skip)]
    pub wall_y_mm: f64,
}

/// A simulated pass.
pub type Trace = Vec<TraceRow>;

/// The trace of a pass in states of the elastic loop over the path's working range, with the wall error of each
/// sample of the contour.
pub fn trace(machine: &Loop, states: &[State], errors_mm: &[f64]) -> Trace {
    let path = machine.path;
    let skipped = path.first() - path.working().start;
    let samples = &path.samples()[path.first()..path.first() + path.count()];
    let rows = samples.iter().zip(&states[skipped..]).zip(errors_mm);
    rows.map(|((sample, state), error)| {
        let (n, t) = machine.mean_force(state);
        let heading = path.setup().wall.heading(state.normal);
        let (n, t) = (float(n), float(t));
        let fx_n = n * float(state.normal.x) + t * float(heading.x);
        let fy_n = n * float(state.normal.y) + t * float(heading.y);
        let feed = path.setup().feed_per_tooth(sample.feed);
        let wall = wall_mm(path, sample);
        TraceRow {
            s_mm: mm(sample.s),
            x_mm: sample.point.x.nm() as f64 / 1e6,
            y_mm: sample.point.y.nm() as f64 / 1e6,
            arc_deg: float(state.engaged).to_degrees(),
            chip_area_mm2: float(chip_area(path.setup(), feed, state.engaged)),
            force_n: n.hypot(t),
            fx_n,
            fy_n,
            dx_mm: mm(state.displacement.x),
            dy_mm: mm(state.displacement.y),
            error_mm: *error,
            wall_x_mm: wall[0],
            wall_y_mm: wall[1],
        }
    })
    .collect()
}

/// `trace.csv`.
///
/// # Errors
/// Internal, when memory cannot be written.
pub fn trace_csv(trace: &Trace) -> Result<Vec<u8>, Failure> {
    table(trace.iter().map(|r| TraceRow {
        s_mm: rounded(r.s_mm, 6),
        x_mm: rounded(r.x_mm, 6),
        y_mm: rounded(r.y_mm, 6),
        arc_deg: rounded(r.arc_deg, 6),
        chip_area_mm2: rounded(r.chip_area_mm2, 6),
        force_n: rounded(r.force_n, 4),
        fx_n: rounded(r.fx_n, 4),
        fy_n: rounded(r.fy_n, 4),
        dx_mm: rounded(r.dx_mm, 6),
        dy_mm: rounded(r.dy_mm, 6),
        error_mm: rounded(r.error_mm, 6),
        ..*r
    }))
}

/// A place on an unrolled wall.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
struct MapRow {
    s_mm: f64,
    z_mm: f64,
    error_mm: f64,
    wall_mm: f64,
}

/// Places of `wall-map.csv` are at least this far apart along the wall, mm.
const MAP_MM: f64 = 0.2;

/// `wall-map.csv`: the wall unrolled, slice by slice from the lowest; where no wall stands there is no row.
///
/// # Errors
/// Internal, when memory cannot be written.
pub fn wall_map_csv(surface: &Surface) -> Result<Vec<u8>, Failure> {
    let mut kept: Vec<usize> = Vec::new();
    for (place, wall) in surface.wall_mm.iter().enumerate() {
        if kept.last().is_none_or(|last| wall - surface.wall_mm[*last] >= MAP_MM - 1e-6) {
            kept.push(place);
        }
    }
    let slices = surface.slices_mm.iter().zip(&surface.errors_mm);
    let rows = slices.flat_map(|((lower, upper), errors)| {
        let row = move |place: &usize| MapRow {
            s_mm: rounded(surface.s_mm[*place], 4),
            z_mm: rounded(0.5 * (lower + upper), 4),
            error_mm: rounded(errors[*place], 6),
            wall_mm: rounded(surface.wall_mm[*place], 4),
        };
        kept.iter().filter(|place| errors[**place].is_finite()).map(row)
    });
    table(rows)
}

/// `correction.csv`.
///
/// # Errors
/// Internal, when memory cannot be written.
pub fn correction_csv(rows: &[CorrectionRow]) -> Result<Vec<u8>, Failure> {
    table(rows)
}

/// `compare.csv`: one line a law.
///
/// # Errors
/// Internal, when memory cannot be written.
pub fn compare_csv(laws: &[Row]) -> Result<Vec<u8>, Failure> {
    let short = |v: Option<f64>| v.map(|v| rounded(v, 6));
    table(laws.iter().map(|row| {
        let of = |figure: fn(&expected::Surface) -> f64| short(row.expected.as_ref().map(figure));
        CompareRow {
            law: row.law,
            title: row.title,
            max_error_mm: short(row.max_error_mm),
            rms_error_mm: short(row.rms_error_mm),
            worst_height_mm: short(row.worst_height_mm),
            gouge_mm: short(row.gouge_mm),
            factor: row.factor.map(|f| rounded(f, 2)),
            max_correction_mm: row.max_correction_mm,
            beyond_clamp: row.beyond_clamp,
            p95_mm: short(row.p95_mm),
            expected_mm: of(|wall| wall.profile.profile_mm),
            expected_sigma_mm: of(|wall| wall.profile.sigma_mm),
            expected_p95_mm: of(|wall| wall.p95_mm),
            expected_p95_sigma_mm: of(|wall| wall.p95_sigma_mm),
            worst_mean_mm: of(|wall| wall.causes.mean_mm).or(short(row.causes.map(|causes| causes.mean_mm))),
            worst_height_part_mm: of(|wall| wall.causes.height_mm).or(short(row.causes.map(|causes| causes.height_mm))),
            worst_bending_mm: of(|wall| wall.causes.bending_mm),
            worst_noise_mm: of(|wall| wall.causes.noise_mm),
            worst_not_modelled_mm: of(|wall| wall.causes.not_modelled_mm),
            remark: &row.remark,
        }
    }))
}

/// A line of the comparison, flat. What makes the error at the worst place begins with `worst`; on a virtual machine the part of the
/// height holds that of bending.
#[derive(serde::Serialize)]
struct CompareRow<'a> {
    law: &'a str,
    title: &'a str,
    max_error_mm: Option<f64>,
    rms_error_mm: Option<f64>,
    worst_height_mm: Option<f64>,
    gouge_mm: Option<f64>,
    factor: Option<f64>,
    max_correction_mm: f64,
    beyond_clamp: bool,
    p95_mm: Option<f64>,
    expected_mm: Option<f64>,
    expected_sigma_mm: Option<f64>,
    expected_p95_mm: Option<f64>,
    expected_p95_sigma_mm: Option<f64>,
    worst_mean_mm: Option<f64>,
    worst_height_part_mm: Option<f64>,
    worst_bending_mm: Option<f64>,
    worst_noise_mm: Option<f64>,
    worst_not_modelled_mm: Option<f64>,
    remark: &'a str,
}

/// One place of one law. `error_mm` is that of the target quantity, the other two are over the engaged depth.
#[derive(serde::Serialize)]
struct WallRow<'a> {
    law: &'a str,
    s_mm: f64,
    error_mm: Option<f64>,
    lowest_mm: Option<f64>,
    highest_mm: Option<f64>,
}

/// `walls.csv`: every law after the other.
///
/// # Errors
/// Internal, when memory cannot be written.
pub fn walls_csv(walls: &[(&str, &Walls)]) -> Result<Vec<u8>, Failure> {
    let known = |v: f64| v.is_finite().then(|| rounded(v, 6));
    table(walls.iter().flat_map(|(law, walls)| {
        walls.places.iter().map(move |p| WallRow {
            law,
            s_mm: rounded(p.s_mm, 6),
            error_mm: known(p.error_mm),
            lowest_mm: known(p.lowest_mm),
            highest_mm: known(p.highest_mm),
        })
    }))
}
