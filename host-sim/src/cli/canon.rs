//! `truepath canon`: what a program does, move by move.

use std::io::Write;
use std::path::PathBuf;

use clap::{Args, ValueEnum};
use truepath_core::gcode::Units;

use super::{Terminal, print};
use crate::canon::{CanonOptions, ToolTable, write_canon};
use crate::diagnostics::{Failure, InputError, Source};
use crate::output::OutputFile;

#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// The program.
    file: PathBuf,
    /// LinuxCNC tool table; without it all tool offsets are 0.
    #[arg(long, value_name = "FILE")]
    tool_table: Option<PathBuf>,
    /// Unit of the tool table.
    #[arg(long, value_enum, default_value_t = TableUnits::Mm)]
    tool_table_units: TableUnits,
    /// Skip blocks that begin with `/`.
    #[arg(long)]
    skip_block_delete: bool,
    /// Write to a file instead of standard output.
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Replace the output file if it exists.
    #[arg(long, requires = "output")]
    force: bool,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum TableUnits {
    Mm,
    Inch,
}

pub(super) fn run(arguments: &Arguments, terminal: &Terminal) -> Result<(), Failure> {
    let source = Source::read(&arguments.file)?;
    let tools = match &arguments.tool_table {
        None => ToolTable::default(),
        Some(path) => {
            let units = match arguments.tool_table_units {
                TableUnits::Mm => Units::Millimetres,
                TableUnits::Inch => Units::Inches,
            };
            ToolTable::parse(&Source::read(path)?, units)?
        }
    };
    let options = CanonOptions { tools, skip_block_delete: arguments.skip_block_delete };
    let mut text = Vec::new();
    let written = write_canon(&source, &options, &mut text)?;
    let summary = written.map_err(|e| Failure::Internal(e.to_string()))?;
    for warning in summary.warnings.as_slice() {
        terminal.warn(&format!(
            "{}:{}:{}: {}: {}",
            source.name(),
            warning.line,
            warning.column,
            warning.kind.code(),
            warning.kind
        ));
    }
    match &arguments.output {
        Some(path) => {
            let mut file = OutputFile::create(path, arguments.force)?;
            file.write_all(&text).map_err(|e| InputError::unwritable(path, &e))?;
            Ok(file.commit()?)
        }
        None => print(&text),
    }
}
