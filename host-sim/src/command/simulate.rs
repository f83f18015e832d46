//! `simulate`: the pass as the core predicts it, or as the plant cuts it.

use std::fmt::Write;
use std::path::{Path as FilePath, PathBuf};

use clap::Args;
use truepath_chart::view::View;
use truepath_core::correct::{Band, Profile, profile};
use truepath_core::cut::{ForceTable, State};
use truepath_core::geometry::Vector;
use truepath_ground::diagnostics::{Failure, Source};
use truepath_ground::length::Remark;
use truepath_ground::output::{OutputFolder, json};
use truepath_ground::units::mm;
use truepath_job::feature::listing;
use truepath_job::job::{JobFile, Which};
use truepath_job::pass::{Pass, PathBuffer};
use truepath_plant as plant;
use truepath_plant::{Surface, judged_trim_mm};
use truepath_report::next::shown;
use truepath_report::page::Along;
use truepath_report::pages::{REPORT, simulated};
use truepath_report::plot::Column;
use truepath_report::{SimulateSummary, Trace, page, plot, simulate_summary, trace, trace_csv, wall_csv, wall_map_csv};
use truepath_trial::codes::{L001, L002};
use truepath_trial::replay::Placement;
use truepath_trial::setpoints::Setpoints;
use truepath_trial::virtual_mill::Made;
use truepath_trial::{process, recorded, virtual_mill};

use super::correction_files::{CONTOURS, contour_name, contour_place};
use super::placement::PlacementOptions;
use crate::terminal::Terminal;

/// Files this command may write.
const FILES: &[&str] = &[
    "trace.csv",
    "wall.csv",
    MAP,
    PROBED,
    TOUCHED,
    TOUCHED_STOCK,
    "summary.json",
    "trace.svg",
    REPORT,
    CONTOURS,
    DYNAMOMETER,
];
/// The wall unrolled.
const MAP: &str = "wall-map.csv";
/// The wall as cut, at several heights.
const PROBED: &str = "probed-wall.csv";
/// Records of a dynamometer, and what was cut.
const DYNAMOMETER: &str = "dynamometer/";
/// What the machine writes while it runs the probing program.
const TOUCHED: &str = "probe.txt";
/// The same while the stock is touched, before the pass.
const TOUCHED_STOCK: &str = "stock.txt";
/// The corrected program in the folder of a correction.
const CORRECTED: &str = "corrected.nc";
/// Heights of probed-wall.csv, over the whole depth.
const HEIGHTS: usize = 21;
/// Slices in which a single pass is judged at every height.
const SLICES: usize = 30;

/// An elastic loop that stays open by more than this is told, mm.
const OPEN_MM: f64 = 1e-3;

/// What is simulated.
#[derive(Clone, Debug, Default, Args)]
pub struct Options {
    /// The job.
    pub job: PathBuf,
    /// A virtual machine to cut with; without it the core predicts from the job's own numbers.
    #[arg(long, value_name = "PLANT.toml")]
    pub plant: Option<PathBuf>,
    /// Cut along a recorded tool path, not along the program's: `# frame = program` or `machine`, then t_s,x_mm,y_mm,z_mm
    /// and other columns as for `truepath replay`.
    #[arg(long, value_name = "FILE", requires = "plant")]
    pub setpoints: Option<PathBuf>,
    /// Cut with the corrected program in DIR, written by truepath correct or learn.
    #[arg(long, value_name = "DIR", requires = "plant", conflicts_with = "setpoints")]
    pub from: Option<PathBuf>,
    /// Cut with this program: all that it does along the wall, pass after pass on one part, each over what the one before
    /// left at every height.
    #[arg(long, value_name = "FILE", requires = "plant", conflicts_with_all = ["setpoints", "from"])]
    pub program: Option<PathBuf>,
    /// Touch the wall with this program, written by truepath probe, and write probe.txt, the file that the machine would
    /// have written.
    #[arg(long, value_name = "FILE", requires = "plant")]
    pub touch: Option<PathBuf>,
    /// Touch the stock before the pass instead, with the program written by truepath probe --stock, and write stock.txt.
    #[arg(long, requires = "touch")]
    pub stock: bool,
    /// Where the program stood in the machine.
    #[command(flatten)]
    pub placement: PlacementOptions,
    /// Also write probed-wall.csv: the wall as cut at several heights, for a simulated probe.
    #[arg(long, requires = "plant")]
    pub probed_wall: bool,
    /// Also write the folder dynamometer: cuts.toml for truepath forces and a record a feed, as a dynamometer under the
    /// workpiece would have written it.
    #[arg(long, requires = "plant")]
    pub dynamometer: bool,
    /// Folder for trace.csv, trace.svg, report.html and summary.json.
    #[arg(short, long, value_name = "DIR")]
    pub output: PathBuf,
    /// Replace the files of an earlier run.
    #[arg(long)]
    pub force: bool,
    /// Which cut of the program.
    #[command(flatten)]
    pub which: Which,
}

