//! The C interface, for the component on the PC and for the one with a board.

mod board_header;
mod board_link;
mod board_properties;
mod board_support;
mod pc_equal;
mod pc_header;
mod pc_jumps;
mod pc_once;
mod pc_properties;
mod pc_rules;
mod pc_support;
mod pc_trust;
mod remote;
mod remote_support;
// Shared with the tests of the wire, which use more of it.
#[allow(dead_code)]
#[path = "../../../../core/wire/tests/all/rewrite_support/mod.rs"]
mod rewrite_support;
