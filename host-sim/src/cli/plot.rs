//! `truepath plot`: pictures for papers and documents, SVG or PNG.

use std::path::PathBuf;

use clap::{Args, Subcommand};
use truepath_chart::view::View;
use truepath_ground::diagnostics::{Failure, InputError};
use truepath_ground::output::json;
use truepath_report::codes::Z012;
use truepath_report::plot::Column;

use super::which::WhichArguments;
use super::{Terminal, print};
use crate::command::plot::{Kind, Options, run as plot};

#[derive(Debug, Args)]
pub(super) struct Arguments {
    #[command(subcommand)]
    kind: Which,
}

#[derive(Debug, Subcommand)]
enum Which {
    /// Engagement, force, deflection and error along the contour; several passes over each other.
    Trace {
        /// trace.csv of simulate, or the folder it lies in; up to seven.
        #[arg(required = true)]
        tables: Vec<PathBuf>,
        /// Name of a pass in the legend, in the order of the tables; otherwise that of its folder.
        #[arg(long = "name")]
        names: Vec<String>,
        /// What is drawn, from top to bottom.
        #[arg(long, value_enum, value_delimiter = ',', default_values = ["arc", "force", "deflection", "error"])]
        columns: Vec<Column>,
        #[command(flatten)]
        picture: Picture,
    },
    /// What a correction adds to the path, and the wall error predicted without and with it.
    Correction {
        /// correction.csv of correct or learn, or the folder it lies in.
        table: PathBuf,
        #[command(flatten)]
        picture: Picture,
    },
    /// The wall to scale with its error magnified, and the probed places.
    Error {
        /// correction.csv or trace.csv, or the folder; several traces are drawn over each other.
        #[arg(required = true)]
        tables: Vec<PathBuf>,
        /// Name of a pass in the legend, in the order of the tables; otherwise that of its folder.
        #[arg(long = "name")]
        names: Vec<String>,
        /// Probed places; otherwise points.csv beside the first table, if there is one.
        #[arg(long, value_name = "points.csv")]
        points: Option<PathBuf>,
        /// How many times larger than the wall its error is drawn; otherwise the largest is a tenth of the part.
        #[arg(long, value_name = "TIMES", allow_negative_numbers = true)]
        magnify: Option<f64>,
        /// The job of the tables; without it the nominal wall is that of the wall.csv beside each of them.
        #[arg(long, value_name = "JOB.toml")]
        job: Option<PathBuf>,
        #[command(flatten)]
        which: WhichArguments,
        #[command(flatten)]
        picture: Picture,
    },
    /// What every law of correction leaves on the same machine.
    Compare {
        /// The folder compare wrote.
        folder: PathBuf,
        #[command(flatten)]
        picture: Picture,
    },
}

#[derive(Debug, Args)]
struct Picture {
    /// The picture: .svg or .png.
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    /// First place shown, mm along the contour.
    #[arg(long, value_name = "MM", allow_negative_numbers = true)]
    from: Option<f64>,
    /// Last place shown, mm along the contour.
    #[arg(long, value_name = "MM", allow_negative_numbers = true)]
    to: Option<f64>,
    /// Width, 1/96 inch on paper.
    #[arg(long, value_name = "PX")]
    width: Option<u32>,
    /// Height.
    #[arg(long, value_name = "PX")]
    height: Option<u32>,
    /// Pixels of a PNG to one of width and height: 3.125 prints with 300 dpi. [default: 2]
    #[arg(long, value_name = "TIMES", allow_negative_numbers = true)]
    scale: Option<f64>,
    /// The line above the picture; "" for none.
    #[arg(long)]
    title: Option<String>,
    /// Replace an existing picture.
    #[arg(long)]
    force: bool,
}

pub(super) fn run(arguments: Arguments, terminal: &Terminal) -> Result<(), Failure> {
    let (kind, magnify, picture) = match arguments.kind {
        Which::Trace { tables, names, columns, picture } => (Kind::Trace { tables, names, columns }, None, picture),
        Which::Correction { table, picture } => (Kind::Correction(table), None, picture),
        Which::Error { tables, names, points, magnify, job, which, picture } => {
            let which = which.which();
            if job.is_none() && which != Default::default() {
                let help = "give --job, the job of the tables, or leave --feature and --pass out";
                return Err(InputError::new(Z012, "--feature and --pass without --job", "a job", help).into());
            }
            let job = job.map(|job| (job, which));
            (Kind::Error { tables, names, points, job }, magnify, picture)
        }
        Which::Compare { folder, picture } => (Kind::Compare(folder), None, picture),
    };
    let Picture { output, from, to, width, height, scale, title, force } = picture;
    let view = View { title, width, height, from_mm: from, to_mm: to, magnify };
    let summary = plot(&Options { kind, output, view, scale, force })?;
    for warning in &summary.warnings {
        terminal.warn(warning);
    }
    if terminal.json() {
        return print(&json(&summary)?);
    }
    print(format!("written to {}\n", summary.output.display()).as_bytes())
}
