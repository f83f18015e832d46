//! The host's own servo under attack: no rule is broken, and the attack has been everywhere.

use truepath_bench::Chance;
use truepath_bench::attack::{Tally, attack, host, session};
use truepath_core::rewrite::Reason;

/// So many sessions, without an alarm.
#[track_caller]
fn without_alarm(seed: u64, sessions: u64) -> Tally {
    let (tally, alarm) = attack(seed, &host, &mut |tally| tally.sessions < sessions);
    assert_eq!(alarm, None, "seed {seed}: {tally:?}");
    tally
}

#[test]
fn no_rule_is_broken_and_every_end_of_a_correction_was_seen() {
    let tally = without_alarm(1, 150);
    assert!(tally.modes.iter().all(|&answers| answers > 500), "{:?}", tally.modes);
    let missing: Vec<Reason> = Reason::ALL.into_iter().filter(|&reason| tally.ended_by(reason) == 0).collect();
    // A correction that ends by a silence or a reset ends in `Off`, without an answer that says so.
    assert_eq!(missing, [Reason::None, Reason::Silence]);
    assert!(tally.settled.iter().all(|&count| count > 0), "{:?}", tally.settled);
    assert!(tally.used.iter().all(|&share| share > 900), "{:?}", tally.used);
}

#[test]
#[ignore = "slow: two million setpoints"]
fn no_rule_is_broken_in_two_million_setpoints() {
    let tally = without_alarm(7, 1_500);
    assert!(tally.setpoints > 2_000_000, "{}", tally.setpoints);
    assert!(tally.settled.iter().all(|&count| count > 500), "{:?}", tally.settled);
}

#[test]
fn bytes_of_a_fuzzer_are_an_attack_like_any_other() {
    let mut tally = Tally::default();
    let folder = |name| concat!(env!("CARGO_MANIFEST_DIR"), "/../../fuzz/").to_owned() + name + "/servo";
    let kept = ["seeds", "regressions"].map(|name| std::fs::read_dir(folder(name)).unwrap());
    for file in kept.into_iter().flatten() {
        let bytes = std::fs::read(file.unwrap().path()).unwrap();
        for length in [0, 1, 100, 400, bytes.len()] {
            session(&mut Chance::taped(&bytes[..length]), &host, &mut tally).unwrap();
        }
    }
    assert!(tally.setpoints > 1_000 && tally.armed > 0, "{tally:?}");
}

#[test]
fn the_same_seed_is_the_same_attack() {
    let digest = |seed| format!("{:?}", without_alarm(seed, 6));
    assert_eq!(digest(5), digest(5));
    assert_ne!(digest(5), digest(6));
}
