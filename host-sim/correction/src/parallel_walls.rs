//! The walls of a pass, cut and read by all processors.
//!
//! The cutter is run over several stretches at a time, each from a few samples before it: the loop forgets where it began, and that it has
//! is seen where the stretch before ends. Where it ends with another deflection, the stretch is run again, so that the bits are those of
//! one run from start to end whatever the number of threads.
//!
//! A design reads the walls some thirty times, at thirteen heights that do not depend on each other
//! ([`truepath_core::correct::WallReader`]). The cutter's positions at all heights of a sample are found together, since they share
//! most of the force, and those of one stretch beside those of another; then half of the heights are read on a thread of their own.

use rayon::prelude::*;
use rayon::{current_num_threads, join};
use truepath_core::correct::{Band, HEIGHTS, Profile, WallReader, begin, finish, read_slice};
use truepath_core::cut::{Envelope, Loop, Passage, Path, State};
use truepath_core::geometry::Vector;
use truepath_core::units::Real;

/// Slices of the band.
const SLICES: usize = HEIGHTS as usize;
/// Samples of a stretch that is not divided among threads.
const STRETCH: usize = 512;
/// Least samples of a stretch that the cutter is run over by itself, and before it.
const RUN: usize = 2048;
const LEAD: usize = 64;

/// Memory for the heights.
#[derive(Clone, Debug)]
pub struct ParallelWalls {
    rows: [Vec<Vector>; SLICES + 1],
    profiles: Vec<Profile>,
}

impl ParallelWalls {
    /// For a path.
    pub(crate) fn of(path: &Path) -> Self {
        let row = || vec![Vector::ZERO; path.working().len()];
        Self { rows: std::array::from_fn(|_| row()), profiles: vec![Profile::default(); path.count()] }
    }
}

impl WallReader for ParallelWalls {
    fn run(
        &mut self,
        machine: &Loop,
        from: usize,
        states: &mut [State],
        commanded: impl Fn(usize) -> Vector + Sync,
        observe: &mut dyn FnMut(usize),
    ) -> Passage {
        let end = from + states.len();
        let passage = run(machine, from, states, &commanded);
        observe(end);
        passage
    }

    fn profile(&mut self, machine: &Loop, states: &[State], band: Band, _: &mut [Vector], profiles: &mut [Profile]) {
        let Self { rows, profiles: others } = self;
        let tip = SLICES;
        let height = |k: usize| if k == tip { Real::ZERO } else { band.at(k as i64) };
        displace(machine, states, std::array::from_fn(height), rows.each_mut().map(Vec::as_mut_slice));
        begin(machine, profiles);
        begin(machine, others);
        let slices: Vec<(i64, &Vec<Vector>)> = (0..HEIGHTS).zip(&*rows).collect();
        let (lower, upper) = slices.split_at(SLICES / 2);
        let read = |slices: &[(i64, &Vec<Vector>)], profiles: &mut [Profile]| {
            slices.iter().for_each(|(slice, row)| read_slice(machine, *slice, row, profiles));
        };
        join(|| read(lower, profiles), || read(upper, others));
        for (own, other) in profiles.iter_mut().zip(&*others) {
            own.join(other);
        }
        finish(machine, &rows[tip], profiles);
    }
}

/// The cutter's displacements at heights of the engaged depth, one row each, of several stretches at a time.
pub(crate) fn displace<const N: usize>(machine: &Loop, states: &[State], heights: [Real; N], rows: [&mut [Vector]; N]) {
    if states.len() <= STRETCH {
        return Envelope::displace_all(machine, states, heights, rows);
    }
    let (near, far) = states.split_at(states.len() / 2);
    let mut halves = rows.map(|row| row.split_at_mut(near.len()));
    let near_rows = halves.each_mut().map(|(near, _)| std::mem::take(near));
    let far_rows = halves.map(|(_, far)| far);
    join(|| displace(machine, near, heights, near_rows), || displace(machine, far, heights, far_rows));
}

