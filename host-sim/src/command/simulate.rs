//! `simulate`: the pass as the core predicts it, or as the plant cuts it.

use std::path::Path as FilePath;

use truepath_core::correct::{Band, Profile, profile};
use truepath_core::cut::{ForceTable, State};
use truepath_core::geometry::Vector;

use super::page::{REPORT, simulated};
use crate::diagnostics::{Failure, InputError, Source};
use crate::job::{Job, Which};
use crate::output::OutputFolder;
use crate::pass::{Pass, PathBuffer};
use crate::plant;
use crate::plot::{self, Column, View};
use crate::report::page::{self, Along};
use crate::report::{SimulateSummary, Trace, json, mm, simulate_summary, trace, trace_csv, wall_csv};
use crate::workshop;

/// Files this command may write.
const FILES: &[&str] = &["trace.csv", "wall.csv", "summary.json", "trace.svg", REPORT];

/// What is simulated.
#[derive(Clone, Debug)]
pub struct Options<'a> {
    /// The job.
    pub job: &'a FilePath,
    /// A machine for the plant; without it the core predicts with the job's priors.
    pub plant: Option<&'a FilePath>,
    /// Output folder.
    pub out: &'a FilePath,
    /// Replace existing files.
    pub force: bool,
    /// Which cut of the program.
    pub which: Which,
}

/// Simulates and writes trace and summary.
///
/// # Errors
/// Whatever is wrong with job, program or plant, and outputs that cannot be written.
pub fn run(options: &Options) -> Result<SimulateSummary, Failure> {
    let mut job = Job::read(options.job)?;
    job.which = options.which.clone();
    let pass = Pass::read(job)?;
    let folder = OutputFolder::create(options.out, options.force, FILES)?;
    let mut warnings = pass.warnings.clone();
    let (by, trace, along) = match options.plant {
        None => {
            let (trace, along) = predicted(&pass, &mut warnings)?;
            ("core", trace, along)
        }
        Some(file) => {
            let (trace, along) = milled(&pass, &read_machine(file)?)?;
            ("plant", trace, along)
        }
    };
    let summary = simulate_summary(&pass, by, &trace, warnings);
    folder.write("trace.csv", &trace_csv(&trace)?)?;
    folder.write("wall.csv", &wall_csv(&trace)?)?;
    folder.write("summary.json", &json(&summary)?)?;
    folder.write("trace.svg", &plot::trace(&View::default(), &[("", &trace)], &Column::USUAL)?)?;
    folder.write(REPORT, &page::render(&simulated(&pass, along, &summary))?)?;
    folder.commit()?;
    Ok(summary)
}

/// The uncorrected pass as the core predicts it from the job's priors; adds to the warnings what is doubtful.
///
/// # Errors
/// As [`Pass::sample`].
fn predicted(pass: &Pass, warnings: &mut Vec<String>) -> Result<(Trace, Along), Failure> {
    let mut buffer = PathBuffer::default();
    let path = pass.sample(&mut buffer)?;
    let prior = pass.core.prior(pass.core.setup.law).mean;
    let table = ForceTable::new(prior.coefficients.size_exponent);
    let machine = prior.machine(&path, &table);
    let mut states = vec![State::REST; path.working().len()];
    let passage = machine.run(path.working().start, &mut states, |_| Vector::ZERO);
    if passage.unsettled > 0 {
        warnings.push(format!(
            "the elastic loop did not settle at {} places (worst residual {:.4} mm): the machine is too soft for this cut",
            passage.unsettled,
            mm(passage.worst_residual)
        ));
    }
    let mut displacements = vec![Vector::ZERO; states.len()];
    let mut profiles = vec![Profile::default(); path.count()];
    profile(&machine, &states, Band::WHOLE, &mut displacements, &mut profiles);
    let errors: Vec<f64> = profiles.iter().map(|p| if p.on_wall { mm(p.mean) } else { f64::NAN }).collect();
    let trace = trace(&machine, &states, &errors);
    let along = page::simulated(&machine, &states, &trace, "predicted by the core from the job's values");
    Ok((trace, along))
}

/// The uncorrected pass as a virtual machine cuts it.
///
/// # Errors
/// What the plant refuses.
fn milled(pass: &Pass, machine: &plant::Machine) -> Result<(Trace, Along), Failure> {
    let milled = workshop::mill(pass, machine, None)?;
    let trace = page::trace_of(&milled);
    let along = page::milled(&milled, &trace, "cut by the virtual machine");
    Ok((trace, along))
}

/// Reads a PLANT.toml.
///
/// # Errors
/// Whatever is wrong with it, with its place.
pub fn read_machine(file: &FilePath) -> Result<plant::Machine, Failure> {
    let source = Source::read(file)?;
    let text = std::str::from_utf8(source.bytes()).map_err(|e| {
        let at = e.valid_up_to();
        let help = "save the file as UTF-8";
        InputError::new("L001", "a byte that is not UTF-8", "a text file", help).at(&source, at..at + 1)
    })?;
    toml::from_str(text).map_err(|e| {
        let span = e.span().unwrap_or(0..0);
        let help = "see docs/plant.md for the keys of a plant and their units";
        InputError::new("L002", e.message().to_owned(), "", help).at(&source, span).into()
    })
}
