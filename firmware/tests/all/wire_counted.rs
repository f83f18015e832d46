//! Counters of signed images and revoked keys over the configuration link, with power that fails at any moment.

use crate::wire_support;
use truepath_core::image::{Binding, DeviceClasses, KeyId, MOST_KEYS_EVER, Role, SignatureError};
use truepath_core::link::{AccessError, Ask, Denial, DeviceKeys, DeviceSettings, Reply, ResetCause};
use truepath_core::rewrite::Mode;
use truepath_fw::flash::{Cut, LEDGER_SECTORS, Moment, SECTOR_BYTES};
use truepath_fw::ledger::{FIRST_COUNTER_PLACE, MOST_COUNTED, PLACES};
use wire_support::*;

const ALL: DeviceClasses = DeviceClasses::ALL;
const MOMENTS: [Moment; 5] = [Moment::Before, Moment::Within(0), Moment::Within(1), Moment::Within(77), Moment::After];

fn provisioned() -> Rig {
    let mut rig = Rig::new();
    rig.done(Ask::Provision(public(&owner(1)))).unwrap();
    rig
}

fn keys(rig: &mut Rig) -> DeviceKeys {
    let Reply::Keys(keys) = rig.ask(Ask::Keys).unwrap() else { panic!() };
    keys
}

/// An image of a feature of the part, four nodes long, signed with a counter.
fn image(feature: u32, counter: u32) -> Vec<u8> {
    let settings = part::settings();
    let binding = Binding { feature, ..settings.binding };
    let settings = truepath_core::image::ImageSettings { binding, ..settings };
    counted(&image_with(&settings, straight(0)[..4].to_vec()), &owner(1), ALL, counter)
}

fn put_in_use(rig: &mut Rig, image: &[u8]) -> Result<(), Denial> {
    let slot = rig.upload(image)?;
    rig.activate(slot, name(image))
}

fn rolled_back(found: u32, least: u32) -> Denial {
    Denial::Untrusted(SignatureError::RolledBack { found, least })
}

fn in_use(rig: &mut Rig) -> Option<u32> {
    rig.status().active.map(|active| active.crc)
}

#[test]
fn an_older_image_of_the_same_pass_is_refused_from_the_activation_of_a_newer_one_on() {
    let mut rig = provisioned();
    let (old, new) = (image(1, 100), image(1, 101));
    put_in_use(&mut rig, &old).unwrap();
    // A newer one that is only there forbids nothing yet.
    let slot = rig.upload(&new).unwrap();
    rig.activate(1 - slot, name(&old)).unwrap();
    rig.activate(slot, name(&new)).unwrap();
    assert_eq!(rig.activate(1 - slot, name(&old)), Err(rolled_back(100, 101)), "it is still in its slot");
    assert_eq!(in_use(&mut rig), Some(name(&new)), "the one in use stays");
    for _ in 0..2 {
        assert_eq!(put_in_use(&mut rig, &image(1, 99)), Err(rolled_back(99, 101)));
        assert_eq!(put_in_use(&mut rig, &image(1, 0)), Err(rolled_back(0, 101)), "signed before there were counters");
        rig.reset(ResetCause::PowerOn);
        assert_eq!(in_use(&mut rig), Some(name(&new)));
    }
    put_in_use(&mut rig, &image(1, 101)).unwrap();
    // Another feature has a counter of its own; the way back is to sign the old one again.
    put_in_use(&mut rig, &image(2, 0)).unwrap();
    put_in_use(&mut rig, &image(1, 102)).unwrap();
    assert_eq!(put_in_use(&mut rig, &new), Err(rolled_back(101, 102)));
}

