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
use std::ops::Range;

use rayon::prelude::*;
use rayon::{current_num_threads, join};
use truepath_core::correct::{Again, Band, HEIGHTS, Height, Profile, Scratch, WallReader, begin, finish, read};
use truepath_core::cut::{Displacements, Envelope, Heights, Kept, Loop, Passage, Path, State, WallError, left_by};
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
    /// The band of the rows, and which states have changed since.
    band: Option<Band>,
    moved: Vec<bool>,
    profiles: Vec<Profile>,
}

impl ParallelWalls {
    /// For a path.
    pub(crate) fn of(path: &Path) -> Self {
        let row = || vec![Vector::ZERO; path.working().len()];
        Self {
            rows: std::array::from_fn(|_| row()),
            band: None,
            moved: vec![true; path.working().len()],
            profiles: vec![Profile::default(); path.count()],
        }
    }
}

impl WallReader for ParallelWalls {
    fn run(
        &mut self,
        machine: &Loop,
        from: usize,
        states: &mut [State],
        again: Again,
        commanded: impl Fn(usize) -> Vector + Sync,
        seen: &mut dyn FnMut(usize, bool),
    ) -> Passage {
        let mut moved = vec![false; states.len()];
        let passage = run_again(machine, from, (states, again), &commanded, &mut moved);
        for (index, moved) in (from..).zip(&moved) {
            seen(index, *moved);
        }
        self.moved.iter_mut().zip(&moved).for_each(|(known, now)| *known |= now);
        passage
    }

    fn profile(&mut self, machine: &Loop, states: &[State], band: Band, _: &mut [Vector], profiles: &mut [Profile]) {
        let Self { rows, band: known, moved, profiles: others } = self;
        if known.replace(band) != Some(band) {
            moved.fill(true);
        }
        let tip = SLICES;
        let height = |k: usize| if k == tip { Real::ZERO } else { band.at(k as i64) };
        for stretch in stretches(moved) {
            let rows = rows.each_mut().map(|row| &mut row[stretch.clone()]);
            displace(machine, &states[stretch], std::array::from_fn(height), rows);
        }
        moved.fill(false);
        others.copy_from_slice(profiles);
        begin(machine, profiles);
        begin(machine, others);
        let slices: Vec<(i64, &Vec<Vector>)> = (0..HEIGHTS).zip(&*rows).collect();
        let (lower, upper) = slices.split_at(SLICES / 2);
        let each = |slices: &[(i64, &Vec<Vector>)], profiles: &mut [Profile]| {
            slices.iter().for_each(|(slice, row)| read(machine, Height::Slice(*slice), row.as_slice(), profiles));
        };
        join(|| each(lower, profiles), || each(upper, others));
        for (own, other) in profiles.iter_mut().zip(&*others) {
            own.join(other);
        }
        read(machine, Height::Tip, rows[tip].as_slice(), profiles);
        finish(machine, profiles);
    }

