//! Any history of uploads, armings, resets and power cuts, against what the device has answered for.

use crate::wire_support;
use proptest::prelude::*;
use truepath_core::link::{Ask, ResetCause, Slot};
use truepath_core::rewrite::Mode;
use truepath_fw::flash::{Cut, Moment};
use wire_support::*;

#[derive(Clone, Debug)]
enum Step {
    Begin(usize),
    Send(usize),
    Commit,
    Activate(u8),
    Deactivate,
    Enable,
    Arm,
    Rearm(u32),
    Disarm,
    Reset,
    Cut(u32, Moment),
}

fn steps() -> impl Strategy<Value = Vec<Step>> {
    let moment = prop_oneof![Just(Moment::Before), any::<u32>().prop_map(Moment::Within), Just(Moment::After)];
    let step = prop_oneof![
        3 => (0..3usize).prop_map(Step::Begin),
        6 => (1..2_000usize).prop_map(Step::Send),
        3 => Just(Step::Commit),
        3 => (0..2u8).prop_map(Step::Activate),
        1 => Just(Step::Deactivate),
        3 => Just(Step::Enable),
        4 => Just(Step::Arm),
        1 => (0..14u32).prop_map(Step::Rearm),
        3 => Just(Step::Disarm),
        1 => Just(Step::Reset),
        2 => (0..60u32, moment).prop_map(|(after, moment)| Step::Cut(after, moment)),
    ];
    prop::collection::vec(step, 10..120)
}

/// What the device has answered for.
#[derive(Default)]
struct Promised {
    /// Checksums of committed images that were not begun over.
    slots: [Option<u32>; 2],
    /// What may be active: the last answer, and one more if the power failed on the way to another.
    active: Vec<Option<u32>>,
    part: u32,
    armed: Vec<u32>,
    current: Option<usize>,
    offset: usize,
}

fn image_in(slot: Slot) -> Option<u32> {
    match slot {
        Slot::Image { crc, .. } => Some(crc),
        _ => None,
    }
}

fn check(rig: &mut Rig, promised: &Promised) {
    let slots = rig.slots();
    for (slot, kept) in slots.into_iter().zip(promised.slots) {
        assert!(kept.is_none() || image_in(slot) == kept, "{slots:?} for {kept:x?}");
    }
    let active = rig.status().active.map(|active| active.crc);
    assert!(promised.active.contains(&active), "{active:x?} for {:x?}", promised.active);
}

fn run(rig: &mut Rig, images: &[Vec<u8>], steps: &[Step]) {
    let mut p = Promised { active: vec![None], ..Promised::default() };
    for step in steps {
        let idle = matches!(rig.mode(), Mode::Off | Mode::Bypass);
        let before = rig.slots();
        match *step {
            Step::Begin(which) => {
                let begun = rig.begin(&images[which]);
                if idle {
                    p.current = None;
                    // Which slot it takes shows only when it is erased or already holds the image.
                    let after = if rig.has_power() { rig.slots() } else { [Slot::Damaged; 2] };
                    let used = rig.status().active.map(|active| usize::from(active.slot));
                    for slot in (0..2).filter(|&slot| used != Some(slot)) {
                        if after[slot] != before[slot] {
                            p.slots[slot] = None;
                        }
                    }
                }
                if let Ok(offset) = begun {
                    (p.current, p.offset) = (Some(which), offset as usize);
                }
            }
            Step::Send(bytes) => {
                let Some(image) = p.current.map(|which| &images[which]) else { continue };
                let end = image.len().min(p.offset + bytes);
                if rig.chunks(p.offset as u32, &image[..end], 1_024).is_ok() {
                    p.offset = end;
                }
            }
            Step::Commit => {
                if let Ok((slot, crc)) = rig.commit() {
                    assert_eq!(Some(crc), p.current.map(|which| name(&images[which])));
                    p.slots[usize::from(slot)] = Some(crc);
                    p.current = None;
                }
            }
            Step::Activate(slot) => {
                let crc = p.slots[usize::from(slot)].unwrap_or(1);
                match rig.activate(slot, crc) {
                    Ok(()) => p.active = vec![Some(crc)],
                    Err(_) if !rig.has_power() => p.active.extend([Some(crc), None]),
                    Err(_) => {}
                }
            }
            Step::Deactivate => match rig.done(Ask::Deactivate) {
                Ok(()) => p.active = vec![None],
                Err(_) if !rig.has_power() => p.active.push(None),
                Err(_) => {}
            },
            Step::Enable => {
                if rig.mode() == Mode::Off {
                    rig.enable();
                }
            }
            Step::Arm => {
                p.part += 1;
                if rig.arm(p.part).is_ok() {
                    p.armed.push(p.part);
                }
            }
            Step::Rearm(back) => {
                if let Some(&part) = p.armed.iter().rev().nth(back as usize) {
                    assert!(rig.arm(part).is_err());
                }
            }
            Step::Disarm => {
                let _ = rig.done(Ask::Disarm);
            }
            Step::Reset => rig.reset(ResetCause::Watchdog),
            Step::Cut(after_operations, moment) => rig.cut(Cut { after_operations, moment }),
        }
        if !rig.has_power() || matches!(step, Step::Reset) {
            rig.reset(ResetCause::BrownOut);
            (p.current, p.offset) = (None, 0);
            assert_eq!(rig.mode(), Mode::Off);
            check(rig, &p);
            p.active = vec![rig.status().active.map(|active| active.crc)];
        } else {
            check(rig, &p);
        }
    }
    // Whatever happened: the way to a corrected part is open, and not for a part that has been armed.
    rig.flash().cut(None);
    rig.reset(ResetCause::PowerOn);
    let slot = rig.upload(&images[0]).unwrap();
    rig.activate(slot, name(&images[0])).unwrap();
    rig.enable();
    for &part in p.armed.iter().rev().take(12) {
        assert!(rig.arm(part).is_err(), "part {part}");
    }
    rig.arm(p.part + 1).unwrap();
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn the_device_keeps_what_it_has_answered_for(steps in steps()) {
        thread_local! {
            static RIG: std::cell::RefCell<Rig> = std::cell::RefCell::new(Rig::new());
        }
        let images = [0, 10, 20].map(|shift| image_of(wire_support::straight(shift)[..30].to_vec()));
        RIG.with_borrow_mut(|rig| {
            rig.wipe();
            run(rig, &images, &steps);
        });
    }
}
