//! `truepath-board.h` says what the crate has: sizes and names of fields, in their order, and every function.

use std::collections::BTreeSet;
use std::mem::{MaybeUninit, offset_of, size_of};

use truepath_abi::board::{Board, PACKET_BYTES};
use truepath_abi::board_abi::*;

const HEADER: &str = include_str!("../truepath-board.h");
const SOURCE: &str = include_str!("../src/board_abi.rs");

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
    let (settings, size) = fields("truepath_board_settings");
    assert_eq!(
        settings,
        offsets!(Settings: acceleration_nm_per_s2, least_nm, greatest_nm, slew_nm_per_s, tick_hz, clamp_nm, axes)
    );
    assert_eq!(size, size_of::<Settings>());
    let (sent, size) = fields("truepath_board_sent");
    assert_eq!(sent, offsets!(Sent: axes_nm, spindle_millirpm, frame_crc, flags, drives_on));
    assert_eq!(size, size_of::<Sent>());
    let (got, size) = fields("truepath_board_got");
    assert_eq!(
        got,
        offsets!(Got: correction_nm, enable, cause, state, reason, status, node, sequence, flags, answered, missed, late,
            damaged)
    );
    assert_eq!(size, size_of::<Got>().next_multiple_of(8));
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
fn a_tick_through_the_functions_of_c_is_one_of_the_board() {
    let mut block = MaybeUninit::<Block>::uninit();
    let settings = Settings {
        acceleration_nm_per_s2: 1_000_000_000,
        least_nm: [i64::MIN; 6],
        greatest_nm: [i64::MAX; 6],
        slew_nm_per_s: 20_000_000,
        tick_hz: 1_000,
        clamp_nm: 500_000,
        axes: 3,
    };
    // SAFETY: a block has no invalid contents, and a board lies in it once `new` has given 0.
    let board = unsafe {
        assert_eq!(truepath_board_new(block.assume_init_mut(), &Settings { axes: 9, ..settings }), 1);
        assert_eq!(truepath_board_new(block.assume_init_mut(), &settings), 0);
        &mut *block.as_mut_ptr().cast::<Board>()
    };
    let mut packet = [0; PACKET_BYTES];
    let mut got = Got::default();
    for tick in 1..=3 {
        assert!(truepath_board_begin(board, &Sent::default(), &mut packet) > 24);
        assert!(truepath_board_room(board) > 100);
        // SAFETY: that many bytes lie there.
        unsafe { truepath_board_take(board, [7, 0].as_ptr(), 2) };
        truepath_board_finish(board, &mut got);
        assert_eq!((got.sequence, got.missed, got.damaged, got.cause, got.enable), (tick, tick, tick, 1, 0));
    }
    truepath_board_port_failed(board);
    truepath_board_not_sent(board);
    truepath_board_finish(board, &mut got);
    assert_eq!(got.cause, 4);
}
