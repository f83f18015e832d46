//! Whatever happens, no drive that is on sees a step: the correction of a joint changes within the limits of speed and
//! acceleration of the machine from period to period, in its own nanometres and not in those of a pin.

use crate::pc_support;
use crate::rewrite_support::*;
use pc_support::*;
use proptest::prelude::*;
use truepath_abi::pc::{Inputs, Outputs, PROBING, Switches};
use truepath_core::rewrite::{Reason, Status};

/// What the drives of X, Y and the second Y got beyond the command, nm; none where there is no number.
fn added(inputs: &Inputs, out: &Outputs) -> [Option<f64>; 3] {
    [0, 1, 3].map(|joint| {
        let nm = (out.motor_pos_cmd[joint] - inputs.motor_pos_cmd[joint]) * 1e6;
        (inputs.motor_pos_cmd[joint].abs() < 1e6).then_some(nm)
    })
}

/// Corrections and their speeds of the periods before.
#[derive(Default)]
struct Watch {
    places: [Option<f64>; 3],
    speeds: [Option<f64>; 3],
}

impl Watch {
    /// A period; the limits are 20 mm/s and 1 m/s² at 1 kHz, and positions are rounded to whole nanometres.
    fn period(&mut self, pc: &mut Pc) {
        let out = pc.period();
        let now = added(&pc.next, &out);
        // Without power no drive follows; a joint limit goes before the limits of speed.
        let drives = pc.next.switches.has(Switches::DRIVES_ON);
        let limited = out.status & u32::from(Status::JOINT_LIMITED.0) != 0;
        for (joint, nm) in now.into_iter().enumerate() {
            let speed = nm.zip(self.places[joint]).map(|(now, before)| now - before);
            if let Some(speed) = speed.filter(|_| drives && !limited) {
                assert!(speed.abs() <= 20_001.5, "joint {joint} steps by {speed} nm: {out:?}");
                // Where the drives go it stops at once.
                if let Some(before) = self.speeds[joint].filter(|_| out.state != OFF) {
                    assert!((speed - before).abs() <= 1_003.0, "joint {joint} jerks from {before} to {speed}: {out:?}");
                }
            }
            (self.places[joint], self.speeds[joint]) = if drives && !limited { (nm, speed) } else { (None, None) };
        }
    }
}

/// What may happen to the pins between two periods, for some periods.
#[derive(Clone, Debug)]
enum Event {
    Switch(u32),
    NoLength(u8),
    Unit(f64),
    Offset(u8),
    Probing,
    Program,
    Tool,
    Jump(i64),
    Back,
    Stand,
    NoImage,
}

fn event() -> impl Strategy<Value = Event> {
    prop_oneof![
        (0..12u32).prop_map(|bit| Event::Switch(1 << bit)),
        (0..8u8).prop_map(Event::NoLength),
        prop::sample::select(vec![25.4e6, 1e3, 0.0, f64::NAN, f64::INFINITY, -1e6]).prop_map(Event::Unit),
        (0..5u8).prop_map(Event::Offset),
        Just(Event::Probing),
        Just(Event::Program),
        Just(Event::Tool),
        prop::sample::select(vec![MM / 2, -30 * MM, 100_000 * MM]).prop_map(Event::Jump),
        Just(Event::Back),
        Just(Event::Stand),
        Just(Event::NoImage),
    ]
}

