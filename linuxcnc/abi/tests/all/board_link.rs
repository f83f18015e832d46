//! What the controller's end does with the answers of a board, event by event. That the drives never jump is asserted
//! in every tick, see `board_support`.

use crate::board_support;

use board_support::*;
use truepath_abi::board::{Board, BoardSettings, BoardSettingsError, Cause, PACKET_BYTES, RECOVERY_TICKS};
use truepath_core::rewrite::{Flags, Mode, Output, Status};

const SAFETY: &str = include_str!("../../../../docs/safety.md");
const HERE: &str = include_str!("board_link.rs");

#[test]
fn the_table_of_the_controllers_end_names_tests_that_exist() {
    let (_, behind) = SAFETY.split_once("## When the board is not heard").unwrap();
    let section = behind.split("\n## ").next().unwrap();
    let named: Vec<&str> = section
        .lines()
        .filter(|line| line.starts_with("| ") && line.contains('`'))
        .filter_map(|line| line.trim_end_matches('|').rsplit_once('|'))
        .flat_map(|(_, tests)| tests.split('`').skip(1).step_by(2))
        .collect();
    assert!(named.len() > 8, "{named:?}");
    for name in named.iter().filter(|name| !name.ends_with(".rs")) {
        assert!(HERE.contains(&format!("#[test]\nfn {name}()")), "{name}");
    }
}

#[test]
fn a_part_over_the_link_is_corrected_as_by_the_rewriter_alone_to_the_last_bit() {
    let mut rig = Rig::ready(board_settings());
    let mut alone = Machine::on(straight()).armed();
    rig.device.arm(&rig.rewriter, &rig.request).unwrap();
    let mut corrected = 0;
    for tick in 0..1_900i64 {
        let z = if tick < 200 { CLEAR + (PASS - CLEAR) * tick.min(150) / 150 } else { PASS };
        rig.next.axes = [(tick - 250).max(0) * FEED, 0, z, 0, 0, 0];
        let driven = rig.tick(Cable::Good);
        let [x, y, z, ..] = rig.next.axes;
        let wanted = alone.send(x, y, z);
        assert_eq!(driven.correction_nm, wanted.correction_nm, "tick {tick}");
        assert_eq!((driven.board.mode, driven.status), (wanted.mode, wanted.status));
        assert!(driven.answered && driven.enable);
        corrected += u32::from(driven.correction_nm != [0; 6]);
    }
    assert!(corrected > 1_000);
    assert_eq!(alone.state.mode(), Mode::Bypass, "through to the end");
}

#[test]
fn nothing_is_added_while_the_board_is_off_in_bypass_or_armed() {
    let mut rig = Rig::new(board_settings());
    for _ in 0..20 {
        let driven = rig.tick(Cable::Good);
        assert!(driven.correction_nm == [0; 6] && !driven.enable);
    }
    assert_eq!(rig.tick(Cable::Good).board.mode, Mode::Off);
    rig.acknowledge();
    rig.drives_on = true;
    for mode in [Mode::Bypass, Mode::Armed] {
        for _ in 0..40 {
            let driven = rig.tick(Cable::Good);
            assert!(driven.correction_nm == [0; 6] && driven.enable);
            assert_eq!(driven.board.mode, mode);
        }
        let _ = rig.device.arm(&rig.rewriter, &rig.request);
    }
}

#[test]
fn over_two_ticks_without_an_answer_the_last_correction_is_held_and_then_caught_up_within_the_limits() {
    for cable in [Cable::NoAnswer, Cable::NoSetpoint, Cable::Damaged, Cable::Late] {
        let mut rig = Rig::active(board_settings());
        let before = rig.correction();
        for _ in 0..2 {
            let driven = rig.go(cable);
            assert_eq!((driven.correction_nm, driven.enable, driven.cause), (before, true, Cause::None), "{cable:?}");
        }
        let driven = rig.forward(5);
        assert_eq!(driven.correction_nm, driven.board.correction_nm, "{cable:?}");
        assert!(!driven.status.has(Status::LAGGING) && rig.board.counters().missed >= 2);
    }
}

#[test]
fn without_an_answer_for_three_ticks_the_drives_go_and_the_correction_stays_until_they_are_off() {
    for cable in [Cable::NoAnswer, Cable::NoSetpoint, Cable::Damaged] {
        let mut rig = Rig::active(board_settings());
        let before = rig.correction();
        assert!(rig.go(cable).enable && rig.go(cable).enable);
        for _ in 0..50 {
            let driven = rig.tick(cable);
            assert_eq!((driven.correction_nm, driven.enable, driven.cause), (before, false, Cause::Silence));
        }
        rig.drives_on = false;
        assert_eq!(rig.tick(cable).correction_nm, [0; 6]);
        assert_eq!(rig.board.counters().lost, 1);
    }
}

