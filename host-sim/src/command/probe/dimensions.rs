//! `probe --dimensions`: what to measure by hand, a sheet to print and the file that the numbers are typed into.

use std::fmt::Write as _;
use std::path::{Path as FilePath, PathBuf};

use truepath_correction::verification::{
    DimensionPlan, DimensionSettings, USUAL_DIMENSIONS, plan_dimensions, sheet, table,
};
use truepath_ground::codes::C001;
use truepath_ground::diagnostics::{Failure, InputError};
use truepath_ground::length::between;
use truepath_ground::output::OutputFile;
use truepath_ground::units::nm;
use truepath_job::job::JobFile;

use super::options::Options;
use crate::terminal::Terminal;
use truepath_report::next::shown;

/// Most dimensions of a sheet.
const MOST: u32 = 64;
/// The largest that any instrument takes, as a dimension of the file, mm.
const MOST_MM: f64 = 4000.0;

/// Plans, writes both files and prints the dimensions. `output` is the name of the sheet, and with another extension of the file to type
/// into.
pub(super) fn main(options: &Options, output: &FilePath, terminal: &Terminal) -> Result<(), Failure> {
    let plan = terminal.watch("choosing dimensions", |progress| run(options, output, progress))?;
    terminal.tell(&plan, || words(&plan, &options.job, output))
}

fn words(plan: &DimensionPlan, job: &FilePath, output: &FilePath) -> String {
    let (unit, name) = (plan.unit, plan.unit.name());
    let mut text = format!(" no.                                        Z {name}  nominal {name}\n");
    for (k, d) in plan.dimensions.iter().enumerate() {
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "{:>4}  {:<34} {:>8.2} {:>11.3}  {}",
            k + 1,
            d.words(unit),
            unit.of(d.z_mm),
            unit.of(d.nominal_mm),
            d.why
        );
        let of = d.of();
        if !of.is_empty() {
            let _ = writeln!(text, "      {of}");
        }
    }
    text += "\nuncertainty left of what the job states:";
    for unknown in &plan.unknowns {
        let _ = write!(text, " {} {:.0} %;", unknown.words, 100.0 * unknown.remaining);
    }
    let [before, after] = plan.wall_sigma_mm.map(|sigma| unit.of(sigma));
    let _ = writeln!(
        text,
        "\npredicted wall, one sigma: {before:.4} {name} before the dimensions, {after:.4} {name} after"
    );
    let [sheet, typed] = files(output);
    let _ = writeln!(text, "written to {}\nwritten to {}", sheet.display(), typed.display());
    let _ = writeln!(
        text,
        "next: print {}, measure the milled part, type the readings into {}, and\n  truepath correct {} --dimensions {} -o DIR",
        sheet.display(),
        typed.display(),
        shown(job),
        shown(&typed)
    );
    text
}

/// The sheet and the file to type into, beside each other.
fn files(output: &FilePath) -> [PathBuf; 2] {
    ["html", "toml"].map(|extension| output.with_extension(extension))
}

fn run(options: &Options, output: &FilePath, progress: &mut dyn FnMut(f64)) -> Result<DimensionPlan, Failure> {
    let count = options.points.unwrap_or(USUAL_DIMENSIONS);
    if !(1..=MOST).contains(&count) {
        let found = format!("--points is {count}");
        return Err(
            InputError::new(C001, found, format!("1 to {MOST} dimensions"), "give --points such a number").into()
        );
    }
    let uncertainty = match options.uncertainty {
        None => options.instrument.uncertainty(),
        Some(mm) if mm > 0.0 && mm <= 1.0 => nm(mm),
        Some(mm) => {
            let found = format!("--uncertainty is {mm} mm");
            let help = "give what a reading stays within: 0.03mm or 0.001in for a calliper";
            return Err(InputError::new(C001, found, format!("above 0, {}", between(0.0, 1.0)), help).into());
        }
    };
    if let Some(mm) = options.reach.filter(|mm| !(*mm > 0.0 && *mm <= MOST_MM)) {
        let help = "give the largest dimension that the instrument takes: 150mm or 6in for a calliper";
        let expected = format!("above 0, {}", between(0.0, MOST_MM));
        return Err(InputError::new(C001, format!("--reach is {mm} mm"), expected, help).into());
    }
    let paths = files(output);
    // Targets that may not be written are refused before the work.
    let [mut page, mut typed] = {
        let [page, typed] = paths.each_ref().map(|path| OutputFile::create(path, options.force));
        [page?, typed?]
    };
    let mut job = JobFile::read(&options.job)?;
    job.which = options.which.clone();
    let passes = options.walls(job)?;
    let (instrument, reach_mm) = (options.instrument, options.reach);
    let settings = DimensionSettings { count, instrument, uncertainty, reach_mm };
    let plan = plan_dimensions(&passes, &settings, progress)?;
    let title = passes.first().map_or("", |pass| pass.program.name());
    let [html, toml] = paths.each_ref().map(|path| path.file_name().unwrap_or_default().to_string_lossy().into_owned());
    let both = [(&mut page, sheet(&plan, title, &toml), &paths[0]), (&mut typed, table(&plan, &html), &paths[1])];
    for (file, text, path) in both {
        std::io::Write::write_all(file, text.as_bytes()).map_err(|e| InputError::unwritable(path, &e))?;
    }
    page.commit()?;
    typed.commit()?;
    Ok(plan)
}
