//! The wall of one pass, as the identified machine cuts it, with what is not known of it.
//!
//! Limits: what the points leave open is linearised about the identified machine; of a long contour five hundred places are drawn, the
//! worst of as many stretches. The ends of an open contour and sharp inside corners are not judged (see [`judged`]).

use rayon::prelude::*;
use truepath_core::correct::{Band, HEIGHTS, Node, commanded};
use truepath_core::cut::{Envelope, ForceTable, Loop, State};
use truepath_core::geometry::Vector;
use truepath_core::identify::{Parameters, neighbours};
use truepath_core::units::Offset;
use truepath_ground::units::{float, mm};

use super::causes::Causes;
use super::draws::{Beside, Predicted, Uncertain, largest};
use super::unmodelled::{unbent, unmodelled};
use super::wall::{WallFigures, judged, p95};
use crate::correction::Identification;
use crate::discrepancy::Along;

/// Places whose walls are drawn, at most.
const DRAWN_PLACES: usize = 500;
/// Heights of a place.
pub const COUNT: usize = HEIGHTS as usize;

/// The predicted error of a whole wall, at every height, mm. Values are means over the machines that the points allow.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct Surface {
    /// The largest error anywhere, the sign aside: the profile error.
    #[serde(flatten)]
    pub profile: Predicted,
    /// 95 of 100 places are nearer to the nominal wall than this.
    pub p95_mm: f64,
    /// Its standard deviation.
    pub p95_sigma_mm: f64,
    /// The largest mean over the height.
    pub mean_mm: f64,
    /// Its standard deviation.
    pub mean_sigma_mm: f64,
    /// Where the identified machine has its largest error, along the contour.
    pub s_mm: f64,
    /// Its height above the tip.
    pub height_mm: f64,
    /// What makes the error there.
    pub causes: Causes,
}

/// The wall of a pass without and with a correction.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct Surfaces {
    /// Without it.
    pub before: Surface,
    /// With it.
    pub after: Surface,
}

impl Surfaces {
    /// Of several contours: each wall is the worst of all.
    pub fn worst(all: impl Iterator<Item = Self> + Clone) -> Self {
        let worst = |of: fn(&Self) -> Surface| {
            let walls = all.clone().map(|both| of(&both));
            walls.max_by(|a, b| a.profile.profile_mm.total_cmp(&b.profile.profile_mm)).unwrap_or_default()
        };
        Self { before: worst(|both| both.before), after: worst(|both| both.after) }
    }

    /// Both in a sentence.
    pub fn words(&self) -> String {
        let (before, after) = (&self.before, &self.after);
        format!(
            "mean over the height {:.3} -> {:.3} mm; worst at any height {:.3} -> {:.3} ± {:.3} mm",
            before.mean_mm,
            after.mean_mm,
            before.profile.profile_mm,
            after.profile.profile_mm,
            2.0 * after.profile.sigma_mm
        )
    }
}

