//! `truepath canon`: what a program does, move by move.

mod kept;

use std::path::PathBuf;

use clap::Args;
use truepath_core::gcode::{Dialect, PointlessLength, Units};
use truepath_ground::diagnostics::{Failure, InputError, Source};
use truepath_ground::output::OutputFile;
use truepath_job::job::{DECIMALS, DIALECTS, one_of};
use truepath_program::canon::{CanonOptions, ParameterFile, ToolTable, write_canon};

use crate::terminal::{Terminal, print_data};

/// Units of length by name.
pub(super) const UNITS: [(&str, Units); 2] = [("mm", Units::Millimetres), ("inch", Units::Inches)];

/// What is read, and how.
#[derive(Debug, Args)]
pub struct Options {
    /// The program.
    file: PathBuf,
    /// LinuxCNC tool table; without it all tool offsets are 0.
    #[arg(long, value_name = "FILE")]
    tool_table: Option<PathBuf>,
    /// Unit of the tool table.
    #[arg(long, value_parser = one_of(&UNITS), default_value = "mm")]
    tool_table_units: Units,
    /// LinuxCNC parameter file with offsets and reference points; without it they are 0.
    #[arg(long, value_name = "VAR")]
    parameters: Option<PathBuf>,
    /// Unit of the machine: of the lengths in the parameter file.
    #[arg(long, value_parser = one_of(&UNITS), default_value = "mm")]
    machine_units: Units,
    /// Folder with the files of subprograms; by default that of the program.
    #[arg(long, value_name = "DIR")]
    subprograms: Option<PathBuf>,
    /// The control the program is written for.
    #[arg(long, value_parser = one_of(&DIALECTS), default_value = "linuxcnc")]
    dialect: Dialect,
    /// What a length without a point is: millimetres and inches, or least increments (0.001 mm, 0.0001 in).
    #[arg(long, value_parser = one_of(&DECIMALS), default_value = "calculator")]
    decimal: PointlessLength,
    /// Skip blocks that begin with `/`.
    #[arg(long, alias = "block-delete")]
    skip_block_delete: bool,
    /// Write to a file instead of standard output.
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Replace the output file if it exists.
    #[arg(long, requires = "output")]
    force: bool,
}

impl Options {
    fn parsed(&self) -> Result<CanonOptions, Failure> {
        let tools = self.tool_table.as_deref().map(Source::read).transpose()?;
        let tools = tools.map(|source| ToolTable::parse(&source, self.tool_table_units)).transpose()?;
        let parameters = self.parameters.as_deref().map(Source::read).transpose()?;
        Ok(CanonOptions {
            tools: tools.unwrap_or_default(),
            parameters: parameters.map(|source| ParameterFile::parse(&source)).transpose()?.unwrap_or_default(),
            machine_units: self.machine_units,
            dialect: self.dialect,
            decimal: self.decimal,
            skip_block_delete: self.skip_block_delete,
            subprograms: self.subprograms.clone(),
            ..CanonOptions::default()
        })
    }
}

/// Prints the canonical moves.
pub(crate) fn main(options: &Options, terminal: &Terminal) -> Result<(), Failure> {
    let source = Source::read(&options.file)?;
    let parsed = options.parsed()?;
    let summary = match &options.output {
        Some(path) => {
            let mut file = OutputFile::create(path, options.force)?;
            let written = write_canon(&source, &parsed, &mut file)?;
            let summary = written.map_err(|e| InputError::unwritable(path, &e))?;
            file.commit()?;
            summary
        }
        None => {
            // A program that is refused prints nothing.
            let (written, text) = kept::text_of(|out| write_canon(&source, &parsed, out))?;
            let summary = written?.map_err(|e| Failure::Internal(e.to_string()))?;
            print_data(&text)?;
            summary
        }
    };
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
    Ok(())
}
