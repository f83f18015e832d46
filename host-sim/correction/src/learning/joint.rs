//! Machine and material from the points of all parts together.
//!
//! Machine, cutter and material are the same for all parts; the correction each was cut with is known, and each has a
//! datum and a level of force of its own ([`identify`](truepath_core::identify::identify)). A part that was cut with a good correction shows a small error, and is as
//! trustworthy as the model is for the deflection that the correction cancelled: a hundredth of it counts as noise.

use std::collections::{HashMap, HashSet};

use truepath_core::correct::{Node, commanded};
use truepath_core::cut::{Path, WallLaw};
use truepath_core::identify::Observation;
use truepath_core::job;
use truepath_core::units::{Offset, Real, hypot_nm};
use truepath_ground::units::nm;
use truepath_job::pass::Pass;

use super::history::Part;
use crate::discrepancy::{Along, Discrepancy, Own, PartCut, own, plain, relieved};
use crate::identification::asked;
use crate::told::Told;

/// A part as the fit takes it.
#[derive(Clone, Debug)]
pub struct PartPoints {
    /// Its number.
    pub number: u32,
    /// Its points.
    pub observations: Vec<Observation>,
    /// The correction it was cut with, beside every sample of the contour; empty for none.
    pub nodes: Vec<Node>,
    /// Standard deviation of one reading.
    pub noise: Offset,
    /// The first part that its cutter has cut, as its [`Part`] has it.
    pub cutter_from: Option<u32>,
}

impl From<PartPoints> for Told {
    fn from(part: PartPoints) -> Self {
        Self { nodes: part.nodes, observations: part.observations }
    }
}

/// What all parts together say.
#[derive(Clone, Debug)]
pub struct Joint {
    /// Machine and material.
    pub core: job::Identified,
    /// The points of every part with predictions, weights and sensitivities.
    pub observations: Vec<Vec<Observation>>,
    /// What every part has of its own.
    pub own: Vec<Own>,
    /// What they show beside the model; `None` where the job ignores it.
    pub beside: Option<Beside>,
}

/// What parts show beside the model, for the next one.
#[derive(Clone, Debug)]
pub struct Beside {
    /// At any place.
    pub discrepancy: Discrepancy,
    /// Along the contour.
    pub along: Along,
}

/// Steps of the walks of force and size by which another cutter counts.
const CHANGE: u32 = 10;

/// Pairs of a part have numbers below; those of different parts stay apart.
const PAIRS: u32 = 1 << 16;
/// Standard deviation of a half whose other half is not known: it tells nothing.
const SILENT: Offset = Offset::from_um(1_000_000);

/// Share of a cancelled deflection that the model may miss.
const MODEL_SHARE: Real = Real::ratio(1, 100);

impl PartPoints {
    /// Of a part of a history; `None` when its correction is not one of this contour.
    pub fn of(part: &Part, path: &Path) -> Option<Self> {
        let nodes = match &part.correction {
            None => Vec::new(),
            Some(correction) => correction.nodes().filter(|nodes| nodes.len() == path.count())?,
        };
        let noise = nm(part.noise_mm);
        let observed = part.points.iter().map(|point| {
            let mut o = point.observation(noise);
            let cancelled = commanded(path, &nodes, path.index_at(o.s)).along(o.normal);
            o.noise = hypot_nm(o.noise, cancelled.scaled(MODEL_SHARE));
            o.pair().map_or(o, |pair| o.paired(part.number.wrapping_mul(PAIRS).wrapping_add(pair)))
        });
        let (number, cutter_from) = (part.number, part.cutter_from);
        Some(Self { number, observations: observed.collect(), nodes, noise, cutter_from })
    }

    /// How many parts its cutter had cut before it, where that of part 1 had cut so many before that.
    pub(super) fn age(&self, cut_before: u32) -> u32 {
        match self.cutter_from {
            Some(first) => self.number.saturating_sub(first),
            None => self.number.saturating_sub(1).saturating_add(cut_before),
        }
    }

    /// Its places: ranges of points at one arc length.
    pub fn places(&self) -> Vec<std::ops::Range<usize>> {
        let mut end = 0;
        let groups = self.observations.chunk_by(|a, b| a.s == b.s);
        let range = |group: &[Observation]| {
            end += group.len();
            end - group.len()..end
        };
        groups.map(range).collect()
    }
}

