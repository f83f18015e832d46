//! The log of changes over the configuration link, with power that fails at any moment.

use crate::wire_support;
use truepath_core::image::{DeviceClasses, KeyId, Role};
use truepath_core::link::{Ask, Change, Denial, DeviceSettings, LogEntry, Reply, ResetCause};
use truepath_core::rewrite::Mode;
use truepath_fw::flash::{Cut, LEDGER_SECTORS, Moment, SECTOR_BYTES, WordState};
use truepath_fw::ledger::{MOST_LOGGED, MOST_WAITING, PLACES};
use wire_support::*;

const MOMENTS: [Moment; 5] = [Moment::Before, Moment::Within(0), Moment::Within(1), Moment::Within(77), Moment::After];

/// Number of the next entry, and all that are there.
fn log(rig: &mut Rig) -> (u32, Vec<LogEntry>) {
    let mut all: Vec<LogEntry> = vec![];
    loop {
        let from = all.last().map_or(0, |entry| entry.sequence + 1);
        let Reply::Log { next, entries } = rig.ask(Ask::Log { from }).unwrap() else { panic!() };
        if entries.is_empty() {
            return (next, all);
        }
        all.extend(entries);
    }
}

fn changes(rig: &mut Rig) -> Vec<Change> {
    log(rig).1.iter().map(|entry| entry.change).collect()
}

fn settings(k: u32) -> DeviceSettings {
    DeviceSettings { silence_us: 20_000 + k, ..DeviceSettings::at_1_khz() }
}

#[test]
fn every_change_is_told_with_who_what_and_when_also_behind_resets() {
    let mut rig = Rig::new();
    let (key, image) = (public(&owner(1)), counted(&image_of(straight(0)), &owner(1), DeviceClasses::ALL, 77));
    rig.now_us += 5_000_000;
    rig.done(Ask::Time { unix_s: 1_700_000_000 }).unwrap();
    rig.now_us += 2_500_000;
    rig.done(Ask::Configure(settings(1))).unwrap();
    rig.done(Ask::Provision(key)).unwrap();
    rig.upload(&image).unwrap();
    rig.activate(0, name(&image)).unwrap();
    rig.enable();
    rig.arm(4_711).unwrap();
    rig.done(Ask::Disarm).unwrap();
    rig.done(Ask::ClearCounters).unwrap();
    rig.done(Ask::ReleaseRecording).unwrap();
    rig.wait(100);
    rig.done(Ask::Deactivate).unwrap();
    rig.done(Ask::Restart { watchdog: true }).unwrap();
    rig.reset(ResetCause::Watchdog);
    rig.done(Ask::Configure(settings(2))).unwrap();
    rig.done(Ask::Revoke(key.id())).unwrap();

    let (next, entries) = log(&mut rig);
    let told = |entry: &LogEntry| (entry.change, entry.key, entry.counter);
    let (id, crc) = (Some(key.id()), name(&image));
    let expected = [
        (Change::Configured, None, 0),
        (Change::Configured, None, 0),
        (Change::Provisioned, id, 0),
        (Change::LoggedIn, None, 0),
        (Change::Activated, id, 77),
        (Change::Acknowledged, None, 0),
        (Change::Armed, None, 0),
        (Change::Disarmed, None, 0),
        (Change::CountersCleared, None, 0),
        (Change::RecordingReleased, None, 0),
        (Change::Deactivated, None, 0),
        (Change::Restarted, None, 0),
        (Change::LoggedIn, None, 0),
        (Change::Configured, None, 0),
        (Change::Revoked, id, 0),
    ];
    assert_eq!(entries.iter().map(told).collect::<Vec<_>>(), expected);
    assert!(entries.iter().map(|entry| entry.sequence).eq(1..next), "no number is missing");
    assert_eq!(entries.iter().map(|entry| entry.boots).collect::<Vec<_>>(), [vec![1; 12], vec![2; 3]].concat());
    let by: Vec<_> = entries.iter().map(|entry| entry.by).collect();
    assert_eq!(by, [vec![None; 3], vec![id; 12]].concat(), "nobody is known before there is a key");
    let of = |change| entries.iter().find(|entry| entry.change == change).unwrap();
    assert_eq!([Change::Activated, Change::Deactivated].map(|change| of(change).value), [crc; 2]);
    assert_eq!([Change::Armed, Change::Restarted].map(|change| of(change).value), [4_711, 1]);
    assert_eq!(entries[0].host_s, None, "no host had told the time");
    assert_eq!((entries[1].uptime_us, entries[1].host_s), (7_500_000, Some(1_700_000_002)));
    assert_ne!(entries[0].value, entries[1].value, "the checksum of the settings");
    assert!(entries[..12].is_sorted_by_key(|entry| entry.uptime_us));
    assert_eq!((entries[12].uptime_us, entries[12].host_s), (0, None), "a reset takes the time away");
}

