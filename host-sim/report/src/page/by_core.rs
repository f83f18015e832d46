//! A pass as the core computes it: columns along the path, with the digits of `trace.csv` and `correction.csv`.

use truepath_core::correct::{Profile, commanded};
use truepath_core::cut::{Loop, Path, Sample, State};
use truepath_core::geometry::Vector;
use truepath_core::units::Offset;
use truepath_correction::correction::Correction;
use truepath_correction::parallel_walls::run;
use truepath_ground::units::{float, mm};

use super::column::{FEED, FINE, FORCE, UNIT};
use super::heights::{errors_at_heights, heights, samples};
use super::kept::Kept;
use super::{Column, Contour, Heights, PassColumns};
use crate::{Trace, TraceRow, trace};

/// What a page shows along the path.
#[derive(Clone, Debug)]
pub struct Along {
    /// The path and its passes.
    pub contour: Contour,
    /// Wall error over the height; `None` where it is the same at every height.
    pub heights: Option<Heights>,
    /// A sentence when not all samples are shown.
    pub note: Option<String>,
}

/// What a pass is called.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Words {
    /// In buttons and tables; `None` where before and after say it.
    pub name: Option<String>,
    /// What it is and who says so.
    pub label: String,
}

/// The passes of a page that the identified machine foretells.
#[derive(Clone, Debug)]
pub struct PredictedPasses<'a> {
    /// The one without any correction, where it is shown.
    pub before: Option<Words>,
    /// The one of a part that was cut with an earlier correction and measured, with that correction.
    pub milled: Option<(Words, &'a Correction)>,
    /// The one with the correction that was made.
    pub after: Words,
    /// That correction.
    pub correction: &'a Correction,
    /// Wall error beside the model, one entry per sample of the contour; empty where none is known.
    pub residual: &'a [Offset],
}

/// The passes as a machine cuts them on its path.
pub fn predicted(machine: &Loop, passes: &PredictedPasses) -> Along {
    let path = machine.path;
    let kept = Kept::of(path.count());
    let correction = passes.correction;
    let aim = |p: &Profile| if p.on_wall { mm(p.aim(correction.wanted.target, None)) } else { f64::NAN };
    let start = path.working().start;
    let mut states = vec![State::REST; path.working().len()];
    let mut pass = |words: &Words, shift: &(dyn Fn(usize) -> Vector + Sync), errors: Vec<f64>| {
        run(machine, start, &mut states, &shift);
        let columns = pass_columns(&words.label, path, &trace(machine, &states, &errors), &kept);
        let name = words.name.clone();
        (PassColumns { name, ..columns }, errors_at_heights(machine, &states, passes.residual, &kept))
    };
    let mut with = |words: &Words, of: &Correction| {
        let errors = of.predicted.iter().map(|p| aim(&p.after)).collect();
        let (columns, heights) = pass(words, &|i| commanded(path, &of.nodes, i), errors);
        let sigma = |i: usize| of.predicted[i].after.on_wall.then(|| mm(of.sigma[i]));
        let sigma_mm = Some(Column::partly(kept.indices().map(sigma), FINE));
        (PassColumns { sigma_mm, ..columns }, heights)
    };
    let total = |of: &Correction, axis: fn(Vector) -> Offset| {
        Some(Column::of(kept.indices().map(|i| mm(axis(of.nodes[i].total()))), FINE))
    };
    let (after, high) = with(&passes.after, correction);
    let milled = passes.milled.as_ref().map(|(words, of)| {
        let (columns, heights) = with(words, of);
        let (correction_x_mm, correction_y_mm) = (total(of, |v| v.x), total(of, |v| v.y));
        (PassColumns { correction_x_mm, correction_y_mm, ..columns }, heights)
    });
    let before = passes.before.as_ref().map(|words| {
        let errors = correction.predicted.iter().map(|p| aim(&p.before)).collect();
        pass(words, &|_| Vector::ZERO, errors)
    });
    let (before, low) = before.unzip();
    let (milled, middle) = milled.unzip();
    let contour = Contour {
        correction_x_mm: total(correction, |v| v.x),
        correction_y_mm: total(correction, |v| v.y),
        before,
        milled,
        after: Some(after),
        ..contour(path, &kept)
    };
    Along { contour, heights: heights(path, &kept, [low, middle, Some(high)]), note: kept.note() }
}

/// A single pass in states of the elastic loop, with its trace.
pub fn simulated(machine: &Loop, states: &[State], trace: &Trace, label: &str) -> Along {
    let path = machine.path;
    let kept = Kept::of(path.count());
    let before = Some(pass_columns(label, path, trace, &kept));
    let errors = errors_at_heights(machine, states, &[], &kept);
    let contour = Contour { before, ..contour(path, &kept) };
    Along { contour, heights: heights(path, &kept, [Some(errors), None, None]), note: kept.note() }
}

/// The path alone.
pub fn nominal(path: &Path) -> Along {
    let kept = Kept::of(path.count());
    Along { contour: contour(path, &kept), heights: None, note: kept.note() }
}

/// The path without passes.
pub(super) fn contour(path: &Path, kept: &Kept) -> Contour {
    let samples = samples(path);
    let column = |of: fn(&Sample) -> f64, decimals| Column::of(kept.indices().map(|i| of(&samples[i])), decimals);
    Contour {
        s_mm: column(|sample| mm(sample.s), FINE),
        x_mm: column(|sample| sample.point.x.nm() as f64 / 1e6, FINE),
        y_mm: column(|sample| sample.point.y.nm() as f64 / 1e6, FINE),
        nx: Some(column(|sample| float(sample.normal.x), UNIT)),
        ny: Some(column(|sample| float(sample.normal.y), UNIT)),
        correction_x_mm: None,
        correction_y_mm: None,
        before: None,
        milled: None,
        after: None,
    }
}

/// The columns of a pass, one row of the trace per sample of the contour.
fn pass_columns(label: &str, path: &Path, trace: &Trace, kept: &Kept) -> PassColumns {
    let samples = samples(path);
    let feeds = kept.indices().map(|i| float(samples[i].feed));
    let rows = kept.indices().map(|i| trace.get(i).copied());
    PassColumns { feed_mm_per_min: Some(Column::of(feeds, FEED)), ..columns(label, rows) }
}

/// The columns of rows, without feed and standard deviation.
pub(super) fn columns(label: &str, rows: impl Iterator<Item = Option<TraceRow>> + Clone) -> PassColumns {
    let column =
        |of: fn(TraceRow) -> f64, decimals| Some(Column::partly(rows.clone().map(|row| row.map(of)), decimals));
    PassColumns {
        name: None,
        label: Some(label.to_owned()),
        error_mm: column(|r| r.error_mm, FINE),
        sigma_mm: None,
        arc_deg: column(|r| r.arc_deg, FINE),
        chip_area_mm2: column(|r| r.chip_area_mm2, FINE),
        force_n: column(|r| r.force_n, FORCE),
        fx_n: column(|r| r.fx_n, FORCE),
        fy_n: column(|r| r.fy_n, FORCE),
        dx_mm: column(|r| r.dx_mm, FINE),
        dy_mm: column(|r| r.dy_mm, FINE),
        feed_mm_per_min: None,
        correction_x_mm: None,
        correction_y_mm: None,
    }
}
