//! The walls of a pass, cut and read by all processors.
//!
//! The cutter is run over several stretches at a time, each from a few samples before it: the loop forgets where it began, and that it has
//! is seen where the stretch before ends. Where it ends with another deflection, the stretch is run again, so that the bits are those of
//! one run from start to end whatever the number of threads.
//!
//! A design reads the walls some thirty times, at thirteen heights that do not depend on each other
//! ([`truepath_core::correct::WallReader`]). The cutter's positions at all heights of a sample are found together, since they share
//! most of the force, and those of one stretch beside those of another; then half of the heights are read on a thread of their own.
//! Where walls are asked for at a few places only, the cutter's positions are found where one of them asks.

use std::cell::RefCell;

use rayon::prelude::*;
use rayon::{current_num_threads, join};
use truepath_core::correct::{Band, HEIGHTS, Profile, WallReader, begin, finish, read_slice};
use truepath_core::cut::{Displacements, Envelope, Heights, Kept, Loop, Passage, Path, State, WallError};
use truepath_core::geometry::Vector;
use truepath_core::units::{Offset, Real};

/// Slices of the band.
const SLICES: usize = HEIGHTS as usize;
/// Samples of a stretch that is not divided among threads.
const STRETCH: usize = 512;
/// Least samples of a stretch that the cutter is run over by itself, and before it.
const RUN: usize = 2048;
const LEAD: usize = 64;
/// Places that have so many samples each are few: of most samples nobody asks where the cutter is.
const FEW: usize = 16;

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
pub fn run(
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

/// The wall errors that states of a run over the working samples of a path leave beside places, which are samples of it, at heights of
/// the engaged depth; `None` where no wall stands.
pub fn walls_at<const N: usize>(
    machine: &Loop,
    states: &[State],
    heights: [Real; N],
    places: &[usize],
) -> Vec<[Option<Offset>; N]> {
    if are_few(states, places) {
        return walls_at_few(machine, states.len(), |slot| states.get(slot).copied(), heights, places);
    }
    let mut displacements: [Vec<Vector>; N] = std::array::from_fn(|_| vec![Vector::ZERO; states.len()]);
    displace(machine, states, heights, displacements.each_mut().map(Vec::as_mut_slice));
    let row = |displacements: &Vec<Vector>| {
        let envelope = Envelope::new(machine.path, machine.path.working().start, displacements);
        let mut ahead = 0;
        let mut wall = |place: usize| beside(machine, place, &mut ahead, |guess| envelope.error(place, guess));
        places.iter().map(|place| wall(*place)).collect::<Vec<_>>()
    };
    let rows: Vec<Vec<Option<Offset>>> = displacements.par_iter().map(row).collect();
    (0..places.len()).map(|at| std::array::from_fn(|height| rows[height][at])).collect()
}

/// The same of a machine that differs little from one with known states and cuts with the same commands. Where the places are few each
/// state that makes a wall is found by itself, from the known one: within the tolerance of the elastic loop, some nanometres, that of a
/// run from start to end.
pub(crate) fn walls_near<const N: usize>(
    machine: &Loop,
    known: &[State],
    heights: [Real; N],
    places: &[usize],
) -> Vec<[Option<Offset>; N]> {
    let start = machine.path.working().start;
    if are_few(known, places) {
        let mut kept = Kept::default();
        let state = |slot: usize| {
            let State { commanded, displacement, .. } = *known.get(slot)?;
            machine.state(&mut kept, start + slot, commanded, displacement).map(|(state, _)| state)
        };
        return walls_at_few(machine, known.len(), state, heights, places);
    }
    let mut states = vec![State::REST; known.len()];
    run(machine, start, &mut states, &|index| known.get(index - start).map_or(Vector::ZERO, |state| state.commanded));
    walls_at(machine, &states, heights, places)
}

fn are_few(states: &[State], places: &[usize]) -> bool {
    places.len() * FEW <= states.len()
}

/// From states that are asked for one by one, counted from the first of so many.
fn walls_at_few<const N: usize>(
    machine: &Loop,
    states: usize,
    state: impl FnMut(usize) -> Option<State>,
    heights: [Real; N],
    places: &[usize],
) -> Vec<[Option<Offset>; N]> {
    let (path, start) = (machine.path, machine.path.working().start);
    let heights = Heights::new(machine, heights);
    let sought = RefCell::new(Sought { machine, state, heights, slots: vec![0; states], known: Vec::new() });
    let mut envelopes: [_; N] =
        std::array::from_fn(|height| (Envelope::of(path, start, AtHeight { of: &sought, height }), 0));
    let mut each = |place: usize| {
        envelopes.each_mut().map(|(envelope, ahead)| beside(machine, place, ahead, |guess| envelope.read(place, guess)))
    };
    places.iter().map(|place| each(*place)).collect()
}

/// The wall error beside a place, made about as far before or behind it as that beside the place before.
fn beside(
    machine: &Loop,
    place: usize,
    ahead: &mut isize,
    error: impl FnOnce(usize) -> Option<WallError>,
) -> Option<Offset> {
    let wall = error(place.saturating_add_signed(*ahead))?;
    *ahead = wall.made_by as isize - place as isize;
    Some(wall.error + machine.undersize)
}

/// Displacements at all heights of the samples that were asked for.
struct Sought<'a, S, const N: usize> {
    machine: &'a Loop<'a>,
    state: S,
    heights: Heights<N>,
    /// Where they are among the known ones, for every sample, counted from 1; 0 for nowhere.
    slots: Vec<u32>,
    known: Vec<[Vector; N]>,
}

/// Those of one height.
struct AtHeight<'s, 'a, S, const N: usize> {
    of: &'s RefCell<Sought<'a, S, N>>,
    height: usize,
}

impl<S: FnMut(usize) -> Option<State>, const N: usize> Displacements for AtHeight<'_, '_, S, N> {
    fn displacement(&mut self, slot: usize) -> Option<Vector> {
        let mut sought = self.of.borrow_mut();
        let Sought { machine, state, heights, slots, known } = &mut *sought;
        let at = slots.get_mut(slot)?;
        if *at == 0 {
            known.push(machine.at_heights(heights, &state(slot)?));
            *at = known.len() as u32;
        }
        known.get(*at as usize - 1)?.get(self.height).copied()
    }
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