    fn each(&mut self, slots: &mut [Scratch], length: usize, work: impl Fn(usize, &mut [Scratch]) + Sync) {
        let length = length.max(1);
        slots.par_chunks_mut(length).enumerate().for_each(|(k, piece)| work(k * length, piece));
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

/// Runs of slots that are marked.
fn stretches(marks: &[bool]) -> Vec<Range<usize>> {
    let (mut all, mut from) = (Vec::new(), 0);
    for run in marks.chunk_by(|a, b| a == b) {
        if run[0] {
            all.push(from..from + run.len());
        }
        from += run.len();
    }
    all
}

/// As [`Loop::run`], to the last bit, on all processors.
pub fn run(
    machine: &Loop,
    from: usize,
    states: &mut [State],
    commanded: &(impl Fn(usize) -> Vector + Sync),
) -> Passage {
    let mut moved = vec![false; states.len()];
    run_again(machine, from, (states, Again::Afresh), commanded, &mut moved)
}

/// The same with what is known of the run before. States that may have changed are marked.
fn run_again(
    machine: &Loop,
    from: usize,
    (states, again): (&mut [State], Again),
    commanded: &(impl Fn(usize) -> Vector + Sync),
    moved: &mut [bool],
) -> Passage {
    let stretches = (states.len() / RUN).clamp(1, current_num_threads());
    let length = states.len().div_ceil(stretches);
    stretch_by_stretch(machine, from, (states, again), commanded, (length, LEAD), moved)
}

/// Over stretches of a length, each from as many samples before it as `lead` says, which is less.
fn stretch_by_stretch(
    machine: &Loop,
    from: usize,
    (states, again): (&mut [State], Again),
    commanded: &(impl Fn(usize) -> Vector + Sync),
    (length, lead): (usize, usize),
    moved: &mut [bool],
) -> Passage {
    let length = length.max(1);
    // With which deflection the stretch before each has ended, as it was: that of the last sample at which the path does not turn on the
    // spot.
    let ended = |slot: usize, states: &[State]| {
        let last = (0..slot).rev().find(|slot| !machine.path.is_pivot(from + slot));
        again.knows(last.map_or(Vector::ZERO, |last| states[last].displacement))
    };
    let leads: Vec<_> = (0..states.len())
        .step_by(length)
        .map(|at| {
            let begins = at.saturating_sub(lead);
            (states[begins..at].to_vec(), ended(begins, states), ended(at, states))
        })
        .collect();
    type Lead = (Vec<State>, Option<Vector>, Option<Vector>);
    type Stretch<'s> = ((&'s mut [State], &'s mut [bool]), Lead);
    let each = |(k, ((states, moved), lead)): (usize, Stretch<'_>)| {
        let from = from + k * length;
        let (mut lead, before_lead, before) = lead;
        let mut begins = before_lead.unwrap_or(Vector::ZERO);
        machine.run_on(from - lead.len(), (&mut begins, before_lead), &mut lead, commanded, |_, _| ());
        let mut ends = begins;
        let mark = |index: usize, has_moved| moved[index - from] = has_moved;
        let passage = machine.run_on(from, (&mut ends, before), states, commanded, mark);
        (begins, ends, passage)
    };
    let stretches = states.par_chunks_mut(length).zip(moved.par_chunks_mut(length)).zip(leads);
    let each: Vec<_> = stretches.enumerate().map(each).collect();
    let (mut ended, mut all) = (Vector::ZERO, Passage::default());
    let stretches = states.chunks_mut(length).zip(moved.chunks_mut(length)).enumerate();
    for ((k, (states, moved)), (begins, ends, passage)) in stretches.zip(each) {
        if begins == ended {
            (ended, all) = (ends, all.and(passage));
        } else {
            let from = from + k * length;
            let mark = |index: usize, has_moved| moved[index - from] |= has_moved;
            all = all.and(machine.run_on(from, (&mut ended, Some(begins)), states, commanded, mark));
        }
    }
    all
}

/// The walls that states of a run over the working samples of a path leave beside places, which are samples of it, at heights of
/// the engaged depth; `None` where no wall stands.
pub fn walls_at<const N: usize>(
    machine: &Loop,
    states: &[State],
    heights: [Real; N],
    places: &[usize],
) -> Vec<[Option<WallError>; N]> {
    if places.len() * FEW <= states.len() {
        return walls_at_few(machine, states, heights, places);
    }
    let mut displacements: [Vec<Vector>; N] = std::array::from_fn(|_| vec![Vector::ZERO; states.len()]);
    displace(machine, states, heights, displacements.each_mut().map(Vec::as_mut_slice));
    let row = |displacements: &Vec<Vector>| {
        let envelope = Envelope::new(machine.path, machine.path.working().start, displacements);
        let mut ahead = 0;
        let mut wall = |place: usize| beside(machine, place, &mut ahead, |guess| envelope.error(place, guess));
        places.iter().map(|place| wall(*place)).collect::<Vec<_>>()
    };
    let rows: Vec<Vec<Option<WallError>>> = displacements.par_iter().map(row).collect();
    (0..places.len()).map(|at| std::array::from_fn(|height| rows[height][at])).collect()
}

/// The same of few places: the cutter is found where one of them asks for it.
fn walls_at_few<const N: usize>(
    machine: &Loop,
    states: &[State],
    heights: [Real; N],
    places: &[usize],
) -> Vec<[Option<WallError>; N]> {
    let (path, start) = (machine.path, machine.path.working().start);
    let sought = RefCell::new(Sought::of(machine, states.len(), heights, |slot| states.get(slot).copied()));
    let mut envelopes: [_; N] =
        std::array::from_fn(|height| (Envelope::of(path, start, AtHeight { of: &sought, height }), 0));
    let mut each = |place: usize| {
        envelopes.each_mut().map(|(envelope, ahead)| beside(machine, place, ahead, |guess| envelope.read(place, guess)))
    };
    places.iter().map(|place| each(*place)).collect()
}

/// The wall beside a place, made about as far before or behind it as that beside the place before.
fn beside(
    machine: &Loop,
    place: usize,
    ahead: &mut isize,
    wall: impl FnOnce(usize) -> Option<WallError>,
) -> Option<WallError> {
    let wall = wall(place.saturating_add_signed(*ahead))?;
    *ahead = wall.made_by as isize - place as isize;
    Some(WallError { error: wall.error + machine.undersize, ..wall })
}

/// Walls beside places at heights of the engaged depth, with the cutter positions that made them, to say how other machines would move
/// them.
pub(crate) struct CutWalls<'a, const N: usize> {
    machine: &'a Loop<'a>,
    /// States over the working samples of the path.
    states: &'a [State],
    heights: [Real; N],
    places: Vec<usize>,
    /// For every place and height the sample nearest to where the wall is made, and how far the cutter ends short of it there.
    made: Vec<[Option<(usize, Offset)>; N]>,
}

impl<'a, const N: usize> CutWalls<'a, N> {
    /// Of a machine with its states and some of its walls.
    pub(crate) fn of(
        (machine, states): (&'a Loop<'a>, &'a [State]),
        heights: [Real; N],
        walls: impl Iterator<Item = (usize, [Option<WallError>; N])>,
    ) -> Self {
        let start = machine.path.working().start;
        let mut makers = Makers::of(machine, heights, |maker| states.get(maker.checked_sub(start)?).copied());
        let (places, made) = walls
            .map(|(place, column)| {
                let made = std::array::from_fn(|height| {
                    let maker = column[height]?.made_by;
                    Some((maker, makers.short_of(place, maker, height)?))
                });
                (place, made)
            })
            .unzip();
        Self { machine, states, heights, places, made }
    }

    /// How another machine, which cuts with the same commands, moves the walls: as it moves the cutter positions that made them, each
    /// found from that of this machine. That another position may make them then is of second order. Zero where no wall stands.
    pub(crate) fn moved_by(&self, other: &Loop) -> Vec<[Offset; N]> {
        let Self { machine, states, heights, .. } = *self;
        let start = machine.path.working().start;
        // By how much its deflection is another one hardly changes from place to place.
        let (mut kept, mut change) = (Kept::default(), Vector::ZERO);
        let state = |maker: usize| {
            let State { commanded, displacement, .. } = *states.get(maker.checked_sub(start)?)?;
            let (state, _) = other.state(&mut kept, maker, commanded, displacement + change)?;
            change = state.displacement - displacement;
            Some(state)
        };
        let mut makers = Makers::of(other, heights, state);
        let smaller = other.undersize - machine.undersize;
        let mut moved = |place: usize, height: usize, (maker, before): (usize, Offset)| {
            Some(makers.short_of(place, maker, height)? - before + smaller)
        };
        let each = |(place, column): (&usize, &[Option<(usize, Offset)>; N])| {
            std::array::from_fn(|height| {
                column[height].and_then(|made| moved(*place, height, made)).unwrap_or_default()
            })
        };
        self.places.iter().zip(&self.made).map(each).collect()
    }
}

/// The cutter positions of a machine that make walls, asked for one height of a place after the other.
struct Makers<'a, S, const N: usize> {
    machine: &'a Loop<'a>,
    state: S,
    heights: Heights<N>,
    /// The last: at the next height the wall is often made by it as well.
    last: Option<(usize, State)>,
}

impl<'a, S: FnMut(usize) -> Option<State>, const N: usize> Makers<'a, S, N> {
    /// From states that are asked for one by one, by their samples.
    fn of(machine: &'a Loop<'a>, heights: [Real; N], state: S) -> Self {
        Self { machine, state, heights: Heights::new(machine, heights), last: None }
    }