/// As [`Loop::run`], to the last bit, on all processors.
pub(crate) fn run(
    machine: &Loop,
    from: usize,
    states: &mut [State],
    commanded: &(impl Fn(usize) -> Vector + Sync),
) -> Passage {
    let stretches = (states.len() / RUN).clamp(1, current_num_threads());
    let length = states.len().div_ceil(stretches);
    stretch_by_stretch(machine, from, states, commanded, (length, LEAD))
}

/// Over stretches of a length, each from as many samples before it as `lead` says, which is less.
fn stretch_by_stretch(
    machine: &Loop,
    from: usize,
    states: &mut [State],
    commanded: &(impl Fn(usize) -> Vector + Sync),
    (length, lead): (usize, usize),
) -> Passage {
    let length = length.max(1);
    let each = |(k, states): (usize, &mut [State])| {
        let from = from + k * length;
        let mut begins = Vector::ZERO;
        if k > 0 {
            machine.run_on(from - lead, &mut begins, &mut vec![State::REST; lead], commanded);
        }
        let mut ends = begins;
        let passage = machine.run_on(from, &mut ends, states, commanded);
        (begins, ends, passage)
    };
    let each: Vec<_> = states.par_chunks_mut(length).enumerate().map(each).collect();
    let (mut ended, mut all) = (Vector::ZERO, Passage::default());
    for ((k, states), (begins, ends, passage)) in states.chunks_mut(length).enumerate().zip(each) {
        if begins == ended {
            (ended, all) = (ends, all.and(passage));
        } else {
            all = all.and(machine.run_on(from + k * length, &mut ended, states, commanded));
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use truepath_core::cut::{Coefficients, Compliance, CutSetup, ForceTable, Milling, Runout, Sample, WallLaw};
    use truepath_core::geometry::{Block, Contour, Curve, Point, Side};
    use truepath_core::units::Offset;

    #[test]
    fn a_run_in_stretches_is_the_one_from_start_to_end_however_far_before_each_begins() {
        let setup = CutSetup {
            radius: Offset::from_um(6_000),
            teeth: 4,
            helix_deg: Real::from_int(30),
            axial_depth: Real::from_int(10),
            allowance: Offset::from_um(500),
            spindle_rpm: Real::from_int(4000),
            wall: Side::Right,
            milling: Milling::of(Side::Right, true),
            law: WallLaw::Helical,
            runout: Runout::NONE,
        };
        // Facets of a wave.
        let at = |k: i64| Point::from_nm(k * 1_000_000, (200_000.0 * (k as f64 * 0.7).sin()) as i64);
        let mut s = Offset::ZERO;
        let blocks = (0..60u32).map(|k| {
            let curve = Curve::line(at(k.into()), at(i64::from(k) + 1)).unwrap();
            let block = Block { curve, s, feed: Real::from_int(800), line: k };
            s += curve.length();
            block
        });
        let blocks: Vec<Block> = blocks.collect();
        let contour = Contour::new(&blocks).unwrap();
        let step = Offset::from_um(100);
        let mut buffer = vec![Sample::BLANK; Path::samples_needed(&contour, &setup, step)];
        let path = Path::sample(&contour, &setup, step, &mut buffer, |_| ()).unwrap();
        let table = ForceTable::new(Real::ZERO);
        let [ktc, krc, edge] = [820, 230, 12].map(Real::from_int);
        let coefficients = Coefficients { ktc, krc, kte: edge, kre: edge, size_exponent: Real::ZERO };
        let compliance = Compliance::from_stiffness(Real::from_int(1900), Real::from_int(1900));
        let machine = Loop { path: &path, table: &table, coefficients, compliance, undersize: Offset::ZERO };
        let commanded = |index: usize| Vector::from_nm(index as i64 % 7 * 3_000, 20_000);
        let working = path.working();
        let mut whole = vec![State::REST; working.len()];
        let passage = machine.run(working.start, &mut whole, commanded);
        // From one sample before it the loop ends otherwise, and the stretch is run again.
        for apart in [(200, 64), (150, 1), (200, 0), (5_000, 64)] {
            let mut states = vec![State::REST; working.len()];
            assert_eq!(stretch_by_stretch(&machine, working.start, &mut states, &commanded, apart), passage);
            assert_eq!(states, whole, "{apart:?}");
        }
    }
}
