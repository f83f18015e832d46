//! `truepath canon`: what a program does, move by move.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use truepath_core::gcode::{Dialect, PointlessLength, Units};
use truepath_ground::diagnostics::{Failure, InputError, Source};
use truepath_ground::output::OutputFile;
use truepath_program::canon::{CanonOptions, ParameterFile, ToolTable, write_canon};

use super::{Terminal, print_data};

#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// The program.
    file: PathBuf,
    /// LinuxCNC tool table; without it all tool offsets are 0.
    #[arg(long, value_name = "FILE")]
    tool_table: Option<PathBuf>,
    /// Unit of the tool table.
    #[arg(long, value_enum, default_value_t = FileUnits::Mm)]
    tool_table_units: FileUnits,
    /// LinuxCNC parameter file with offsets and reference points; without it they are 0.
    #[arg(long, value_name = "VAR")]
    parameters: Option<PathBuf>,
    /// Unit of the machine: of the lengths in the parameter file.
    #[arg(long, value_enum, default_value_t = FileUnits::Mm)]
    machine_units: FileUnits,
    /// Folder with the files of subprograms; by default that of the program.
    #[arg(long, value_name = "DIR")]
    subprograms: Option<PathBuf>,
    /// The control the program is written for.
    #[arg(long, value_enum, default_value_t = Control::Linuxcnc)]
    dialect: Control,
    /// What a length without a point is: millimetres and inches, or least increments (0.001 mm, 0.0001 in).
    #[arg(long, value_enum, default_value_t = Pointless::Calculator)]
    decimal: Pointless,
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

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(super) enum FileUnits {
    Mm,
    Inch,
}

impl From<FileUnits> for Units {
    fn from(units: FileUnits) -> Self {
        match units {
            FileUnits::Mm => Self::Millimetres,
            FileUnits::Inch => Self::Inches,
        }
    }
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(super) enum Pointless {
    Calculator,
    Least,
}

impl From<Pointless> for PointlessLength {
    fn from(decimal: Pointless) -> Self {
        match decimal {
            Pointless::Calculator => Self::Calculator,
            Pointless::Least => Self::Least,
        }
    }
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(super) enum Control {
    Linuxcnc,
    Fanuc,
    Haas,
    Siemens,
    Mach,
}

impl From<Control> for Dialect {
    fn from(control: Control) -> Self {
        match control {
            Control::Linuxcnc => Self::Linuxcnc,
            Control::Fanuc => Self::Fanuc,
            Control::Haas => Self::Haas,
            Control::Siemens => Self::Siemens,
            Control::Mach => Self::Mach,
        }
    }
}

impl Arguments {
    fn options(&self) -> Result<CanonOptions, Failure> {
        let tools = self.tool_table.as_deref().map(Source::read).transpose()?;
        let tools = tools.map(|source| ToolTable::parse(&source, self.tool_table_units.into())).transpose()?;
        let parameters = self.parameters.as_deref().map(Source::read).transpose()?;
        Ok(CanonOptions {
            tools: tools.unwrap_or_default(),
            parameters: parameters.map(|source| ParameterFile::parse(&source)).transpose()?.unwrap_or_default(),
            machine_units: self.machine_units.into(),
            dialect: self.dialect.into(),
            decimal: self.decimal.into(),
            skip_block_delete: self.skip_block_delete,
            subprograms: self.subprograms.clone(),
        })
    }
}

pub(super) fn run(arguments: &Arguments, terminal: &Terminal) -> Result<(), Failure> {
    let source = Source::read(&arguments.file)?;
    let options = arguments.options()?;
    let summary = match &arguments.output {
        Some(path) => {
            let mut file = OutputFile::create(path, arguments.force)?;
            let written = write_canon(&source, &options, &mut file)?;
            let summary = written.map_err(|e| InputError::unwritable(path, &e))?;
            file.commit()?;
            summary
        }
        None => {
            // A program that is refused prints nothing.
            let mut text = Vec::new();
            let summary = write_canon(&source, &options, &mut text)?.map_err(|e| Failure::Internal(e.to_string()))?;
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
