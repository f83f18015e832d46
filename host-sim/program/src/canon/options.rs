//! What is known besides the program.

use std::path::PathBuf;

use truepath_core::gcode::{Dialect, Options, PointlessLength, Units};

use super::parameter_file::ParameterFile;
use super::tool_table::ToolTable;

/// What the interpreter is told besides the program.
#[derive(Clone, Debug)]
pub struct CanonOptions {
    /// Offsets for G43, diameters for G41.
    pub tools: ToolTable,
    /// Offsets and reference points.
    pub parameters: ParameterFile,
    /// The unit of the machine: of the parameters.
    pub machine_units: Units,
    /// The control the program is written for.
    pub dialect: Dialect,
    /// What a length without a point is.
    pub decimal: PointlessLength,
    /// Whether blocks with `/` are skipped.
    pub skip_block_delete: bool,
    /// How many blocks may be executed beyond as many as the program has lines; loops that run longer are an error.
    pub block_limit: u32,
    /// The folder with the files of subprograms; by default that of the program.
    pub subprograms: Option<PathBuf>,
}

impl Default for CanonOptions {
    fn default() -> Self {
        Self {
            tools: ToolTable::default(),
            parameters: ParameterFile::default(),
            machine_units: Units::Millimetres,
            dialect: Dialect::Linuxcnc,
            decimal: PointlessLength::Calculator,
            skip_block_delete: false,
            block_limit: Options::default().block_limit,
            subprograms: None,
        }
    }
}
