//! 100,000 random moves over all machine types: after insertion the chord error never exceeds the tolerance, and there are
//! never more points than midpoint halving inserts.
//!
//! The tool's way is sampled densely with the matrices of the second formulation, not with the code under test.

use truepath_multiaxis::{Joints, Machine, Rule, chord_error, divide};

use crate::machines::{Draw, from_segment, place_by_matrices, types, with_slack};

/// Moves in all; threads share them.
const MOVES: u64 = 100_000;
/// Samples of every piece.
const SAMPLES: u32 = 64;
/// Rounding of the sampled distance, mm: positions of some hundred mm, and the ends of long turns.
const ROUNDING: f64 = 1e-9;

/// Largest sampled distance of a joint move from the chord between its ends.
fn sampled(machine: &Machine, from: &Joints, to: &Joints, samples: u32) -> f64 {
    let height = machine.counted_height_mm();
    let place = |joints: &Joints| place_by_matrices(machine, joints, height);
    let (a, b) = (place(from), place(to));
    let distance = |i| from_segment(place(&from.towards(to, f64::from(i) / f64::from(samples))), a, b);
    (1..samples).map(distance).fold(0.0, f64::max)
}

/// Moves, pieces of the fewest, pieces of midpoint halving, moves on which the fewest are fewer.
type Tally = [u64; 4];

fn check(seed: u64) -> Tally {
    let mut draw = Draw::new(seed);
    let kinds = types();
    let mut tally = [0; 4];
    for i in 0..MOVES / 100 {
        let kind = kinds[(seed * 7 + i) as usize % kinds.len()];
        let machine = draw.machine(kind);
        let [from, to] = draw.ends(&machine);
        let tolerance = draw.decades(0.001, 0.1);
        let context = || format!("{machine:?} {from:?} {to:?} {tolerance}");
        let division =
            divide(&machine, &from, &to, tolerance, Rule::Fewest).unwrap_or_else(|e| panic!("{e} {}", context()));
        let halved = divide(&machine, &from, &to, tolerance, Rule::Midpoint).expect("midpoint halving");
        assert!(division.pieces() <= halved.pieces(), "{}", context());
        let (mut last, mut certified) = (from, 0.0f64);
        let (start, end) = (machine.counted(&from), machine.counted(&to));
        for joints in division.inserted.iter().map(|(_, joints)| joints).chain([&to]) {
            let error = sampled(&machine, &last, joints, SAMPLES);
            assert!(error <= tolerance + ROUNDING, "{error} > {tolerance}: {}", context());
            assert!(from_segment(machine.counted(joints), start, end) <= ROUNDING, "off the chord: {}", context());
            certified = certified.max(chord_error(&machine, &last, joints).bound);
            last = *joints;
        }
        assert_eq!(division.after, certified, "{}", context());
        assert!(certified <= with_slack(tolerance), "{certified} > {tolerance}: {}", context());
        tally[0] += 1;
        tally[1] += division.pieces() as u64;
        tally[2] += halved.pieces() as u64;
        tally[3] += u64::from(division.pieces() < halved.pieces());
    }
    tally
}

#[test]
#[ignore = "slow: cargo xtask test --all"]
fn after_insertion_no_random_move_exceeds_its_tolerance_and_none_has_more_points_than_midpoint_halving() {
    let next = std::sync::atomic::AtomicU64::new(0);
    let work = || {
        let mut sum = [0; 4];
        loop {
            let seed = next.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
            if seed >= 100 {
                return sum;
            }
            let tally = check(seed);
            (0..4).for_each(|i| sum[i] += tally[i]);
        }
    };
    let threads = std::thread::available_parallelism().map_or(2, usize::from).min(8);
    let tallies: Vec<Tally> = std::thread::scope(|scope| {
        let started: Vec<_> = (0..threads).map(|_| scope.spawn(work)).collect();
        started.into_iter().map(|thread| thread.join().unwrap_or_else(|e| std::panic::resume_unwind(e))).collect()
    });
    let total: Tally = std::array::from_fn(|i| tallies.iter().map(|tally| tally[i]).sum());
    println!("moves, pieces, pieces halved, moves with fewer: {total:?}");
    assert_eq!(total[0], MOVES);
    assert!(total[3] > MOVES / 10, "halving is beaten often: {total:?}");
}

#[test]
fn the_certified_maximum_is_the_sampled_one_and_its_bound_is_never_passed() {
    let mut draw = Draw::new(1_000);
    let kinds = types();
    for i in 0..5_000 {
        let machine = draw.machine(kinds[i % kinds.len()]);
        let [from, to] = draw.ends(&machine);
        let error = chord_error(&machine, &from, &to);
        let sample = sampled(&machine, &from, &to, 500);
        assert!(sample <= error.bound + ROUNDING, "{sample} {error:?} {machine:?} {from:?} {to:?}");
        // Between samples the way bends on by no more than an eighth of its second derivative times the step squared.
        let gap = 1e-3 * error.exact + 1e-7;
        assert!(error.exact <= sample + gap, "{sample} {error:?} {machine:?} {from:?} {to:?}");
        assert!(error.bound - error.exact <= 1.1e-7 + 1e-5 * error.exact, "{error:?}");
    }
}
