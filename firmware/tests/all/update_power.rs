//! Firmware updates with power that fails at every single operation of the flash: of the upload, of the hand-over, of the swap,
//! of the way back, of the confirmation. Whatever happens, a whole program is started: the old one or the new one.

#![expect(clippy::redundant_closure, reason = "a generic function is not one for every lifetime, a closure is")]

use std::cell::RefCell;

use crate::wire_support;
use embedded_storage::nor_flash::NorFlash;
use truepath_core::link::{Ask, Denial, ResetCause, UpdateStage};
use truepath_fw::flash::{
    Cut, FLASH_BYTES, FLASH_WORDS, Moment, Nor, PROGRAM_SECTORS, SECTOR_BYTES, UPDATE_SECTORS, WORD_BYTES, WordState,
};
use truepath_fw::loader::{LoaderFailed, Start, confirm, install, prepare};
use truepath_fw::program;
use wire_support::update::{install_over_link, program_of, stage, update_of};
use wire_support::*;

const MOMENTS: [Moment; 4] = [Moment::Before, Moment::Within(0), Moment::Within(1), Moment::After];

/// A flash with a program, and an update of it over both slots.
#[derive(Clone)]
struct Flash {
    bytes: Vec<u8>,
    words: Vec<WordState>,
}

impl Flash {
    fn new(old: &[u8], new: &[u8]) -> Self {
        let mut flash = Self { bytes: vec![0xFF; FLASH_BYTES], words: vec![WordState::Blank; FLASH_WORDS] };
        let mut nor = Nor::new(&mut flash.bytes, &mut flash.words);
        for (update, region) in [(old, PROGRAM_SECTORS), (new, UPDATE_SECTORS)] {
            let (head, program) = update.split_at(truepath_core::update::UPDATE_HEAD_BYTES);
            let head_at = region.start() + program::PROGRAM_BYTES;
            for (from, bytes) in [(region.start(), program), (head_at, head)] {
                let mut padded = bytes.to_vec();
                padded.resize(bytes.len().next_multiple_of(WORD_BYTES), 0xFF);
                for (at, word) in (from..).step_by(WORD_BYTES).zip(padded.chunks(WORD_BYTES)) {
                    if word != [0xFF; WORD_BYTES] {
                        nor.write(at, word).unwrap();
                    }
                }
            }
        }
        flash
    }
    /// Does something to it, with the power failing in between; what came of it, and operations.
    fn cut<T>(&mut self, cut: Option<Cut>, mut what: impl FnMut(&RefCell<Nor<'_>>) -> T) -> (T, u32) {
        let mut nor = Nor::new(&mut self.bytes, &mut self.words);
        nor.cut(cut);
        let shared = RefCell::new(nor);
        let done = what(&shared);
        (done, shared.into_inner().wear().operations())
    }
    fn start(&mut self) -> Start {
        self.cut(None, |nor| prepare(nor)).0.unwrap()
    }
    /// Counter of the program in its place, if all of it is there.
    fn program(&mut self) -> Option<u32> {
        let mut nor = Nor::new(&mut self.bytes, &mut self.words);
        let head = program::running(&mut nor)?;
        program::running_is_whole(&mut nor).then_some(head.counter)
    }
}

/// Counters of the program that is there and of its update.
const OLD: u32 = 3;
const NEW: u32 = 9;

/// Updates of two programs with words in every sector, some in the same place and some not.
fn updates() -> [Vec<u8>; 2] {
    let of = |counter: u32, length: usize| {
        let seed = counter as u8;
        let mut program = vec![0xFF; length];
        for sector in (0..length).step_by(SECTOR_BYTES) {
            for word in [0, WORD_BYTES * usize::from(seed), SECTOR_BYTES / 2] {
                if let Some(place) = program.get_mut(sector + word..sector + word + WORD_BYTES) {
                    place.fill(seed ^ (sector / SECTOR_BYTES) as u8);
                }
            }
        }
        update_of(&program, &owner(1), counter)
    };
    [of(OLD, 5 * SECTOR_BYTES - 4_000), of(NEW, 4 * SECTOR_BYTES + 77)]
}

/// Tries a step of the loader with a cut at each of its operations; `check` sees the flash after each.
fn at_every_operation(
    flash: &Flash,
    step: impl Fn(&RefCell<Nor<'_>>) -> Result<(), LoaderFailed>,
    mut check: impl FnMut(Flash, &str),
) -> u32 {
    let (done, operations) = flash.clone().cut(None, &step);
    done.unwrap();
    for after_operations in 0..operations {
        for moment in MOMENTS {
            let mut cut = flash.clone();
            let (done, _) = cut.cut(Some(Cut { after_operations, moment }), &step);
            // Only behind the last one may it be thought to be done.
            assert!(done.is_err() || after_operations + 1 == operations, "{after_operations}, {moment:?}");
            check(cut, &format!("operation {after_operations} of {operations}, {moment:?}"));
        }
    }
    operations
}

#[test]
fn a_start_interrupted_at_every_flash_operation_of_the_swap_starts_a_whole_program() {
    let [old_update, new_update] = updates();
    let mut flash = Flash::new(&old_update, &new_update);
    assert_eq!((flash.start(), flash.program()), (Start::Settled, Some(OLD)));
    flash.cut(None, |nor| install(&mut *nor.borrow_mut())).0.unwrap();
    let mut seen = [0, 0];
    let operations = at_every_operation(
        &flash,
        |nor| prepare(nor).map(|_| ()),
        |mut flash, place| {
            let start = flash.start();
            // The last word of the record may be torn; then all were swapped, and the start counts as the one after.
            let expected = if start == Start::Trial { NEW } else { OLD };
            assert_eq!(flash.program(), Some(expected), "{place}: {start:?}");
            assert_ne!(start, Start::Settled, "{place}");
            seen[usize::from(start == Start::Trial)] += 1;
            // Without a confirmation the old one comes back, whatever was before.
            if start == Start::Trial {
                assert_eq!((flash.start(), flash.program()), (Start::RolledBack, Some(OLD)), "{place}");
            }
            assert_eq!((flash.start(), flash.program()), (Start::RolledBack, Some(OLD)), "{place}");
        },
    );
    assert!(operations > 40 && seen.iter().all(|&n| n > 0), "{operations} operations, {seen:?}");
}

#[test]
fn a_start_interrupted_at_every_flash_operation_of_the_way_back_starts_the_old_program() {
    let [old_update, new_update] = updates();
    let mut flash = Flash::new(&old_update, &new_update);
    flash.cut(None, |nor| install(&mut *nor.borrow_mut())).0.unwrap();
    assert_eq!((flash.start(), flash.program()), (Start::Trial, Some(NEW)));
    let operations = at_every_operation(
        &flash,
        |nor| prepare(nor).map(|_| ()),
        |mut flash, place| {
            let start = flash.start();
            assert_ne!(start, Start::Trial, "{place}");
            assert_eq!(flash.program(), Some(OLD), "{place}: {start:?}");
            // And it stays.
            flash.start();
            assert_eq!(flash.program(), Some(OLD), "{place}");
        },
    );
    assert!(operations > 40, "{operations}");
}

#[test]
fn power_that_fails_again_and_again_during_swap_and_way_back_does_no_harm() {
    let [old_update, new_update] = updates();
    let mut marked = Flash::new(&old_update, &new_update);
    marked.cut(None, |nor| install(&mut *nor.borrow_mut())).0.unwrap();
    for pace in [1, 3, 7, 12, 16] {
        let mut flash = marked.clone();
        let mut ended = [0, 0];
        for round in 0..200 {
            let cut = Cut { after_operations: pace + round % 3, moment: MOMENTS[round as usize % 4] };
            if let (Ok(start), _) = flash.cut(Some(cut), |nor| prepare(nor)) {
                let expected = if start == Start::Trial { NEW } else { OLD };
                assert_eq!(flash.program(), Some(expected), "pace {pace}, round {round}, {start:?}");
                ended[usize::from(start == Start::Trial)] += 1;
            }
        }
        if flash.start() == Start::Trial {
            flash.start();
        }
        assert_eq!(flash.program(), Some(OLD), "pace {pace}");
        // A sector takes an erase, up to nine words and a record: with less power nothing is ever done, and nothing lost.
        assert!(pace < 12 || ended[0] > 0, "pace {pace}: {ended:?}");
    }
}

#[test]
fn hand_over_and_confirmation_interrupted_at_every_flash_operation_have_happened_or_have_not() {
    let [old_update, new_update] = updates();
    let mut flash = Flash::new(&old_update, &new_update);
    let mut seen = [0, 0];
    at_every_operation(
        &flash.clone(),
        |nor| install(&mut *nor.borrow_mut()),
        |mut flash, place| {
            let start = flash.start();
            let (expected, index) = if start == Start::Trial { (NEW, 1) } else { (OLD, 0) };
            assert_eq!(flash.program(), Some(expected), "{place}: {start:?}");
            seen[index] += 1;
        },
    );
    assert!(seen.iter().all(|&n| n > 0), "{seen:?}");

    flash.cut(None, |nor| install(&mut *nor.borrow_mut())).0.unwrap();
    assert_eq!(flash.start(), Start::Trial);
    let mut seen = [0, 0];
    at_every_operation(
        &flash.clone(),
        |nor| confirm(&mut *nor.borrow_mut()),
        |mut flash, place| {
            let start = flash.start();
            let (expected, index) = if start == Start::Settled { (NEW, 1) } else { (OLD, 0) };
            assert_eq!(flash.program(), Some(expected), "{place}: {start:?}");
            assert_ne!(start, Start::Trial, "{place}");
            seen[index] += 1;
            // Whichever it is, the other can be installed, for what the loader cares.
            flash.cut(None, |nor| install(&mut *nor.borrow_mut())).0.unwrap();
        },
    );
    assert!(seen.iter().all(|&n| n > 0), "{seen:?}");
    flash.cut(None, |nor| confirm(&mut *nor.borrow_mut())).0.unwrap();
    for _ in 0..3 {
        assert_eq!((flash.start(), flash.program()), (Start::Settled, Some(NEW)));
    }
}

#[test]
fn a_torn_word_of_an_update_is_never_started() {
    let [old_update, new_update] = updates();
    let flash = Flash::new(&old_update, &new_update);
    // Of the program, and of what its head says of it.
    for word in [0, 9, 4_096, 5 * 4_096 - 6, 5 * 4_096 - 3] {
        let mut flash = flash.clone();
        flash.cut(None, |nor| install(&mut *nor.borrow_mut())).0.unwrap();
        Nor::new(&mut flash.bytes, &mut flash.words).tear((word * WORD_BYTES) as u32);
        assert_eq!((flash.start(), flash.program()), (Start::RolledBack, Some(OLD)), "word {word}");
    }
}

#[test]
fn an_update_over_the_link_interrupted_at_every_flash_operation_leaves_a_program_and_a_log() {
    let [old, new] = [program_of(1), program_of(2)].map(|program| program.to_vec());
    let [_, first] = [0, 100].map(|counter| update_of(&old, &owner(1), counter));
    let second = update_of(&new, &owner(1), 200);
    let mut rig = Rig::with_loader();
    let key = public(&owner(1));
    rig.done(Ask::ProvisionFirmware { key, rights: Default::default() }).unwrap();
    install_over_link(&mut rig, &first).unwrap();
    rig.reset(ResetCause::Software);
    rig.done(Ask::Confirm).unwrap();
    let image = signed(&image_of(straight(0)[..40].to_vec()), &owner(1), truepath_core::image::DeviceClasses::ALL);
    let slot = rig.upload(&image).unwrap();
    rig.activate(slot, name(&image)).unwrap();
    let kept = rig.contents();
    let before = rig.operations();
    install_over_link(&mut rig, &second).unwrap();
    let operations = rig.operations() - before;
    assert!(operations > 80, "{operations}");
    let mut seen = [0, 0];
    for after_operations in 0..operations {
        for moment in [Moment::Within(1), Moment::After] {
            rig.restore(&kept);
            rig.cut(Cut { after_operations, moment });
            let done = install_over_link(&mut rig, &second);
            let place = format!("operation {after_operations} of {operations}, {moment:?}: {done:?}");
            assert!(done.is_err() || after_operations + 1 == operations, "{place}");
            rig.reset(ResetCause::BrownOut);
            let found = stage(&mut rig);
            let running = rig.running().unwrap();
            let trial = found == UpdateStage::Trial;
            assert_eq!(running.counter, if trial { 200 } else { 100 }, "{place}: {found:?}");
            assert!(trial || found == UpdateStage::Settled, "{place}: {found:?}");
            seen[usize::from(trial)] += 1;
            // No image of before is taken for one that lies where the update does.
            assert!(!trial || rig.status().active.is_none(), "{place}");
            if trial {
                rig.done(Ask::Confirm).unwrap();
            } else {
                // And the same goes through the second time.
                install_over_link(&mut rig, &second).unwrap();
                rig.reset(ResetCause::Software);
                rig.done(Ask::Confirm).unwrap();
            }
            rig.reset(ResetCause::PowerOn);
            assert_eq!(rig.running().unwrap().counter, 200, "{place}");
            assert!(matches!(install_over_link(&mut rig, &first), Err(Denial::Update(_))), "{place}");
        }
    }
    assert!(seen.iter().all(|&n| n > 0), "{seen:?}");
}
