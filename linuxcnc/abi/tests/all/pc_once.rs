//! One part, one arming: the ledger is on the disk before an arming takes effect, and outlives the component.

use crate::pc_support;
use crate::rewrite_support::*;
use pc_support::*;
use truepath_abi::pc::{PROBING, Switches};
use truepath_abi::pc_abi::*;
use truepath_core::rewrite::Reason;

#[test]
fn nothing_is_armed_before_the_ledger_is_written() {
    let mut pc = Pc::ready(&[]);
    pc.set(Switches::ARM, true);
    for _ in 0..100 {
        assert_eq!(pc.period().state, BYPASS);
    }
    assert!(pc.disk.is_empty());
    pc.round();
    assert!(!pc.disk.is_empty());
    assert_eq!(pc.period().state, ARMED);
    assert_eq!((pc.last.armed_serial, pc.last.refusal), (7, 0));
}

#[test]
fn a_part_is_armed_once_also_after_the_component_was_loaded_anew() {
    let mut pc = Pc::armed();
    pc.set(Switches::DISARM, true);
    pc.period();
    assert_eq!(pc.arm(), 4);
    let mut again = Pc::ready(&pc.disk);
    assert_eq!(again.arm(), 4);
    assert_eq!(again.last.state, BYPASS);
    again.next.part_serial += 1;
    assert_eq!(again.arm(), 0);
    assert_eq!(again.last.state, ARMED);
    let mut third = Pc::ready(&again.disk);
    for serial in [7, 8] {
        third.next.part_serial = serial;
        assert_eq!(third.arm(), 4);
    }
}

#[test]
fn a_ledger_that_cannot_be_written_arms_nothing_and_the_part_may_be_tried_again() {
    let mut pc = Pc::ready(&[]);
    pc.disk_fails = true;
    assert_eq!((pc.arm(), pc.last.state), (67, BYPASS));
    pc.disk_fails = false;
    assert_eq!((pc.arm(), pc.last.state), (0, ARMED));
}

#[test]
fn a_damaged_ledger_is_not_forgotten() {
    let pc = Pc::armed();
    let mut sides = Sides { servo: std::ptr::null_mut(), config: std::ptr::null_mut() };
    let mut open = |file: &[u8]| {
        let block = Box::leak(Box::new(Block::new()));
        // SAFETY: the block is leaked; the file is a slice.
        unsafe { truepath_pc_new(block, &JOINTS, file.as_ptr(), file.len(), &mut sides) }
    };
    assert_eq!(open(&pc.disk), 0);
    for bit in 0..8 * pc.disk.len() {
        let mut damaged = pc.disk.clone();
        damaged[bit / 8] ^= 1 << (bit % 8);
        assert_ne!(open(&damaged), 0, "bit {bit}");
    }
}

#[test]
fn what_comes_while_the_ledger_is_written_takes_the_arming_back() {
    type Event = fn(&mut Pc);
    let events: [Event; 12] = [
        |pc| pc.set(Switches::DISARM, true),
        |pc| pc.set(Switches::ENABLE, false),
        |pc| pc.set(Switches::PROGRAM_RUNNING, false),
        |pc| pc.set(Switches::EMERGENCY_STOP, true),
        |pc| pc.set(Switches::TOOL_CHANGE, true),
        |pc| pc.next.offset[0] = 5.0,
        |pc| pc.set(Switches::DRIVES_ON, false),
        |pc| pc.set(Switches::ALL_HOMED, false),
        |pc| pc.set(Switches::TRIVIAL_KINEMATICS, false),
        |pc| pc.next.program_crc ^= 1,
        |pc| pc.next.tool = 4,
        |pc| pc.next.nm_per_unit = 25.4e6,
    ];
    for (index, event) in events.into_iter().enumerate() {
        let mut pc = Pc::ready(&[]);
        pc.set(Switches::PROGRAM_RUNNING, true);
        pc.period();
        pc.set(Switches::ARM, true);
        pc.period();
        event(&mut pc);
        pc.period();
        pc.round();
        pc.period();
        assert_eq!(pc.last.state, BYPASS, "event {index}");
        // A frame that changed is found by the core, in the period in which it was armed.
        let frame = index == 5;
        assert_eq!(pc.last.refusal, if frame { 0 } else { 69 }, "event {index}");
        assert_eq!(pc.last.reason, if frame { Reason::FrameChanged.code().into() } else { 0 });
    }
}

#[test]
fn a_disarming_in_the_same_period_is_the_stronger_one() {
    let mut pc = Pc::ready(&[]);
    pc.set(Switches::ARM, true);
    pc.set(Switches::DISARM, true);
    pc.period();
    pc.round();
    pc.periods(2);
    assert_eq!((pc.last.state, pc.last.refusal), (BYPASS, 69));
    assert!(pc.disk.is_empty(), "the part is not spent");
}