/// Simulates and prints the summary.
pub(crate) fn main(options: &Options, terminal: &Terminal) -> Result<(), Failure> {
    let summary = run(options)?;
    terminal.warn_all(&summary.warnings);
    terminal.tell(&summary, || words(&summary, &options.output) + &next(options))
}

/// What to do with the touches, where there are any.
fn next(options: &Options) -> String {
    let job = shown(&options.job);
    let probe = |name: &str| shown(&options.output.join(name));
    match (&options.touch, options.stock, &options.from) {
        (None, ..) => String::new(),
        (Some(_), true, _) => {
            format!(
                "touches written to {0}; next: name them in the job: [stock] probe = \"{0}\"\n",
                probe(TOUCHED_STOCK)
            )
        }
        (Some(_), false, Some(from)) => {
            format!("next: truepath learn {job} --probe {} --from {} -o DIR\n", probe(TOUCHED), shown(from))
        }
        (Some(_), false, None) => format!("next: truepath correct {job} --probe {} -o DIR\n", probe(TOUCHED)),
    }
}

fn words(summary: &SimulateSummary, output: &FilePath) -> String {
    let (unit, mm) = (summary.unit, summary.unit.name());
    let cut = summary.recorded.as_ref().map_or_else(String::new, |facts| {
        format!(
            "recorded from {:.3} to {:.3} s, at most {:.4} {mm} from the program's path, feed {:.0} to {:.0} %\n",
            facts.from_s,
            facts.to_s,
            unit.of(facts.farthest_mm),
            100.0 * facts.least_feed,
            100.0 * facts.greatest_feed
        )
    });
    let judged = summary.judged.map_or_else(String::new, |score| {
        format!(
            "away from the ends: largest wall error {:.4} {mm} (rms {:.4})\n",
            unit.of(score.max_error_mm),
            unit.of(score.rms_error_mm)
        )
    });
    let contours = summary.contours.iter().map(|one| {
        let name = one.contour.as_deref().unwrap_or_default();
        format!(
            "{name}: {:.1} {mm}, largest wall error {:.4} {mm} (rms {:.4})\n",
            unit.of(one.length_mm),
            unit.of(one.max_error_mm),
            unit.of(one.rms_error_mm)
        )
    });
    let contours: String = contours.collect();
    let laps = summary.laps.iter().enumerate().map(|(k, lap)| {
        format!(
            "lap {}: tip at Z {:.3} {mm}, {}{}, {:.3} {mm} beside the contour, {:.1} {mm} long, largest mean force {:.0} N\n",
            k + 1,
            unit.of(lap.tip_z_mm),
            if lap.climb { "climb" } else { "conventional" },
            if lap.reversed { ", reversed" } else { "" },
            unit.of(lap.beside_mm),
            unit.of(lap.length_mm),
            lap.largest_force_n
        )
    });
    let laps: String = laps.collect();
    let surface = summary.surface.as_ref().map_or_else(String::new, |all| {
        format!(
            "at every height: profile error {:.4} {mm} (at s {:.1}, Z {:.2} {mm}), 95 % within {:.4} {mm}, deepest gouge {:.4} {mm}\n",
            unit.of(all.profile_mm), unit.of(all.worst.s_mm), unit.of(all.worst.z_mm), unit.of(all.p95_mm), unit.of(all.gouge_mm)
        )
    });
    format!(
        "{contours}{}{:.1} {mm} of contour, {} milling, by the {}\n\
         largest wall error {:.4} {mm} (rms {:.4}), largest engagement {:.2} degrees, largest mean force {:.0} N\n\
         {judged}{surface}{laps}{cut}written to {}; to look at: {}\n",
        summary.feature.as_ref().map(|feature| listing(feature, unit)).unwrap_or_default(),
        unit.of(summary.length_mm),
        summary.milling,
        summary.by,
        unit.of(summary.max_error_mm),
        unit.of(summary.rms_error_mm),
        summary.max_arc_deg,
        summary.max_force_n,
        output.display(),
        output.join(REPORT).display()
    )
}

