//! Firmware updates over the link: which are taken, when, and what becomes of the images.

use crate::wire_support;
use truepath_core::image::{DeviceClasses, Rights, Role, SignatureError};
use truepath_core::link::{Ask, CHUNK_BYTES, Change, Denial, Item, Reply, ResetCause, Slot, TRIAL_US, UpdateStage};
use truepath_core::rewrite::{Mode, Refusal};
use truepath_core::update::{Label, UPDATE_HEAD_BYTES, UpdateError};
use truepath_fw::flash::SECTOR_BYTES;
use truepath_fw::program::PROGRAM_BYTES;
use wire_support::update::{install_over_link, program_of, send, stage, status, update_for, update_of};
use wire_support::*;

/// A device with a key for firmware (1), one for images (2), and images in both slots, one of them in use.
fn provisioned() -> Rig {
    let mut rig = Rig::with_loader();
    let firmware_alone = Rights { role: Role::Engineer, signs: false, firmware: false };
    rig.done(Ask::ProvisionFirmware { key: public(&owner(1)), rights: firmware_alone }).unwrap();
    rig.done(Ask::Provision(public(&owner(2)))).unwrap();
    for shift in [0, 10] {
        let image = signed(&image_of(wire_support::straight(shift)), &owner(2), DeviceClasses::ALL);
        let slot = rig.upload(&image).unwrap();
        rig.activate(slot, name(&image)).unwrap();
    }
    rig
}

fn refused(error: UpdateError) -> Result<u32, Denial> {
    Err(Denial::Update(error))
}

#[test]
fn an_update_is_swapped_in_confirmed_and_kept() {
    let mut rig = provisioned();
    let update = update_of(&program_of(1), &owner(1), 100);
    let before = status(&mut rig);
    assert_eq!(
        (before.stage, before.most, before.running, before.least),
        (UpdateStage::Settled, PROGRAM_BYTES, None, 0)
    );
    assert_eq!(before.signs, [true, false, false, false]);
    let name = send(&mut rig, &update).unwrap();
    assert_eq!(stage(&mut rig), UpdateStage::Settled);
    rig.done(Ask::Install).unwrap();
    rig.done(Ask::Install).unwrap();
    assert_eq!((stage(&mut rig), rig.running()), (UpdateStage::Installed, None));
    rig.reset(ResetCause::Software);
    let trial = status(&mut rig);
    let running = trial.running.unwrap();
    assert_eq!((trial.stage, running.name, running.counter), (UpdateStage::Trial, name, 100));
    assert_eq!((running.version, running.key), (Label::of("1.2.3").unwrap(), public(&owner(1)).id()));
    assert_eq!(trial.least, 0, "nothing is forbidden before it is confirmed");
    rig.done(Ask::Confirm).unwrap();
    rig.done(Ask::Confirm).unwrap();
    rig.reset(ResetCause::PowerOn);
    let settled = status(&mut rig);
    assert_eq!((settled.stage, settled.running, settled.least), (UpdateStage::Settled, Some(running), 100));

    let Reply::Log { entries, .. } = rig.ask(Ask::Log { from: 0 }).unwrap() else { panic!() };
    let (key, by) = (Some(public(&owner(1)).id()), entries.iter().rev().find_map(|entry| entry.by));
    let mut logged = vec![];
    let next = rig.logged_next();
    for from in (0..next).step_by(8) {
        let Reply::Log { entries, .. } = rig.ask(Ask::Log { from }).unwrap() else { panic!() };
        logged.extend(entries.into_iter().filter(|entry| entry.sequence >= from && entry.sequence < from + 8));
    }
    for change in [Change::Installed, Change::Confirmed] {
        let found: Vec<_> = logged.iter().filter(|entry| entry.change == change).collect();
        assert_eq!(found.len(), 1, "{change:?} once: {logged:?}");
        assert_eq!((found[0].value, found[0].key, found[0].counter), (name, key, 100));
        assert_eq!(found[0].by, by);
    }
}

