//! `pocket`: the compensated path of a whole pocket from tool and material data alone.

use std::path::{Path as FilePath, PathBuf};

use clap::Args;
use truepath_core::checksum::crc32;
use truepath_core::correct::Node;
use truepath_core::cut::Path;
use truepath_core::geometry::{Side, Vector};
use truepath_core::units::Offset;
use truepath_correction::edits::block_edits;
use truepath_ground::diagnostics::Failure;
use truepath_ground::length::{self, Remark, Unit};
use truepath_ground::output::{OutputFolder, json};
use truepath_ground::units::mm;
use truepath_job::job::{JobFile, Mode, PerSection, PocketTable, Which};
use truepath_job::levels;
use truepath_job::pass::{Pass, PathBuffer, read_blocks};
use truepath_pocket::{
    Designed, Machine, PocketError, PocketSummary, Process, Told, Wanted, before_after, correction_csv, design, edits,
    finishing, materials, materials_text, pocket_summary, section_rows, sections_csv, sections_text, sensitivity,
    slotting,
};
use truepath_program::{BlockEdit, Origin, RewriteOptions, Rewritten, rewrite_program};

use crate::terminal::Terminal;

/// Files this command may write.
const FILES: &[&str] =
    &["corrected.nc", "difference.txt", "correction.csv", "sections.csv", "summary.json", "before-after.svg"];

/// What is compensated.
#[derive(Clone, Debug, Default, Args)]
pub struct Options {
    /// The job: with `stickout_mm` and `material` in `[tool]`, and `[pocket]`.
    #[arg(required_unless_present = "materials")]
    pub job: Option<PathBuf>,
    /// Folder for corrected.nc, sections.csv, correction.csv, before-after.svg and summary.json.
    #[arg(short, long, value_name = "DIR", required_unless_present = "materials")]
    pub output: Option<PathBuf>,
    /// Half of the width of the band the walls may lie in, mm, or with its unit (0.0005in, 12um); over that of the
    /// job.
    #[arg(long, value_name = "LENGTH", value_parser = length::flag, allow_negative_numbers = true)]
    pub tolerance: Option<f64>,
    /// How a section out of the band is shifted; over what the job says.
    #[arg(long, value_name = "WAY")]
    pub per_section: Option<PerSection>,
    /// The force coefficients of materials, with their sources, and nothing else.
    #[arg(long, conflicts_with_all = ["job", "output", "tolerance", "per_section"])]
    pub materials: bool,
    /// Replace the files of an earlier run.
    #[arg(long)]
    pub force: bool,
    /// Which cut of the program.
    #[command(flatten)]
    pub which: Which,
}

/// Compensates, or lists the materials.
pub(crate) fn main(options: &Options, terminal: &Terminal) -> Result<(), Failure> {
    let (Some(job), Some(out)) = (&options.job, &options.output) else {
        let rows = materials();
        return terminal.tell(&rows, || materials_text(&rows));
    };
    compensate(options, job, out, terminal)
}

/// Compensates and prints; `truepath correct --no-probe` comes here as well.
pub(super) fn compensate(
    options: &Options,
    job: &FilePath,
    out: &FilePath,
    terminal: &Terminal,
) -> Result<(), Failure> {
    let summary = terminal.watch("compensating", |progress| run(options, job, out, progress))?;
    terminal.warn_all(&summary.warnings);
    terminal.tell(&summary, || format!("{}written to {}\n", words(&summary), out.display()))
}

