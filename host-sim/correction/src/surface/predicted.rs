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
use truepath_ground::rows::largest;
use truepath_ground::units::{float, mm};

use super::draws::{Beside, Uncertain};
use super::expected::Surface;
use super::unmodelled::{unbent, unmodelled};
use super::wall::{WallFigures, judged};
use crate::correction::Identification;
use crate::discrepancy::Along;

/// Places whose walls are drawn, at most.
const DRAWN_PLACES: usize = 500;
/// Heights of a place.
pub const COUNT: usize = HEIGHTS as usize;

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

        // Of every stretch the worst place; of several as bad as the worst of all, that one.
        let stretch = places.len().div_ceil(DRAWN_PLACES).max(1);
        let worst_place = figures.worst / COUNT;
        let worst_of = |from: usize| {
            let to = (from + stretch).min(places.len());
            let of_all = (from..to).contains(&worst_place).then_some(worst_place);
            of_all.or_else(|| (from..to).max_by(|a, b| largest(columns[*a]).total_cmp(&largest(columns[*b]))))
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
        let worst = worst_place / stretch * COUNT + figures.worst % COUNT;
        let place = (figures.worst_s_mm, figures.worst_fraction * depth_mm);
        Self::of(&uncertain, worst, place).0
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