#[test]
fn nothing_is_counted_while_the_device_is_open() {
    let mut rig = Rig::new();
    put_in_use(&mut rig, &image(1, u32::MAX)).unwrap();
    put_in_use(&mut rig, &image(1, 5)).unwrap();
    // The one in use is counted when the first key comes.
    rig.done(Ask::Provision(public(&owner(1)))).unwrap();
    assert_eq!(in_use(&mut rig), Some(name(&image(1, 5))));
    assert_eq!(put_in_use(&mut rig, &image(1, 4)), Err(rolled_back(4, 5)));
}

#[test]
fn power_that_fails_at_any_operation_of_an_activation_leaves_the_old_image_and_counter_or_the_new_ones() {
    let (old, new) = (image(1, 100), image(1, 200));
    // In the middle of a sector, and where its page of counters or its records are used up.
    for fill in [Fill::None, Fill::Counters, Fill::Records] {
        let prepare = |rig: &mut Rig| {
            rig.wipe();
            rig.done(Ask::Provision(public(&owner(1)))).unwrap();
            put_in_use(rig, &old).unwrap();
            rig.upload(&new).unwrap();
            fill.fill(rig);
        };
        let mut rig = Rig::new();
        prepare(&mut rig);
        let (first, erased) = (rig.operations(), rig.flash().wear().erased_sectors);
        rig.activate(1, name(&new)).unwrap();
        let operations = rig.operations() - first;
        assert_eq!(rig.flash().wear().erased_sectors - erased, u32::from(fill != Fill::None), "{fill:?}");
        let mut seen = [0; 2];
        for after_operations in 0..operations {
            for moment in MOMENTS {
                prepare(&mut rig);
                rig.cut(Cut { after_operations, moment });
                let answered = rig.activate(1, name(&new)).is_ok();
                assert!(!rig.has_power());
                let place = format!("{fill:?}, operation {after_operations} of {operations}, {moment:?}");
                for _ in 0..2 {
                    rig.reset(ResetCause::BrownOut);
                    let is_new = in_use(&mut rig) == Some(name(&new));
                    assert!(is_new || in_use(&mut rig) == Some(name(&old)) && !answered, "{place}");
                    seen[usize::from(is_new)] += 1;
                    let back = rig.activate(0, name(&old));
                    assert_eq!(back, if is_new { Err(rolled_back(100, 200)) } else { Ok(()) }, "{place}");
                    assert_eq!(keys(&mut rig).keys.iter().count(), 1, "{place}");
                }
            }
        }
        assert!(seen.iter().all(|&n| n > 0), "{seen:?}");
    }
}

/// What is used up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Fill {
    None,
    Counters,
    Records,
}

impl Fill {
    fn fill(self, rig: &mut Rig) {
        let page = LEDGER_SECTORS.start() + (FIRST_COUNTER_PLACE * 1_024) as u32;
        let programmed =
            |rig: &mut Rig, at: u32| rig.flash().word_state(at) == truepath_fw::flash::WordState::Programmed;
        match self {
            Self::None => {}
            // As power cuts would leave them.
            Self::Counters => {
                for word in 0..128 {
                    if !programmed(rig, page + word * 32) {
                        rig.flash().tear(page + word * 32);
                    }
                }
            }
            Self::Records => {
                let mut k = 0;
                while !programmed(rig, LEDGER_SECTORS.start() + (PLACES as u32 - 1) * 1_024) {
                    k += 1;
                    let settings = DeviceSettings { silence_us: 20_000 + k, ..DeviceSettings::at_1_khz() };
                    rig.done(Ask::Configure(settings)).unwrap();
                }
            }
        }
    }
}

#[test]
fn counters_survive_the_change_of_the_sector_again_and_again() {
    let mut rig = provisioned();
    for feature in 1..=5 {
        put_in_use(&mut rig, &image(feature, 100 + feature)).unwrap();
    }
    let erased = rig.flash().wear().erased_sectors;
    for round in 0..5 * PLACES as u32 / 2 {
        rig.done(Ask::Configure(DeviceSettings { silence_us: 20_000 + round, ..DeviceSettings::at_1_khz() })).unwrap();
    }
    // So often that the page of counters is used up as well.
    for counter in 0..150 {
        put_in_use(&mut rig, &image(9, 1_000 + counter)).unwrap();
    }
    assert!(rig.flash().wear().erased_sectors - erased > 4);
    rig.reset(ResetCause::PowerOn);
    for feature in 1..=5 {
        assert_eq!(put_in_use(&mut rig, &image(feature, 50)), Err(rolled_back(50, 100 + feature)));
    }
    assert_eq!(put_in_use(&mut rig, &image(9, 1_148)), Err(rolled_back(1_148, 1_149)));
}

