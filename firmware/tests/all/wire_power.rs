//! Power that fails at every single operation of the flash: before it, in the middle of it, after it.

use crate::wire_support;
use truepath_core::image::crc32;
use truepath_core::link::{ActiveImage, Ask, CHUNK_BYTES, Denial, ResetCause, Slot};
use truepath_core::rewrite::Refusal;
use truepath_fw::flash::{Cut, Moment, SECTOR_BYTES, WordState};
use wire_support::*;

const MOMENTS: [Moment; 5] = [Moment::Before, Moment::Within(0), Moment::Within(1), Moment::Within(77), Moment::After];

/// What the device had answered when the power failed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Answered {
    committed: bool,
    activated: bool,
    armed: bool,
}

/// Upload into the idle slot, use it, arm the next part.
fn replace(rig: &mut Rig, image: &[u8]) -> Answered {
    let mut answered = Answered { committed: rig.upload(image).is_ok(), ..Answered::default() };
    answered.activated = answered.committed && rig.activate(1, name(image)).is_ok();
    answered.armed = answered.activated && rig.arm(2).is_ok();
    answered
}

fn is(slot: Slot, image: &[u8]) -> bool {
    matches!(slot, Slot::Image { crc, length, .. } if crc == name(image) && length as usize == image.len())
}

#[test]
fn an_upload_interrupted_at_every_flash_operation_leaves_the_old_image_or_the_new_one() {
    let old = image_of(straight(0));
    // The idle slot holds an image before, so that erases matter; words of zeros and ones are among the new ones.
    let (before, new) = (image_of(straight(10)[..40].to_vec()), image_of(straight(20)[..40].to_vec()));
    let mut rig = Rig::new();
    let prepare = |rig: &mut Rig| {
        rig.wipe();
        rig.upload(&old).unwrap();
        rig.activate(0, name(&old)).unwrap();
        rig.upload(&before).unwrap();
        rig.enable();
        rig.arm(1).unwrap();
        rig.done(Ask::Disarm).unwrap();
    };
    prepare(&mut rig);
    let first = rig.operations();
    assert_eq!(replace(&mut rig, &new), Answered { committed: true, activated: true, armed: true });
    let operations = rig.operations() - first;
    assert!(operations > 60, "{operations}");
    let mut seen = [0; 4];
    for after_operations in 0..operations {
        for moment in MOMENTS {
            prepare(&mut rig);
            rig.cut(Cut { after_operations, moment });
            let answered = replace(&mut rig, &new);
            assert!(!rig.has_power() && !answered.armed);
            rig.reset(ResetCause::BrownOut);
            let place = format!("operation {after_operations}, {moment:?}, {answered:?}");
            let slots = rig.slots();
            assert!(is(slots[0], &old), "{place}: {slots:?}");
            seen[match slots[1] {
                Slot::Image { .. } if is(slots[1], &before) => 0,
                Slot::Image { .. } => 1,
                Slot::Partial { .. } => 2,
                _ => 3,
            }] += 1;
            if let Slot::Image { .. } = slots[1] {
                assert!(is(slots[1], if answered.committed { &new } else { &before }) || is(slots[1], &new), "{place}");
            }
            assert!(!answered.committed || is(slots[1], &new), "{place}");
            let active = rig.status().active.unwrap();
            let [with_old, with_new] = [(0, name(&old)), (1, name(&new))].map(|(slot, crc)| ActiveImage { slot, crc });
            assert!(active == with_new || (active == with_old && !answered.activated), "{place}: {active:?}");
            // Part 1 was armed before and stays so, with either image.
            rig.enable();
            assert_eq!(rig.arm(1), Err(Denial::Refused(Refusal::PartRepeated { part_serial: 1 })), "{place}");
            // And the same goes through the second time.
            let again = rig.upload(&new).unwrap();
            rig.activate(again, name(&new)).unwrap();
            let _ = rig.arm(2);
            rig.reset(ResetCause::PowerOn);
            rig.enable();
            assert_eq!(rig.arm(2), Err(Denial::Refused(Refusal::PartRepeated { part_serial: 2 })), "{place}");
        }
    }
    // The cases are worth their name: each of the four happened.
    assert!(seen.iter().all(|&n| n > 0), "{seen:?}");
}

#[test]
fn an_upload_goes_on_after_a_power_cut_without_sending_everything_again() {
    let mut rig = Rig::new();
    let image = image_of((0..9_000).map(|i| (i * 100_000, 0)).collect());
    // Words of the third sector, the last but one of them torn.
    for (sector, moment) in [(2, Moment::Within(5)), (2, Moment::Before), (1, Moment::Within(9))] {
        rig.wipe();
        rig.begin(&image).unwrap();
        let words = (sector * SECTOR_BYTES + 4_096) / 32 - 2;
        rig.cut(Cut { after_operations: words as u32, moment });
        assert!(matches!(rig.chunks(0, &image, CHUNK_BYTES), Err(Denial::Flash { .. })));
        rig.reset(ResetCause::BrownOut);
        let offset = rig.begin(&image).unwrap() as usize;
        let expected = if moment == Moment::Before { words * 32 } else { sector * SECTOR_BYTES - 64 };
        assert_eq!(offset, expected);
        rig.chunks(offset as u32, &image, CHUNK_BYTES).unwrap();
        assert_eq!(rig.commit(), Ok((0, name(&image))));
    }
}

