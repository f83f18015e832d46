//! The decision, section by section, and the shifts: sections whose predicted error is within the band stay as they are.
//!
//! The correction changes the cut: a path nearer to the wall takes more off. So the shifts are refined on the predicted
//! error of the shifted path, elastic loop and envelope included, until what is left is small beside the tolerance.

use truepath_job::job::PerSection;

use super::corner::vectors;
use super::error::PocketError;
use super::process::{Cutting, Process};
use super::ramp;
use super::section::{Kind, Section, sections};
use super::shift::{self, constants, hold, middle, refine};

/// Refinements at most.
const REFINEMENTS: usize = 16;
/// Share of the tolerance at which it is enough.
const SETTLED: f64 = 0.004;

/// What is wanted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wanted {
    /// Half of the width of the band, mm, above 0.
    pub tolerance_mm: f64,
    /// How sections are shifted.
    pub per_section: PerSection,
    /// Largest shift, mm.
    pub clamp_mm: f64,
    /// The path runs on into itself: shifts have no seam.
    pub closed: bool,
}

/// A compensated pocket; vectors are one entry per station.
#[derive(Clone, Debug)]
pub struct Designed {
    /// The sections.
    pub sections: Vec<Section>,
    /// How they are shifted.
    pub per_section: PerSection,
    /// Which of them are shifted.
    pub shifted: Vec<bool>,
    /// Shift towards the near wall, mm.
    pub shift_mm: Vec<f64>,
    /// The same as vectors, without a jump at corners, mm.
    pub vectors: Vec<[f64; 2]>,
    /// The cut of the program as it is.
    pub before: Vec<Cutting>,
    /// The cut of the shifted path.
    pub after: Vec<Cutting>,
    /// Passes of the cutter that were predicted.
    pub passes: usize,
}

/// The largest error of a section, mm; 0 where no wall stands.
pub(super) fn worst(section: &Section, cut: &[Cutting]) -> f64 {
    cut[section.from..section.to].iter().map(|c| c.walls.worst()).filter(|e| e.is_finite()).fold(0.0, f64::max)
}

/// Decides and shifts. `progress` is told the share done, 0…1.
///
/// # Errors
/// [`PocketError`] for a cutter too soft for the cut, and a shift beyond the clamp.
pub fn design(process: &dyn Process, wanted: &Wanted, progress: &mut dyn FnMut(f64)) -> Result<Designed, PocketError> {
    let stations = process.stations();
    let still = vec![[0.0; 2]; stations.len()];
    let limit_mm = process.limit_mm();
    let intended = (0..stations.len()).map(|i| (process.intended_mm(i).abs(), stations[i].s_mm));
    match intended.max_by(|a, b| a.0.total_cmp(&b.0)) {
        Some((deflection_mm, s_mm)) if deflection_mm >= limit_mm => {
            return Err(PocketError::TooSoft { deflection_mm, limit_mm, s_mm });
        }
        _ => {}
    }
    let before = process.cut(&still, 1.0)?;
    let sections = sections(stations, process.nominal());
    let decided = |s: &Section| s.kind != Kind::Sharp && worst(s, &before) > wanted.tolerance_mm;
    let shifted: Vec<bool> = sections.iter().map(decided).collect();
    let mut designed = Designed {
        shift_mm: vec![0.0; stations.len()],
        vectors: still,
        after: before.clone(),
        before,
        sections,
        per_section: wanted.per_section,
        shifted,
        passes: 1,
    };
    if designed.shifted.contains(&true) {
        match wanted.per_section {
            PerSection::Profile => profile(process, wanted, &mut designed, progress)?,
            PerSection::Constant => constant(process, wanted, &mut designed, progress)?,
        }
    }
    let largest = designed.vectors.iter().zip(stations).map(|(v, s)| (v[0].hypot(v[1]), s.s_mm));
    match largest.max_by(|a, b| a.0.total_cmp(&b.0)) {
        Some((shift_mm, s_mm)) if shift_mm > wanted.clamp_mm => {
            Err(PocketError::Clamp { shift_mm, clamp_mm: wanted.clamp_mm, s_mm })
        }
        _ => Ok(designed),
    }
}

