//! Moves at the edges of what a move can be: none at all, standing tips, whole turns, hundreds of turns, numbers that
//! are none.

use truepath_multiaxis::division::MOST_PIECES;
use truepath_multiaxis::machine::{Letter, Machine, Rotary, Sense, Side, Tool};
use truepath_multiaxis::singular::passage;
use truepath_multiaxis::{DivisionError, Joints, Rule, chord_error, divide, insert};

use crate::machines::{Draw, from_segment, place_by_matrices, types, with_slack};

const RULES: [Rule; 4] = [Rule::Equal, Rule::Midpoint, Rule::Longest, Rule::Fewest];

fn rotary_table() -> Machine {
    let axis =
        |letter| Rotary { letter, side: Side::Table, point_mm: [0.0; 3], sense: Sense::RightHand, limits_deg: None };
    Machine::new([axis(Letter::A), axis(Letter::C)], Tool::default()).expect("a machine")
}

#[test]
fn a_move_to_where_it_is_has_no_error_and_is_not_divided() {
    let mut draw = Draw::new(41);
    for kind in types() {
        let machine = draw.machine(kind);
        let [joints, _] = draw.ends(&machine);
        let error = chord_error(&machine, &joints, &joints);
        assert!(error.estimate == 0.0 && error.exact < 1e-9 && error.bound < 1e-9, "{error:?}");
        let found = passage(&machine, &joints, &joints);
        assert!(found.orientation_error == 0.0 && found.swing == 0.0 && found.turn < 1e-7);
        for rule in RULES {
            assert_eq!(divide(&machine, &joints, &joints, 1e-6, rule).expect("nothing to divide").pieces(), 1);
        }
    }
}

#[test]
fn a_move_of_the_linear_axes_alone_has_no_error() {
    let mut draw = Draw::new(42);
    for kind in types() {
        let machine = draw.machine(kind);
        let [from, _] = draw.ends(&machine);
        let to = Joints { xyz: draw.vector(500.0), ..from };
        let error = chord_error(&machine, &from, &to);
        assert!(error.estimate < 1e-12 && error.bound < 2e-9, "{error:?}");
    }
}

/// A tip that stands on the part while C turns by Δ: the linear axes cut the corner, by the sagitta ρ(1 − cos Δ/2).
#[test]
fn a_standing_tip_errs_by_the_sagitta_and_is_divided() {
    let machine = rotary_table();
    for degrees in [0.5f64, 5.0, 40.0, 90.0] {
        let ends = [0.0, degrees].map(|word| machine.inverse([80.0, 0.0, 0.0], [0.0, word.to_radians()]));
        let error = chord_error(&machine, &ends[0], &ends[1]);
        let sagitta = 80.0 * (1.0 - (degrees / 2.0).to_radians().cos());
        assert!(error.exact >= sagitta - 1e-9 && error.exact <= error.bound, "{error:?} {sagitta}");
        // The tip also slides along while the turn runs ahead of the chord: third order in the angle.
        assert!(error.exact <= sagitta * 1.02 + 1e-9, "{error:?} {sagitta}");
        for rule in RULES {
            let division = divide(&machine, &ends[0], &ends[1], 0.01, rule).expect("a division");
            assert!(division.after <= with_slack(0.01));
            for (_, joints) in &division.inserted {
                assert!(from_segment(machine.counted(joints), [80.0, 0.0, 0.0], [80.0, 0.0, 0.0]) < 1e-9);
            }
        }
    }
}