fn apply(pc: &mut Pc, event: &Event) {
    let next = &mut pc.next;
    match event {
        Event::Switch(bit) => next.switches.0 ^= bit,
        Event::NoLength(pin) if *pin < 4 => next.pos_cmd[usize::from(*pin)] = f64::NAN,
        Event::NoLength(pin) => next.motor_pos_cmd[usize::from(pin - 4)] = f64::INFINITY,
        Event::Unit(unit) => next.nm_per_unit = *unit,
        Event::Offset(pin) if *pin < 3 => next.offset[usize::from(*pin)] += 0.01,
        Event::Offset(3) => next.cosine = 0,
        Event::Offset(_) => next.sine = i32::MIN,
        Event::Probing => next.motion_type = PROBING,
        Event::Program => next.program_crc ^= 1,
        Event::Tool => next.tool = -1,
        Event::NoImage => {
            // SAFETY: no image.
            unsafe { truepath_abi::pc_abi::truepath_pc_offer(pc.config, &limits(), std::ptr::null(), 0) };
        }
        Event::Jump(_) | Event::Back | Event::Stand => {}
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, ..ProptestConfig::default() })]

    #[test]
    fn no_event_makes_a_drive_that_is_on_step(
        milled in 1..900i64,
        events in prop::collection::vec((event(), 1..200u32, any::<bool>()), 1..6),
    ) {
        let mut pc = Pc::armed();
        let mut watch = Watch::default();
        for i in 0..=100 {
            pc.to(0, 0, GATE + (PASS - GATE) * i / 100);
            watch.period(&mut pc);
        }
        let mut x = 0;
        for _ in 0..milled {
            x += FEED;
            pc.to(x, 0, PASS);
            watch.period(&mut pc);
        }
        prop_assert_eq!(pc.last.state, ACTIVE);
        let good = pc.next;
        for (event, periods, healed) in events {
            if let Event::Jump(by) = event {
                x += by;
            }
            for i in 0..periods {
                match event {
                    Event::Stand => {}
                    Event::Back => x -= FEED,
                    _ => x += FEED,
                }
                pc.to(x, 0, PASS);
                // A pin that is touched for one period only is the shortest that may happen.
                if i == 0 || !matches!(event, Event::Switch(_) | Event::Program | Event::NoImage | Event::Offset(0..3)) {
                    apply(&mut pc, &event);
                }
                watch.period(&mut pc);
                if healed && i == 0 {
                    pc.next = Inputs { pos_cmd: pc.next.pos_cmd, motor_pos_cmd: pc.next.motor_pos_cmd, ..good };
                }
            }
        }
    }
}

#[test]
fn a_unit_that_is_changed_while_a_correction_is_on_ends_it_and_nothing_jumps() {
    for unit in [25.4e6, 1e3, 0.0, f64::NAN, f64::INFINITY, -1e6] {
        let mut pc = Pc::active();
        let before = pc.last.correction_nm[0];
        pc.next.nm_per_unit = unit;
        pc.period();
        assert_eq!((pc.last.state, pc.last.reason), (FAULT, Reason::Abort.code().into()), "{unit}");
        let [x, ..] = added(&pc.next, &pc.last);
        assert!((x.unwrap() - f64::from(before)).abs() <= 20_001.0, "{unit}: {x:?} nm instead of {before}");
        pc.ramp();
        // It is only another unit from here on.
        pc.period();
        assert!(untouched(&pc.next, &pc.last));
    }
    let mut pc = Pc::armed();
    pc.next.nm_per_unit = 25.4e6;
    assert_eq!(pc.period().state, BYPASS);
}

#[test]
fn where_a_position_is_no_length_the_correction_stays_until_the_drives_are_off() {
    let mut pc = Pc::active();
    let before = pc.last.correction_nm;
    pc.next.pos_cmd[2] = f64::NAN;
    for _ in 0..5 {
        let out = pc.period();
        assert_eq!((out.state, out.forward, out.correction_nm), (OFF, 0, before));
        assert_eq!(added(&pc.next, &out)[0].map(f64::round), Some(f64::from(before[0])));
        let mut plain = [0.0; 6];
        truepath_abi::pc_abi::truepath_pc_feedback(pc.servo, &out.motor_pos_cmd, &mut plain);
        assert!((plain[0] - pc.next.motor_pos_cmd[0]).abs() < 1e-12, "LinuxCNC does not see it");
    }
    pc.set(Switches::DRIVES_ON, false);
    pc.period();
    assert!(untouched(&pc.next, &pc.last));
}
