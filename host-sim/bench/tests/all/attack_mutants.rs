//! Each rule is broken by a double of the servo, and the alarm is the one of that rule: not just any.

use std::collections::BTreeSet;

use truepath_bench::Chance;
use truepath_bench::attack::{Rule, Tally, session};
use truepath_core::rewrite::Reason;

use crate::doubles::{Mistake, double};

/// Most sessions until a mistake must have been noticed.
const SESSIONS: u64 = 150;

/// First alarms of the sessions with a mistake, until there are enough, with the last one's words.
fn alarms(mistake: Mistake, sessions: u64, enough: usize) -> (Vec<Rule>, String) {
    let (mut found, mut words) = (vec![], String::new());
    for number in 0..sessions {
        // Each of its own, so that one can be looked at by itself.
        let mut chance = Chance::new(17, number);
        if let Err(alarm) = session(&mut chance, &|setup| double(setup, mistake), &mut Tally::default()) {
            words = format!("session {number}: {alarm}");
            found.push(alarm.rule);
        }
        if found.len() >= enough {
            break;
        }
    }
    (found, words)
}

/// Every double, and the rule that it breaks.
pub const EXPECTED: &[(Mistake, Rule)] = &[
    (Mistake::DamagedFrameFollowed, Rule::Damaged),
    (Mistake::RepeatedFrameAnswered, Rule::Old),
    (Mistake::LateAnswerGiven, Rule::Late),
    (Mistake::SumOffByOne, Rule::Sum),
    (Mistake::CorrectedInBypass, Rule::Plain),
    (Mistake::EnabledInOff, Rule::Enable),
    (Mistake::AcknowledgedWithDrives, Rule::Acknowledge),
    (Mistake::SilenceIgnored, Rule::Silence),
    (Mistake::ArmsItself, Rule::Unarmed),
    (Mistake::BindingIgnored, Rule::Arming),
    (Mistake::ArmedInFault, Rule::Arming),
    (Mistake::SpentListIgnored, Rule::Spent),
    (Mistake::GateIgnored, Rule::Begin),
    (Mistake::OtherAxis, Rule::Axis),
    (Mistake::ClampOffByOne, Rule::Clamp),
    (Mistake::TooFast, Rule::Speed),
    (Mistake::TooHard, Rule::Acceleration),
    (Mistake::NoJointLimits, Rule::Joint),
    (Mistake::GapFollowed, Rule::Gap),
    (Mistake::Deaf(Reason::EmergencyStop), Rule::Stopped),
    (Mistake::Deaf(Reason::Abort), Rule::Stopped),
    (Mistake::Deaf(Reason::ToolChange), Rule::Stopped),
    (Mistake::Deaf(Reason::ProgramEnd), Rule::Stopped),
    (Mistake::Deaf(Reason::DrivesDisabled), Rule::Stopped),
    (Mistake::Deaf(Reason::FrameChanged), Rule::Stopped),
    (Mistake::DisarmIgnored, Rule::Stopped),
    (Mistake::ImageChangeIgnored, Rule::ImageChanged),
    (Mistake::PaceIgnored, Rule::Pace),
    (Mistake::Deaf(Reason::Jump), Rule::Jump),
    (Mistake::Deaf(Reason::OffPath), Rule::OffPath),
    (Mistake::Deaf(Reason::Backwards), Rule::Backwards),
    (Mistake::Deaf(Reason::LeftGate), Rule::AbovePass),
    (Mistake::Deaf(Reason::LeftPass), Rule::AbovePass),
    (Mistake::Deaf(Reason::BelowPass), Rule::BelowPass),
    (Mistake::Deaf(Reason::MovedInHold), Rule::MovedInHold),
    (Mistake::SpindleIgnored, Rule::Fade),
    (Mistake::RampCutShort, Rule::RampCut),
    (Mistake::RampStands, Rule::RampLong),
];

/// Each of these doubles has so many sessions with an alarm, and it is the alarm of its rule.
#[track_caller]
fn are_noticed(expected: &[(Mistake, Rule)], sessions: u64, enough: usize) {
    let mut wrong = vec![];
    for &(mistake, rule) in expected {
        let (found, words) = alarms(mistake, sessions, enough);
        if found.is_empty() || found.iter().any(|&alarm| alarm != rule) {
            wrong.push(format!("{mistake:?}: {rule:?} is broken, found {found:?}, {words}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Rules of a range of numbers.
fn rules(numbers: std::ops::RangeInclusive<u8>) -> Vec<(Mistake, Rule)> {
    EXPECTED.iter().copied().filter(|(_, rule)| numbers.contains(&rule.number())).collect()
}

#[test]
fn a_mistake_of_link_or_arming_raises_the_alarm_of_its_rule() {
    are_noticed(&rules(1..=12), SESSIONS, 1);
}

#[test]
fn a_mistake_of_limits_or_gaps_raises_the_alarm_of_its_rule() {
    are_noticed(&rules(13..=18), SESSIONS, 1);
}

#[test]
fn a_stop_that_is_not_seen_raises_the_alarm_of_its_rule() {
    are_noticed(&rules(19..=22), SESSIONS, 1);
}

#[test]
fn a_mistake_of_place_or_ramp_raises_the_alarm_of_its_rule() {
    are_noticed(&rules(23..=30), SESSIONS, 1);
}

#[test]
#[ignore = "slow: 38 doubles in up to 1000 sessions each"]
fn every_mistake_raises_the_alarm_of_its_rule_and_no_other_in_many_sessions() {
    are_noticed(EXPECTED, 1_000, 10);
}

#[test]
fn every_rule_is_broken_by_a_mistake() {
    let broken: BTreeSet<Rule> = EXPECTED.iter().map(|&(_, rule)| rule).collect();
    assert_eq!(broken, Rule::ALL.into_iter().collect());
    let numbers: Vec<u8> = Rule::ALL.iter().map(|rule| rule.number()).collect();
    assert_eq!(numbers, (1..=Rule::ALL.len() as u8).collect::<Vec<_>>());
}

#[test]
fn a_tolerance_wider_by_a_fiftieth_is_noticed_by_the_rules_of_place_alone() {
    let (found, _) = alarms(Mistake::WideTolerance, SESSIONS, 25);
    let found: BTreeSet<Rule> = found.into_iter().collect();
    let place = BTreeSet::from([Rule::OffPath, Rule::AbovePass, Rule::BelowPass, Rule::MovedInHold, Rule::Begin]);
    assert!(found.is_subset(&place), "{found:?}");
    assert!(found.contains(&Rule::OffPath) && found.contains(&Rule::BelowPass), "{found:?}");
    assert!(found.contains(&Rule::AbovePass), "{found:?}");
}