#[test]
fn of_more_passes_than_have_room_the_lowest_counter_becomes_that_of_every_pass_and_none_ever_goes_back() {
    let mut rig = provisioned();
    let most = MOST_COUNTED as u32;
    for feature in 1..=most {
        put_in_use(&mut rig, &image(feature, 1_000 + feature)).unwrap();
    }
    put_in_use(&mut rig, &image(500, 5)).unwrap();
    assert_eq!(put_in_use(&mut rig, &image(501, 4)), Err(rolled_back(4, 5)), "its own was the lowest, and is known so");
    put_in_use(&mut rig, &image(502, 9_000)).unwrap();
    rig.reset(ResetCause::PowerOn);
    assert_eq!(in_use(&mut rig), Some(name(&image(502, 9_000))));
    // The first one was the lowest: it is forgotten, what it forbade is not.
    assert_eq!(put_in_use(&mut rig, &image(1, 1_000)), Err(rolled_back(1_000, 1_001)));
    assert_eq!(put_in_use(&mut rig, &image(503, 1_000)), Err(rolled_back(1_000, 1_001)), "never seen, but as old");
    for feature in 2..=most {
        assert_eq!(put_in_use(&mut rig, &image(feature, 999)), Err(rolled_back(999, 1_000 + feature)), "{feature}");
    }
    // Signed anew, every one of them is taken.
    put_in_use(&mut rig, &image(1, 9_001)).unwrap();
    put_in_use(&mut rig, &image(503, 9_002)).unwrap();
}

#[test]
fn a_revoked_key_signs_nothing_more_over_resets_and_changes_of_the_sector() {
    let mut rig = provisioned();
    let (one, two) = (public(&owner(1)), public(&owner(2)));
    rig.done(Ask::Provision(two)).unwrap();
    let mine = image(1, 100);
    put_in_use(&mut rig, &mine).unwrap();
    rig.done(Ask::Revoke(one.id())).unwrap();
    rig.done(Ask::Revoke(one.id())).unwrap();
    let revoked = Denial::Untrusted(SignatureError::Revoked { key: one.id() });
    let settings = |round| DeviceSettings { silence_us: 20_000 + round, ..DeviceSettings::at_1_khz() };
    for round in 0..3 {
        assert_eq!(in_use(&mut rig), None, "it was signed with that key");
        assert_eq!(rig.activate(0, name(&mine)), Err(revoked));
        assert_eq!(rig.upload(&image(1, 101)), Err(revoked));
        assert_eq!(rig.done(Ask::Provision(one)), Err(revoked), "it does not come back");
        let now = keys(&mut rig).keys;
        assert_eq!((now.iter().collect::<Vec<_>>(), now.revoked().collect::<Vec<_>>()), (vec![&two], vec![one.id()]));
        (0..PLACES as u32).for_each(|k| rig.done(Ask::Configure(settings(200 * round + k))).unwrap());
        rig.reset(ResetCause::PowerOn);
    }
    assert!(rig.flash().wear().erased_sectors >= 3);
    put_in_use(&mut rig, &signed(&image_of(straight(0)), &owner(2), ALL)).unwrap();
}

