//! A whole device that is told anything keeps every rule and promise, and each is broken by a double that is noticed on the seeds of the
//! fuzzing.

use truepath_bench::Chance;
use truepath_bench::attack::{Rule, Setup};
use truepath_bench::whole::{Breach, Broken, Promise, Stand, Whole, WholeDevice};
use truepath_core::rewrite::Reason;

use crate::doubles::{Mistake, mistaken, whole_double};
use crate::whole_seeds::{Script, Start, seeds};

fn sound<'a>(device: WholeDevice, _: &'a Setup) -> Box<dyn Whole + 'a> {
    Box::new(device)
}

/// Mistakes, and what each breaks.
const EXPECTED: &[(Mistake, Broken)] = &[
    (Mistake::DamagedFrameFollowed, Broken::Rule(Rule::Damaged)),
    (Mistake::RepeatedFrameAnswered, Broken::Rule(Rule::Old)),
    (Mistake::LateAnswerGiven, Broken::Rule(Rule::Late)),
    (Mistake::SumOffByOne, Broken::Rule(Rule::Sum)),
    (Mistake::CorrectedInBypass, Broken::Rule(Rule::Plain)),
    (Mistake::EnabledInOff, Broken::Rule(Rule::Enable)),
    (Mistake::AcknowledgedWithDrives, Broken::Rule(Rule::Acknowledge)),
    (Mistake::SilenceIgnored, Broken::Rule(Rule::Silence)),
    (Mistake::ArmsItself, Broken::Promise(Promise::Message)),
    (Mistake::BindingIgnored, Broken::Rule(Rule::Arming)),
    (Mistake::ArmedInFault, Broken::Rule(Rule::Arming)),
    (Mistake::SpentListIgnored, Broken::Rule(Rule::Spent)),
    (Mistake::GateIgnored, Broken::Rule(Rule::Begin)),
    (Mistake::OtherAxis, Broken::Rule(Rule::Axis)),
    (Mistake::ClampOffByOne, Broken::Rule(Rule::Clamp)),
    (Mistake::TooFast, Broken::Rule(Rule::Speed)),
    (Mistake::TooHard, Broken::Rule(Rule::Acceleration)),
    (Mistake::NoJointLimits, Broken::Rule(Rule::Joint)),
    (Mistake::GapFollowed, Broken::Rule(Rule::Gap)),
    (Mistake::Deaf(Reason::EmergencyStop), Broken::Rule(Rule::Stopped)),
    (Mistake::Deaf(Reason::Abort), Broken::Rule(Rule::Stopped)),
    (Mistake::Deaf(Reason::ToolChange), Broken::Rule(Rule::Stopped)),
    (Mistake::Deaf(Reason::ProgramEnd), Broken::Rule(Rule::Stopped)),
    (Mistake::Deaf(Reason::DrivesDisabled), Broken::Rule(Rule::Stopped)),
    (Mistake::DisarmIgnored, Broken::Rule(Rule::Stopped)),
    (Mistake::PaceIgnored, Broken::Rule(Rule::Pace)),
    (Mistake::WideTolerance, Broken::Rule(Rule::OffPath)),
    (Mistake::SpindleIgnored, Broken::Rule(Rule::Fade)),
    (Mistake::RampCutShort, Broken::Rule(Rule::RampCut)),
    (Mistake::RampStands, Broken::Rule(Rule::RampLong)),
    (Mistake::RoleIgnored, Broken::Promise(Promise::Role)),
    (Mistake::SignatureIgnored, Broken::Promise(Promise::Trust)),
    (Mistake::CounterIgnored, Broken::Promise(Promise::Older)),
    (Mistake::SettingsForgotten, Broken::Promise(Promise::Settings)),
    (Mistake::ActivationForgotten, Broken::Promise(Promise::Image)),
    (Mistake::AnswerDamaged, Broken::Promise(Promise::Answered)),
    (Mistake::AnswerOfAnother, Broken::Promise(Promise::Answered)),
    (Mistake::AwakeAfterReset, Broken::Promise(Promise::Off)),
];

/// The first breach of the seeds: after how many inputs.
fn noticed(stand: &mut Stand, mistake: Mistake) -> Option<(usize, &'static str, Box<Breach>)> {
    seeds().into_iter().enumerate().find_map(|(k, (name, bytes))| {
        let breach = stand.run(&bytes, &|device, setup| whole_double(device, setup, mistake)).err()?;
        Some((k + 1, name, breach))
    })
}

