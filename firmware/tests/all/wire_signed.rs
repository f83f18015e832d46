//! Signed images over the configuration link: what a device with a key takes, and what it does not.

use crate::wire_support;
use truepath_core::image::{DeviceClass, DeviceClasses, PublicKey, SignatureError};
use truepath_core::link::{Ask, Denial, DeviceKeys, DeviceSettings, Reply, ResetCause, Slot};
use truepath_core::rewrite::Mode;
use truepath_fw::flash::{Cut, Moment};
use truepath_fw::ledger::PLACES;
use wire_support::*;

const ALL: DeviceClasses = DeviceClasses::ALL;

fn keys(rig: &mut Rig) -> DeviceKeys {
    let Reply::Keys(keys) = rig.ask(Ask::Keys).unwrap() else { panic!() };
    keys
}

fn trusted(rig: &mut Rig) -> Vec<PublicKey> {
    keys(rig).keys.iter().copied().collect()
}

fn provisioned(seed: u8) -> Rig {
    let mut rig = Rig::new();
    rig.done(Ask::Provision(public(&owner(seed)))).unwrap();
    rig
}

#[test]
fn a_device_without_a_key_is_open_and_one_with_a_key_takes_only_what_is_signed_with_it() {
    let (key, stranger) = (owner(1), owner(2));
    let plain = image_of(straight(0));
    let mut rig = Rig::new();
    assert!(keys(&mut rig).keys.is_open());
    assert_eq!(rig.upload(&plain), Ok(0), "open");
    rig.wipe();
    rig.done(Ask::Provision(public(&key))).unwrap();
    assert_eq!(trusted(&mut rig), [public(&key)]);

    assert_eq!(rig.upload(&plain), Err(Denial::Untrusted(SignatureError::Missing)));
    let by_stranger = SignatureError::UnknownKey { key: public(&stranger).id() };
    assert_eq!(rig.upload(&signed(&plain, &stranger, ALL)), Err(Denial::Untrusted(by_stranger)));
    let board = DeviceClasses::of(&[DeviceClass::Board]).unwrap();
    let elsewhere = SignatureError::OtherClass { found: board, expected: DeviceClass::Bench };
    assert_eq!(rig.upload(&signed(&plain, &key, board)), Err(Denial::Untrusted(elsewhere)));
    assert!(rig.slots().iter().all(|slot| !matches!(slot, Slot::Image { .. })), "none of them is there");

    let good = signed(&plain, &key, ALL);
    let slot = rig.upload(&good).unwrap();
    rig.activate(slot, name(&good)).unwrap();
    rig.reset(ResetCause::PowerOn);
    assert_eq!(rig.status().active.unwrap().crc, name(&good), "it is verified at each start");
    rig.enable();
    rig.arm(1).unwrap();
}

#[test]
fn an_image_that_came_while_the_device_was_open_is_used_no_more() {
    let plain = image_of(straight(0));
    let mut rig = Rig::with_image(&plain);
    assert!(rig.status().active.is_some());
    rig.done(Ask::Provision(public(&owner(1)))).unwrap();
    assert_eq!(rig.status().active, None);
    let missing = Err(Denial::Untrusted(SignatureError::Missing));
    assert_eq!(rig.activate(0, name(&plain)), missing);
    rig.reset(ResetCause::PowerOn);
    assert_eq!(rig.status().active, None);
    assert_eq!(rig.activate(0, name(&plain)), missing);
    rig.enable();
    assert!(rig.arm(1).is_err());
    assert_eq!(rig.mode(), Mode::Bypass);
}

#[test]
fn a_signed_image_in_use_stays_in_use_while_its_key_is_provisioned_and_a_refused_upload_leaves_it() {
    let (key, plain) = (owner(1), image_of(straight(0)));
    let good = signed(&plain, &key, ALL);
    let mut rig = Rig::with_image(&good);
    rig.done(Ask::Provision(public(&key))).unwrap();
    assert_eq!(rig.status().active.unwrap().crc, name(&good));
    assert!(rig.upload(&image_of(straight(10))).is_err());
    assert_eq!(rig.status().active.unwrap().crc, name(&good));
}