#[test]
fn revoking_needs_somebody_at_the_device_drives_that_are_off_and_a_key_that_is_there() {
    let mut rig = provisioned();
    let key = public(&owner(1)).id();
    let stranger = KeyId([7; 8]);
    let unknown = Denial::Untrusted(SignatureError::UnknownKey { key: stranger });
    assert_eq!(rig.done(Ask::Revoke(stranger)), Err(unknown));
    rig.enable();
    assert_eq!(rig.done(Ask::Revoke(key)), Err(Denial::Mode(Mode::Bypass)));
    assert_eq!(Rig::absent().done(Ask::Revoke(key)), Err(Denial::NotPresent));
    assert_eq!(keys(&mut rig).keys.revoked().count(), 0);
}

#[test]
fn with_all_keys_revoked_the_device_is_not_open_but_closed_for_good() {
    let mut rig = Rig::new();
    let all: Vec<_> = (1..=MOST_KEYS_EVER as u8 + 1).map(|seed| public(&owner(seed))).collect();
    for (count, key) in all.iter().enumerate().take(4) {
        rig.done(Ask::Provision(*key)).unwrap();
        assert_eq!(keys(&mut rig).keys.iter().count(), count + 1);
    }
    assert_eq!(rig.done(Ask::Provision(all[4])), Err(Denial::KeysFull));
    // A revoked one makes room for another, until the device has known eight.
    for k in 0..MOST_KEYS_EVER {
        rig.done(Ask::Revoke(all[k].id())).unwrap();
        let more = (k + 4 < all.len()).then(|| rig.done(Ask::Provision(all[k + 4])));
        assert_eq!(
            more,
            match k + 4 {
                4..MOST_KEYS_EVER => Some(Ok(())),
                MOST_KEYS_EVER => Some(Err(Denial::KeysFull)),
                _ => None,
            },
            "{k}"
        );
    }
    for _ in 0..2 {
        let now = keys(&mut rig).keys;
        assert_eq!((now.is_open(), now.iter().count(), now.revoked().count()), (false, 0, MOST_KEYS_EVER));
        let closed = Err(Denial::Access(AccessError::Role { needed: Role::Engineer }));
        assert_eq!(rig.upload(&image_of(straight(0))).map(|_| ()), closed);
        assert_eq!(rig.done(Ask::Compute), closed);
        assert!(rig.upload(&image(1, 1)).is_err());
        rig.reset(ResetCause::PowerOn);
    }
}

#[test]
fn power_that_fails_at_any_operation_of_a_revocation_leaves_the_key_trusted_or_revoked_and_never_the_device_open() {
    for page_is_full in [false, true] {
        let prepare = |rig: &mut Rig| {
            rig.wipe();
            rig.done(Ask::Provision(public(&owner(1)))).unwrap();
            let page = LEDGER_SECTORS.start() + SECTOR_BYTES as u32 - 1_024;
            // Behind the first key, as power cuts would leave the others.
            (2..32).filter(|_| page_is_full).for_each(|word| rig.flash().tear(page + word * 32));
        };
        let mut rig = Rig::new();
        let key = public(&owner(1)).id();
        prepare(&mut rig);
        let first = rig.operations();
        rig.done(Ask::Revoke(key)).unwrap();
        let operations = rig.operations() - first;
        // The entry of the log and the revocation; or more.
        assert_eq!(operations > 3, page_is_full);
        for after_operations in 0..operations {
            for moment in MOMENTS {
                prepare(&mut rig);
                rig.cut(Cut { after_operations, moment });
                let answered = rig.done(Ask::Revoke(key)).is_ok();
                for _ in 0..2 {
                    rig.reset(ResetCause::BrownOut);
                    let now = keys(&mut rig).keys;
                    assert!(!now.is_open() && now.is_revoked(key) != now.iter().any(|there| there.id() == key));
                    assert!(!answered || now.is_revoked(key), "operation {after_operations}, {moment:?}");
                }
                rig.done(Ask::Revoke(key)).unwrap();
                rig.reset(ResetCause::PowerOn);
                assert!(keys(&mut rig).keys.is_revoked(key));
            }
        }
    }
}
