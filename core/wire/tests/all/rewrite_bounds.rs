//! The last value that is permitted and the first that is not: of places, steps, heights, joint limits and settings.

use crate::rewrite_support;
use rewrite_support::*;
use truepath_units::Offset;
use truepath_wire::rewrite::{Flags, Mode, Reason, Rewriter, Setting, Settings, SettingsError, Status};

/// In the middle of the path, at a node, with settings of the machine.
fn middle(settings: Settings) -> Machine {
    let mut m = Machine::new(settings, image_with(&self::settings(), &nodes(straight()))).active();
    for i in 1..=100 {
        m.send(i * MM / 20, 0, PASS);
    }
    m
}

/// At a way along the straight, the correction settled.
fn at(x: i64) -> Machine {
    let mut m = middle(Settings::at_1_khz());
    for i in 1..=100 {
        m.send(5 * MM + (x - 5 * MM) * i / 100, 0, PASS);
    }
    m
}

/// The first setpoint changes nothing, the second is a fault.
fn edge(reason: Reason, within: [i64; 3], beyond: [i64; 3]) {
    for (to, mode, reason) in [(within, Mode::Active, Reason::None), (beyond, Mode::Fault, reason)] {
        let mut m = middle(Settings { max_step: Offset::from_um(300), ..Settings::at_1_khz() });
        let [x, y, z] = to;
        let out = m.send(5 * MM + x, y, PASS + z);
        assert_eq!((out.mode, out.reason), (mode, reason), "{to:?}");
    }
}

#[test]
fn a_setpoint_a_tolerance_below_the_pass_is_in_it_and_a_nanometre_lower_is_not() {
    edge(Reason::BelowPass, [0, 0, -200_000], [0, 0, -200_001]);
}

#[test]
fn a_setpoint_a_tolerance_beside_the_path_is_on_it_and_a_nanometre_farther_is_not() {
    for side in [-1, 1] {
        edge(Reason::OffPath, [0, side * 200_000, 0], [0, side * 200_001, 0]);
    }
}

#[test]
fn a_setpoint_a_tolerance_back_along_the_path_is_followed_and_a_nanometre_farther_is_not() {
    // From the middle of a segment, because the walk goes back by one in a tick.
    for (last, mode, reason) in [(200_000, Mode::Active, Reason::None), (200_001, Mode::Fault, Reason::Backwards)] {
        let mut m = at(5 * MM + 50_000);
        assert_eq!(m.send(5 * MM - 50_000, 0, PASS).mode, Mode::Active);
        let out = m.send(5 * MM + 50_000 - last, 0, PASS);
        assert_eq!((out.mode, out.reason), (mode, reason), "{last}");
    }
}

#[test]
fn a_step_as_large_as_permitted_is_followed_and_a_nanometre_more_in_either_axis_is_a_jump() {
    for side in [-1, 1] {
        // Beside the path, where a step across it ends within the tolerance.
        let start = |side: i64| {
            let mut m = middle(Settings { max_step: Offset::from_um(150), ..Settings::at_1_khz() });
            assert_eq!(m.send(5 * MM, -side * 75_000, PASS).mode, Mode::Active);
            m
        };
        for (x, y) in [(150_000, 0), (-150_000, 0), (0, side * 150_000)] {
            let out = start(side).send(5 * MM + x, -side * 75_000 + y, PASS);
            assert_eq!((out.mode, out.reason), (Mode::Active, Reason::None), "{x} {y}");
        }
        for (x, y) in [(150_001, 0), (-150_001, 0), (0, side * 150_001)] {
            let out = start(side).send(5 * MM + x, -side * 75_000 + y, PASS);
            assert_eq!((out.mode, out.reason), (Mode::Fault, Reason::Jump), "{x} {y}");
        }
    }
}

#[test]
fn a_setpoint_lost_at_the_gate_and_a_feed_hold_keep_it_shut() {
    let mut m = Machine::on(straight()).armed();
    m.next.sequence += 1;
    assert_eq!(m.send(0, 0, GATE).mode, Mode::Armed, "a setpoint was lost");
    m.next.flags = m.next.flags.with(Flags::FEED_HOLD);
    assert_eq!(m.send(0, 0, GATE).mode, Mode::Armed, "in a feed hold");
    m.next.flags = Flags::DRIVES_ENABLED;
    assert_eq!(m.send(0, 0, GATE).mode, Mode::Active);
}

#[test]
fn the_gate_reaches_from_the_tolerance_below_the_pass_to_its_height() {
    let heights = [(PASS + 5 * MM, true), (PASS + 5 * MM + 1, false), (PASS - 200_000, true), (PASS - 200_001, false)];
    for (z, opens) in heights {
        let mut m = Machine::on(straight()).armed();
        let out = m.send(0, 0, z);
        assert_eq!(out.mode == Mode::Active, opens, "{z}");
        assert!(opens || is_plain(&out, &m.next));
    }
}

#[test]
fn leaving_the_path_is_its_end_where_less_than_the_tolerance_was_left_or_the_end_was_passed() {
    let leaves = |mut m: Machine, x, y| {
        let out = m.send(x, y, PASS);
        (out.mode, out.reason)
    };
    // Aside, 50 µm before the end.
    assert_eq!(leaves(at(10 * MM - 50_000), 10 * MM - 50_000, 250_000), (Mode::Active, Reason::Completed));
    // Over the end in one step from where more was left.
    assert_eq!(leaves(at(10 * MM - 350_000), 10 * MM + 250_000, 0), (Mode::Active, Reason::Completed));
    // Aside of the last segment in one step from where more was left: the end was not passed.
    assert_eq!(leaves(at(10 * MM - 350_000), 10 * MM - 50_000, 250_000), (Mode::Fault, Reason::OffPath));
    // So far ahead in one step that the walk ends at the last of its segments: that is no end of the path.
    assert_eq!(leaves(at(5 * MM), 6 * MM - 10_000, 190_000), (Mode::Fault, Reason::OffPath));
}