/// Simulates and writes trace and summary, of every contour of the program.
///
/// # Errors
/// Whatever is wrong with job, program or plant, and outputs that cannot be written.
pub fn run(options: &Options) -> Result<SimulateSummary, Failure> {
    let recording = options.setpoints.as_deref().map(|file| recording(file, &options.placement)).transpose()?;
    let mut job = JobFile::read(&options.job)?;
    job.which = options.which.clone();
    if options.stock {
        // It is what the touches are to find.
        job.stock_probe = None;
    }
    let walls = Pass::every(job)?;
    let source = |file: &FilePath| Source::read(file);
    let corrected = options.from.as_ref().map(|dir| source(&dir.join(CORRECTED))).transpose()?;
    let whole = options.program.as_deref().map(source).transpose()?;
    let probing = options.touch.as_deref().map(source).transpose()?;
    let machine = options.plant.as_deref().map(read_machine).transpose()?;
    let folder = OutputFolder::create(&options.output, options.force, FILES)?;
    let several = walls.len() > 1;
    let (mut all, mut pages, mut milled) = (Vec::new(), Vec::new(), Vec::new());
    for pass in &walls {
        let mut warnings = pass.warnings.clone();
        let done = match &machine {
            None => {
                let (trace, along) = predicted(pass, &mut warnings)?;
                Done { by: "core", trace, along, made: None, surface: None, facts: None }
            }
            Some(machine) => {
                let commanded = match (&recording, &corrected, &whole) {
                    (Some((setpoints, placement)), ..) => Commanded::Recorded(setpoints, placement),
                    (None, Some(program), _) if several_passes(pass, program)? => Commanded::Whole(program),
                    (None, Some(program), _) => Commanded::Program(program),
                    (None, None, Some(program)) => Commanded::Whole(program),
                    (None, None, None) => Commanded::Nominal,
                };
                self::milled(pass, machine, &commanded, &mut warnings)?
            }
        };
        let (judged, laps) = match &done.made {
            None => (None, Vec::new()),
            Some(Made::Pass(milled)) => (Some(milled.score()), Vec::new()),
            Some(Made::Part(part)) => (Some(part.score()), part.laps().to_vec()),
        };
        let trim = judged_trim_mm(mm(pass.core.setup.radius));
        let summary = SimulateSummary {
            judged,
            surface: done.surface.as_ref().and_then(|surface| surface.score(trim)),
            laps,
            recorded: done.facts,
            contour: several.then(|| contour_name(pass)),
            ..simulate_summary(pass, done.by, &done.trace, warnings)
        };
        let place = contour_place(pass, several);
        let write = |name: &str, bytes: &[u8]| folder.write(&format!("{place}{name}"), bytes);
        if let Some(made) = done.made.as_ref().filter(|_| options.probed_wall) {
            write(PROBED, probed_wall(pass, made).as_bytes())?;
        }
        if let Some(surface) = &done.surface {
            write(MAP, &wall_map_csv(surface)?)?;
        }
        write("trace.csv", &trace_csv(&done.trace)?)?;
        write("wall.csv", &wall_csv(&done.trace)?)?;
        write("trace.svg", &plot::trace(&View::in_unit(pass.unit()), &[("", &done.trace)], &Column::USUAL)?)?;
        if several {
            write("summary.json", &json(&summary)?)?;
        }
        pages.push((contour_name(pass), simulated(pass, done.along, &summary)));
        milled.extend(done.made.map(|made| (pass, made)));
        all.push(summary);
    }
    if let (Some(program), Some(machine), true) = (&probing, &machine, options.stock) {
        folder.write(TOUCHED_STOCK, virtual_mill::touch_stock(&walls, machine, program)?.as_bytes())?;
    } else if let Some(program) = probing.as_ref().filter(|_| !milled.is_empty()) {
        let milled: Vec<(&Pass, &Made)> = milled.iter().map(|(pass, made)| (*pass, made)).collect();
        folder.write(TOUCHED, virtual_mill::touch(&milled, program)?.as_bytes())?;
    }
    if let (true, Some(machine), Some(pass)) = (options.dynamometer, &machine, walls.first()) {
        for (name, bytes) in truepath_trial::dynamometer::records(pass, machine)? {
            folder.write(&format!("{DYNAMOMETER}{name}"), &bytes)?;
        }
    }
    let summary = SimulateSummary::of_every(all).ok_or_else(|| Failure::Internal("no contour".to_owned()))?;
    folder.write("summary.json", &json(&summary)?)?;
    folder.write(REPORT, &page::render_all(&pages)?)?;
    folder.commit()?;
    Ok(summary)
}