/// Whether the neighbours of a section stay as they are.
fn beside(sections: &[Section], shifted: &[bool], k: usize, closed: bool) -> ramp::Neighbours {
    let count = sections.len();
    let still = |i: usize| !shifted[i] && sections[i].kind != Kind::Sharp;
    let before = if k > 0 { Some(k - 1) } else { closed.then_some(count - 1) };
    let behind = if k + 1 < count { Some(k + 1) } else { closed.then_some(0) };
    [before, behind].map(|neighbour| neighbour.is_some_and(|i| i != k && still(i)))
}

fn profile(
    process: &dyn Process,
    wanted: &Wanted,
    designed: &mut Designed,
    progress: &mut dyn FnMut(f64),
) -> Result<(), PocketError> {
    let stations = process.stations();
    let errors: Vec<f64> = designed.before.iter().map(|c| c.walls.position()).collect();
    let mut shares = vec![0.0; stations.len()];
    for (k, section) in designed.sections.iter().enumerate().filter(|(k, _)| designed.shifted[*k]) {
        let beside = beside(&designed.sections, &designed.shifted, k, wanted.closed);
        let own = ramp::shares(stations, section, beside, &errors, wanted.tolerance_mm);
        shares[section.from..section.to].copy_from_slice(&own);
    }
    let target: Vec<f64> = errors.iter().zip(&shares).map(|(e, share)| (1.0 - share) * e).collect();
    let mut shift = vec![0.0; stations.len()];
    let mut best = f64::INFINITY;
    let mut cut = designed.before.clone();
    for turn in 0..REFINEMENTS {
        refine(&mut shift, &cut, &target, &shares);
        for (shift, share) in shift.iter_mut().zip(&shares) {
            if *share == 0.0 {
                *shift = 0.0;
            }
        }
        hold(stations, &designed.sections, &mut shift);
        if wanted.closed
            && let [first, .., last] = shift.as_mut_slice()
        {
            *last = *first;
        }
        let vectors = vectors(stations, &shift);
        cut = process.cut(&vectors, 1.0)?;
        designed.passes += 1;
        let followed = (0..shift.len()).filter(|i| shares[*i] > 0.0 && !stations[*i].held);
        let left = followed.map(|i| (cut[i].walls.position() - target[i]).abs()).filter(|e| e.is_finite());
        let left = left.fold(0.0, f64::max);
        progress((turn + 1) as f64 / REFINEMENTS as f64);
        if left < best {
            best = left;
            (designed.shift_mm, designed.vectors, designed.after) = (shift.clone(), vectors, cut.clone());
        }
        if left < SETTLED * wanted.tolerance_mm {
            break;
        }
    }
    Ok(())
}

fn constant(
    process: &dyn Process,
    wanted: &Wanted,
    designed: &mut Designed,
    progress: &mut dyn FnMut(f64),
) -> Result<(), PocketError> {
    let stations = process.stations();
    let sections = &designed.sections;
    let mut value: Vec<Option<f64>> = designed.shifted.iter().map(|shifted| shifted.then_some(0.0)).collect();
    let mut cut = designed.before.clone();
    for turn in 0..REFINEMENTS {
        let mut change = 0.0f64;
        for (value, section) in value.iter_mut().zip(sections) {
            if let Some(value) = value {
                let more = middle(section, &cut);
                *value += more;
                change = change.max(more.abs());
            }
        }
        let mut shift = constants(stations, sections, &value, wanted.closed);
        shift::hold(stations, sections, &mut shift);
        let vectors = vectors(stations, &shift);
        cut = process.cut(&vectors, 1.0)?;
        designed.passes += 1;
        (designed.shift_mm, designed.vectors, designed.after) = (shift, vectors, cut.clone());
        progress((turn + 1) as f64 / REFINEMENTS as f64);
        if change < SETTLED * wanted.tolerance_mm {
            break;
        }
    }
    Ok(())
}