#[test]
fn an_update_that_is_not_confirmed_is_undone_by_the_next_start_whatever_causes_it() {
    for cause in [ResetCause::Software, ResetCause::Watchdog, ResetCause::PowerOn] {
        let mut rig = provisioned();
        install_over_link(&mut rig, &update_of(&program_of(1), &owner(1), 100)).unwrap();
        rig.reset(ResetCause::Software);
        rig.done(Ask::Confirm).unwrap();
        install_over_link(&mut rig, &update_of(&program_of(2), &owner(1), 200)).unwrap();
        rig.reset(ResetCause::Software);
        assert_eq!((stage(&mut rig), rig.running().unwrap().counter), (UpdateStage::Trial, 200));
        rig.reset(cause);
        let back = status(&mut rig);
        assert_eq!((back.stage, back.running.unwrap().counter, back.least), (UpdateStage::RolledBack, 100, 100));
        assert_eq!(rig.done(Ask::Confirm), Err(Denial::Update(UpdateError::Nothing)));
        // It can be tried once more as it lies there, or replaced.
        rig.done(Ask::Install).unwrap();
        rig.reset(ResetCause::Software);
        assert_eq!((stage(&mut rig), rig.running().unwrap().counter), (UpdateStage::Trial, 200));
    }
}

#[test]
fn a_trial_that_nobody_confirms_ends_by_itself_once_the_drives_are_off() {
    let mut rig = provisioned();
    install_over_link(&mut rig, &update_of(&program_of(1), &owner(1), 100)).unwrap();
    rig.reset(ResetCause::Software);
    rig.wait(TRIAL_US / 1_000 - 1);
    assert_eq!(rig.restart, None);
    rig.wait(1);
    assert!(rig.restart.take().is_some_and(|restart| !restart.watchdog));

    rig.reset(ResetCause::PowerOn);
    install_over_link(&mut rig, &update_of(&program_of(1), &owner(1), 100)).unwrap();
    rig.reset(ResetCause::Software);
    rig.enable();
    assert_eq!(rig.mode(), Mode::Bypass);
    for _ in 0..TRIAL_US / 1_000_000 + 2 {
        // The link would fall silent: so setpoints come, only more seldom.
        rig.now_us += 990_000;
        for _ in 0..10 {
            rig.stay();
        }
        if rig.mode() == Mode::Off {
            rig.enable();
        }
    }
    assert!(rig.device().drive_enable());
    let now_us = rig.now_us;
    assert_eq!(rig.device().watch(now_us), None, "the drives may be enabled");
    rig.restart = None;
    rig.wait(1_000);
    assert_eq!(rig.mode(), Mode::Off, "the controller has fallen silent");
    assert!(rig.restart.is_some());
}

