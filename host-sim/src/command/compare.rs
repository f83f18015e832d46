//! `compare`: what every law of correction leaves on the same machine, from the same measurement.

use std::path::Path as FilePath;

use truepath_chart::view::View;
use truepath_correction::correction::identify;
use truepath_ground::diagnostics::{Failure, Source};
use truepath_ground::output::{OutputFolder, json};
use truepath_ground::units::{float, mm};
use truepath_job::job::{Job, ProbeFlags, Which};
use truepath_job::measurement::Measurement;
use truepath_job::pass::{Pass, PathBuffer};
use truepath_report::plot::{Compared, LawWall};
use truepath_report::{compare_csv, plot, walls_csv};
use truepath_trial::compare::{Row, Walls, candidates, identified as by_model, row, virtual_machine};

use super::simulate::read_machine;

/// Files this command may write.
const FILES: &[&str] = &["compare.csv", "walls.csv", "summary.json", "compare.svg"];

/// What is compared.
#[derive(Clone, Debug)]
pub struct Options<'a> {
    /// The job.
    pub job: &'a FilePath,
    /// The probe file of the uncorrected part.
    pub probe: &'a FilePath,
    /// A virtual machine to compare on; without it the identified one.
    pub plant: Option<&'a FilePath>,
    /// Output folder, if anything is to be written.
    pub out: Option<&'a FilePath>,
    /// Replace existing files.
    pub force: bool,
    /// What the command line says of the probe file.
    pub probe_flags: ProbeFlags,
    /// Which cut of the program.
    pub which: Which,
}

/// The comparison.
#[derive(Clone, Debug, serde::Serialize)]
pub struct CompareSummary {
    /// Version of this file.
    pub version: u32,
    /// On which machine: `identified` (the model's own prediction) or `plant`.
    pub machine: &'static str,
    /// The target whose error is compared: `mean`, `tip` or `minimax`.
    pub target: &'static str,
    /// Heights the target counts, mm above the tip.
    pub band_mm: [f64; 2],
    /// What is left out at either end of the contour, mm.
    pub trim_mm: f64,
    /// Contacts used.
    pub points_used: usize,
    /// One line a law.
    pub laws: Vec<Row>,
    /// What the user should know.
    pub warnings: Vec<String>,
}

/// Compares all laws, and writes table and picture where a folder is named. `progress` is told the share done, 0…1.
///
/// # Errors
/// Whatever is wrong with job, program, probe file or plant, and outputs that cannot be written.
pub fn run(options: &Options, progress: &mut dyn FnMut(f64)) -> Result<CompareSummary, Failure> {
    let mut job = Job::read(options.job)?;
    job.override_probe(&options.probe_flags)?;
    job.which = options.which.clone();
    let pass = Pass::read(job)?;
    let file = Source::read(options.probe)?;
    let (pass, measurement) = Measurement::of_any_depth(pass, &file)?;
    let plant = options.plant.map(read_machine).transpose()?;
    let folder = options.out.map(|out| OutputFolder::create(out, options.force, FILES)).transpose()?;
    let mut buffer = PathBuffer::default();
    let sampled = pass.sample(&mut buffer)?;
    let identified = identify(&pass, &sampled, &measurement, |share| progress(0.3 * share))?;
    let path = sampled.with_law(identified.law());
    let table = identified.table();
    let machine = identified.machine(&path, &table);
    let candidates = candidates(&pass, &machine, &identified, &measurement.contacts, |share| {
        progress(0.3 + 0.4 * share);
    });
    let wanted = pass.job.numbers.design(truepath_core::correct::Law::Model);
    let mut left: Vec<Result<Walls, String>> = Vec::new();
    for candidate in &candidates {
        left.push(match &plant {
            None => Ok(by_model(&machine, &wanted, &candidate.nodes)),
            Some(plant) => virtual_machine(&pass, &path, plant, &wanted, &candidate.nodes).map_err(|e| e.to_string()),
        });
        progress(0.7 + 0.3 * left.len() as f64 / candidates.len() as f64);
    }
    let trim_mm = (0.8 * mm(pass.core.setup.radius)).max(6.0);
    let clamp = pass.job.numbers.correct.clamp;
    let mut laws: Vec<Row> = Vec::new();
    for (candidate, walls) in candidates.iter().zip(&left) {
        let none = laws.first().and_then(|none| none.max_error_mm);
        laws.push(row(candidate, walls.as_ref().map_err(String::as_str), none, trim_mm, clamp));
    }
    let mut warnings = pass.warnings.clone();
    warnings.extend(measurement.remarks(&file));
    let depth = float(pass.core.setup.axial_depth);
    let summary = CompareSummary {
        version: 1,
        machine: if plant.is_some() { "plant" } else { "identified" },
        target: target_name(wanted.target),
        band_mm: [float(wanted.band.from) * depth, float(wanted.band.to) * depth],
        trim_mm,
        points_used: measurement.contacts.len(),
        laws,
        warnings,
    };
    if let Some(folder) = folder {
        let named: Vec<(&str, &Walls)> =
            candidates.iter().zip(&left).filter_map(|(c, walls)| Some((c.law, walls.as_ref().ok()?))).collect();
        folder.write("compare.csv", &compare_csv(&summary.laws)?)?;
        folder.write("walls.csv", &walls_csv(&named)?)?;
        folder.write("summary.json", &json(&summary)?)?;
        folder.write("compare.svg", &picture(&summary, &named)?)?;
        folder.commit()?;
    }
    Ok(summary)
}

fn target_name(target: truepath_core::correct::Target) -> &'static str {
    match target {
        truepath_core::correct::Target::Mean => "mean",
        truepath_core::correct::Target::Tip => "tip",
        truepath_core::correct::Target::Minimax => "minimax",
    }
}

/// The walls of all laws.
fn picture(summary: &CompareSummary, walls: &[(&str, &Walls)]) -> Result<Vec<u8>, Failure> {
    let law = |law: &str, walls: &Walls| {
        let row = summary.laws.iter().find(|r| r.law == law);
        LawWall {
            law: law.to_owned(),
            title: row.map_or("", |r| r.title).to_owned(),
            max_error_mm: row.and_then(|r| r.max_error_mm),
            places: walls.places.iter().map(|p| [p.s_mm, p.error_mm, p.lowest_mm, p.highest_mm]).collect(),
        }
    };
    let laws = walls.iter().map(|(name, walls)| law(name, walls)).collect();
    let compared = Compared { on_plant: summary.machine == "plant", trim_mm: summary.trim_mm, laws };
    plot::compare(&View::default(), &compared)
}
