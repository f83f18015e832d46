//! What goes to the drives is what the core says, to the last bit.

use crate::pc_support;
use crate::rewrite_support::*;
use pc_support::*;
use truepath_abi::pc::Switches;
use truepath_abi::pc_abi::truepath_pc_feedback;
use truepath_core::image::Image;
use truepath_core::rewrite::{ArmRequest, Flags, Frame, Rewriter, Setpoint, Settings, State};

/// Settings that come of [`limits`].
fn machine() -> Settings {
    let mut settings = Settings {
        correction_slew_nm_per_s: 20_000_000,
        correction_acceleration_nm_per_s2: 1_000_000_000,
        require_spindle_load: true,
        ..Settings::at_1_khz()
    };
    for axis in 0..3 {
        settings.joint_limits_nm[axis] = (-500_000_000, 500_000_000);
    }
    settings
}

#[test]
fn a_part_gets_the_corrections_of_the_rewriter_to_the_last_bit_and_linuxcnc_never_sees_them() {
    let bytes = image();
    let rewriter = Rewriter::new(machine(), Some(Image::new_checked(&bytes).unwrap())).unwrap();
    let mut state = State::default();
    rewriter.acknowledge_drives_disabled(&mut state).unwrap();
    let offset = [12_345_678i64, -250_000_001, 7];
    let frame = Frame { offset_nm: offset, ..Frame::identity() }.sealed();
    rewriter.arm(&mut state, &ArmRequest { binding: settings().binding, part_serial: 7, frame }).unwrap();

    let mut pc = Pc::ready(&[]);
    pc.set(Switches::PROGRAM_RUNNING, true);
    pc.next.offset = offset.map(|nm| nm as f64 / 1e6);
    assert_eq!(pc.arm(), 0);
    let mut places = vec![(0, 0, CLEAR); 5];
    places.extend((0..=100).map(|i| (0, 0, GATE + (PASS - GATE) * i / 100)));
    places.extend(along(&straight(), FEED).into_iter().map(|(x, y)| (x, y, PASS)));
    places.extend((1..60).map(|i| (10 * MM + i * FEED, 0, PASS)));
    places.extend([(10 * MM + 59 * FEED, 0, PASS); 300]);
    let (mut corrected, mut states) = (0, vec![]);
    for (tick, (x, y, z)) in places.into_iter().enumerate() {
        pc.next.spindle_rpm = 1500.0 + (tick % 7) as f64;
        let [mx, my, mz] = [x + offset[0], y + offset[1], z + offset[2]];
        let out = pc.go(mx, my, mz);
        let setpoint = Setpoint {
            axes: [mx, my, mz, 0, 0, 0],
            spindle_millirpm: 1_500_000 + 1_000 * (tick as u32 % 7),
            spindle_age_ticks: 0,
            sequence: out.sequence,
            frame_crc: frame.crc,
            flags: Flags::DRIVES_ENABLED.with(Flags::SPINDLE_LOADED),
        };
        assert_eq!(u32::from(setpoint.flags.0), out.flags);
        let expected = rewriter.tick(&mut state, &setpoint);
        assert_eq!(out.correction_nm[..], expected.correction_nm[..3], "tick {tick}");
        assert_eq!((out.state, out.status), (state.mode() as u32, expected.status.0.into()), "tick {tick}");
        assert_eq!((out.node, out.forward), (expected.place.node, 1));
        for (joint, axis) in [(0, 0), (1, 1), (2, 2), (3, 1)] {
            let nm = out.correction_nm[axis];
            let wanted =
                if nm == 0 { pc.next.motor_pos_cmd[joint] } else { pc.next.motor_pos_cmd[joint] + f64::from(nm) / 1e6 };
            assert_eq!(out.motor_pos_cmd[joint].to_bits(), wanted.to_bits());
        }
        // The drive is where it was sent; what LinuxCNC reads is what it commanded, but for the rounding of the sum.
        let mut plain = [0.0; 6];
        truepath_pc_feedback(pc.servo, &out.motor_pos_cmd, &mut plain);
        for (seen, commanded) in plain.iter().zip(pc.next.motor_pos_cmd) {
            assert!((seen - commanded).abs() < 1e-13, "{seen} {commanded}");
        }
        corrected += usize::from(out.correction_nm != [0; 3]);
        states.push(out.state);
    }
    states.dedup();
    assert_eq!(states, [ARMED, ACTIVE, BYPASS]);
    assert!(corrected > 1_500, "{corrected}");
}

#[test]
fn inches_are_nanometres_as_well() {
    let mut mm = Pc::active();
    let mut inch = Pc::ready(&[]);
    inch.next.nm_per_unit = 25.4e6;
    inch.set(Switches::PROGRAM_RUNNING, true);
    let go = |pc: &mut Pc, x: i64, z: i64| {
        pc.next.pos_cmd = [x as f64 / 25.4e6, 0.0, z as f64 / 25.4e6, 0.0, 0.0, 0.0];
        pc.next.motor_pos_cmd = pc.next.pos_cmd;
        pc.period()
    };
    go(&mut inch, 0, CLEAR);
    assert_eq!(inch.arm(), 0);
    for i in 0..=100 {
        go(&mut inch, 0, GATE + (PASS - GATE) * i / 100);
    }
    for i in 1..500 {
        go(&mut inch, i * FEED, PASS);
    }
    assert_eq!(inch.last.correction_nm, mm.last.correction_nm);
    assert_eq!(inch.last.correction[0], f64::from(inch.last.correction_nm[0]) / 25.4e6);
    mm.period();
}