#[test]
fn only_what_a_key_for_firmware_signed_for_this_board_is_taken_and_nothing_is_lost_for_another() {
    let mut rig = provisioned();
    let (program, key) = (program_of(1), public(&owner(1)).id());
    let good = update_of(&program, &owner(1), 100);
    let mut forged = update_of(&program, &owner(3), 100);
    forged[48..56].copy_from_slice(&key.0);
    let mut relabelled = good.clone();
    relabelled[32] = b'9';
    let mut shapeless = good.clone();
    shapeless[0] = b'X';
    let cases = [
        (update_of(&program, &owner(3), 100), UpdateError::UnknownKey { key: public(&owner(3)).id() }),
        (update_of(&program, &owner(2), 100), UpdateError::UnknownKey { key: public(&owner(2)).id() }),
        (forged, UpdateError::Forged { key }),
        (relabelled, UpdateError::Forged { key }),
        (shapeless, UpdateError::Format),
        (
            update_for("other", &program, &owner(1), 100),
            UpdateError::OtherBoard { found: Label::of("other").unwrap(), expected: Label::of("test").unwrap() },
        ),
        (good[..good.len() - 1].to_vec(), UpdateError::Length { length: 2_047, most: 2_048 }),
        (good[..UPDATE_HEAD_BYTES].to_vec(), UpdateError::Length { length: 0, most: PROGRAM_BYTES }),
        (
            vec![0; (PROGRAM_BYTES as usize) + UPDATE_HEAD_BYTES + 1],
            UpdateError::Length { length: PROGRAM_BYTES + 1, most: PROGRAM_BYTES },
        ),
    ];
    let (slots, active, erased) = (rig.slots(), rig.status().active, rig.flash().wear().erased_sectors);
    for (update, error) in cases {
        assert_eq!(send(&mut rig, &update), refused(error));
        assert_eq!((rig.slots(), rig.status().active), (slots, active), "{error:?}");
        assert_eq!(rig.commit(), Err(Denial::NoUpload));
    }
    assert_eq!(rig.flash().wear().erased_sectors, erased);
    assert_eq!(rig.done(Ask::Install), Err(Denial::Update(UpdateError::Nothing)));

    // A program that is not the one of the head is seen when it is read back.
    let mut changed = good.clone();
    *changed.last_mut().unwrap() ^= 1;
    assert_eq!(send(&mut rig, &changed), refused(UpdateError::Digest));
    assert_eq!(rig.done(Ask::Install), Err(Denial::Update(UpdateError::Nothing)));
    assert_eq!((rig.slots(), rig.status().active), ([Slot::Damaged; 2], None), "both slots are lost by then");

    install_over_link(&mut rig, &good).unwrap();
    rig.reset(ResetCause::Software);
    rig.done(Ask::Confirm).unwrap();
    let older = update_of(&program, &owner(1), 99);
    assert_eq!(send(&mut rig, &older), refused(UpdateError::RolledBack { found: 99, least: 100 }));
    assert!(send(&mut rig, &good).is_ok(), "the same is not older");
    rig.done(Ask::Revoke(key)).unwrap();
    assert_eq!(rig.done(Ask::Install), Err(Denial::Update(UpdateError::Revoked { key })));
    assert_eq!(send(&mut rig, &good), refused(UpdateError::Revoked { key }));
}

#[test]
fn a_device_without_a_key_for_firmware_takes_no_update_and_one_without_a_loader_none_either() {
    let update = update_of(&program_of(1), &owner(1), 100);
    let unknown = UpdateError::UnknownKey { key: public(&owner(1)).id() };
    let mut open = Rig::with_loader();
    assert_eq!(send(&mut open, &update), refused(unknown), "open to images alone");
    open.done(Ask::Provision(public(&owner(1)))).unwrap();
    assert_eq!(send(&mut open, &update), refused(unknown), "a key without the right");
    let mut bare = Rig::new();
    assert_eq!(stage(&mut bare), UpdateStage::NoLoader);
    bare.done(Ask::ProvisionFirmware { key: public(&owner(1)), rights: Rights::default() }).unwrap();
    assert_eq!(send(&mut bare, &update), refused(UpdateError::NoLoader));
    for ask in [Ask::Install, Ask::Confirm] {
        assert_eq!(bare.done(ask), Err(Denial::Update(UpdateError::NoLoader)));
    }
}

#[test]
fn a_key_for_firmware_alone_signs_no_images() {
    let mut rig = provisioned();
    let image = signed(&image_of(wire_support::straight(20)), &owner(1), DeviceClasses::ALL);
    let error = SignatureError::SignsNothing { key: public(&owner(1)).id() };
    assert_eq!(rig.upload(&image), Err(Denial::Untrusted(error)));
}

#[test]
fn no_request_of_an_update_is_taken_while_the_drives_may_be_enabled() {
    let mut rig = provisioned();
    let update = update_of(&program_of(1), &owner(1), 100);
    send(&mut rig, &update).unwrap();
    let bypass = Denial::Mode(Mode::Bypass);
    // Half an upload, and then the drives.
    rig.begin_item(Item::Firmware, &update, 0).unwrap();
    rig.chunk(0, &update[..1_000]).unwrap();
    rig.enable();
    let operations = rig.operations();
    assert_eq!(rig.begin_item(Item::Firmware, &update, 0), Err(bypass));
    assert_eq!(rig.chunk(1_000, &update[1_000..1_100]), Err(Denial::NoUpload));
    for ask in [Ask::Install, Ask::Confirm] {
        assert_eq!(rig.done(ask), Err(bypass));
    }
    assert_eq!(rig.operations(), operations);

    let mut rig = provisioned();
    rig.begin_item(Item::Firmware, &update, 0).unwrap();
    rig.chunk(0, &update[..1_000]).unwrap();
    rig.enable();
    let operations = rig.operations();
    assert_eq!(rig.chunk(1_000, &update[1_000..1_100]), Err(bypass));
    assert_eq!(rig.commit(), Err(bypass));
    assert_eq!(rig.operations(), operations);
}