/// A recorded tool path, and where the program stood in the machine.
fn recording(file: &FilePath, placement: &PlacementOptions) -> Result<(Setpoints, Placement), Failure> {
    let source = Source::read(file)?;
    let setpoints = Setpoints::parse(&source)?;
    let placement = placement.of(&setpoints, &source)?;
    Ok((setpoints, placement))
}

/// The uncorrected pass as the core predicts it from the job's priors; adds to the warnings what is doubtful.
///
/// # Errors
/// As [`Pass::sample`].
fn predicted(pass: &Pass, warnings: &mut Vec<Remark>) -> Result<(Trace, Along), Failure> {
    let mut buffer = PathBuffer::default();
    let path = pass.sample(&mut buffer)?;
    let prior = pass.core.prior(pass.core.setup.law).mean;
    let table = ForceTable::new(prior.coefficients.size_exponent);
    let machine = prior.machine(&path, &table);
    let mut states = vec![State::REST; path.working().len()];
    let passage = machine.run(path.working().start, &mut states, |_| Vector::ZERO);
    if passage.unsettled > 0 {
        warnings.push(pass.unit().remark(|unit| {
            format!(
                "the elastic loop did not settle at {} places (worst residual {:.4} {}): the machine is too soft for this cut",
                passage.unsettled,
                unit.of(mm(passage.worst_residual)),
                unit.name()
            )
        }));
    }
    let mut displacements = vec![Vector::ZERO; states.len()];
    let mut profiles = vec![Profile::default(); path.count()];
    profile(&machine, &states, Band::WHOLE, &mut displacements, &mut profiles);
    let errors: Vec<f64> = profiles.iter().map(|p| if p.on_wall { mm(p.mean) } else { f64::NAN }).collect();
    let trace = trace(&machine, &states, &errors);
    let along = page::simulated(&machine, &states, &trace, "predicted by the core from the job's values");
    Ok((trace, along))
}

/// A pass, whoever made it.
struct Done {
    by: &'static str,
    trace: Trace,
    along: Along,
    made: Option<Made>,
    surface: Option<Surface>,
    facts: Option<recorded::Facts>,
}

/// Whether a program goes along the wall more often than the job's own: then one pass is not all of it.
fn several_passes(pass: &Pass, program: &Source) -> Result<bool, Failure> {
    Ok(process::laps(pass, program)? > process::laps(pass, &pass.program)?)
}

