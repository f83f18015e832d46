//! The normal equations are solved, and turn with the part.

use super::*;
use proptest::prelude::*;

fn observations(seed: &[i32]) -> std::vec::Vec<([Real; COUNT], Real)> {
    seed.chunks_exact(COUNT + 1)
        .map(|c| (core::array::from_fn(|i| Real::ratio(c[i].into(), 1000)), Real::ratio(c[COUNT].into(), 1000)))
        .collect()
}

proptest! {
    #[test]
    fn the_step_solves_the_normal_equations(seed in prop::collection::vec(-30_000i32..30_000, (COUNT + 1) * 14)) {
        let mut info = Information::prior(&[Real::ZERO; COUNT], &[Real::ONE; COUNT]);
        for (row, residual) in observations(&seed) {
            info.add(&row, residual, Real::ONE);
        }
        let x = info.step();
        for i in 0..COUNT {
            let product = (0..COUNT).fold(Real::ZERO, |s, j| s + info.matrix[i][j] * x[j]);
            prop_assert!((product - info.gradient[i]).abs() < Real::ratio(1, 1000), "row {}", i);
        }
    }

    #[test]
    fn a_level_taken_out_steps_as_if_it_were_solved_with_the_others(
        seed in prop::collection::vec(-3_000i32..3_000, (COUNT + 1) * 12)
    ) {
        let rows = observations(&seed);
        let (ratio, at) = (Real::ratio(3, 10), Real::HALF);
        let mut part = Information::of_part([Real::HALF, -Real::ONE]);
        for (row, residual) in &rows {
            part.add(row, *residual, Real::ONE);
        }
        let alone = part;
        let level = part.take_level(ratio, at);
        let mut whole = Information::prior(&[Real::ZERO; COUNT], &[Real::ONE; COUNT]);
        let eliminated = whole.add_part(&part).with_level(level);
        let x = whole.step();
        let (level, datum) = eliminated.step(&x);
        let step = |i: usize| if i < SCALARS { x[i] } else { datum[i - SCALARS] };
        // What the level does is what the first parameter does: its equation, and those of the others.
        let product = |i: usize| (0..COUNT).fold(alone.matrix[i][0] * ratio * level, |s, j| s + alone.matrix[i][j] * step(j));
        let own = product(0) * ratio + level - (alone.gradient[0] * ratio - at);
        prop_assert!(own.abs() < Real::ratio(1, 1000), "level {own:?}");
        for (i, shared) in x.into_iter().enumerate() {
            let prior = if i < SCALARS { shared } else { Real::ZERO };
            prop_assert!((product(i) + prior - alone.gradient[i]).abs() < Real::ratio(1, 1000), "row {}", i);
        }
    }

    #[test]
    fn eliminated_parts_step_as_if_all_were_solved_together(
        seed in prop::collection::vec(-3_000i32..3_000, (COUNT + 1) * 12)
    ) {
        let rows = observations(&seed);
        let mut part = Information::of_part([Real::HALF, -Real::ONE]);
        let mut whole = Information::prior(&[Real::ZERO; COUNT], &[Real::ONE; COUNT]);
        for (row, residual) in &rows[..6] {
            part.add(row, *residual, Real::ONE);
        }
        for (row, residual) in &rows[6..] {
            whole.add(row, *residual, Real::ONE);
        }
        let alone = part;
        let last = whole;
        let eliminated = whole.add_part(&part);
        let x = whole.step();
        let (_, d) = eliminated.step(&x);
        // The equations of the shared parameters, of the part's datum and of the last datum.
        for i in 0..COUNT {
            let own = (0..COUNT).fold(Real::ZERO, |s, j| s + last.matrix[i][j] * x[j]);
            let of_part = |i: usize| {
                let shared = (0..SCALARS).fold(Real::ZERO, |s, j| s + alone.matrix[i][j] * x[j]);
                shared + alone.matrix[i][SCALARS] * d[0] + alone.matrix[i][SCALARS + 1] * d[1]
            };
            if i < SCALARS {
                let gradient = last.gradient[i] + alone.gradient[i];
                prop_assert!((own + of_part(i) - gradient).abs() < Real::ratio(1, 1000), "row {}", i);
            } else {
                prop_assert!((own - last.gradient[i]).abs() < Real::ratio(1, 1000), "row {}", i);
                prop_assert!((of_part(i) - alone.gradient[i]).abs() < Real::ratio(1, 1000), "datum {}", i);
            }
        }
    }

    #[test]
    fn a_quarter_turn_of_two_parts_exchanges_bits(seed in prop::collection::vec(-30_000i32..30_000, (COUNT + 1) * 14)) {
        let turn = |r: &[Real; COUNT]| {
            let mut t = *r;
            (t[1], t[2], t[SCALARS], t[SCALARS + 1]) = (-r[1], -r[2], -r[SCALARS + 1], r[SCALARS]);
            t
        };
        let (mut part, mut whole) = (Information::of_part([Real::HALF, Real::ONE]), Information::prior(&[Real::ZERO; COUNT], &[Real::ONE; COUNT]));
        let (mut turned_part, mut turned) = (Information::of_part([-Real::ONE, Real::HALF]), whole);
        for (k, (row, residual)) in observations(&seed).iter().enumerate() {
            let (one, other) = if k < 7 { (&mut part, &mut turned_part) } else { (&mut whole, &mut turned) };
            one.add(row, *residual, Real::HALF);
            other.add(&turn(row), *residual, Real::HALF);
        }
        let [level, turned_level] = [&mut part, &mut turned_part].map(|part| part.take_level(Real::HALF, Real::HALF));
        let eliminated = whole.add_part(&part).with_level(level);
        let other = turned.add_part(&turned_part).with_level(turned_level);
        let (x, y) = (whole.step(), turned.step());
        prop_assert_eq!(turn(&x), y);
        let (level, [dx, dy]) = eliminated.step(&x);
        prop_assert_eq!((level, [-dy, dx]), other.step(&y));
        prop_assert_eq!(eliminated.log2_determinant(), other.log2_determinant());
    }

    #[test]
    fn signs_and_the_last_two_places_may_be_exchanged(
        seed in prop::collection::vec(-30_000i32..30_000, (COUNT + 1) * 14)
    ) {
        // A quarter turn: parameters 1 and 2 change sign, (x, y) becomes (−y, x).
        let turn = |r: &[Real; COUNT]| {
            let mut t = *r;
            t[1] = -r[1];
            t[2] = -r[2];
            t[SCALARS] = -r[SCALARS + 1];
            t[SCALARS + 1] = r[SCALARS];
            t
        };
        let mut info = Information::prior(&[Real::ZERO; COUNT], &[Real::ONE; COUNT]);
        let mut turned = info;
        for (row, residual) in observations(&seed) {
            info.add(&row, residual, Real::HALF);
            turned.add(&turn(&row), residual, Real::HALF);
        }
        prop_assert_eq!(turn(&info.step()), turned.step());
    }
}