#[test]
fn a_device_keeps_every_rule_and_promise_on_the_seeds() {
    let mut stand = Stand::new();
    let broken =
        |(name, bytes): (&str, Vec<u8>)| stand.run(&bytes, &sound).err().map(|breach| format!("{name}: {breach}"));
    let found: Vec<String> = seeds().into_iter().chain(seeds()).filter_map(broken).collect();
    assert!(found.is_empty(), "{}", found.join("\n"));
}

#[test]
fn each_broken_rule_and_promise_is_noticed_on_the_seeds() {
    let mut stand = Stand::new();
    let mut wrong = vec![];
    for &(mistake, broken) in EXPECTED {
        let found = match mistake {
            Mistake::TooFast | Mistake::TooHard | Mistake::NoJointLimits | Mistake::WideTolerance => {
                // The device itself has the mistake, in what it was told to keep to.
                let mut stand = Stand::mistaken(&|setup| mistaken(&setup, mistake));
                noticed(&mut stand, mistake)
            }
            _ => noticed(&mut stand, mistake),
        };
        match found {
            Some((inputs, name, breach)) if breach.broken == broken => {
                println!("{mistake:?}: input {inputs} ({name}): {breach}");
            }
            Some((inputs, name, breach)) => {
                wrong.push(format!("{mistake:?}: input {inputs} ({name}) found another one: {breach}"));
            }
            None => wrong.push(format!("{mistake:?} was not noticed")),
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn a_device_keeps_every_rule_and_promise_on_changed_seeds() {
    let (seeds, mut stand, mut chance) = (seeds(), Stand::new(), Chance::new(5, 0));
    let mut found: Vec<String> = vec![];
    for number in 0..150 {
        let [(_, one), (_, other)] = [(); 2].map(|()| &seeds[chance.below(seeds.len() as u64) as usize]);
        let mut bytes = one.clone();
        for _ in 0..chance.below(8) {
            let at = chance.below(bytes.len() as u64) as usize;
            match chance.below(4) {
                0 => bytes[at] = chance.below(256) as u8,
                1 => drop(bytes.remove(at)),
                2 => bytes.insert(at, chance.below(256) as u8),
                _ => {
                    let from = chance.below(other.len() as u64) as usize;
                    let piece = &other[from..(from + 60).min(other.len())];
                    bytes.splice(at..at, piece.iter().copied());
                }
            }
        }
        found.extend(stand.run(&bytes, &sound).err().map(|breach| format!("{number}: {breach}: {bytes:?}")));
    }
    assert!(found.is_empty(), "{}", found.join("\n"));
}

#[test]
fn power_may_fail_anywhere_in_a_change_of_settings() {
    let mut stand = Stand::new();
    for (moment, after) in (0..3).flat_map(|moment| (0..40).map(move |after| (moment, after))) {
        // Before the reset another change, or one back to the settings that are still in force.
        for lost_frames in [8, 5] {
            let cut = Script::at(Start::Ready).cut(moment, after).ask(9, &[2, 7]).ask(9, &[2, lost_frames]).reset(0);
            let told = cut.awake().ask(9, &[2, 8]).reset(0).ask(9, &[2, 9]).reset(0);
            if let Err(breach) = stand.run(&told.0, &sound) {
                panic!("moment {moment}, operation {after}, {lost_frames} lost frames: {breach}");
            }
        }
    }
}

#[test]
fn an_acknowledgement_that_comes_again_once_it_is_off_is_one_of_its_own() {
    let again = Script::at(Start::Ready).pace(10, 0).stay(40).ask(2, &[]).wait(30).stay(40).step(&[16]).stay(5);
    Stand::new().run(&again.0, &sound).unwrap();
}

#[test]
fn an_input_does_the_same_again_whatever_came_between() {
    let (seeds, mut stand) = (seeds(), Stand::new());
    let mut told = |name: &str| {
        let (_, bytes) = seeds.iter().find(|(found, _)| *found == name).unwrap();
        let breach = stand.run(bytes, &|device, setup| whole_double(device, setup, Mistake::ClampOffByOne));
        breach.map_err(|breach| breach.to_string())
    };
    let first = told("a-part");
    assert!(first.is_err());
    for name in ["power", "update", "closed", "factory"] {
        let _ = told(name);
    }
    assert_eq!(told("a-part"), first);
}