fn words(s: &PocketSummary) -> String {
    let (unit, name) = (s.unit, s.unit.name());
    let what = match s.mode {
        Mode::Wall => "finishing pass",
        Mode::Slot => "slot, near wall on the",
    };
    let side = if s.mode == Mode::Slot { format!(" {}", s.near_wall) } else { String::new() };
    let cutter = &s.cutter;
    let mut text = format!(
        "{what}{side}, {:.1} {name}, {} milling; cutter {:.1} {name} free, {:.1} of it fluted: {:.3} µm/N at the tip, {:.3} at the top of the cut\n\n",
        unit.of(s.length_mm),
        s.milling,
        unit.of(cutter.stickout_mm),
        unit.of(cutter.flute_length_mm),
        cutter.tip_um_per_n,
        cutter.top_um_per_n,
    );
    text += &sections_text(&s.sections, unit);
    text += &format!(
        "\nband ±{} {name}: {} of {} sections shifted, largest error {:.4} -> {:.4} {name}, predicted\n\
         without a probe this is as good as the force coefficients:\n",
        unit.of(s.tolerance_mm),
        s.sections_shifted,
        s.sections.len(),
        unit.of(s.max_error_before_mm),
        unit.of(s.max_error_after_mm)
    );
    if s.max_error_sharp_mm > 0.0 {
        let left = unit.of(s.max_error_sharp_mm);
        text += &format!("  (corners without an arc apart: {left:.4} {name} remain there)\n");
    }
    for case in &s.sensitivity {
        let out = match case.sections_out {
            0 => "all sections within the band".to_owned(),
            1 => "1 section out of the band".to_owned(),
            n => format!("{n} sections out of the band"),
        };
        text += &format!(
            "  coefficients {:+.0} %: largest error {:.4} -> {:.4} {name}, {out}\n",
            100.0 * (case.factor - 1.0),
            unit.of(case.max_error_before_mm),
            unit.of(case.max_error_after_mm)
        );
    }
    text
}

/// A compensated pocket in memory.
#[derive(Debug)]
struct Made {
    told: Told,
    edits: Vec<BlockEdit>,
    correction: Vec<u8>,
    picture: Vec<u8>,
}

/// Compensates a pocket and writes the outputs.
///
/// # Errors
/// Whatever is wrong with job or program, a cutter too soft for the cut, outputs that cannot be written.
fn run(
    options: &Options,
    job: &FilePath,
    out: &FilePath,
    progress: &mut dyn FnMut(f64),
) -> Result<PocketSummary, Failure> {
    let mut job = JobFile::read(job)?;
    job.which = options.which.clone();
    let mut table = job.pocket.unwrap_or_default();
    table.per_section = options.per_section.unwrap_or(table.per_section);
    if let Some(tolerance) = options.tolerance {
        table.tolerance = checked(tolerance).map_err(|e| e.failure(&job, Unit::default()))?;
    }
    if table.mode == Mode::Slot && job.numbers.wall.is_none() {
        // A slot has a wall on either side: the right one is called near, unless the program names one.
        let named =
            read_blocks(&job.read_program()?, job.numbers.program_options()).ok().and_then(|(_, contour)| contour.wall);
        job.numbers.wall = named.or(Some(Side::Right));
    }
    let machine = Machine::of(&job).map_err(|e| e.failure(&job, Unit::default()))?;
    let pass = Pass::read(job)?;
    let folder = OutputFolder::create(out, options.force, FILES)?;
    let mut warnings = pass.warnings.clone();
    if table.mode == Mode::Slot && pass.job.gives("stock.allowance_mm") {
        warnings.push("[stock] is not used: a slot is cut at full immersion".into());
    }
    let refused = |error: PocketError| error.failure(&pass.job, pass.unit());
    let made = match table.mode {
        Mode::Wall => {
            let mut buffer = PathBuffer::default();
            let path = pass.sample(&mut buffer)?;
            let process = finishing(&pass, &path).map_err(refused)?;
            let closed = path.is_closed();
            make(&pass, &process, (&table, closed), &mut warnings, progress, |designed, warnings| {
                wall_edits(&pass, &path, designed, warnings)
            })?
        }
        Mode::Slot => {
            let process = slotting(&pass).map_err(refused)?;
            if pass.plan.as_ref().is_some_and(|plan| plan.passes.len() > 1) {
                warnings.push("only the depth that was asked for is compensated, see --pass".into());
            }
            make(&pass, &process, (&table, false), &mut warnings, progress, |designed, _| {
                Ok(edits(process.stations(), &designed.vectors))
            })?
        }
    };
    let written = if made.told.designed.shifted.contains(&true) {
        Some(corrected_program(&pass, &made.edits)?)
    } else {
        warnings.push("every section is within the band: the program stays as it is, and none is written".into());
        None
    };
    let difference = written.as_ref().map(|written| written.difference.clone());
    let summary = pocket_summary(&pass, &table, &machine, &made.told, difference, warnings);
    if let Some(written) = &written {
        folder.write("corrected.nc", &written.text)?;
        let text = written.difference.text(pass.program.name(), pass.unit());
        folder.write("difference.txt", text.as_bytes())?;
    }
    folder.write("correction.csv", &made.correction)?;
    folder.write("sections.csv", &sections_csv(&made.told.rows)?)?;
    folder.write("summary.json", &json(&summary)?)?;
    folder.write("before-after.svg", &made.picture)?;
    folder.commit()?;
    progress(1.0);
    Ok(summary)
}