#[test]
fn while_an_update_waits_or_is_on_trial_nothing_is_written_to_the_slots() {
    let mut rig = provisioned();
    let (update, pending) = (update_of(&program_of(1), &owner(1), 100), Denial::Update(UpdateError::Pending));
    let image = signed(&image_of(wire_support::straight(0)), &owner(2), DeviceClasses::ALL);
    install_over_link(&mut rig, &update).unwrap();
    for trial in [false, true] {
        if trial {
            rig.reset(ResetCause::Software);
            assert_eq!(rig.done(Ask::Install), Err(pending));
        } else {
            assert_eq!(rig.done(Ask::Confirm), Err(pending));
        }
        assert_eq!(rig.upload(&image), Err(pending));
        assert_eq!(send(&mut rig, &update), refused(UpdateError::Pending));
        assert_eq!(rig.done(Ask::Compute), Err(pending));
        for slot in [0, 1] {
            assert!(rig.activate(slot, name(&image)).is_err());
        }
        assert_eq!(rig.status().active, None);
    }
    // Setpoints pass all the same.
    rig.enable();
    assert_eq!(rig.arm(1), Err(Denial::Refused(Refusal::NoImage)));
    rig.reset(ResetCause::PowerOn);
    assert_eq!(stage(&mut rig), UpdateStage::RolledBack);
    assert_eq!(rig.upload(&image), Ok(0));
}

#[test]
fn an_upload_of_any_length_and_in_any_pieces_erases_no_more_than_a_sector_a_request() {
    let mut rig = provisioned();
    for (length, size) in [(1, 1_000), (31, 7), (33, 1), (SECTOR_BYTES, 1_024), (PROGRAM_BYTES as usize, 1_024)] {
        let program: Vec<u8> = (0..length).map(|at| (at / 7) as u8).collect();
        let update = update_of(&program, &owner(1), 100);
        let mut offset = rig.begin_item(Item::Firmware, &update, 0).unwrap() as usize;
        while offset < update.len() {
            let erased = rig.flash().wear().erased_sectors;
            let end = update.len().min(offset + size);
            offset = rig.chunk(offset as u32, &update[offset..end]).unwrap() as usize;
            assert!(rig.flash().wear().erased_sectors <= erased + 1);
        }
        let wrong = Denial::Offset { expected: offset as u32, found: 0, bytes: 1 };
        assert_eq!(rig.chunk(0, &update[..1]), Err(wrong));
        let erased = rig.flash().wear().erased_sectors;
        rig.commit().unwrap();
        assert!(rig.flash().wear().erased_sectors <= erased + 1);
        rig.done(Ask::Install).unwrap();
        rig.reset(ResetCause::Software);
        assert_eq!(stage(&mut rig), UpdateStage::Trial, "{length} bytes");
        rig.reset(ResetCause::Software);
        assert_eq!(stage(&mut rig), UpdateStage::RolledBack);
    }
    let update = update_of(&program_of(1), &owner(1), 100);
    rig.begin_item(Item::Firmware, &update, 0).unwrap();
    rig.chunk(0, &update[..CHUNK_BYTES]).unwrap();
    let incomplete = Denial::Incomplete { length: update.len() as u32, written: CHUNK_BYTES as u32 };
    assert_eq!(rig.commit(), Err(incomplete));
    rig.chunks(CHUNK_BYTES as u32, &update, CHUNK_BYTES).unwrap();
    rig.commit().unwrap();
}
