//! A pass as a virtual machine cut it: columns along its own samples, or along those of a correction.
//!
//! The virtual machine samples the path for itself. `simulate` shows its samples as they are, with the digits of `trace.csv`;
//! beside a correction its values are taken linearly between its samples at the arc lengths of the correction. Limits: a place of
//! a corrected pass belongs to the nominal place that its commanded centre passes nearest to.

use truepath_plant::{LapSample, Milled, Part, Path, Sample};

use super::by_core::{Along, columns};
use super::column::{FEED, FINE, UNIT};
use super::heights::{HEIGHTS, fraction, of_depth};
use super::kept::Kept;
use super::{Column, Contour, Heights, PassColumns};
use crate::{Trace, TraceRow};

/// How far along the commanded path the place nearest to the next nominal one is looked for, mm.
const AHEAD_MM: f64 = 3.0;

/// A pass with one row for every nominal sample of the virtual machine.
pub fn trace_of(pass: &Milled) -> Trace {
    let (path, cut) = (&pass.path, &pass.cut);
    let errors = pass.mean_errors();
    let row = |(i, sample): (usize, &Sample)| {
        let leaving = sample.leaving_rad();
        let feed = cut.feed_per_tooth_mm(cut.feed_at(sample.s_mm));
        let [fx_n, fy_n] = sample.force_n;
        let wall = |axis: usize| path.centre[i][axis] + path.normal[i][axis] * cut.radius_mm;
        TraceRow {
            s_mm: path.s_mm[i],
            x_mm: path.centre[i][0],
            y_mm: path.centre[i][1],
            arc_deg: leaving.to_degrees(),
            chip_area_mm2: cut.axial_depth_mm * feed * (1.0 - leaving.cos()),
            force_n: fx_n.hypot(fy_n),
            fx_n,
            fy_n,
            dx_mm: sample.actual[0] - sample.commanded[0],
            dy_mm: sample.actual[1] - sample.commanded[1],
            error_mm: errors[i],
            wall_x_mm: wall(0),
            wall_y_mm: wall(1),
        }
    };
    beside(pass).into_iter().enumerate().map(row).collect()
}

/// A part that several runs have cut, with one row for every nominal sample: the wall that all of them left, and of engagement,
/// force and deflection what the last one beside the sample had.
pub fn trace_of_part(part: &Part) -> Trace {
    let (path, cut) = (part.path(), part.set_up());
    let errors = part.mean_errors();
    let last = last_beside(part);
    let row = |(i, sample): (usize, Option<&LapSample>)| {
        let leaving = sample.map_or(0.0, |s| s.leaving_rad);
        let feed = sample.map_or(0.0, |s| cut.feed_per_tooth_mm(s.feed_mm_per_min));
        let [fx_n, fy_n] = sample.map_or([0.0; 2], |s| s.force_n);
        let moved = |axis: usize| sample.map_or(0.0, |s| s.actual[axis] - s.commanded[axis]);
        let wall = |axis: usize| path.centre[i][axis] + path.normal[i][axis] * cut.radius_mm;
        TraceRow {
            s_mm: path.s_mm[i],
            x_mm: path.centre[i][0],
            y_mm: path.centre[i][1],
            arc_deg: leaving.to_degrees(),
            chip_area_mm2: cut.axial_depth_mm * feed * (1.0 - leaving.cos()),
            force_n: fx_n.hypot(fy_n),
            fx_n,
            fy_n,
            dx_mm: moved(0),
            dy_mm: moved(1),
            error_mm: errors[i],
            wall_x_mm: wall(0),
            wall_y_mm: wall(1),
        }
    };
    last.into_iter().enumerate().map(row).collect()
}

/// For every nominal sample the last step beside it, or beside the nearest sample before it that has one.
fn last_beside(part: &Part) -> Vec<Option<&LapSample>> {
    let mut beside: Vec<Option<&LapSample>> = vec![None; part.path().s_mm.len()];
    for sample in part.samples().iter().flatten() {
        beside[sample.nominal] = Some(sample);
    }
    let mut last = beside.iter().find_map(|sample| *sample);
    for sample in &mut beside {
        if sample.is_none() { *sample = last } else { last = *sample }
    }
    beside
}

/// For every nominal sample the one of the pass whose commanded centre is nearest, in the order of the path. Along an uncorrected
/// pass that is the sample itself.
fn beside(pass: &Milled) -> Vec<&Sample> {
    let ahead = (AHEAD_MM / pass.path.step_mm).ceil() as usize;
    let mut at = 0;
    let nearest = |centre: &[f64; 2]| {
        let off = |k: &usize| {
            let [x, y] = pass.samples[*k].commanded;
            (x - centre[0]).hypot(y - centre[1])
        };
        let window = at..(at + ahead).min(pass.samples.len());
        at = window.min_by(|a, b| off(a).total_cmp(&off(b))).unwrap_or(at);
        pass.samples.get(at)
    };
    pass.path.centre.iter().filter_map(nearest).collect()
}

/// A single pass with its trace, one row per nominal sample.
pub fn milled(pass: &Milled, trace: &Trace, label: &str) -> Along {
    let feed = |i: usize| pass.cut.feed_at(pass.path.s_mm[i]);
    along(&pass.path, pass.cut.axial_depth_mm, &over_height(pass), &feed, trace, label)
}

/// A part that several runs have cut with its trace, one row per nominal sample.
pub fn parted(part: &Part, trace: &Trace, label: &str) -> Along {
    let [bottom, top] = part.height_mm();
    let errors: Vec<Vec<f64>> = (0..HEIGHTS).map(|k| part.errors_at(bottom + (top - bottom) * fraction(k))).collect();
    let last = last_beside(part);
    let feed = |i: usize| last[i].map_or(f64::NAN, |sample| sample.feed_mm_per_min);
    along(part.path(), top - bottom, &errors, &feed, trace, label)
}

