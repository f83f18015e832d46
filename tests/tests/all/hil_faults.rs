//! Each kind of fault on the cable, ten thousand frames of each: the device treats them as the host's endpoint does,
//! forwards nothing that was damaged, stays inside the limits, and comes back from every fault.

use crate::hil_support::{everything, on_host, options, probability};
use truepath::command::hil::{Report, Source};
use truepath_bench::Faults;

const FRAMES: u64 = 10_000;

/// A run with faults: equal and by the rules, and the device was armed again after the faults that ended an arming.
fn under(faults: Faults, seed: u64) -> Report {
    let report = on_host(0, &options(Source::Random, FRAMES, faults, seed));
    assert!(report.identical, "{:?}", report.difference);
    assert_eq!(report.digest, report.host_digest);
    report
}

#[test]
fn lost_frames_are_bridged_and_too_many_end_the_correction() {
    let report = under(Faults { drop: probability(0.2), ..Faults::default() }, 1);
    assert!(report.injected.dropped > FRAMES / 6);
    assert_eq!(report.answers, report.setpoints - report.injected.dropped);
    assert!(report.counters.lost > 500 && report.armed > 20, "{report:?}");
    assert!(report.faults.iter().any(|(reason, count)| reason.contains("lost") && *count > 20), "{:?}", report.faults);
}

#[test]
fn damaged_frames_get_no_answer() {
    let report = under(Faults { corrupt: probability(0.2), ..Faults::default() }, 2);
    // A frame whose delimiter was lost takes the next one with it; one that was split counts twice.
    let missing = report.setpoints - report.answers;
    assert!(missing >= report.injected.corrupted * 8 / 10 && missing <= report.injected.corrupted * 2, "{report:?}");
    assert!(u64::from(report.counters.damaged) > report.injected.corrupted * 8 / 10 && report.armed > 20);
}

#[test]
fn overtaken_frames_are_left_behind() {
    let report = under(Faults { reorder: probability(0.2), ..Faults::default() }, 3);
    assert!(report.injected.reordered > FRAMES / 15);
    assert!(u64::from(report.counters.out_of_order) > report.injected.reordered * 9 / 10, "{report:?}");
}

#[test]
fn repeated_frames_are_answered_once() {
    let report = under(Faults { repeat: probability(0.2), ..Faults::default() }, 4);
    assert!(report.injected.repeated > FRAMES / 6);
    assert_eq!(report.answers, report.setpoints);
    assert!(u64::from(report.counters.repeated) >= report.injected.repeated * 9 / 10, "{report:?}");
}

#[test]
fn pauses_drop_the_drives_until_they_are_acknowledged() {
    let faults = Faults { pause: probability(0.005), pause_us: 25_000, jitter_us: 900, ..Faults::default() };
    let report = under(faults, 5);
    // A pause in the 48 frames before the drives are acknowledged finds them off already.
    let silences = u64::from(report.counters.silences);
    assert!(silences > report.injected.pauses * 6 / 10 && silences > 30, "{report:?}");
    // From each of them it came back: acknowledged, armed, active.
    assert!(report.armed + 1 >= silences && report.modes[0] >= report.injected.pauses, "{report:?}");
}

#[test]
fn jitter_alone_changes_no_answer() {
    let report = under(Faults { jitter_us: 15_000, ..Faults::default() }, 6);
    let calm = under(Faults::default(), 6);
    assert_eq!((report.counters.silences, report.counters.late), (0, 0));
    assert_eq!(report.digest, calm.digest);
}

#[test]
fn everything_at_once_is_survived() {
    for seed in 7..12 {
        let report = under(everything(), seed);
        assert!(report.armed > 3 && report.modes[3] > 1_000, "{report:?}");
    }
}