#[test]
fn nothing_is_computed_on_a_device_with_a_key() {
    let mut rig = provisioned(1);
    assert_eq!(rig.done(Ask::Compute), Err(Denial::Untrusted(SignatureError::Missing)));
}

#[test]
fn a_key_needs_somebody_at_the_device_and_drives_that_are_off() {
    let mut rig = Rig::absent();
    assert!(!keys(&mut rig).present);
    assert_eq!(rig.done(Ask::Provision(public(&owner(1)))), Err(Denial::NotPresent));
    assert!(keys(&mut rig).keys.is_open());
    let mut rig = Rig::new();
    rig.enable();
    assert_eq!(rig.done(Ask::Provision(public(&owner(1)))), Err(Denial::Mode(Mode::Bypass)));
    assert!(keys(&mut rig).keys.is_open());
}

#[test]
fn keys_are_four_at_most_sound_and_stay() {
    let mut rig = provisioned(1);
    let weak = PublicKey([0; 32]);
    assert_eq!(rig.done(Ask::Provision(weak)), Err(Denial::Untrusted(SignatureError::Key { key: weak.id() })));
    let four: Vec<PublicKey> = (1..=4).map(|seed| public(&owner(seed))).collect();
    for key in &four {
        rig.done(Ask::Provision(*key)).unwrap();
    }
    assert_eq!(rig.done(Ask::Provision(public(&owner(5)))), Err(Denial::KeysFull));
    rig.reset(ResetCause::PowerOn);
    assert_eq!(trusted(&mut rig), four);
    // As often as it takes to fill both sectors of the ledger, and begin them again.
    for round in 0..5 * PLACES as u32 / 2 {
        rig.done(Ask::Configure(DeviceSettings { silence_us: 20_000 + round, ..DeviceSettings::at_1_khz() })).unwrap();
    }
    rig.reset(ResetCause::PowerOn);
    assert_eq!(trusted(&mut rig), four);
}

#[test]
fn power_that_fails_at_any_word_of_a_provisioning_leaves_the_keys_before_or_one_more() {
    let (first, second) = (public(&owner(1)), public(&owner(2)));
    let mut rig = provisioned(1);
    for after_operations in 0..3 {
        for moment in [Moment::Before, Moment::Within(after_operations)] {
            rig.cut(Cut { after_operations, moment });
            let _ = rig.ask(Ask::Provision(second));
            rig.reset(ResetCause::PowerOn);
            let found = trusted(&mut rig);
            assert!(found == [first] || found == [first, second], "{after_operations}: {found:?}");
        }
    }
    rig.done(Ask::Provision(second)).unwrap();
    rig.reset(ResetCause::PowerOn);
    assert_eq!(trusted(&mut rig), [first, second]);
}

#[test]
fn power_that_fails_while_the_ledger_changes_its_sector_loses_no_key() {
    let key = public(&owner(1));
    let changed = |rig: &mut Rig, k: u32| {
        rig.ask(Ask::Configure(DeviceSettings { silence_us: 20_000 + k, ..DeviceSettings::at_1_khz() })).is_ok()
    };
    // The erase is the next operation after the places are used up; the key's words and the record follow.
    for after_operations in 0..6 {
        let mut rig = provisioned(1);
        let mut k = 0;
        // Boots and settings were two records.
        while k + 2 < PLACES as u32 {
            assert!(changed(&mut rig, k));
            k += 1;
        }
        rig.cut(Cut { after_operations, moment: Moment::Within(after_operations) });
        let done = changed(&mut rig, k);
        assert!(!done, "the power failed at operation {after_operations}");
        rig.reset(ResetCause::PowerOn);
        assert_eq!(trusted(&mut rig), [key], "after {after_operations} operations");
        for more in 1..10 {
            assert!(changed(&mut rig, k + more));
        }
        rig.reset(ResetCause::PowerOn);
        assert_eq!(trusted(&mut rig), [key], "after {after_operations} operations");
    }
}