    /// How far the cutter at a sample ends short of the wall beside a place at a height.
    fn short_of(&mut self, place: usize, maker: usize, height: usize) -> Option<Offset> {
        let state = match self.last {
            Some((sample, state)) if sample == maker => state,
            _ => (self.state)(maker)?,
        };
        self.last = Some((maker, state));
        let displacement = state.commanded + self.machine.deflection(&mut self.heights, height, &state);
        left_by(self.machine.path, place, maker, displacement)
    }
}

/// Displacements of a machine at all heights of the samples that were asked for.
struct Sought<'a, S, const N: usize> {
    machine: &'a Loop<'a>,
    state: S,
    heights: Heights<N>,
    /// Where they are among the known ones, for every sample, counted from 1; 0 for nowhere.
    slots: Vec<u32>,
    known: Vec<[Vector; N]>,
}

impl<'a, S: FnMut(usize) -> Option<State>, const N: usize> Sought<'a, S, N> {
    /// From states that are asked for one by one, counted from the first of so many.
    fn of(machine: &'a Loop<'a>, states: usize, heights: [Real; N], state: S) -> Self {
        Self { machine, state, heights: Heights::new(machine, heights), slots: vec![0; states], known: Vec::new() }
    }

    fn displacement(&mut self, slot: usize, height: usize) -> Option<Vector> {
        let at = self.slots.get_mut(slot)?;
        if *at == 0 {
            self.known.push(self.machine.at_heights(&mut self.heights, &(self.state)(slot)?));
            *at = self.known.len() as u32;
        }
        self.known.get(*at as usize - 1)?.get(height).copied()
    }
}

