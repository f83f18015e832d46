//! One part, one arming: whatever runs without a new arming runs uncorrected, in a series of any length.

use crate::rewrite_support;
use rewrite_support::*;
use truepath_wire::rewrite::{Mode, Reason, Refusal, SPENT_CAPACITY, SPENT_FLOORS, Spent, SpentList, State};

/// The whole program: plunge, path, retract. Gives whether any setpoint was corrected.
fn whole_program(m: &mut Machine) -> bool {
    let mut corrected = false;
    let mut setpoints = vec![(0, 0, CLEAR); 3];
    setpoints.extend((0..=100).map(|i| (0, 0, GATE + (PASS - GATE) * i / 100)));
    setpoints.extend(along(&straight(), FEED).into_iter().map(|(x, y)| (x, y, PASS)));
    setpoints.extend((0..200).map(|i| (10 * MM, 0, PASS + i * 50_000)));
    for (x, y, z) in setpoints {
        let out = m.send(x, y, z);
        corrected |= out.axes != m.next.axes;
    }
    corrected
}

#[test]
fn the_program_repeated_without_a_new_arming_runs_uncorrected() {
    let mut m = Machine::on(straight()).armed();
    assert!(whole_program(&mut m));
    assert_eq!((m.state.mode(), m.state.reason()), (Mode::Bypass, Reason::Completed));
    for _ in 0..2 {
        assert!(!whole_program(&mut m));
        assert_eq!(m.state.mode(), Mode::Bypass);
    }
}

#[test]
fn a_spring_pass_of_the_same_part_is_refused_and_the_next_part_is_not() {
    let mut m = Machine::on(straight()).armed();
    whole_program(&mut m);
    assert_eq!(m.rewriter.arm(&mut m.state, &m.request), Err(Refusal::PartRepeated { part_serial: 1 }));
    assert!(!whole_program(&mut m));
    m.request.part_serial = 2;
    m.rewriter.arm(&mut m.state, &m.request).unwrap();
    assert!(whole_program(&mut m));
    // And the first part stays spent behind the second.
    m.request.part_serial = 1;
    assert_eq!(m.rewriter.arm(&mut m.state, &m.request), Err(Refusal::PartRepeated { part_serial: 1 }));
}

#[test]
fn a_part_that_was_armed_but_never_reached_the_gate_counts_as_spent() {
    let mut m = Machine::on(straight()).armed();
    m.rewriter.disarm(&mut m.state).unwrap();
    assert_eq!(m.rewriter.arm(&mut m.state, &m.request), Err(Refusal::PartRepeated { part_serial: 1 }));
}

#[test]
fn armings_can_be_remembered_over_a_power_down() {
    let mut m = Machine::on(straight()).armed();
    whole_program(&mut m);
    m.state = State::remembering(*m.state.spent());
    m.next.flags = Default::default();
    assert!(!m.stay().forward);
    m.acknowledge();
    assert_eq!(m.rewriter.arm(&mut m.state, &m.request), Err(Refusal::PartRepeated { part_serial: 1 }));
}

#[test]
fn every_part_of_a_long_series_stays_spent() {
    let mut m = Machine::on(straight()).armed();
    for part in 1..=100 {
        if part > 1 {
            m.request.part_serial = part;
            m.rewriter.arm(&mut m.state, &m.request).unwrap();
        }
        m.rewriter.disarm(&mut m.state).unwrap();
        for part_serial in 1..=part {
            m.request.part_serial = part_serial;
            let refused = m.rewriter.arm(&mut m.state, &m.request);
            assert_eq!(refused, Err(Refusal::PartRepeated { part_serial }), "after {part}");
        }
    }
}

const fn pass(part_serial: u32, feature: u32) -> Spent {
    Spent { part_serial, program_crc: 0x1234_5678, feature, pass: 1 }
}

#[test]
fn as_many_passes_as_there_are_floors_are_remembered_for_ever_in_any_order() {
    for passes in [1, 20, SPENT_FLOORS as u32] {
        let (mut list, mut next) = (SpentList::EMPTY, vec![1; passes as usize]);
        // Not in turn: some passes wait for thousands of armings of others.
        let mut random = 1u32;
        for _ in 0..20_000 {
            random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let feature = ((random >> 16) % (passes * passes)).isqrt();
            let serial = &mut next[feature as usize];
            assert!(!list.contains(&pass(*serial, feature)));
            list.spend(pass(*serial, feature));
            *serial += 1;
            for (feature, next) in next.iter().enumerate() {
                let last = *next - 1;
                assert!(last == 0 || list.contains(&pass(last, feature as u32)));
                assert!(last == 0 || list.contains(&pass(1 + random % last, feature as u32)));
            }
        }
    }
}

#[test]
fn the_newest_parts_may_come_in_any_order_and_a_floor_never_falls() {
    let mut list = SpentList::EMPTY;
    for serial in [9, 7, 8, 3] {
        list.spend(pass(serial, 0));
    }
    assert!(!list.contains(&pass(2, 0)) && !list.contains(&pass(5, 0)) && !list.contains(&pass(10, 0)));
    // 9, 7, 8 and 3 become floors, in this order.
    for feature in 1..=SPENT_CAPACITY as u32 {
        list.spend(pass(1, feature));
    }
    assert!((0..=9).all(|serial| list.contains(&pass(serial, 0))));
    assert!(!list.contains(&pass(10, 0)));
    // Another program, feature or pass has its own.
    let other = pass(5, 0);
    assert!(!list.contains(&Spent { program_crc: 1, ..other }));
    assert!(!list.contains(&Spent { pass: 2, ..other }) && !list.contains(&pass(5, 17)));
    assert_eq!(list.last(), Some(pass(1, SPENT_CAPACITY as u32)));
}

#[test]
fn of_more_passes_than_that_the_one_longest_untouched_is_forgotten() {
    let mut list = SpentList::EMPTY;
    let most = (SPENT_CAPACITY + SPENT_FLOORS) as u32;
    for feature in 0..most {
        list.spend(pass(1, feature));
    }
    assert!((0..most).all(|feature| list.contains(&pass(1, feature))));
    list.spend(pass(1, most));
    assert!(!list.contains(&pass(1, 0)) && (1..=most).all(|feature| list.contains(&pass(1, feature))));
}

#[test]
fn a_restart_in_the_middle_runs_uncorrected() {
    let mut m = Machine::on(straight()).armed();
    for i in 0..=100 {
        assert!(is_plain(&m.send(5 * MM, 0, GATE + (PASS - GATE) * i / 100), &m.next.clone()));
    }
    for &(x, y) in along(&straight(), FEED).iter().filter(|p| p.0 > 5 * MM) {
        assert!(is_plain(&m.send(x, y, PASS), &m.next.clone()));
    }
    assert_eq!(m.state.mode(), Mode::Armed);
}
