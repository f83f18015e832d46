//! The rules the bench holds every answer against: each of them must be able to fail.

use std::collections::VecDeque;

use truepath_bench::traffic::Command;
use truepath_bench::{Happened, Judge, Violation};
use truepath_core::image::{Binding, CorrectionLimits};
use truepath_core::rewrite::{ArmRequest, Frame, Limits, Mode, Output, Place, Reason, Setpoint, Status};
use truepath_core::units::Offset;

/// Clamp 0.5 mm, 20 µm and 2 µm a tick.
fn judge() -> Judge {
    let limits = CorrectionLimits {
        clamp: Offset::from_um(500),
        warn: Offset::from_um(400),
        slew_nm_per_s: 20_000_000,
        acceleration_nm_per_s2: 2_000_000_000,
    };
    Judge::new(Limits::new(&limits, 1_000).unwrap(), 3)
}

fn setpoint(sequence: u32) -> Setpoint {
    Setpoint { axes: [1_000, -2_000, 3_000, 0, 0, 0], sequence, ..Setpoint::default() }
}

fn output(sequence: u32, mode: Mode, correction: i32) -> Output {
    let mut output = Output {
        axes: setpoint(sequence).axes,
        correction_nm: [correction, 0, 0, 0, 0, 0],
        forward: mode != Mode::Off,
        mode,
        reason: Reason::None,
        status: Status::default(),
        place: Place::default(),
        sequence,
    };
    output.axes[0] += i64::from(correction);
    output
}

fn arming() -> [Happened; 2] {
    let request = ArmRequest { binding: Binding::default(), part_serial: 1, frame: Frame::identity() };
    [Happened::Commanded(Command::Acknowledge), Happened::Commanded(Command::Arm(request))]
}

/// Judges answers to frames 1, 2, 3 … of an armed device; the last one's verdict.
fn last(outputs: &[Output]) -> Result<Setpoint, Violation> {
    let mut judge = judge();
    let mut log: VecDeque<Happened> = arming().into();
    log.extend(outputs.iter().map(|o| Happened::Delivered(setpoint(o.sequence))));
    let mut verdicts: Vec<_> = outputs.iter().map(|o| judge.answer(o, &mut log)).collect();
    let last = verdicts.pop().unwrap();
    assert!(verdicts.iter().all(Result::is_ok), "{verdicts:?}");
    last
}

#[test]
fn a_correction_that_starts_gently_is_good() {
    let outputs = [output(1, Mode::Armed, 0), output(2, Mode::Active, 2_000), output(3, Mode::Active, 6_000)];
    assert_eq!(last(&outputs), Ok(setpoint(3)));
}

#[test]
fn size_speed_and_acceleration_are_limits() {
    let what = |outputs: &[Output]| match last(outputs) {
        Err(Violation::Limit { axis: 0, what, .. }) => what,
        other => panic!("{other:?}"),
    };
    assert_eq!(what(&[output(1, Mode::Active, 500_001)]), "size");
    assert_eq!(what(&[output(1, Mode::Active, 20_002)]), "change per tick");
    assert_eq!(what(&[output(1, Mode::Active, 2_003)]), "change of change per tick");
    // Stopping is as hard as starting.
    let mut outputs: Vec<Output> = (1..=8).map(|k| output(k, Mode::Active, (k * (k + 1)) as i32 * 1_000)).collect();
    assert!(last(&outputs).is_ok());
    outputs.push(output(9, Mode::Active, 72_000));
    assert_eq!(what(&outputs), "change of change per tick");
}

#[test]
fn a_position_that_is_not_setpoint_and_correction_is_found() {
    let mut wrong = output(1, Mode::Active, 1_000);
    wrong.axes[2] += 1;
    assert!(matches!(last(&[wrong]), Err(Violation::Sum { axis: 2, .. })));
    let mut wrong = output(1, Mode::Active, 1_000);
    wrong.correction_nm[0] -= 1;
    assert!(matches!(last(&[wrong]), Err(Violation::Sum { axis: 0, .. })));
}

#[test]
fn no_correction_goes_out_where_there_must_be_none() {
    for mode in [Mode::Armed, Mode::Bypass] {
        assert!(matches!(last(&[output(1, mode, 1)]), Err(Violation::State { .. })));
    }
    let withheld = Output { forward: false, ..output(1, Mode::Active, 0) };
    assert!(matches!(last(&[withheld]), Err(Violation::State { .. })));
}

#[test]
fn an_answer_needs_a_frame_that_arrived_whole_and_only_one() {
    let twice = [output(1, Mode::Armed, 0), output(1, Mode::Armed, 0)];
    let mut judge = judge();
    let mut log: VecDeque<Happened> = arming().into();
    log.push_back(Happened::Delivered(setpoint(1)));
    assert!(judge.answer(&twice[0], &mut log).is_ok());
    assert_eq!(judge.answer(&twice[1], &mut log), Err(Violation::NoFrame { sequence: 1 }));
    // The frame before one that was answered is over.
    let mut log: VecDeque<Happened> = [2, 3].map(|k| Happened::Delivered(setpoint(k))).into();
    assert!(judge.answer(&output(3, Mode::Armed, 0), &mut log).is_ok());
    assert!(judge.answer(&output(2, Mode::Armed, 0), &mut log).is_err());
}

#[test]
fn setpoints_at_their_rate_are_not_too_fast() {
    let mut too_fast = output(2, Mode::Fault, 0);
    too_fast.reason = Reason::FrameRate;
    let judged = last(&[output(1, Mode::Active, 0), too_fast]);
    assert_eq!(judged, Err(Violation::Reason { reason: Reason::FrameRate }));
}

#[test]
fn modes_change_as_the_contract_says_and_a_fault_ends() {
    let illegal = |outputs: &[Output]| matches!(last(outputs), Err(Violation::Transition { .. }));
    assert!(illegal(&[output(1, Mode::Bypass, 0), output(2, Mode::Active, 0)]));
    assert!(illegal(&[output(1, Mode::Active, 0), output(2, Mode::Armed, 0)]));
    assert!(illegal(&[output(1, Mode::Armed, 0), output(2, Mode::Hold, 0)]));
    // Not to Bypass with a correction on, and to Off only by silence.
    assert!(illegal(&[output(1, Mode::Active, 1_000), output(2, Mode::Bypass, 0)]));
    assert!(illegal(&[output(1, Mode::Active, 0), output(2, Mode::Off, 0)]));
    let mut judge = judge();
    let mut log: VecDeque<Happened> = arming().into();
    log.extend([Happened::Delivered(setpoint(1)), Happened::Silent, Happened::Delivered(setpoint(2))]);
    assert!(judge.answer(&output(1, Mode::Armed, 0), &mut log).is_ok());
    assert!(judge.answer(&output(2, Mode::Off, 0), &mut log).is_ok());
    // A fault that goes on and on.
    let forever: Vec<Output> = (1..2_000).map(|k| output(k, Mode::Fault, 0)).collect();
    let mut judge = self::judge();
    let mut log: VecDeque<Happened> = arming().into();
    log.extend(forever.iter().map(|o| Happened::Delivered(setpoint(o.sequence))));
    let ends = forever.iter().map(|o| judge.answer(o, &mut log)).position(|v| matches!(v, Err(Violation::Ramp { .. })));
    assert!(ends.is_some_and(|tick| tick < 200), "{ends:?}");
}
