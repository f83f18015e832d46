//! `compare`: what every law of correction leaves on the same machine, from the same measurement.

use std::path::PathBuf;

use clap::Args;
use truepath_chart::view::View;
use truepath_correction::correct::as_its_points_tell;
use truepath_correction::correction::identify;
use truepath_correction::surface::expected::Surfaces;
use truepath_ground::diagnostics::{Failure, Source};
use truepath_ground::length::{Remark, Unit};
use truepath_ground::output::{OutputFolder, json};
use truepath_ground::units::{float, mm};
use truepath_job::job::Said;
use truepath_job::measurement::Measurement;
use truepath_job::pass::{Pass, PathBuffer};
use truepath_report::plot::{Compared, LawWall};
use truepath_report::{compare_csv, plot, walls_csv};
use truepath_trial::compare::{Row, Walls, candidates, identified as by_model, row, virtual_machine};

use super::simulate::read_machine;
use crate::terminal::Terminal;
use truepath_report::next::correct;

/// Files this command may write.
const FILES: &[&str] = &["compare.csv", "walls.csv", "summary.json", "compare.svg"];

/// What is compared.
#[derive(Clone, Debug, Default, Args)]
pub struct Options {
    /// The job.
    pub job: PathBuf,
    /// What the probe measured on the part cut by the job's program.
    #[arg(long, value_name = "FILE")]
    pub probe: PathBuf,
    /// A virtual machine to compare on; without it the machine identified from the points.
    #[arg(long, value_name = "PLANT.toml")]
    pub plant: Option<PathBuf>,
    /// Folder for the tables, the summary and the picture.
    #[arg(short, long, value_name = "DIR")]
    pub output: Option<PathBuf>,
    /// Replace the files of an earlier run.
    #[arg(long, requires = "output")]
    pub force: bool,
    /// What is said in place of the job.
    #[command(flatten)]
    pub said: Said,
}

/// Compares and prints the table.
pub(crate) fn main(options: &Options, terminal: &Terminal) -> Result<(), Failure> {
    let summary = terminal.watch("comparing", |progress| run(options, progress))?;
    terminal.warn_all(&summary.warnings);
    terminal.tell(&summary, || words(&summary) + "\n" + &correct(&options.job, Some(&options.probe), None).to_string())
}

fn words(s: &CompareSummary) -> String {
    let on = match s.machine {
        "plant" => "on the virtual machine, which shares no physics with the model",
        _ => "on the machine identified from the points: the model's own prediction",
    };
    let (unit, name) = (s.unit, s.unit.name());
    let mut text = format!(
        "{on}\nerror of the target ({}, heights {:.1} to {:.1} {name}) and at any height, without {:.1} {name} at either end\n\n\
         law                     largest       rms  any height      95 %     gouge   {name}\n",
        s.target,
        unit.of(s.band_mm[0]),
        unit.of(s.band_mm[1]),
        unit.of(s.trim_mm)
    );
    let number = |v: Option<f64>| v.map_or_else(|| "-".to_owned(), |v| format!("{:.4}", unit.of(v)));
    for row in &s.laws {
        text += &format!(
            "{:<20} {:>10} {:>9} {:>11} {:>9} {:>9}\n",
            row.title,
            number(row.max_error_mm),
            number(row.rms_error_mm),
            number(row.worst_height_mm),
            number(row.p95_mm),
            number(row.gouge_mm),
        );
    }
    text.push('\n');
    if let [before, .., after] = &s.laws[..] {
        text += &whole_wall(before, after, s.target, unit);
    }
    for row in s.laws.iter().filter(|row| !row.remark.is_empty()) {
        text += &format!("{}: {}\n", row.title, row.remark);
    }
    text
}

/// The whole wall without a correction and with that of the last law, and what makes the worst of the latter.
fn whole_wall(before: &Row, after: &Row, target: &str, unit: Unit) -> String {
    let name = unit.name();
    if let (Some(without), Some(with)) = (before.expected, after.expected) {
        let (surfaces, within) = (Surfaces { before: without, after: with }, [with.p95_mm, 2.0 * with.p95_sigma_mm]);
        return format!(
            "{}, with what the points leave open (± 2 sigma): {}; 95 % of the wall within {:.3} -> {:.3} ± {:.3} {name}\n  {}\n\n",
            after.title,
            surfaces.words(unit),
            unit.of(without.p95_mm),
            unit.of(within[0]),
            unit.of(within[1]),
            with.worst_words(unit)
        );
    }
    let short = |v: Option<f64>| v.map_or_else(|| "-".to_owned(), |v| format!("{:.3}", unit.of(v)));
    format!(
        "{}: {} {} -> {} {name}; worst at any height {} -> {} {name}; 95 % of the wall within {} -> {} {name}\n{}\n",
        after.title,
        if target == "mean" { "mean over the height" } else { "target" },
        short(before.max_error_mm),
        short(after.max_error_mm),
        short(before.worst_height_mm),
        short(after.worst_height_mm),
        short(before.p95_mm),
        short(after.p95_mm),
        after.causes.map_or_else(String::new, |causes| format!("  at the worst place: {}\n", causes.words(unit))),
    )
}

/// The comparison.
#[derive(Clone, Debug, serde::Serialize)]
pub struct CompareSummary {
    /// Version of this file.
    pub version: u32,
    /// The unit of the program, in which people are told.
    #[serde(skip)]
    pub unit: Unit,
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
    pub warnings: Vec<Remark>,
}

/// Compares all laws, and writes table and picture where a folder is named. `progress` is told the share done, 0…1.
///
/// # Errors
/// Whatever is wrong with job, program, probe file or plant, and outputs that cannot be written.
pub fn run(options: &Options, progress: &mut dyn FnMut(f64)) -> Result<CompareSummary, Failure> {
    let pass = Pass::read(options.said.read(&options.job)?)?;
    let file = Source::read(&options.probe)?;
    let (pass, measurement) = Measurement::of_any_depth(pass, &file)?;
    let plant = options.plant.as_deref().map(read_machine).transpose()?;
    let folder = options.output.as_ref().map(|out| OutputFolder::create(out, options.force, FILES)).transpose()?;
    let pass = as_its_points_tell(pass, &measurement)?;
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
            None => Ok(by_model(&machine, &identified, &wanted, &candidate.nodes)),
            Some(plant) => virtual_machine(&pass, &path, plant, &wanted, &candidate.nodes).map_err(|e| e.to_string()),
        });
        progress(0.7 + 0.3 * left.len() as f64 / candidates.len() as f64);
    }
    let trim_mm = (0.8 * mm(pass.core.setup.radius)).max(6.0);
    let clamp = pass.job.numbers.correct.clamp;
    let mut laws: Vec<Row> = Vec::new();
    for (candidate, walls) in candidates.iter().zip(&left) {
        let none = laws.first().and_then(|none| none.max_error_mm);
        laws.push(row(candidate, walls.as_ref().map_err(String::as_str), none, trim_mm, (clamp, pass.unit())));
    }
    let mut warnings = pass.warnings.clone();
    warnings.extend(measurement.remarks(&file));
    let depth = float(pass.core.setup.axial_depth);
    let summary = CompareSummary {
        version: 1,
        unit: pass.unit(),
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
    plot::compare(&View::in_unit(summary.unit), &compared)
}
