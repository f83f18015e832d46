//! Canonical moves of a program as text, in the format of LinuxCNC's `rs274 -g`.
//!
//! The text can be compared line by line with the reference interpreter, under its own assumptions: the axes start at
//! machine 0 and everything about the machine is known, offsets and reference points by the parameter file (0 without
//! one), tools by the tool table. One line a call: running number, N word of the block, `CALL(arguments)`; lengths in
//! the program's unit with four decimals, six axes.
//!
//! | file | what |
//! |---|---|
//! | `printer.rs` | the order of the calls of a block |
//! | `call.rs`, `moves.rs`, `comment.rs` | the calls |
//! | `lines.rs`, `argument.rs`, `number.rs` | the text |
//! | `options.rs`, `tool_table.rs`, `parameter_file.rs` | what is known of control and machine |
//!
//! Limits: what the interpreter of the core does not execute is an error, as everywhere; a zero never carries a minus
//! sign; the exact-path switches around the moves of canned cycles are left out; M codes that are not known are shown
//! as a comment.

mod argument;
mod call;
mod comment;
mod lines;
mod moves;
mod number;
mod options;
mod parameter_file;
mod printer;
mod tool_table;

use std::io::{self, Write};
use std::path::Path;

use printer::Printer;
use truepath_core::gcode::{Axes, CompensationBy, HostMemory, Interpreter, Machine, Options, Program, ProgramSummary};
use truepath_core::units::Offset;
use truepath_ground::diagnostics::{InputError, Source};
use truepath_ground::library::Folder;

pub use options::CanonOptions;
pub use parameter_file::ParameterFile;
pub use tool_table::ToolTable;

/// Without a machine the reference stands 0.01 in before the end of a probing move after it.
const PROBE_BEFORE_END: Offset = Offset::from_nm(254_000);

/// Writes the canonical moves of a program; what the writer answers is returned inside.
///
/// # Errors
/// Whatever the interpreter does not understand, at its place; what stands before it is written.
pub fn write_canon(
    source: &Source,
    options: &CanonOptions,
    out: &mut impl Write,
) -> Result<io::Result<ProgramSummary>, InputError> {
    let start = Options {
        start: Axes::ORIGIN,
        skip_block_delete: options.skip_block_delete,
        block_limit: options.block_limit,
        dialect: options.dialect,
        as_linuxcnc: true,
        decimal: options.decimal,
        tools: options.tools.tools(),
        machine: Some(Machine { units: options.machine_units, probe_before_end: PROBE_BEFORE_END }),
        whole_splines: true,
        compensation: CompensationBy::Table,
        ..Options::default()
    };
    let mut buffers = Box::new(HostMemory::new());
    let mut memory = buffers.lend();
    options.parameters.load(&mut memory);
    // The folder is that of the file named, which need not exist.
    let within = options.subprograms.as_ref().map(|folder| folder.join("program"));
    let beside = Folder::beside(within.as_deref().unwrap_or(Path::new(source.name())));
    let program = Program { text: source.bytes(), library: Some(&beside) };
    let mut printer = Printer::new(options, out);
    let run = Interpreter::new(start).run(program, &mut memory, &mut |event| {
        printer.event(event);
        Ok(())
    });
    let written = printer.finish(run.is_ok());
    let summary = run.map_err(|error| InputError::of_program(beside.source(error.file).unwrap_or(source), &error))?;
    Ok(written.map(|()| summary))
}
