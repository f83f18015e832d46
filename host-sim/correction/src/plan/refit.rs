//! Machine and material under the physics of several passes.
//!
//! An identification uses the model of one pass, whose instant forces are those of the mean engagement; the tool yields before they are
//! reached. What that is at the probed places is taken off the measurement, and the machine is identified anew; twice, because it
//! depends on the machine.

use truepath_core::cut::{Envelope, Path, State, WallLaw};
use truepath_core::geometry::Vector;
use truepath_core::identify::{Cut, Observation};
use truepath_core::process::{Depths, ImmersionGrid, Mill, Order, Part, Slices, Wall};
use truepath_core::units::{Offset, Real};
use truepath_ground::diagnostics::Failure;
use truepath_ground::units::{float, mm};
use truepath_job::measurement::Measurement;
use truepath_job::pass::Pass;

use crate::correction::Identification;
use crate::identification::{Found, Points, found};

/// How often the machine is identified anew.
const ROUNDS: usize = 2;

/// Identifies the machine anew. `coarse` is the path on which the passes are compared, `sampled` that of the identification.
///
/// # Errors
/// Points that are not on the contour.
pub fn refit(
    pass: &Pass,
    (sampled, coarse): (&Path, &Path),
    measurement: &Measurement,
    known: &Identification,
) -> Result<Identification, Failure> {
    let mut known = known.clone();
    if known.law() == WallLaw::Mean {
        return Ok(known);
    }
    let measured = measurement.observations()?;
    for _ in 0..ROUNDS {
        let yielded = yielded(coarse, &known, &measured);
        let mut shifted = measured.clone();
        shifted.iter_mut().zip(&yielded).for_each(|(point, by)| point.error -= *by);
        let cuts = [Cut { path: *sampled, points: shifted.len(), part: 0 }];
        let points = Points { cuts: &cuts, earlier: &[], observations: &shifted };
        let Found { core, mut observations, .. } =
            found(&pass.core, Some(known.law()), points, |_, _| Vector::ZERO, &mut |_| ());
        for (point, by) in observations.iter_mut().zip(&yielded) {
            (point.error, point.predicted) = (point.error + *by, point.predicted + *by);
        }
        known = Identification { core, observations };
    }
    Ok(known)
}

/// How much more the uncorrected pass leaves at the probed places when the tool is in equilibrium at every instant.
fn yielded(path: &Path, known: &Identification, points: &[Observation]) -> Vec<Offset> {
    let (table, grid) = (known.table(), ImmersionGrid::new());
    let machine = known.machine(path, &table);
    let slices = Slices::of(path.setup(), 1);
    let mill = Mill::new(machine, &grid, slices);
    let order = Order { first: 0, reversed: false, feed: Real::ONE };
    let mut left = vec![Offset::ZERO; Part::needed(path, slices)];
    let Some(part) = Part::raw(path, slices, &mut left) else { return vec![Offset::ZERO; points.len()] };
    let mut moved = vec![Vector::ZERO; mill.displacements_needed()];
    let mut walls = vec![Wall::default(); mill.walls_needed()];
    let mut depths = Box::new(Depths::NONE);
    mill.run(&part, &order, |_| Vector::ZERO, &mut depths, &mut moved);
    mill.walls(&order, &moved, &mut walls);

    let working = path.working();
    let mut states = vec![State::REST; working.len()];
    machine.run(working.start, &mut states, |_| Vector::ZERO);
    let mut displacements = vec![Vector::ZERO; states.len()];
    let count = slices.count();
    let of_point = |point: &Observation| {
        let index = path.index_at(point.s);
        let own = index.checked_sub(path.first())?;
        let column = walls.get(own * count..(own + 1) * count)?;
        // Between the middles of the slices, and beyond the last of them as at it.
        let at = (float(point.height) * count as f64 - 0.5).clamp(0.0, (count - 1) as f64);
        let (below, share) = (at as usize, at.fract());
        let error = |k: usize| column.get(k.min(count - 1))?.error.map(mm);
        let by_field = error(below)? * (1.0 - share) + error(below + 1)? * share;
        Envelope::displace(&machine, &states, point.height, &mut displacements);
        let by_mean = Envelope::new(path, working.start, &displacements).error(index, index)?;
        Some(Offset::from_nm((by_field * 1e6).round() as i64) - by_mean.error - machine.undersize)
    };
    points.iter().map(of_point).map(Option::unwrap_or_default).collect()
}