#[test]
fn the_ledger_never_loses_an_arming_it_has_answered_for() {
    // Around the change of the sector, which two entries of the log for each part bring on.
    const FIRST: u32 = 90;
    let image = image_of(straight(0)[..4].to_vec());
    let mut rig = Rig::new();
    let arm = |rig: &mut Rig, part: u32| rig.arm(part).and_then(|()| rig.done(Ask::Disarm));
    let prepare = |rig: &mut Rig| {
        rig.wipe();
        rig.upload(&image).unwrap();
        rig.activate(0, name(&image)).unwrap();
        rig.enable();
        (1..=FIRST).for_each(|part| arm(rig, part).unwrap());
    };
    prepare(&mut rig);
    let first = rig.operations();
    let erased = rig.flash().wear().erased_sectors;
    (FIRST + 1..FIRST + 12).for_each(|part| arm(&mut rig, part).unwrap());
    assert_eq!(rig.flash().wear().erased_sectors, erased + 1, "the change of the sector is among them");
    let operations = rig.operations() - first;
    for after_operations in 0..operations {
        for moment in MOMENTS {
            prepare(&mut rig);
            rig.cut(Cut { after_operations, moment });
            let mut answered = FIRST;
            while arm(&mut rig, answered + 1).is_ok() {
                answered += 1;
            }
            assert!(!rig.has_power());
            for _ in 0..2 {
                rig.reset(ResetCause::BrownOut);
                rig.enable();
                // One more may have been written without an answer: then fifteen of the answered ones are left.
                for part in answered - 14..=answered {
                    let refused = Err(Denial::Refused(Refusal::PartRepeated { part_serial: part }));
                    assert_eq!(rig.arm(part), refused, "operation {after_operations}, {moment:?}");
                }
            }
            arm(&mut rig, answered + 2).unwrap();
        }
    }
}

#[test]
fn power_that_fails_again_and_again_at_the_same_place_does_no_harm() {
    let image = image_of(straight(0)[..10].to_vec());
    let mut rig = Rig::new();
    for after_operations in 0..12 {
        rig.wipe();
        for round in 0..40 {
            rig.cut(Cut { after_operations, moment: Moment::Within(round) });
            let done = rig.upload(&image).is_ok();
            assert!(!done || rig.has_power());
            rig.reset(ResetCause::BrownOut);
        }
        rig.upload(&image).unwrap();
        rig.activate(0, name(&image)).or_else(|_| rig.activate(1, name(&image))).unwrap();
    }
}

#[test]
fn a_torn_word_anywhere_in_a_committed_image_is_noticed_at_the_next_reset() {
    let (old, new) = (image_of(straight(0)), image_of(straight(10)));
    let mut rig = Rig::new();
    let words = 2 + image_words(&new);
    for word in (0..words).step_by(7).chain([0, 1, 2, words - 1]) {
        rig.wipe();
        rig.upload(&old).unwrap();
        rig.upload(&new).unwrap();
        rig.activate(1, name(&new)).unwrap();
        let offset = (3 * SECTOR_BYTES + word * 32) as u32;
        // In the slot that is not in use as well.
        let other = word as u32 * 32;
        if word % 2 == 0 {
            rig.flash().tear(other);
            rig.reset(ResetCause::BrownOut);
            assert_eq!(rig.slots()[0], Slot::Damaged, "word {word}");
            assert_eq!(rig.status().active.unwrap().crc, name(&new));
            assert_eq!(rig.upload(&old), Ok(0));
        }
        assert_eq!(rig.flash().word_state(offset), WordState::Programmed);
        rig.flash().tear(offset);
        rig.reset(ResetCause::BrownOut);
        assert_eq!(rig.status().active, None, "word {word}");
        assert_eq!(rig.slots()[1], Slot::Damaged);
        assert!(is(rig.slots()[0], &old));
        rig.enable();
        assert_eq!(rig.arm(1), Err(Denial::Refused(Refusal::NoImage)));
        assert_eq!(rig.upload(&new), Ok(1));
        rig.activate(1, name(&new)).unwrap();
        rig.arm(1).unwrap();
    }
}

fn image_words(image: &[u8]) -> usize {
    assert_ne!(crc32(image), 0);
    image.len().div_ceil(32)
}

#[test]
fn a_torn_word_anywhere_in_the_ledger_costs_at_most_the_newest_record() {
    let image = image_of(straight(0)[..4].to_vec());
    let mut rig = Rig::new();
    for word in 0..24 {
        rig.wipe();
        rig.upload(&image).unwrap();
        rig.activate(0, name(&image)).unwrap();
        rig.enable();
        for part in 1..=3 {
            rig.arm(part).unwrap();
            rig.done(Ask::Disarm).unwrap();
        }
        // Boots, settings, activate, three armings: six records of 1 KiB.
        let newest = (6 * SECTOR_BYTES + 5 * 1_024) as u32;
        assert_eq!(rig.flash().word_state(newest), WordState::Programmed);
        assert_eq!(rig.flash().word_state(newest + 1_024), WordState::Blank);
        if rig.flash().word_state(newest + word * 32) != WordState::Programmed {
            continue;
        }
        rig.flash().tear(newest + word * 32);
        rig.reset(ResetCause::BrownOut);
        assert_eq!(rig.status().active.unwrap().crc, name(&image));
        rig.enable();
        for part in 1..=2 {
            assert_eq!(rig.arm(part), Err(Denial::Refused(Refusal::PartRepeated { part_serial: part })), "word {word}");
        }
        rig.arm(4).unwrap();
        rig.reset(ResetCause::BrownOut);
        rig.enable();
        assert_eq!(rig.arm(4), Err(Denial::Refused(Refusal::PartRepeated { part_serial: 4 })));
    }
}
