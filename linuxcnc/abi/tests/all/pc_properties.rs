//! Whatever is on the pins, in whatever order: no panic, and what the safety contract says holds in every period.

use crate::pc_support;
use crate::rewrite_support::{GATE, MM, PASS};
use pc_support::*;
use proptest::prelude::*;
use truepath_abi::pc::{Inputs, Switches};

/// What LinuxCNC, its operator or a torn wire may do between two periods.
#[derive(Clone, Debug)]
enum Event {
    /// A switch is turned.
    Turn(u32),
    /// A pin of type float has any bits.
    Float(u8, u64),
    /// A pin of type integer has any bits.
    Integer(u8, u32),
    /// The configuration thread does a round; the disk takes it or not.
    Round(bool),
    /// The pin arm goes up and down, with the next part.
    Arm,
    /// Some periods along the path.
    Mill(u16),
    /// Down through the gate, drives on, everything in order.
    Enter,
    /// Another image, or none.
    Image(bool),
}

fn event() -> impl Strategy<Value = Event> {
    let bits = prop_oneof![
        any::<u64>(),
        prop::sample::select(vec![f64::NAN, f64::INFINITY, -f64::INFINITY, 1e300, -0.0, 5e-324, 1e9, -4e9])
            .prop_map(f64::to_bits),
        (-500.0..500.0f64).prop_map(f64::to_bits),
    ];
    prop_oneof![
        3 => (0..12u32).prop_map(|bit| Event::Turn(1 << bit)),
        1 => (0..14u8, bits).prop_map(|(pin, bits)| Event::Float(pin, bits)),
        1 => (0..10u8, any::<u32>()).prop_map(|(pin, value)| Event::Integer(pin, value)),
        3 => any::<bool>().prop_map(Event::Round),
        3 => Just(Event::Arm),
        6 => (1..300u16).prop_map(Event::Mill),
        6 => Just(Event::Enter),
        1 => any::<bool>().prop_map(Event::Image),
    ]
}

/// A machine in order, at the place where it is.
fn heal(pc: &mut Pc) {
    let fresh = Pc::load(&[]);
    let (place, serial) = (pc.next.pos_cmd, pc.next.part_serial);
    pc.next = Inputs { pos_cmd: place, part_serial: serial, ..fresh.next };
    for switch in [Switches::DRIVES_ON, Switches::PROGRAM_RUNNING] {
        pc.set(switch, true);
    }
}

fn torn(pc: &mut Pc, pin: u8, value: f64) {
    let next = &mut pc.next;
    match pin {
        0..4 => next.pos_cmd[usize::from(pin)] = value,
        4..8 => next.motor_pos_cmd[usize::from(pin - 4)] = value,
        8..11 => next.offset[usize::from(pin - 8)] = value,
        11 => next.spindle_rpm = value,
        _ => next.nm_per_unit = value,
    }
}

fn integer(pc: &mut Pc, pin: u8, value: u32) {
    let next = &mut pc.next;
    match pin {
        0 => next.cosine = value as i32,
        1 => next.sine = value as i32,
        2 => next.motion_type = (value % 8) as i32,
        3 => next.tool = value as i32,
        4 => next.tool_offset = value as i32,
        5 => next.program_crc = value,
        6 => next.feature = value,
        7 => next.setup = value,
        8 => next.part_serial = value,
        _ => next.period_ns = value,
    }
}

/// A period, and what holds in each.
fn checked(pc: &mut Pc, was_armed: &mut bool) {
    let out = pc.period();
    assert!(out.state <= FAULT);
    let largest = out.correction_nm.iter().map(|nm| nm.unsigned_abs()).max().unwrap_or(0);
    assert!(largest <= 500_000, "beyond the clamp: {out:?}");
    assert_eq!(out.correction_nm[2], 0, "Z is not corrected");
    *was_armed |= out.state == ARMED;
    // With the drives that go, it stays until they are off.
    let goes = out.state == OFF && out.forward == 0 && pc.next.switches.has(Switches::DRIVES_ON);
    if out.state <= ARMED && !goes {
        assert!(untouched(&pc.next, &out), "{out:?}");
    }
    if largest > 0 {
        assert!(*was_armed, "a correction without an arming");
        assert_eq!(out.forward != 0, !goes);
        for (joint, axis) in [(0, 0), (1, 1), (2, 2), (3, 1)] {
            let added = out.motor_pos_cmd[joint] - pc.next.motor_pos_cmd[joint];
            let wanted = out.correction[axis];
            let position = pc.next.motor_pos_cmd[joint].abs();
            assert!(!position.is_finite() || (added - wanted).abs() <= (position + 1.0) * 1e-15, "{added} {wanted}");
        }
    }
    if out.state == BYPASS {
        *was_armed = false;
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, ..ProptestConfig::default() })]

    #[test]
    fn no_pin_makes_a_correction_without_an_arming_or_beyond_its_limits(events in prop::collection::vec(event(), 1..60)) {
        let mut pc = Pc::ready(&[]);
        let (mut armed, mut x) = (false, 0);
        for event in events {
            match event {
                Event::Turn(switch) => pc.next.switches.0 ^= switch,
                Event::Float(pin, bits) => torn(&mut pc, pin, f64::from_bits(bits)),
                Event::Integer(pin, value) => integer(&mut pc, pin, value),
                Event::Round(works) => {
                    pc.disk_fails = !works;
                    pc.round();
                }
                Event::Arm => {
                    pc.next.part_serial = pc.next.part_serial.wrapping_add(1);
                    pc.set(Switches::ARM, true);
                    checked(&mut pc, &mut armed);
                    pc.set(Switches::ARM, false);
                    pc.disk_fails = false;
                    pc.round();
                }
                Event::Mill(periods) => {
                    for _ in 0..periods {
                        x = (x + 6_667) % (11 * MM);
                        pc.to(x, 0, PASS);
                        checked(&mut pc, &mut armed);
                    }
                }
                Event::Enter => {
                    heal(&mut pc);
                    x = 0;
                    for i in 0..=50 {
                        pc.to(0, 0, GATE + (PASS - GATE) * i / 50);
                        checked(&mut pc, &mut armed);
                    }
                }
                Event::Image(some) => {
                    if some {
                        pc.offer(&image());
                    } else {
                        // SAFETY: no image.
                        unsafe {
                            truepath_abi::pc_abi::truepath_pc_offer(pc.config, &limits(), std::ptr::null(), 0);
                        }
                    }
                    truepath_abi::pc_abi::truepath_pc_returned(pc.config);
                }
            }
            checked(&mut pc, &mut armed);
        }
    }
}

#[test]
fn the_events_of_the_property_reach_a_correction() {
    let mut pc = Pc::ready(&[]);
    heal(&mut pc);
    assert_eq!(pc.arm(), 0);
    let mut armed = true;
    for i in 0..=50 {
        pc.to(0, 0, GATE + (PASS - GATE) * i / 50);
        checked(&mut pc, &mut armed);
    }
    assert_eq!(pc.last.state, ACTIVE);
    assert!(pc.last.correction_nm[0].abs() > 0);
}