impl Surface {
    /// Of the wall that a machine, which was identified, leaves with a correction, empty for none; `beside` is what is beside it.
    pub fn predicted(machine: &Loop, known: &Identification, beside: &Along, nodes: &[Node]) -> Self {
        let path = machine.path;
        let (first, depth_mm) = (path.first(), float(path.setup().axial_depth));
        let places: Vec<(usize, f64)> = judged(path).collect();
        let indices: Vec<usize> = places.iter().map(|(index, _)| *index).collect();
        let all = errors(machine, nodes, &beside.mean, &indices);
        let columns: Vec<&[f64]> = all.chunks(COUNT).collect();
        let figures = WallFigures::over(places.iter().zip(&columns).map(|((_, s), c)| (*s, c.to_vec())));

        // Of every stretch the worst place.
        let stretch = places.len().div_ceil(DRAWN_PLACES).max(1);
        let worst_of = |from: usize| {
            let to = (from + stretch).min(places.len());
            (from..to).max_by(|a, b| largest(columns[*a]).total_cmp(&largest(columns[*b])))
        };
        let kept: Vec<usize> = (0..places.len()).step_by(stretch).filter_map(worst_of).collect();
        let drawn: Vec<usize> = kept.iter().map(|at| indices[*at]).collect();
        let base: Vec<f64> = kept.iter().flat_map(|at| columns[*at].iter().copied()).collect();

        let found = &known.fit().parameters;
        let noise = neighbours(known.prior(), known.fit()).map(|(other, share)| (Origin::Points, other, float(share)));
        let lacking = unmodelled(found).map(|other| (Origin::Model, other, 1.0));
        let machines: Vec<_> = noise.chain(lacking).chain([(Origin::Unbent, unbent(found), 1.0)]).collect();
        let cut = |(origin, other, share): &(Origin, Parameters, f64)| {
            let exponent = other.coefficients.size_exponent;
            let own = (exponent != machine.table.size_exponent()).then(|| Box::new(ForceTable::new(exponent)));
            let other = other.machine(path, own.as_deref().unwrap_or(machine.table));
            // Some columns move nothing but the datum of the part that was probed.
            let moves = !other.cuts_as(machine);
            let walls = moves.then(|| errors(&other, nodes, &beside.mean, &drawn))?;
            Some((*origin, walls.iter().zip(&base).map(|(wall, base)| (wall - base) * share).collect::<Vec<f64>>()))
        };
        let changes: Vec<_> = machines.par_iter().filter_map(cut).collect();
        let mut uncertain = Uncertain { heights: COUNT, base, ..Uncertain::default() };
        for (origin, change) in changes {
            match origin {
                Origin::Points => uncertain.noise.push(change),
                Origin::Model => uncertain.lacking.push(change),
                Origin::Unbent => uncertain.unbent = change,
            }
        }
        let of = |sigmas: &[Offset], index: usize| sigmas.get(index - first).copied().map_or(0.0, mm);
        let sigma = |index: usize| of(&beside.sigma, index);
        if !beside.repeat.is_empty() {
            // The level of force is one for the whole part.
            uncertain.lacking.push(drawn.iter().flat_map(|index| [of(&beside.repeat, *index); COUNT]).collect());
        }
        uncertain.beside = (!beside.sigma.is_empty()).then(|| Beside {
            places: kept.iter().map(|at| places[*at]).map(|(index, s)| (s, sigma(index))).collect(),
            reach_mm: mm(path.setup().radius),
        });
        let worst = kept.iter().position(|at| *at == figures.worst / COUNT).unwrap_or_default();
        let causes = uncertain.causes_at(worst * COUNT + figures.worst % COUNT);

        let mut magnitudes = Vec::new();
        let drawn = uncertain.draws(|wall| {
            magnitudes.clear();
            magnitudes.extend(wall.iter().map(|error| error.abs()));
            [largest(wall), p95(&mut magnitudes), largest_mean(wall)]
        });
        let [profile, p95, mean] = drawn.map(|draws| draws.predicted());
        Self {
            profile,
            p95_mm: p95.profile_mm,
            p95_sigma_mm: p95.sigma_mm,
            mean_mm: mean.profile_mm,
            mean_sigma_mm: mean.sigma_mm,
            s_mm: figures.worst_s_mm,
            height_mm: figures.worst_fraction * depth_mm,
            causes,
        }
    }
}

/// Why another machine is asked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Origin {
    /// The points do not tell it apart.
    Points,
    /// The model is not the cut.
    Model,
    /// Its cutter does not bend.
    Unbent,
}

/// The largest mean over the height, the sign aside.
fn largest_mean(errors: &[f64]) -> f64 {
    let means = errors.chunks(COUNT).map(|column| column.iter().sum::<f64>() / COUNT as f64);
    means.fold(0.0, |most, mean| most.max(mean.abs()))
}

/// The wall errors that a machine leaves with a correction, empty for none, at samples of its path, mm: sample by sample, in each at
/// [`COUNT`] even heights from the tip up; zero where no wall stands.
pub fn errors(machine: &Loop, nodes: &[Node], residual: &[Offset], places: &[usize]) -> Vec<f64> {
    let path = machine.path;
    let start = path.working().start;
    let mut states = vec![State::REST; path.working().len()];
    machine.run(start, &mut states, |index| commanded(path, nodes, index));
    let row = |k: usize| {
        let mut displacements = vec![Vector::ZERO; states.len()];
        Envelope::displace(machine, &states, Band::WHOLE.at(k as i64), &mut displacements);
        let envelope = Envelope::new(path, start, &displacements);
        // The wall beside a place is made about as far before or behind it as beside the place before.
        let mut ahead = 0isize;
        let beside = |index: &usize| {
            let wall = envelope.error(*index, index.saturating_add_signed(ahead))?;
            ahead = wall.made_by as isize - *index as isize;
            let residual = residual.get(index - path.first()).copied().unwrap_or_default();
            Some(mm(wall.error + machine.undersize + residual))
        };
        places.iter().map(beside).map(Option::unwrap_or_default).collect::<Vec<f64>>()
    };
    let rows: Vec<Vec<f64>> = (0..COUNT).into_par_iter().map(row).collect();
    (0..places.len()).flat_map(|at| rows.iter().map(move |row| row[at])).collect()
}
