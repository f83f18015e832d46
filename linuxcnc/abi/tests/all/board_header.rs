//! `truepath-board.h` says what the crate has: sizes and names of fields, in their order, and every function.

use crate::remote_support;

use std::collections::BTreeSet;
use std::mem::{MaybeUninit, offset_of, size_of};

use remote_support::{inputs, outputs};
use truepath_abi::board::{Cause, PACKET_BYTES};
use truepath_abi::board_abi::*;
use truepath_abi::pc::Limits;
use truepath_abi::remote::Remote;

const HEADER: &str = include_str!("../../truepath-board.h");
const SOURCE: &str = include_str!("../../src/board_abi.rs");

/// Fields of a structure of the header, with their offset by the rules of C, and its size.
fn fields(name: &str) -> (Vec<(String, usize)>, usize) {
    let (_, behind) = HEADER.split_once(&format!("struct {name} {{")).unwrap();
    let (body, _) = behind.split_once('}').unwrap();
    let (mut at, mut found) = (0usize, vec![]);
    for line in body.lines().map(|line| line.split("/*").next().unwrap().trim()).filter(|line| !line.is_empty()) {
        let (kind, name) = line.trim_end_matches(';').split_once(' ').unwrap();
        let bytes = if kind.contains("64") { 8 } else { 4 };
        let (name, count) = name.split_once('[').map_or((name, 1), |(name, _)| (name, 6));
        at = at.next_multiple_of(bytes);
        found.push((name.to_owned(), at));
        at += bytes * count;
    }
    (found, at.next_multiple_of(8))
}

fn named(expected: &[(&str, usize)]) -> Vec<(String, usize)> {
    expected.iter().map(|&(name, at)| (name.to_owned(), at)).collect()
}

macro_rules! offsets {
    ($of:ident: $($field:ident),*) => { named(&[$((stringify!($field), offset_of!($of, $field))),*]) };
}

#[test]
fn structures_lie_in_memory_as_the_header_says() {
    let (link, size) = fields("truepath_link");
    assert_eq!(link, offsets!(Link: cause, answered, missed, late, damaged));
    assert_eq!(size, size_of::<Link>().next_multiple_of(8));
    for (name, value) in [("WORDS", BOARD_WORDS), ("PACKET_BYTES", PACKET_BYTES)] {
        assert!(HEADER.contains(&format!("#define TRUEPATH_BOARD_{name} {value}\n")));
    }
}

#[test]
fn the_header_declares_every_function_and_no_other() {
    let names = |text: &str| -> BTreeSet<String> {
        let calls = text.split("truepath_board_").skip(1).filter_map(|s| s.split_once('(')).map(|(name, _)| name);
        calls.filter(|name| name.chars().all(|c| c.is_lowercase() || c == '_')).map(str::to_owned).collect()
    };
    let defined: String = SOURCE.lines().filter(|line| line.contains("extern \"C\" fn")).collect();
    assert_eq!(names(HEADER), names(&defined));
}

#[test]
fn the_causes_of_the_header_are_those_of_the_crate() {
    for (name, cause) in [
        ("THERE", Cause::None),
        ("NOT_HEARD", Cause::Start),
        ("SILENT", Cause::Silence),
        ("BOARD_OFF", Cause::BoardOff),
        ("PORT", Cause::Port),
        ("NO_SETPOINT", Cause::Setpoint),
    ] {
        assert!(HEADER.contains(&format!("    TRUEPATH_LINK_{name} = {},\n", cause as u32)), "{name}");
    }
}

#[test]
fn a_tick_through_the_functions_of_c_is_one_of_the_board() {
    let mut block = MaybeUninit::<Block>::uninit();
    let limits = Limits {
        least: [-100.0; 6],
        greatest: [100.0; 6],
        velocity: [20.0; 6],
        acceleration: [1000.0; 6],
        nm_per_unit: 1e6,
    };
    let axes = [0, 1, 2, 255, 255, 255];
    // SAFETY: a block has no invalid contents, and a board lies in it once `new` has given 0.
    let board = unsafe {
        let none = Limits::default();
        assert_eq!(truepath_board_new(block.assume_init_mut(), &axes, &none, 1_000_000, 3, 500_000), 32);
        for (wrong, axes_of_frame, clamp) in [(64, 9, 500_000), (66, 3, 0), (66, 3, u32::MAX)] {
            let refused = truepath_board_new(block.assume_init_mut(), &axes, &limits, 1_000_000, axes_of_frame, clamp);
            assert_eq!(refused, wrong);
        }
        assert_eq!(truepath_board_new(block.assume_init_mut(), &axes, &limits, 1_000_000, 3, 500_000), 0);
        &mut *block.as_mut_ptr().cast::<Remote>()
    };
    let mut packet = [0; PACKET_BYTES];
    let (inputs, mut outputs) = (inputs(), outputs());
    let mut link = Link::default();
    for tick in 1..=3 {
        assert!(truepath_board_begin(board, &inputs, &mut packet) > 24);
        assert!(truepath_board_room(board) > 100);
        // SAFETY: that many bytes lie there.
        unsafe { truepath_board_take(board, [7, 0].as_ptr(), 2) };
        truepath_board_finish(board, &inputs, &mut outputs, &mut link);
        assert_eq!((outputs.sequence, link.missed, link.damaged, link.cause), (tick, tick, tick, 1));
        assert_eq!((outputs.forward, outputs.motor_pos_cmd), (0, inputs.motor_pos_cmd));
    }
    truepath_board_port_failed(board);
    truepath_board_not_sent(board);
    truepath_board_finish(board, &inputs, &mut outputs, &mut link);
    assert_eq!(link.cause, 4);
    let mut plain = [0.0; 6];
    truepath_board_feedback(board, &[1.5; 6], &mut plain);
    assert_eq!(plain, [1.5; 6]);
}