/// What the virtual machine is told to do.
enum Commanded<'a> {
    /// The nominal path of the job's program.
    Nominal,
    /// What a controller was recorded to do.
    Recorded(&'a Setpoints, &'a Placement),
    /// Another program of the same cut.
    Program(&'a Source),
    /// A program with all its passes.
    Whole(&'a Source),
}

/// The pass as a virtual machine cuts it.
///
/// # Errors
/// What the plant refuses, and a recording without the pass.
fn milled(
    pass: &Pass,
    machine: &plant::Machine,
    commanded: &Commanded,
    warnings: &mut Vec<Remark>,
) -> Result<Done, Failure> {
    let (milled, facts) =
        match commanded {
            Commanded::Whole(program) => {
                let part = process::cut(pass, machine, program)?;
                let worst = part.laps().iter().map(|lap| lap.residual_mm).fold(0.0, f64::max);
                if worst > OPEN_MM {
                    let open: usize = part.laps().iter().map(|lap| lap.open_places).sum();
                    warnings.push(pass.unit().remark(|unit| {
                    format!(
                        "the elastic loop did not settle at {open} places, teeth and heights (worst residual {:.4} {})",
                        unit.of(worst),
                        unit.name()
                    )
                }));
                }
                let trace = page::trace_of_part(&part);
                let along = page::parted(&part, &trace, "cut by the virtual machine, all passes of the program");
                let surface = Some(part.surface());
                return Ok(Done {
                    by: "plant",
                    trace,
                    along,
                    made: Some(Made::Part(Box::new(part))),
                    surface,
                    facts: None,
                });
            }
            Commanded::Nominal => (virtual_mill::mill(pass, machine, None)?, None),
            Commanded::Program(program) => (virtual_mill::mill_executed(pass, machine, program)?, None),
            Commanded::Recorded(setpoints, placement) => {
                let (milled, facts) = virtual_mill::mill_recorded(pass, machine, setpoints, placement)?;
                if facts.passes > 1 {
                    warnings.push(format!(
                    "the recording passes the contour {} times; taken is the pass nearest to it, {:.3} to {:.3} s",
                    facts.passes, facts.from_s, facts.to_s
                ).into());
                }
                (milled, Some(facts))
            }
        };
    let trace = page::trace_of(&milled);
    let label = match commanded {
        Commanded::Nominal => "cut by the virtual machine",
        Commanded::Recorded(..) => "cut by the virtual machine along the recorded path",
        Commanded::Program(_) | Commanded::Whole(_) => "cut by the virtual machine with the corrected program",
    };
    let along = page::milled(&milled, &trace, label);
    let surface = Some(Surface::of(&milled, pass.core.contour.z.nm() as f64 / 1e6, SLICES));
    Ok(Done { by: "plant", trace, along, made: Some(Made::Pass(Box::new(milled))), surface, facts })
}

/// The wall as cut, for a simulated probe: program coordinates, mm, from the lowest height to the highest.
fn probed_wall(pass: &Pass, made: &Made) -> String {
    let levels: [f64; HEIGHTS] = std::array::from_fn(|k| k as f64 / (HEIGHTS - 1) as f64);
    let (tip, depth, walls) = match made {
        Made::Pass(milled) => (pass.core.contour.z.nm() as f64 / 1e6, milled.cut.axial_depth_mm, milled.walls(&levels)),
        Made::Part(part) => {
            let [bottom, top] = part.height_mm();
            let wall = |level: &f64| part.wall_at(bottom + level * (top - bottom));
            (bottom, top - bottom, levels.iter().map(wall).collect())
        }
    };
    let mut text = String::from("z_mm,x_mm,y_mm\n");
    for (level, wall) in levels.iter().zip(walls) {
        let z = tip + level * depth;
        // Writing to a String cannot fail.
        wall.iter().for_each(|[x, y]| _ = writeln!(text, "{z:.4},{x:.6},{y:.6}"));
    }
    text
}

/// Reads a PLANT.toml.
///
/// # Errors
/// Whatever is wrong with it, with its place.
pub fn read_machine(file: &FilePath) -> Result<plant::Machine, Failure> {
    let source = Source::read(file)?;
    let text = std::str::from_utf8(source.bytes()).map_err(|e| {
        let at = e.valid_up_to();
        L001.error("a byte that is not UTF-8", "a text file").at(&source, at..at + 1)
    })?;
    toml::from_str(text).map_err(|e| {
        let span = e.span().unwrap_or(0..0);
        L002.error(e.message(), "").at(&source, span).into()
    })
}
