//! Machine and material under the physics of several passes.
//!
//! An identification uses the model of one pass, whose instant forces are those of the mean engagement; the tool yields before they are
//! reached. What that is at the probed places is taken off the measurement, and the machine is identified anew, until neither
//! changes, because the one depends on the other.

use truepath_core::cut::{Envelope, Path, State, WallLaw};
use truepath_core::geometry::Vector;
use truepath_core::identify::{Cut, Observation};
use truepath_core::process::{ImmersionGrid, Mill, Slices};
use truepath_core::units::Offset;
use truepath_ground::diagnostics::Failure;
use truepath_ground::units::{float, mm};

use super::bench::Bench;
use crate::correction::{Identification, MeasuredCut};
use crate::identification::{Found, Points, found};
use crate::surface::wall::at_height;

/// How often the machine is identified anew at most.
const ROUNDS: usize = 6;
/// What is taken off changes by no more than this when it has settled.
const SETTLED: Offset = Offset::from_nm(300);

/// Identifies the machine anew from the points of all cuts; `coarse` are the paths on which their passes are compared, `known` what was
/// found before.
///
/// # Errors
/// Points that are not on the contour.
pub fn refit(
    cuts: &[MeasuredCut<'_>],
    coarse: &[Path],
    mut known: Vec<Identification>,
) -> Result<Vec<Identification>, Failure> {
    let Some(first) = cuts.first().filter(|_| known.iter().all(|known| known.law() != WallLaw::Mean)) else {
        return Ok(known);
    };
    let measured = cuts.iter().map(|cut| cut.measurement.observations()).collect::<Result<Vec<_>, _>>()?;
    let placed: Vec<Cut> = cuts
        .iter()
        .zip(&measured)
        .map(|(cut, points)| Cut { path: *cut.path, points: points.len(), part: 0 })
        .collect();
    let mut before = vec![Offset::ZERO; measured.iter().map(Vec::len).sum()];
    for _ in 0..ROUNDS {
        let each = coarse.iter().zip(&known).zip(&measured);
        let yielded: Vec<Offset> = each.flat_map(|((path, known), points)| yielded(path, known, points)).collect();
        if yielded.iter().zip(&before).all(|(now, before)| (*now - *before).abs() <= SETTLED) {
            break;
        }
        before.clone_from(&yielded);
        let mut shifted: Vec<Observation> = measured.concat();
        shifted.iter_mut().zip(&yielded).for_each(|(point, by)| point.error -= *by);
        let points = Points { cuts: &placed, earlier: &[], observations: &shifted };
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
    Ok(known)
}

/// How much more the uncorrected pass leaves at the probed places when the tool is in equilibrium at every instant.
fn yielded(path: &Path, known: &Identification, points: &[Observation]) -> Vec<Offset> {
    let (table, grid) = (known.table(), ImmersionGrid::new());
    let machine = known.machine(path, &table);
    let slices = Slices::of(path.setup(), 1);
    let walls = Bench::new(Mill::new(machine, &grid, slices), slices, 0.0).programmed_walls();

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
