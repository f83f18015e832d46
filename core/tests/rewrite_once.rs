//! One part, one arming: whatever runs without a new arming runs uncorrected.

mod rewrite_support;
use rewrite_support::*;
use truepath_core::rewrite::{Mode, Reason, Refusal, State};

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
