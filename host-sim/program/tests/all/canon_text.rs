//! Canonical moves against the reference interpreter.
//!
//! Every `canon/NAME.txt` was written by `rs274 -g NAME.nc` of LinuxCNC 2.9 (with the tool table for `tools.nc`), not by
//! this program.

use std::path::{Path, PathBuf};

use truepath_core::gcode::Units;
use truepath_ground::diagnostics::Source;
use truepath_program::canon::{CanonOptions, ToolTable, write_canon};

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/canon")
}

fn canon(name: &str, options: &CanonOptions) -> String {
    let source = Source::read(&folder().join(name)).expect("a program");
    let mut text = Vec::new();
    write_canon(&source, options, &mut text).expect("understood").expect("written");
    String::from_utf8(text).expect("UTF-8")
}

#[test]
fn the_text_is_that_of_the_reference_interpreter() {
    let table = Source::read(&folder().join("tools.tbl")).expect("a table");
    let tools = ToolTable::parse(&table, Units::Millimetres).expect("a tool table");
    for name in ["corner", "pocket", "modes", "tools"] {
        let options = if name == "tools" {
            CanonOptions { tools: tools.clone(), ..CanonOptions::default() }
        } else {
            CanonOptions::default()
        };
        let expected = std::fs::read_to_string(folder().join(format!("{name}.txt"))).expect("the reference's text");
        let written = canon(&format!("{name}.nc"), &options);
        for (ours, theirs) in written.lines().zip(expected.lines()) {
            assert_eq!(ours, theirs, "{name}.nc");
        }
        assert_eq!(written.lines().count(), expected.lines().count(), "{name}.nc");
    }
}

#[test]
fn skipped_blocks_leave_no_trace() {
    let all = canon("modes.nc", &CanonOptions::default());
    let skipped = canon("modes.nc", &CanonOptions { skip_block_delete: true, ..CanonOptions::default() });
    assert_eq!(all.lines().count(), skipped.lines().count() + 1);
    assert!(skipped.contains("STRAIGHT_FEED(1.0000, 0.0000, 5.0000"), "{skipped}");
}
