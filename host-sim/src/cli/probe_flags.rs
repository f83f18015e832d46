//! Flags that say what a probe file holds, in place of the keys of `[probe]`.

use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use truepath_core::probe::Columns;
use truepath_job::job::{DECIMALS, FORMATS, FRAMES, POINTS, ProbeFlags, SEPARATORS, columns};

#[derive(Debug, Args)]
#[group(id = "probe_flags")]
#[command(next_help_heading = "Probe file, in place of [probe] of the job")]
pub(super) struct Arguments {
    /// Its format.
    #[arg(long, value_name = "FORMAT", value_parser = names(&FORMATS))]
    format: Option<usize>,
    /// Columns in their order: x,y,z and nx,ny, hit where there are such; other names are not read.
    #[arg(long, value_name = "NAMES", value_parser = parsed_columns)]
    cols: Option<Columns>,
    /// What separates the columns.
    #[arg(long, value_name = "NAME", value_parser = names(&SEPARATORS))]
    sep: Option<usize>,
    /// What stands before decimals.
    #[arg(long, value_name = "NAME", value_parser = names(&DECIMALS))]
    decimal: Option<usize>,
    /// Coordinates of the columns; machine coordinates need probe.work_offset_mm.
    #[arg(long, value_name = "NAME", value_parser = names(&FRAMES))]
    frame: Option<usize>,
    /// Ball centre (tip) or touched point (surface).
    #[arg(long, value_name = "NAME", value_parser = names(&POINTS))]
    point: Option<usize>,
}

/// One of a list of names, as its place in the list.
fn names<T: Copy + Send + Sync, const N: usize>(
    choices: &'static [(&'static str, T); N],
) -> impl TypedValueParser<Value = usize> {
    PossibleValuesParser::new(choices.iter().map(|(name, _)| *name))
        .map(|text| choices.iter().position(|(name, _)| *name == text).unwrap_or(0))
}

fn parsed_columns(text: &str) -> Result<Columns, String> {
    columns(text)
        .ok_or_else(|| "expected x, y and z, each once, and nx and ny both or not at all: x,y,z,nx,ny".to_owned())
}

impl Arguments {
    /// As the job takes them.
    pub(super) fn flags(&self) -> ProbeFlags {
        ProbeFlags {
            format: self.format.map(|at| FORMATS[at].1),
            columns: self.cols,
            separator: self.sep.map(|at| SEPARATORS[at].1),
            decimal: self.decimal.map(|at| DECIMALS[at].1),
            frame: self.frame.map(|at| FRAMES[at].1),
            point: self.point.map(|at| POINTS[at].1),
        }
    }
}