/// Another contour of the same parts: its points tell of the same machine.
#[derive(Clone, Copy, Debug)]
pub struct Companion<'a> {
    /// Its path.
    pub path: &'a Path<'a>,
    /// Its points of the parts, in their order.
    pub parts: &'a [PartPoints],
}

/// Fits machine and material to all parts, of which the companions' points are as well, with what they show beside both;
/// the wall law is the one given, or found. `progress` is told the share done.
pub fn joint(
    pass: &Pass,
    path: &Path,
    parts: &[PartPoints],
    companions: &[Companion<'_>],
    law: Option<WallLaw>,
    progress: &mut dyn FnMut(f64),
) -> Joint {
    // The points of a part stand together: those of the contour itself, then those of its companions.
    let (parts, others) = &whole(parts, companions);
    let companions: Vec<Companion<'_>> =
        companions.iter().zip(others).map(|(of, parts)| Companion { parts, ..*of }).collect();
    let newest = parts.last().map_or(0, |part| part.number);
    let mut cuts: Vec<PartCut<'_>> = Vec::new();
    for (part, own) in parts.iter().enumerate() {
        let others = companions.iter().enumerate().filter_map(|(k, companion)| {
            let points = companion.parts.iter().find(|other| other.number == own.number)?;
            Some((k + 1, *companion.path, points))
        });
        for (contour, path, points) in std::iter::once((0, *path, own)).chain(others) {
            let parts_ago = newest.saturating_sub(own.number).saturating_add(1).saturating_add(changed(&parts[part..]));
            let (nodes, observations) = (&points.nodes[..], &points.observations[..]);
            cuts.push(PartCut { path, contour, part, parts_ago, nodes, observations });
        }
    }
    let law = law.or(asked(pass.core.job.force.model));
    let found = plain(pass, law, &cuts, &mut |share| progress(0.5 * share));
    let (found, own, beside) = if pass.job.discrepancy {
        let relieved = relieved(&pass.core, found, &cuts, &mut |share| progress(0.5 + 0.5 * share));
        let along = relieved.along(path, 0);
        (relieved.found, relieved.own, relieved.discrepancy.map(|discrepancy| Beside { discrepancy, along }))
    } else {
        let own = own(&found, parts.len());
        (found, own, None)
    };
    let mut rest = found.observations.into_iter();
    let mut observations: Vec<Vec<Observation>> = Vec::new();
    for cut in &cuts {
        let own = rest.by_ref().take(cut.observations.len()).collect();
        if cut.contour == 0 {
            observations.push(own);
        }
    }
    Joint { core: found.core, observations, own, beside }
}

/// Steps that the changes of the cutter after the first of some parts count for.
fn changed(parts: &[PartPoints]) -> u32 {
    let changes = parts.windows(2).filter(|pair| pair[0].cutter_from != pair[1].cutter_from).count();
    CHANGE.saturating_mul(changes as u32)
}

/// The parts of a contour and of its companions, where a half of a pair tells nothing whose other half is in none of them: a part that
/// is set aside on one contour may count on the other.
fn whole(parts: &[PartPoints], companions: &[Companion<'_>]) -> (Vec<PartPoints>, Vec<Vec<PartPoints>>) {
    let numbers: HashSet<u32> = parts.iter().map(|part| part.number).collect();
    let mut halves: HashMap<u32, usize> = HashMap::new();
    let all = || std::iter::once(parts).chain(companions.iter().map(|companion| companion.parts));
    let fitted = all().flatten().filter(|part| numbers.contains(&part.number));
    for pair in fitted.flat_map(|part| &part.observations).filter_map(Observation::pair) {
        *halves.entry(pair).or_default() += 1;
    }
    let whole = |part: &PartPoints| {
        let mut part = part.clone();
        let is_half = |o: &&mut Observation| o.pair().is_some_and(|pair| halves.get(&pair) != Some(&2));
        part.observations.iter_mut().filter(is_half).for_each(|o| o.noise = SILENT);
        part
    };
    let each = |parts: &[PartPoints]| parts.iter().map(whole).collect::<Vec<_>>();
    (each(parts), companions.iter().map(|companion| each(companion.parts)).collect())
}