#[test]
fn a_lost_link_stays_lost_however_good_the_answers_are_while_a_drive_is_on() {
    let mut rig = Rig::active(board_settings());
    let before = rig.correction();
    for _ in 0..3 {
        rig.go(Cable::NoAnswer);
    }
    for _ in 0..500 {
        let driven = rig.tick(Cable::Good);
        assert_eq!((driven.correction_nm, driven.enable, driven.cause), (before, false, Cause::Silence));
    }
    // The board was told that the drives are off and the program aborted.
    assert_eq!(rig.device.mode(), Mode::Bypass);
}

#[test]
fn behind_a_lost_link_nothing_is_corrected_before_a_new_arming() {
    let mut rig = Rig::active(board_settings());
    for _ in 0..3 {
        rig.go(Cable::NoAnswer);
    }
    rig.drives_on = false;
    let ticks = (1..).find(|_| rig.tick(Cable::Good).enable).unwrap();
    // The board ramps out first.
    assert!(ticks <= rig.rewriter.limits().unwrap().ramp_ticks() + RECOVERY_TICKS + 1, "{ticks}");
    rig.drives_on = true;
    for _ in 0..200 {
        let driven = rig.go(Cable::Good);
        assert!(driven.enable && driven.correction_nm == [0; 6] && driven.board.mode == Mode::Bypass);
    }
}

#[test]
fn an_arming_does_not_survive_a_lost_link() {
    let mut rig = Rig::ready(board_settings());
    rig.device.arm(&rig.rewriter, &rig.request).unwrap();
    assert_eq!(rig.tick(Cable::Good).board.mode, Mode::Armed);
    // Only answers are lost: the board does not notice.
    for _ in 0..3 {
        rig.tick(Cable::NoAnswer);
    }
    rig.tick(Cable::Good);
    assert_eq!(rig.device.mode(), Mode::Bypass);
}

#[test]
fn a_board_that_is_reset_with_a_correction_on_loses_the_link_and_nothing_jumps() {
    let mut rig = Rig::active(board_settings());
    let before = rig.correction();
    rig.reset_board();
    let driven = rig.go(Cable::Good);
    assert_eq!((driven.correction_nm, driven.enable, driven.cause), (before, false, Cause::BoardOff));
    rig.drives_on = false;
    for _ in 0..20 {
        rig.tick(Cable::Good);
    }
    // It answers, but forwards nothing until the drives are acknowledged as disabled.
    let driven = rig.tick(Cable::Good);
    assert_eq!((driven.cause, driven.enable, driven.board.mode), (Cause::None, false, Mode::Off));
    rig.acknowledge();
    assert!(rig.tick(Cable::Good).enable);
}

#[test]
fn a_board_that_is_reset_without_a_correction_only_drops_the_drives() {
    let mut rig = Rig::ready(board_settings());
    rig.reset_board();
    let driven = rig.tick(Cable::Good);
    assert_eq!((driven.cause, driven.enable, driven.correction_nm), (Cause::None, false, [0; 6]));
}

#[test]
fn a_late_answer_is_dropped_and_counted_and_the_next_one_is_taken() {
    let mut rig = Rig::active(board_settings());
    rig.go(Cable::Late);
    let driven = rig.go(Cable::Good);
    assert!(driven.answered);
    assert_eq!((rig.board.counters().late, rig.board.counters().missed), (1, 1));
}

#[test]
fn an_answer_that_was_cut_off_spoils_the_next_one_and_no_more() {
    let mut rig = Rig::active(board_settings());
    let came = [Cable::CutOff, Cable::Good, Cable::Good].map(|cable| rig.go(cable).answered);
    assert_eq!((came, rig.board.counters().damaged), ([false, false, true], 1));
}

#[test]
fn an_answer_that_comes_twice_is_taken_once() {
    let mut rig = Rig::active(board_settings());
    let driven = rig.go(Cable::Twice);
    assert_eq!(driven.correction_nm, driven.board.correction_nm);
    assert_eq!(rig.board.counters().missed, 0);
}

#[test]
fn an_answer_that_cannot_be_true_is_not_taken_and_ends_the_link_like_none() {
    let mistakes: [fn(&mut Output); 6] = [
        |o| o.axes[0] += 1,
        |o| o.correction_nm[1] += 1,
        |o| (o.correction_nm[0], o.axes[0]) = (500_001, o.axes[0] + 500_001 - i64::from(o.correction_nm[0])),
        |o| o.forward = false,
        |o| o.mode = Mode::Bypass,
        |o| o.sequence = o.sequence.wrapping_add(1),
    ];
    for mistake in mistakes {
        let mut rig = Rig::active(board_settings());
        let before = rig.correction();
        rig.mistake = Some(mistake);
        for expected in [Cause::None, Cause::None, Cause::Silence] {
            let driven = rig.go(Cable::Good);
            assert_eq!((driven.correction_nm, driven.cause, driven.answered), (before, expected, false));
        }
        assert_eq!(rig.board.counters().wrong, 3);
    }
}