/// Those of one height.
struct AtHeight<'s, 'a, S, const N: usize> {
    of: &'s RefCell<Sought<'a, S, N>>,
    height: usize,
}

impl<S: FnMut(usize) -> Option<State>, const N: usize> Displacements for AtHeight<'_, '_, S, N> {
    fn displacement(&mut self, slot: usize) -> Option<Vector> {
        self.of.borrow_mut().displacement(slot, self.height)
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
        // A correction that changes along two stretches, of which the second begins before a seam.
        let changes = |index: usize| (250..300).contains(&index) || (395..420).contains(&index);
        let refined = |index: usize| commanded(index) + Vector::from_nm(if changes(index) { 500 } else { 0 }, 0);
        let mut after = vec![State::REST; working.len()];
        let later = machine.run(working.start, &mut after, refined);
        // From one sample before it the loop ends otherwise, and the stretch is run again.
        for apart in [(200, 64), (150, 1), (200, 0), (5_000, 64)] {
            let mut states = vec![State::REST; working.len()];
            let mut run = |commanded: &(dyn Fn(usize) -> Vector + Sync), again, moved: &mut [bool]| {
                let passage =
                    stretch_by_stretch(&machine, working.start, (&mut states, again), &commanded, apart, moved);
                (passage, states.clone())
            };
            let mut moved = vec![false; working.len()];
            assert_eq!(run(&commanded, Again::Afresh, &mut moved), (passage, whole.clone()), "{apart:?}");
            assert!(moved.iter().all(|moved| *moved), "{apart:?}");
            assert_eq!(run(&refined, Again::AsBefore, &mut moved), (later, after.clone()), "{apart:?}");
            for ((before, after), moved) in whole.iter().zip(&after).zip(&moved) {
                assert!(*moved || before == after, "{apart:?}");
            }
            let still = moved.iter().filter(|moved| !**moved).count();
            assert!(still > working.len() / 2, "{apart:?}: {still} of {}", working.len());
        }
    }
}