#[test]
fn what_changes_nothing_and_what_is_refused_is_no_entry() {
    let image = image_of(straight(0));
    let mut rig = Rig::with_image(&image);
    for seed in [1, 2] {
        rig.done(Ask::Provision(public(&owner(seed)))).unwrap();
    }
    rig.done(Ask::Revoke(public(&owner(1)).id())).unwrap();
    rig.log_in(&owner(2), Role::Engineer).unwrap();
    let before = changes(&mut rig);
    use Change::{Activated, Configured, LoggedIn, Provisioned, Revoked};
    assert_eq!(before, [Configured, Activated, Provisioned, Provisioned, Revoked, LoggedIn]);
    rig.done(Ask::Configure(DeviceSettings::at_1_khz())).unwrap();
    rig.done(Ask::Revoke(public(&owner(1)).id())).unwrap();
    assert!(rig.done(Ask::Revoke(KeyId([3; 8]))).is_err());
    assert!(rig.done(Ask::Provision(public(&owner(1)))).is_err());
    assert!(rig.activate(0, name(&image)).is_err());
    assert!(rig.done(Ask::Configure(DeviceSettings { axes: 9, ..DeviceSettings::at_1_khz() })).is_err());
    assert!(rig.arm(1).is_err() && rig.done(Ask::Disarm).is_err());
    assert!(rig.done(Ask::AcknowledgeDrivesDisabled).is_err());
    for _ in 0..3 {
        rig.done(Ask::Deactivate).unwrap();
    }
    assert_eq!(changes(&mut rig), [&before[..], &[Change::Deactivated]].concat());
}

#[test]
fn while_something_is_armed_or_on_no_flash_is_written_and_what_has_no_room_is_a_gap_in_the_numbers() {
    let mut rig = Rig::active(&image_of(straight(0)));
    rig.wait(0);
    let (next, kept) = log(&mut rig);
    let operations = rig.operations();
    let more = MOST_WAITING as u32 + 3;
    for _ in 0..more {
        rig.done(Ask::ReleaseRecording).unwrap();
        rig.stay();
        assert_eq!(log(&mut rig), (rig.logged_next(), kept.clone()), "{:?}", rig.mode());
    }
    rig.done(Ask::Disarm).unwrap();
    assert_eq!((rig.mode(), rig.operations()), (Mode::Active, operations));
    rig.settle();
    let (after, entries) = log(&mut rig);
    assert_eq!(after, next + more + 1);
    let written: Vec<u32> = entries.iter().map(|entry| entry.sequence).filter(|&sequence| sequence >= next).collect();
    assert_eq!(written, (next..next + MOST_WAITING as u32).collect::<Vec<_>>());
    rig.done(Ask::ReleaseRecording).unwrap();
    assert_eq!(log(&mut rig).1.last().unwrap().sequence, after, "the numbers between are missing");
}