fn checked(tolerance_mm: f64) -> Result<Offset, PocketError> {
    let tolerance = Offset::from_nm((tolerance_mm.clamp(0.0, 2.0) * 1e6).round() as i64);
    if tolerance_mm.is_nan() || tolerance_mm > 1.0 || tolerance <= Offset::ZERO {
        return Err(PocketError::Tolerance(tolerance_mm));
    }
    Ok(tolerance)
}

fn make(
    pass: &Pass,
    process: &dyn Process,
    (table, closed): (&PocketTable, bool),
    warnings: &mut Vec<Remark>,
    progress: &mut dyn FnMut(f64),
    edits: impl FnOnce(&Designed, &mut Vec<Remark>) -> Result<Vec<BlockEdit>, Failure>,
) -> Result<Made, Failure> {
    let refused = |error: PocketError| error.failure(&pass.job, pass.unit());
    let tolerance_mm = mm(table.tolerance);
    let clamp_mm = mm(pass.job.numbers.correct.clamp);
    let wanted = Wanted { tolerance_mm, per_section: table.per_section, clamp_mm, closed };
    let designed = design(process, &wanted, &mut |share| progress(0.8 * share)).map_err(refused)?;
    let sensitivity = sensitivity(process, &designed, tolerance_mm).map_err(refused)?;
    progress(0.9);
    let edits = edits(&designed, warnings)?;
    let stations = process.stations();
    Ok(Made {
        edits,
        correction: correction_csv(stations, &designed)?,
        picture: before_after(stations, &designed, table.mode, (tolerance_mm, pass.unit()))?,
        told: Told { rows: section_rows(stations, &designed, table.mode, tolerance_mm), sensitivity, designed },
    })
}

/// The shifted path of a finishing pass at every depth it stands for.
fn wall_edits(
    pass: &Pass,
    path: &Path,
    designed: &Designed,
    warnings: &mut Vec<Remark>,
) -> Result<Vec<BlockEdit>, Failure> {
    let nm = |v: f64| Offset::from_nm((v * 1e6).round() as i64);
    let node = |v: &[f64; 2]| Node { chip: Vector::ZERO, edge: Vector { x: nm(v[0]), y: nm(v[1]) } };
    let nodes: Vec<Node> = designed.vectors.iter().map(node).collect();
    let mut edits = Vec::new();
    let levels = levels::each(pass, path, |_, pass, path| {
        edits.extend(block_edits(pass, path, &nodes, None));
        Ok(())
    })?;
    warnings.extend(levels.left.into_iter().map(Remark::from));
    Ok(edits)
}

fn corrected_program(pass: &Pass, edits: &[BlockEdit]) -> Result<Rewritten, Failure> {
    let options = RewriteOptions {
        tolerance: pass.job.tolerance,
        max_arc_radius: pass.job.max_arc_radius,
        max_kink_deg: pass.job.max_kink_deg,
        program: pass.job.numbers.program_options(),
        origin: Origin { job: Some(crc32(pass.job.source().bytes())), ..Origin::default() },
        notes: vec!["FROM TOOL AND MATERIAL DATA ALONE, NOT FROM A PROBE".to_owned()],
        ..RewriteOptions::default()
    };
    rewrite_program(&pass.program, edits, &options)
}
