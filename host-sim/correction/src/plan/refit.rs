//! Machine and material under the physics of several passes.
//!
//! An identification uses the model of one pass, whose instant forces are those of the mean engagement; the tool yields before they are
//! reached. What that is at the probed places is taken off the measurement, and the machine is identified anew, until neither
//! changes, because the one depends on the other. Where the tool yields by a good part of the allowance the two would swing from one
//! machine to another for ever; then they are brought together by half and less of what changes.

use truepath_core::cut::{Envelope, Path, State, WallLaw};
use truepath_core::geometry::Vector;
use truepath_core::identify::{Cut, Observation};
use truepath_core::process::{ImmersionGrid, Mill, Slices};
use truepath_core::units::{Offset, Real};
use truepath_ground::diagnostics::Failure;
use truepath_ground::units::{float, mm};

use super::bench::Bench;
use crate::correction::{Identification, MeasuredCut};
use crate::identification::{Found, Points, found};
use crate::surface::wall::at_height;

/// How often the machine is identified anew at most.
const ROUNDS: usize = 12;
/// The least share of a change that is gone.
const LEAST: Real = Real::ratio(1, 8);
/// What is taken off changes by no more than this when it has settled, or by no more than …
const SETTLED: Offset = Offset::from_nm(300);
/// … this share of the largest of it, because a robust fit is no smoother.
const SETTLED_SHARE: Real = Real::ratio(1, 50);

/// Machine and material under the physics of several passes.
pub struct Refitted {
    /// For each of the cuts.
    pub known: Vec<Identification>,
    /// How far what is taken off at a probed place still changes, where it does not settle.
    pub unsettled: Option<Offset>,
}

/// Identifies the machine anew from the points of all cuts; `coarse` are the paths on which their passes are compared, `known` what was
/// found before.
///
/// # Errors
/// Points that are not on the contour.
pub fn refit(cuts: &[MeasuredCut<'_>], coarse: &[Path], mut known: Vec<Identification>) -> Result<Refitted, Failure> {
    let Some(first) = cuts.first().filter(|_| known.iter().all(|known| known.law() != WallLaw::Mean)) else {
        return Ok(Refitted { known, unsettled: None });
    };
    let measured = cuts.iter().map(|cut| cut.measurement.observations()).collect::<Result<Vec<_>, _>>()?;
    let placed: Vec<Cut> = cuts
        .iter()
        .zip(&measured)
        .map(|(cut, points)| Cut { path: *cut.path, points: points.len(), part: 0 })
        .collect();
    let mut before = vec![Offset::ZERO; measured.iter().map(Vec::len).sum()];
    let (mut share, mut last) = (Real::ONE, None);
    for round in 0.. {
        let each = coarse.iter().zip(&known).zip(&measured);
        let now = each.flat_map(|((path, known), points)| yielded(path, known, points));
        let changes: Vec<Offset> = now.zip(&before).map(|(now, before)| now - *before).collect();
        let largest = changes.iter().map(|change| change.abs()).max().unwrap_or_default();
        let most = before.iter().map(|yielded| yielded.abs()).max().unwrap_or_default();
        if largest <= SETTLED.max(most.scaled(SETTLED_SHARE)) {
            break;
        }
        if round == ROUNDS {
            return Ok(Refitted { known, unsettled: Some(largest) });
        }
        // The first changes are measured from nothing.
        if last.is_some_and(|last: Offset| largest + largest > last) {
            share = (share * Real::HALF).max(LEAST);
        }
        last = (round > 0).then_some(largest);
        let yielded: Vec<Offset> =
            before.iter().zip(&changes).map(|(before, change)| *before + change.scaled(share)).collect();
        before.clone_from(&yielded);
        let mut shifted: Vec<Observation> = measured.concat();
        shifted.iter_mut().zip(&yielded).for_each(|(point, by)| point.error -= *by);
        let points = Points { cuts: &placed, earlier: &[], observations: &shifted, begin: None };
        let law = known.first().map(Identification::law);
        let Found { core, mut observations, .. } =
            found(&first.pass.core, law, points, |_, _| Vector::ZERO, &mut |_| ());
        for (point, by) in observations.iter_mut().zip(&yielded) {
            (point.error, point.predicted) = (point.error + *by, point.predicted + *by);
        }
        let mut rest = observations.into_iter();
        let own = |cut: &Cut| Identification { core, observations: rest.by_ref().take(cut.points).collect() };
        known = placed.iter().map(own).collect();
    }
    Ok(Refitted { known, unsettled: None })
}

/// How much more the uncorrected pass leaves at the probed places when the tool is in equilibrium at every instant.
fn yielded(path: &Path, known: &Identification, points: &[Observation]) -> Vec<Offset> {
    let (table, grid) = (known.table(), ImmersionGrid::new());
    let machine = known.machine(path, &table);
    let slices = Slices::of(path.setup(), 1);
    let walls = Bench::new(Mill::new(machine, &grid, slices), slices).programmed_walls();

    let working = path.working();
    let mut states = vec![State::REST; working.len()];
    machine.run(working.start, &mut states, |_| Vector::ZERO);
    let mut displacements = vec![Vector::ZERO; states.len()];
    let of_point = |point: &Observation| {
        let index = path.index_at(point.s);
        let own = index.checked_sub(path.first())?;
        let column = walls.get(own * slices.count()..(own + 1) * slices.count())?;
        let by_field = at_height(slices, float(point.height), |k| column[k].error.map(mm))?;
        Envelope::displace(&machine, &states, point.height, &mut displacements);
        let by_mean = Envelope::new(path, working.start, &displacements).error(index, index)?;
        Some(Offset::from_nm((by_field * 1e6).round() as i64) - by_mean.error - machine.undersize)
    };
    points.iter().map(of_point).map(Option::unwrap_or_default).collect()
}
