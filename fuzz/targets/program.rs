//! Any bytes as a program: an error with its place, or steps that can be printed and contours that can be listed.
//! The first byte chooses what the program is read for.
#![no_main]

use std::cell::RefCell;

use libfuzzer_sys::fuzz_target;
use truepath_program::canon::{CanonOptions, write_canon};
use truepath_ground::diagnostics::Source;
use truepath_core::gcode::{ContourOptions, DeviceMemory, GcodeError, Lines, Options, Program, Words, find_contours};

thread_local! {
    /// Too large to be made anew for every input.
    static MEMORY: RefCell<Box<DeviceMemory>> = RefCell::new(Box::new(DeviceMemory::new()));
}

/// A loop without an end is noticed twenty times earlier than by the program, which takes seconds with these counters.
const BLOCKS: u32 = 50_000;

fuzz_target!(|bytes: &[u8]| {
    let Some((&purpose, text)) = bytes.split_first() else { return };
    let words: usize = Lines::new(text).map(|line| Words::new(line).take_while(Result::is_ok).count()).sum();
    assert!(words <= text.len());
    if purpose.is_multiple_of(4) {
        let source = Source::new("fuzz.nc", text.to_vec());
        let skip_block_delete = purpose & 16 != 0;
        let options = CanonOptions { skip_block_delete, block_limit: BLOCKS, ..CanonOptions::default() };
        if let Err(error) = write_canon(&source, &options, &mut std::io::sink()) {
            assert!(error.code().len() == 4 && error.line_column().is_some());
        }
        return;
    }
    let program = Options { block_limit: BLOCKS, ..Options::default() };
    let options = ContourOptions { program, ..ContourOptions::default() };
    MEMORY.with_borrow_mut(|memory| {
        let mut memory = memory.lend();
        memory.clear();
        let found = find_contours(&Program::new(text), &mut memory, &options, |run| {
            assert!(run.blocks > 0 && run.lines.first >= 1);
        });
        if let Err(error) = found {
            in_the_text(&error, text);
        }
    });
});

/// An error points into the text.
fn in_the_text(error: &GcodeError, text: &[u8]) {
    assert!(error.line >= 1 && error.column >= 1 && error.start <= text.len(), "{error:?}");
    assert!(error.kind.code().len() == 4 && error.to_string().len() > 20);
}