#[test]
fn the_newest_entries_stay_in_their_order_over_many_changes_of_the_sector() {
    let mut rig = Rig::new();
    for k in 1..=5 * PLACES as u32 {
        rig.done(Ask::Configure(settings(k))).unwrap();
        rig.done(Ask::ReleaseRecording).unwrap();
        if k % 50 == 0 {
            rig.reset(ResetCause::PowerOn);
        }
        if k % 30 == 0 {
            let (next, entries) = log(&mut rig);
            let there = entries.len() as u32;
            assert!(there >= (MOST_LOGGED as u32).min(next - 1) && there <= 192, "{there} of {next}");
            assert!(entries.iter().map(|entry| entry.sequence).eq(next - there..next), "{k}");
        }
    }
    assert!(rig.flash().wear().erased_sectors > 4);
    let one = rig.ask(Ask::Log { from: 0 }).unwrap();
    assert!(matches!(one, Reply::Log { entries, .. } if entries.len() == 8));
}

/// A change and whether it has happened.
type Case = (Change, fn(&mut Rig) -> Result<(), Denial>, fn(&mut Rig) -> bool);

fn prepared(image: &[u8]) -> impl Fn(&mut Rig, bool) {
    move |rig: &mut Rig, full: bool| {
        rig.wipe();
        rig.upload(image).unwrap();
        if full {
            let page = LEDGER_SECTORS.start() + (PLACES * 1_024) as u32;
            // As power cuts would leave them, behind what is there.
            for word in (0..12 * 32)
                .filter(|word| rig.flash().word_state(page + word * 32) == WordState::Blank)
                .collect::<Vec<_>>()
            {
                rig.flash().tear(page + word * 32);
            }
        }
    }
}

#[test]
fn power_that_fails_at_any_operation_leaves_no_change_without_its_entry_and_loses_none() {
    let image = signed(&image_of(straight(0)), &owner(1), DeviceClasses::ALL);
    let cases: [Case; 3] = [
        (Change::Configured, |rig| rig.done(Ask::Configure(settings(9))), |rig| rig.settings() == settings(9)),
        (
            Change::Activated,
            |rig| {
                let crc = rig.slots().iter().find_map(|slot| match slot {
                    truepath_core::link::Slot::Image { crc, .. } => Some(*crc),
                    _ => None,
                });
                rig.activate(0, crc.unwrap())
            },
            |rig| rig.status().active.is_some(),
        ),
        (
            Change::Provisioned,
            |rig| rig.done(Ask::Provision(public(&owner(1)))),
            |rig| matches!(rig.ask(Ask::Keys).unwrap(), Reply::Keys(keys) if !keys.keys.is_open()),
        ),
    ];
    let prepare = prepared(&image);
    let mut rig = Rig::new();
    for (change, make, happened) in cases {
        for full in [false, true] {
            prepare(&mut rig, full);
            let before = log(&mut rig).1;
            let first = rig.operations();
            make(&mut rig).unwrap();
            let operations = rig.operations() - first;
            assert!(operations >= 4);
            for after_operations in 0..operations {
                for moment in MOMENTS {
                    prepare(&mut rig, full);
                    rig.cut(Cut { after_operations, moment });
                    let answered = make(&mut rig).is_ok();
                    for _ in 0..2 {
                        rig.reset(ResetCause::BrownOut);
                        let there = log(&mut rig).1;
                        assert_eq!(there[..before.len()], before, "{change:?} {after_operations} {moment:?}");
                        let noted = there.get(before.len()).is_some_and(|entry| entry.change == change);
                        let is = happened(&mut rig);
                        assert!(noted || !is && !answered, "{change:?} {after_operations} {moment:?}");
                    }
                }
            }
        }
    }
}

#[test]
fn a_change_whose_entry_the_flash_does_not_take_does_not_happen() {
    let mut rig = Rig::new();
    for sector in 0..2 {
        let page = LEDGER_SECTORS.start() + (sector * SECTOR_BYTES + PLACES * 1_024) as u32;
        for word in 0..12 * 32 {
            if rig.flash().word_state(page + word * 32) == WordState::Blank {
                rig.flash().tear(page + word * 32);
            }
        }
    }
    // The other sector cannot be begun either: its erase fails with the power.
    rig.cut(Cut { after_operations: 0, moment: Moment::Before });
    assert!(matches!(rig.done(Ask::Configure(settings(3))), Err(Denial::Flash { .. })));
    assert_eq!(rig.settings(), DeviceSettings::at_1_khz());
}
