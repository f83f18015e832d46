//! The machines on which laws are compared.

use truepath_core::correct::{Band, Design, Node, Profile, Target};
use truepath_core::cut::{Loop, Path};
use truepath_correction::correction::{Identification, walls};
use truepath_correction::discrepancy::Along;
use truepath_correction::surface::expected::Surface;
use truepath_correction::surface::predicted::{COUNT, errors};
use truepath_ground::diagnostics::Failure;
use truepath_ground::units::{float, mm};
use truepath_job::pass::Pass;
use truepath_plant as plant;

use super::score::{Place, Walls};
use crate::virtual_mill;

/// Heights at which the virtual machine is judged, in the band of the target and in the whole engaged depth.
const HEIGHTS: usize = 10;

/// The walls that the identified machine leaves with a correction, as the core predicts them.
pub fn identified(machine: &Loop, known: &Identification, wanted: &Design, nodes: &[Node]) -> Walls {
    let (inside, _) = walls(machine, wanted.band, nodes, &[]);
    let whole = if wanted.band == Band::WHOLE { inside.clone() } else { walls(machine, Band::WHOLE, nodes, &[]).0 };
    let samples = machine.path.samples().iter().skip(machine.path.first());
    let place = |((sample, p), whole): ((&truepath_core::cut::Sample, &Profile), &Profile)| Place {
        s_mm: mm(sample.s),
        error_mm: if p.on_wall { mm(p.aim(wanted.target, None)) } else { f64::NAN },
        lowest_mm: mm(whole.lowest.min(whole.tip)),
        highest_mm: mm(whole.highest.max(whole.tip)),
    };
    let indices: Vec<usize> = (machine.path.first()..).take(machine.path.count()).collect();
    let all = errors(machine, nodes, &indices);
    Walls {
        places: samples.zip(&inside).zip(&whole).map(place).collect(),
        over_height_mm: all.chunks(COUNT).map(<[f64]>::to_vec).collect(),
        expected: Some(Surface::predicted(machine, known, &Along::NONE, nodes)),
    }
}

/// The walls that a virtual machine leaves when the program's centres are displaced by a correction.
///
/// # Errors
/// What the plant refuses.
pub fn virtual_machine(
    pass: &Pass,
    path: &Path,
    machine: &plant::Machine,
    wanted: &Design,
    nodes: &[Node],
) -> Result<Walls, Failure> {
    let samples = path.samples().iter().skip(path.first());
    let mut centres: Vec<plant::Point> = Vec::with_capacity(nodes.len());
    for (sample, node) in samples.zip(nodes) {
        let at = sample.point + node.total();
        let at = [at.x.nm() as f64 / 1e6, at.y.nm() as f64 / 1e6];
        // At a sharp corner samples share their place.
        if centres.last() != Some(&at) {
            centres.push(at);
        }
    }
    let milled = virtual_mill::mill(pass, machine, Some(&centres))?;
    let band = [float(wanted.band.from), float(wanted.band.to)];
    let even = |k: usize| band[0] + (band[1] - band[0]) * (k as f64 + 0.5) / HEIGHTS as f64;
    let levels: Vec<f64> = match wanted.target {
        Target::Tip => vec![0.0],
        Target::Mean | Target::Minimax => (0..HEIGHTS).map(even).collect(),
    };
    let inside = milled.wall_errors(&levels);
    let mut whole = milled.wall_errors(&plant::judged_levels());
    whole.extend(inside.iter().cloned());
    let places = milled.path.s_mm.iter().enumerate().map(|(i, s)| {
        let [low, high] = range(&whole, i);
        Place { s_mm: *s, error_mm: aim(&inside, i, wanted.target), lowest_mm: low, highest_mm: high }
    });
    let column = |i: usize| whole.iter().map(|row| row.get(i).copied().unwrap_or(f64::NAN)).collect();
    let over_height_mm = (0..milled.path.s_mm.len()).map(column).collect();
    Ok(Walls { places: places.collect(), over_height_mm, expected: None })
}

fn finite(rows: &[Vec<f64>], i: usize) -> impl Iterator<Item = f64> {
    rows.iter().filter_map(move |row| row.get(i).copied()).filter(|e| e.is_finite())
}

fn range(rows: &[Vec<f64>], i: usize) -> [f64; 2] {
    let (low, high) = finite(rows, i).fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), e| (l.min(e), h.max(e)));
    if low <= high { [low, high] } else { [f64::NAN; 2] }
}

fn aim(rows: &[Vec<f64>], i: usize, target: Target) -> f64 {
    let [low, high] = range(rows, i);
    match target {
        Target::Minimax => f64::midpoint(low, high),
        Target::Mean | Target::Tip => {
            let (sum, count) = finite(rows, i).fold((0.0, 0.0), |(sum, count), e| (sum + e, count + 1.0));
            sum / count
        }
    }
}