#[test]
fn an_arming_is_refused_with_its_number() {
    type Event = fn(&mut Pc);
    let refusals: [(Event, u32); 14] = [
        (|pc| pc.set(Switches::ENABLE, false), 64),
        (|pc| pc.set(Switches::TRIVIAL_KINEMATICS, false), 65),
        (|pc| pc.next.motion_type = PROBING, 66),
        (|pc| pc.next.program_crc ^= 1, 16),
        (|pc| pc.next.feature += 1, 17),
        (|pc| pc.next.pass += 1, 18),
        (|pc| pc.next.tool = 4, 19),
        (|pc| pc.next.tool = -1, 19),
        (|pc| pc.next.tool_offset = 0, 20),
        (|pc| pc.next.setup += 1, 21),
        (|pc| pc.next.offset[2] = f64::INFINITY, 5),
        (|pc| pc.next.cosine = 1 << 29, 6),
        (|pc| pc.next.nm_per_unit = 0.0, 5),
        (
            |pc| {
                // SAFETY: no image.
                assert_eq!(unsafe { truepath_pc_offer(pc.config, &limits(), std::ptr::null(), 0) }, 0);
                pc.period();
            },
            2,
        ),
    ];
    for (event, code) in refusals {
        let mut pc = Pc::ready(&[]);
        event(&mut pc);
        assert_eq!((pc.arm(), pc.last.state), (code, BYPASS));
        assert!(pc.disk.is_empty(), "a refused part is not spent");
    }
    let mut pc = Pc::armed();
    assert_eq!((pc.arm(), pc.last.state), (1, ARMED));
    let mut busy = Pc::ready(&[]);
    busy.set(Switches::ARM, true);
    busy.period();
    busy.set(Switches::ARM, false);
    busy.period();
    busy.set(Switches::ARM, true);
    assert_eq!(busy.period().refusal, 68);
}

#[test]
fn images_change_hands_in_bypass_only_and_the_old_one_comes_back() {
    let first = image();
    let other = {
        let mut settings = settings();
        settings.limits.warn = settings.limits.clamp;
        let nodes = nodes(straight());
        let mut bytes = vec![0; first.len()];
        truepath_core::image::build(&settings, &nodes, &mut bytes).unwrap();
        bytes
    };
    let mut pc = Pc::active();
    assert_eq!(truepath_pc_ready(pc.config), 1);
    assert_eq!(pc.offer(&other), 0);
    for _ in 0..50 {
        assert_eq!(pc.period().image_crc, Pc::crc(&first));
    }
    assert_eq!((truepath_pc_ready(pc.config), pc.offer(&other)), (0, 41), "the last one was not taken");
    assert!(truepath_pc_returned(pc.config).is_null());
    pc.set(Switches::DISARM, true);
    pc.period();
    pc.ramp();
    pc.period();
    assert_eq!(pc.last.image_crc, Pc::crc(&other));
    let back = truepath_pc_returned(pc.config);
    // SAFETY: it is the leaked first image.
    assert_eq!(unsafe { std::slice::from_raw_parts(back, first.len()) }, &first[..]);
    assert!(truepath_pc_returned(pc.config).is_null());
}

#[test]
fn an_image_without_limits_of_the_machine_or_with_a_flipped_bit_is_not_taken() {
    let mut pc = Pc::ready(&[]);
    let good = image();
    for bit in (0..8 * good.len()).step_by(97) {
        let mut damaged = good.clone();
        damaged[bit / 8] ^= 1 << (bit % 8);
        let error = pc.offer(&damaged);
        assert!((1..32).contains(&error), "bit {bit}: {error}");
    }
    let bytes = image().leak();
    let mut offered = |change: fn(&mut truepath_abi::pc::Limits)| {
        let mut limits = limits();
        change(&mut limits);
        // SAFETY: leaked.
        unsafe { truepath_pc_offer(pc.config, &limits, bytes.as_ptr(), bytes.len()) }
    };
    assert_eq!(offered(|l| l.least[2] = 500.0), 34);
    assert_eq!(offered(|l| l.velocity[0] = 0.0), 32);
    assert_eq!(offered(|l| l.acceleration[3] = f64::NAN), 35);
    assert_eq!(offered(|l| l.nm_per_unit = 0.0), 32);
    assert_eq!(offered(|l| l.acceleration[1] = 1e-6), 40);
    assert_eq!(offered(|l| l.velocity[2] = 0.0), 0, "Z is not corrected");
}