/// Over a whole turn with the linear axes standing the tip runs a circle on the part: its diameter, not zero, though the
/// ends and the middle of a double turn meet.
#[test]
fn whole_turns_are_not_mistaken_for_no_turn() {
    let machine = rotary_table();
    for turns in [1.0, 2.0, 4.0] {
        let from = Joints { xyz: [30.0, 40.0, 0.0], rotary: [0.0; 2] };
        let to = Joints { rotary: [0.0, turns * std::f64::consts::TAU], ..from };
        let error = chord_error(&machine, &from, &to);
        assert!((error.exact - 100.0).abs() < 1e-3 && error.bound >= 100.0 && error.bound < 100.01, "{error:?}");
        for rule in RULES {
            let division = divide(&machine, &from, &to, 0.05, rule).expect("a division");
            let mut last = from;
            for joints in division.inserted.iter().map(|(_, joints)| joints).chain([&to]) {
                for i in 0..50 {
                    let there = last.towards(joints, f64::from(i) / 50.0);
                    assert!(
                        from_segment(place_by_matrices(&machine, &there, 0.0), [30.0, 40.0, 0.0], [30.0, 40.0, 0.0])
                            <= 0.05 + 1e-9
                    );
                }
                last = *joints;
            }
        }
    }
}

#[test]
fn hundreds_of_turns_end_in_an_error_and_the_bound_stays_true() {
    let machine = rotary_table();
    let from = Joints { xyz: [100.0, 0.0, 0.0], rotary: [0.0; 2] };
    let to = Joints { rotary: [0.0, 500.3 * std::f64::consts::TAU], ..from };
    let error = chord_error(&machine, &from, &to);
    // The tip runs the circle; its chord spans 108° of it, and the far side of the circle is the farthest.
    let farthest = 100.0 * (1.0 + 54f64.to_radians().cos());
    assert!(error.bound >= error.exact && (error.exact - farthest).abs() < 1e-3, "{error:?}");
    for rule in RULES {
        assert_eq!(divide(&machine, &from, &to, 0.001, rule), Err(DivisionError::TooManyPieces), "{rule:?}");
    }
    let coarse = divide(&machine, &from, &Joints { rotary: [0.0, 40.0], ..from }, 0.01, Rule::Equal).expect("coarse");
    assert!(coarse.pieces() < MOST_PIECES && coarse.after <= with_slack(0.01));
}

#[test]
fn numbers_that_are_none_are_refused() {
    let machine = rotary_table();
    let good = Joints { xyz: [1.0, 2.0, 3.0], rotary: [0.1, 0.2] };
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        for wrong in [Joints { xyz: [bad, 0.0, 0.0], ..good }, Joints { rotary: [0.0, bad], ..good }] {
            for (from, to) in [(good, wrong), (wrong, good), (wrong, wrong)] {
                assert!(!chord_error(&machine, &from, &to).bound.is_finite(), "no proof about {wrong:?}");
                assert_eq!(divide(&machine, &from, &to, 0.01, Rule::Fewest), Err(DivisionError::NotFinite));
                assert_eq!(insert(&machine, &from, &to, 0.01, Rule::Fewest).err(), Some(DivisionError::NotFinite));
            }
        }
    }
    for tolerance in [0.0, -1.0, f64::INFINITY] {
        let refused = divide(&machine, &good, &good, tolerance, Rule::Equal);
        assert_eq!(refused, Err(DivisionError::Tolerance(tolerance)));
    }
    assert!(matches!(divide(&machine, &good, &good, f64::NAN, Rule::Equal), Err(DivisionError::Tolerance(_))));
}

#[test]
fn a_tolerance_below_the_rounding_is_refused_and_does_not_hang() {
    let machine = rotary_table();
    let ends = [0.0, 0.3].map(|word| machine.inverse([90_000.0, 0.0, 0.0], [word, 2.0 * word]));
    for rule in RULES {
        let refused = divide(&machine, &ends[0], &ends[1], 1e-12, rule);
        assert!(matches!(refused, Err(DivisionError::Unprovable(_) | DivisionError::TooManyPieces)), "{refused:?}");
    }
    // Numbers as large as f64 holds prove nothing, and end.
    let far = Joints { xyz: [1e300, -1e300, 1e308], rotary: [1e300, -1e15] };
    let error = chord_error(&machine, &ends[0], &far);
    assert!(error.bound.is_nan() || error.bound > 1.0, "{error:?}");
    assert!(divide(&machine, &ends[0], &far, 0.01, Rule::Fewest).is_err());
}
