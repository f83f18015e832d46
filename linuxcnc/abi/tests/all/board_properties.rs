//! Whatever arrives: no panic, no jump, no more work in a tick than is stated. The properties themselves are asserted in
//! every tick of the rig.

use crate::board_support;

use board_support::*;
use proptest::collection::vec;
use proptest::prelude::*;
use truepath_abi::board::{BYTES_A_TICK, Board, Cause, PACKET_BYTES};
use truepath_core::rewrite::{Mode, Setpoint};

fn cable() -> impl Strategy<Value = Cable> {
    prop_oneof![
        12 => Just(Cable::Good),
        1 => Just(Cable::NoSetpoint),
        1 => Just(Cable::NoAnswer),
        1 => Just(Cable::Late),
        1 => Just(Cable::Damaged),
        1 => Just(Cable::CutOff),
        1 => Just(Cable::Twice),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn losses_delays_and_damage_never_make_a_drive_jump(cables in vec(cable(), 1..400), off in 0usize..400) {
        let mut rig = Rig::active(board_settings());
        for (tick, cable) in cables.into_iter().enumerate() {
            rig.drives_on &= tick != off;
            let driven = rig.go(cable);
            if cable == Cable::Good && driven.cause == Cause::None && driven.answered && driven.board.forward {
                prop_assert!(driven.enable);
            }
        }
        // Once the drives are off and the answers good, the link is there again within the ramp and the recovery.
        rig.drives_on = false;
        for _ in 0..200 {
            rig.tick(Cable::Good);
        }
        let driven = rig.tick(Cable::Good);
        prop_assert_eq!(driven.cause, Cause::None);
        prop_assert_eq!(driven.correction_nm, [0; 6]);
    }

    #[test]
    fn random_bytes_are_no_answer_and_cost_no_more_than_a_tick_may(
        ticks in vec(vec(prop_oneof![Just(0u8), any::<u8>()], 0..2_000), 1..20),
    ) {
        let mut board = Board::new(board_settings()).unwrap();
        let mut packet = [0; PACKET_BYTES];
        for bytes in ticks {
            board.begin(&Setpoint::default(), false, &mut packet);
            let taken = board.take(&bytes);
            prop_assert_eq!(taken, bytes.len().min(BYTES_A_TICK));
            prop_assert_eq!(board.take(&[1, 2, 3]), (BYTES_A_TICK - taken).min(3));
            let driven = board.finish();
            prop_assert!(!driven.answered && !driven.enable && driven.correction_nm == [0; 6]);
        }
    }

    #[test]
    fn answers_in_any_order_with_any_correction_move_it_by_no_more_than_the_machine_permits(
        ticks in vec((any::<bool>(), -3i32..4, 0u8..6, -600_000i32..600_000, any::<i64>()), 1..200),
    ) {
        let mut board = Board::new(board_settings()).unwrap();
        let modes = [Mode::Off, Mode::Bypass, Mode::Armed, Mode::Active, Mode::Hold, Mode::Fault];
        let mut packet = [0; PACKET_BYTES];
        let (mut before, mut was_on) = ([0; 6], false);
        for (on, shift, mode, nm, position) in ticks {
            let next = Setpoint { axes: [position, 0, -position.saturating_add(1), 0, 0, 0], ..Setpoint::default() };
            let bytes = board.begin(&next, on, &mut packet);
            let mut answered = sent(&packet[..bytes]);
            answered.sequence = answered.sequence.wrapping_add_signed(shift);
            let mode = modes[usize::from(mode)];
            board.take(&answer_bytes(&answered, mode, [nm, -nm / 2, 0, 0, 0, 0]));
            let driven = board.finish();
            for (now, before) in driven.correction_nm.into_iter().zip(before) {
                let gone = now == 0 && !on && driven.cause != Cause::None;
                prop_assert!(gone || (now - before).abs() <= STEP_NM + 1 || !(on || was_on), "{} to {}", before, now);
                prop_assert!(now.abs() <= 500_000);
            }
            (before, was_on) = (driven.correction_nm, on);
        }
    }

    #[test]
    fn an_answer_cut_anywhere_is_taken_once_it_is_whole(cuts in vec(0usize..70, 0..6)) {
        let mut board = Board::new(board_settings()).unwrap();
        let mut packet = [0; PACKET_BYTES];
        let bytes = board.begin(&Setpoint::default(), false, &mut packet);
        let answer = answer_bytes(&sent(&packet[..bytes]), Mode::Bypass, [0; 6]);
        let mut cuts: Vec<usize> = cuts.into_iter().map(|c| c.min(answer.len())).chain([0, answer.len()]).collect();
        cuts.sort_unstable();
        for pair in cuts.windows(2) {
            prop_assert_ne!(board.room(), 0);
            board.take(&answer[pair[0]..pair[1]]);
            if pair[1] == answer.len() {
                break;
            }
        }
        prop_assert_eq!(board.room(), 0);
        prop_assert!(board.finish().answered);
    }
}