/// One row per nominal sample.
fn along(
    path: &Path,
    depth_mm: f64,
    errors: &[Vec<f64>],
    feed: &dyn Fn(usize) -> f64,
    trace: &Trace,
    label: &str,
) -> Along {
    let kept = Kept::of(path.s_mm.len());
    let column = |of: &dyn Fn(usize) -> f64, decimals| Column::of(kept.indices().map(of), decimals);
    let rows = kept.indices().map(|i| trace.get(i).copied());
    let feeds = column(feed, FEED);
    let contour = Contour {
        s_mm: column(&|i| path.s_mm[i], FINE),
        x_mm: column(&|i| path.centre[i][0], FINE),
        y_mm: column(&|i| path.centre[i][1], FINE),
        nx: Some(column(&|i| path.normal[i][0], UNIT)),
        ny: Some(column(&|i| path.normal[i][1], UNIT)),
        correction_x_mm: None,
        correction_y_mm: None,
        before: Some(PassColumns { feed_mm_per_min: Some(feeds), ..columns(label, rows) }),
        milled: None,
        after: None,
    };
    let nodes = kept.nodes().flat_map(|i| errors.iter().map(move |row| row[i])).collect();
    Along { contour, heights: of_depth(depth_mm, &kept, [Some(nodes), None, None]), note: kept.note() }
}

/// Puts two passes in place of those of a contour, and gives their walls over the height. Within `trim_mm` of the ends, where the
/// cutter plunges and lifts, no error is shown.
pub fn milled_twice(contour: &mut Contour, passes: [(&Milled, &str); 2], trim_mm: f64) -> Option<Heights> {
    let s_mm: Vec<f64> = contour.s_mm.values().into_iter().map(Option::unwrap_or_default).collect();
    // What a page shows is no longer than it may be, so that all of it is kept.
    let kept = Kept::of(s_mm.len());
    let [first, second] = passes.map(|(pass, label)| {
        let judged = |s: f64| s > trim_mm && s < pass.path.length_mm - trim_mm;
        let trace = trace_of(pass);
        let rows = s_mm.iter().map(|s| {
            let row = at(&pass.path.s_mm, &trace, *s)?;
            Some(if judged(*s) { row } else { TraceRow { error_mm: f64::NAN, ..row } })
        });
        let feeds = Column::of(s_mm.iter().map(|s| pass.cut.feed_at(*s)), FEED);
        let errors = over_height(pass);
        let nodes = kept.nodes().flat_map(|i| {
            let s = s_mm[i];
            let error = move |row: &Vec<f64>| between(&pass.path.s_mm, s, |k| row.get(k).copied(), mix);
            let shown = judged(s);
            errors.iter().map(move |row| error(row).filter(|_| shown).unwrap_or(f64::NAN)).collect::<Vec<_>>()
        });
        let nodes: Vec<f64> = nodes.collect();
        (PassColumns { feed_mm_per_min: Some(feeds), ..columns(label, rows) }, nodes)
    });
    (contour.before, contour.after) = (Some(first.0), Some(second.0));
    let depth_mm = passes[0].0.cut.axial_depth_mm;
    of_depth(depth_mm, &kept, [Some(first.1), None, Some(second.1)])
}

/// Wall errors, for each height those of every nominal sample.
fn over_height(pass: &Milled) -> Vec<Vec<f64>> {
    pass.wall_errors(&(0..HEIGHTS).map(fraction).collect::<Vec<_>>())
}

fn mix(a: f64, b: f64, u: f64) -> f64 {
    if u == 0.0 { a } else { a + (b - a) * u }
}

/// What lies at an arc length, from the values at the samples before and behind it; beyond the ends those of the ends.
fn between<T>(s_mm: &[f64], s: f64, value: impl Fn(usize) -> Option<T>, mix: impl Fn(T, T, f64) -> T) -> Option<T> {
    let last = s_mm.len().checked_sub(1)?;
    let behind = s_mm.partition_point(|x| *x <= s).min(last);
    let before = behind.saturating_sub(1);
    let room = s_mm[behind] - s_mm[before];
    let u = if room > 0.0 { ((s - s_mm[before]) / room).clamp(0.0, 1.0) } else { 0.0 };
    Some(mix(value(before)?, value(behind)?, u))
}

/// The row at an arc length.
fn at(s_mm: &[f64], trace: &Trace, s: f64) -> Option<TraceRow> {
    between(
        s_mm,
        s,
        |k| trace.get(k).copied(),
        |a, b, u| {
            let mixed = |of: fn(&TraceRow) -> f64| mix(of(&a), of(&b), u);
            TraceRow {
                s_mm: s,
                x_mm: mixed(|r| r.x_mm),
                y_mm: mixed(|r| r.y_mm),
                arc_deg: mixed(|r| r.arc_deg),
                chip_area_mm2: mixed(|r| r.chip_area_mm2),
                force_n: mixed(|r| r.force_n),
                fx_n: mixed(|r| r.fx_n),
                fy_n: mixed(|r| r.fy_n),
                dx_mm: mixed(|r| r.dx_mm),
                dy_mm: mixed(|r| r.dy_mm),
                error_mm: mixed(|r| r.error_mm),
                wall_x_mm: mixed(|r| r.wall_x_mm),
                wall_y_mm: mixed(|r| r.wall_y_mm),
            }
        },
    )
}