#[test]
fn a_board_that_is_faster_than_the_machine_permits_is_followed_within_its_limits() {
    let narrow = BoardSettings { slew_nm_per_s: 10_000, acceleration_nm_per_s2: 1_000_000, ..board_settings() };
    let mut rig = Rig::ready(narrow);
    rig.device.arm(&rig.rewriter, &rig.request).unwrap();
    let (mut before, mut speed, mut lagged) = ([0; 6], 0, false);
    for i in 0..=1_000 {
        rig.next.axes[2] = GATE + (PASS - GATE) * i.min(100) / 100;
        let driven = rig.tick(Cable::Good);
        let moved = driven.correction_nm[0] - before[0];
        assert!(moved.abs() <= 12 && (moved - speed).abs() <= 5, "{moved} nm after {speed}");
        lagged |= driven.status.has(Status::LAGGING);
        (before, speed) = (driven.correction_nm, moved);
    }
    assert!(lagged);
}

#[test]
fn no_correction_that_is_held_carries_an_axis_over_its_limit() {
    let limit = 6 * MM;
    let mut joints = board_settings().joint_limits_nm;
    joints[1] = (-limit, 20_000);
    let mut rig = Rig::active(BoardSettings { joint_limits_nm: joints, ..board_settings() });
    let driven = rig.go(Cable::NoAnswer);
    assert!(driven.board.correction_nm[1] > 20_000, "the test needs a correction towards the limit");
    assert_eq!(rig.next.axes[1] + i64::from(driven.correction_nm[1]), 20_000);
    assert!(driven.status.has(Status::JOINT_LIMITED));
}

#[test]
fn a_port_that_fails_loses_the_link_at_once() {
    let mut rig = Rig::active(board_settings());
    let before = rig.correction();
    rig.board.port_failed();
    let driven = rig.tick(Cable::NoAnswer);
    assert_eq!((driven.correction_nm, driven.enable, driven.cause), (before, false, Cause::Port));
}

#[test]
fn the_first_frame_and_one_behind_a_frame_that_was_cut_off_clear_the_line() {
    let mut rig = Rig::new(board_settings());
    let mut packet = [0; PACKET_BYTES];
    let first = rig.board.begin(&rig.next, false, &mut packet);
    assert_eq!((packet[0], sent(&packet[..first]).sequence), (0, 1));
    rig.board.finish();
    let second = rig.board.begin(&rig.next, false, &mut packet);
    assert_ne!(packet[0], 0);
    assert_eq!(second, first - 1);
    rig.board.not_sent();
    rig.board.finish();
    let third = rig.board.begin(&rig.next, false, &mut packet);
    assert_eq!((third, packet[0], sent(&packet[..third]).sequence), (first, 0, 3));
}

#[test]
fn a_lost_link_tells_the_board_that_drives_are_off_and_the_program_aborted() {
    let mut rig = Rig::new(board_settings());
    let mut packet = [0; PACKET_BYTES];
    rig.next.flags = Flags::DRIVES_ENABLED.with(Flags::SPINDLE_LOADED);
    let bytes = rig.board.begin(&rig.next, true, &mut packet);
    assert_eq!(sent(&packet[..bytes]).flags, Flags::SPINDLE_LOADED.with(Flags::ABORT));
}

#[test]
fn settings_out_of_range_are_refused() {
    let good = board_settings();
    let refused = |settings| Board::new(settings).err();
    assert_eq!(refused(good), None);
    assert_eq!(refused(BoardSettings { axes: 0, ..good }), Some(BoardSettingsError::Axes(0)));
    assert_eq!(refused(BoardSettings { axes: 7, ..good }), Some(BoardSettingsError::Axes(7)));
    assert_eq!(refused(BoardSettings { tick_hz: 9, ..good }), Some(BoardSettingsError::TickRate(9)));
    assert_eq!(refused(BoardSettings { clamp_nm: 0, ..good }), Some(BoardSettingsError::Clamp(0)));
    assert_eq!(refused(BoardSettings { clamp_nm: 4_000_001, ..good }), Some(BoardSettingsError::Clamp(4_000_001)));
    assert_eq!(refused(BoardSettings { slew_nm_per_s: 0, ..good }), Some(BoardSettingsError::Caps));
    assert_eq!(refused(BoardSettings { acceleration_nm_per_s2: 0, ..good }), Some(BoardSettingsError::Caps));
    let mut joints = good.joint_limits_nm;
    joints[2] = (1, 0);
    let wrong = BoardSettings { joint_limits_nm: joints, ..good };
    assert_eq!(refused(wrong), Some(BoardSettingsError::JointLimits { axis: 2 }));
}