/// Gives the machine joint limits of Y.
fn limit(m: &mut Machine, low: i64, high: i64) {
    let mut machine = Settings::at_1_khz();
    machine.joint_limits_nm[1] = (low, high);
    m.rewriter = Rewriter::new(machine, m.rewriter.image().copied()).unwrap();
}

#[test]
fn at_a_joint_limit_the_axis_stands_at_it_and_a_nanometre_nearer_is_no_limit() {
    for reversed in [false, true] {
        // The correction of Y settled over the start; with Y reversed it goes to the lower limit.
        let mut m = Machine::on(straight());
        m.request.frame.axes[1].reversed = reversed;
        m.request.frame = m.request.frame.sealed();
        m.next.frame_crc = m.request.frame.crc;
        let mut m = m.active();
        let full = i64::from(m.stay().correction_nm[1]);
        assert!(full.abs() > 30_000 && (full < 0) == reversed);
        let sign = full.signum();
        let mut seen = |left: i64| {
            if reversed {
                limit(&mut m, -left, i64::MAX)
            } else {
                limit(&mut m, i64::MIN, left)
            }
            let out = m.stay();
            (sign * out.axes[1], out.mode, out.reason, out.status.has(Status::JOINT_LIMITED))
        };
        assert_eq!(seen(full.abs()), (full.abs(), Mode::Active, Reason::None, false));
        assert_eq!(seen(full.abs() - 1), (full.abs() - 1, Mode::Fault, Reason::JointLimit, true));
        // At a limit and beyond it the setpoint goes out as it is.
        for left in [0, -5] {
            assert_eq!(seen(left), (0, Mode::Fault, Reason::JointLimit, true));
        }
    }
}

#[test]
fn beyond_a_joint_limit_the_correction_back_into_the_range_is_whole() {
    // The correction of Y is positive, the setpoint below the lower limit.
    let mut m = Machine::on(straight()).active();
    let full = m.stay().correction_nm[1];
    limit(&mut m, 100_000, i64::MAX);
    let out = m.stay();
    assert_eq!((out.axes[1], out.correction_nm[1], out.mode), (full.into(), full, Mode::Active));
    assert!(full > 30_000 && !out.status.has(Status::JOINT_LIMITED));
}

#[test]
fn joint_limits_may_leave_one_position_but_not_be_the_wrong_way_round() {
    let made = |low, high| {
        let mut machine = Settings::at_1_khz();
        machine.joint_limits_nm[4] = (low, high);
        Rewriter::new(machine, None).map(|_| ())
    };
    assert_eq!(made(7, 7), Ok(()));
    assert_eq!(made(8, 7), Err(SettingsError::JointLimits { axis: 4 }));
    assert_eq!(made(i64::MAX, i64::MIN), Err(SettingsError::JointLimits { axis: 4 }));
}

#[test]
fn every_setting_is_taken_at_the_ends_of_its_range_and_refused_beyond() {
    type Set = fn(&mut Settings, i64);
    let ranges: [(Setting, i64, i64, Set); 6] = [
        (Setting::TickRate, 10, 100_000, |s, v| s.tick_hz = v as u32),
        (Setting::LargestStep, 1, 8_000_000, |s, v| s.max_step = Offset::from_nm(v)),
        (Setting::LostFrames, 0, 16, |s, v| s.max_lost_frames = v as u32),
        (Setting::HoldAfter, 2, 1 << 31, |s, v| s.hold_after_ticks = v as u32),
        (Setting::Fade, 1, 65_536, |s, v| s.fade_ticks = v as u32),
        (Setting::FeedSmoothing, 0, 12, |s, v| s.feed_smoothing = v as u32),
    ];
    for (name, low, high, set) in ranges {
        let made = |value| {
            let mut machine = Settings::at_1_khz();
            set(&mut machine, value);
            Rewriter::new(machine, None).map(|_| ())
        };
        assert_eq!((made(low), made(high)), (Ok(()), Ok(())), "{name}");
        for value in [low - 1, high + 1].into_iter().filter(|&value| value >= 0) {
            assert_eq!(made(value), Err(SettingsError::Range { name, value, low, high }));
        }
    }
}

#[test]
fn a_correction_at_the_warn_level_is_no_warning_and_one_above_it_in_either_axis_is() {
    for (x, y, warns) in [(50_000, -50_000, false), (-50_001, 0, true), (0, 50_001, true), (50_001, 50_001, true)] {
        let mut low = settings();
        low.limits.warn = Offset::from_nm(50_000);
        let mut steady = nodes(straight());
        for node in &mut steady {
            node.chip = [fine(0), fine(0)];
            node.edge = [fine(x), fine(y)];
        }
        let out = Machine::new(Settings::at_1_khz(), image_with(&low, &steady)).active().stay();
        assert_eq!(out.correction_nm[..2], [x as i32, y as i32]);
        assert_eq!(out.status.has(Status::WARN), warns, "{x} {y}");
    }
}
