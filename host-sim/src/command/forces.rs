//! `forces`: force coefficients from records of a dynamometer, or of the power of the spindle.

use std::fmt::Write;
use std::path::PathBuf;

use clap::Args;
use truepath_forces::analysis::Analysis;
use truepath_forces::description::Description;
use truepath_forces::fit::Along;
use truepath_forces::page::page;
use truepath_forces::written::forces_toml;
use truepath_ground::diagnostics::Failure;
use truepath_ground::length::Unit;
use truepath_ground::output::{OutputFolder, json};

use crate::terminal::Terminal;

/// Files this command may write.
const FILES: &[&str] = &["forces.toml", "summary.json", "report.html"];

/// What was recorded.
#[derive(Clone, Debug, Args)]
pub struct Options {
    /// What was cut while forces were recorded (TOML): tool, engagement, feeds, speeds, and the records' files.
    cuts: PathBuf,
    /// Folder for forces.toml, report.html and summary.json.
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    /// Replace the files of an earlier run.
    #[arg(long)]
    force: bool,
}

/// Fits, writes and prints.
pub(crate) fn main(options: &Options, terminal: &Terminal) -> Result<(), Failure> {
    let description = Description::read(&options.cuts)?;
    let folder = OutputFolder::create(&options.output, options.force, FILES)?;
    let analysis = Analysis::of(&description)?;
    folder.write("forces.toml", forces_toml(&analysis).as_bytes())?;
    folder.write("report.html", page(&analysis)?.as_bytes())?;
    folder.write("summary.json", &json(&analysis)?)?;
    folder.commit()?;
    let unit = description.unit;
    analysis.warnings.iter().for_each(|warning| terminal.warn(&unit.retold(warning)));
    terminal.tell(&analysis, || {
        let file = options.output.join("forces.toml");
        let next =
            format!("next: in a job, [force] with from = \"{}\" in place of material or coefficients", file.display());
        format!("{}written to {}\n{next}\n", words(&analysis, unit), options.output.display())
    })
}

fn words(analysis: &Analysis, unit: Unit) -> String {
    let mut text = String::new();
    if let Some(axes) = &analysis.axes {
        let _ = writeln!(text, "columns taken as {axes}");
    }
    for cut in &analysis.cuts {
        let _ = write!(text, "{}: {:.4} {} per tooth", cut.name, unit.of(cut.cut.feed_per_tooth_mm), unit.name());
        if cut.revolutions > 0 {
            let _ = write!(text, ", {} revolutions", cut.revolutions);
        }
        for mean in &cut.means {
            let (name, of) = match mean.measured.along {
                Along::Feed => ("feed", "N"),
                Along::Across => ("across", "N"),
                Along::Torque => ("torque", "N·m"),
            };
            let off = 100.0 * (mean.law / mean.measured.value - 1.0);
            let _ = write!(
                text,
                "; {name} {:.2} ± {:.2} {of}, {} {:.2} ({off:+.1} %)",
                mean.measured.value,
                mean.measured.sigma,
                if cut.fitted { "laws" } else { "predicted" },
                mean.law
            );
        }
        if let Some(shape) = cut.shape.as_ref().filter(|s| s.believed) {
            let [runout, sigma] = [shape.runout_mm, shape.runout_sigma_mm].map(|mm| unit.of(mm));
            let _ = write!(text, "; runout {runout:.4} ± {sigma:.4} {}", unit.name());
        }
        text.push('\n');
    }
    for law in analysis.laws.iter().filter(|l| l.weight > 0.05) {
        let [tangential, radial] = law.model.laws.map(|l| l.words());
        let _ = writeln!(
            text,
            "{:.0} %: {tangential} tangential, {radial} radial; means within {:.1} %",
            100.0 * law.weight,
            100.0 * law.worst
        );
    }
    let [ktc, krc, kte, kre] = analysis.linear.coefficients;
    let _ = writeln!(
        text,
        "for the job: Ktc {:.0} ± {:.0}, Krc {:.0} ± {:.0} N/mm², Kte {:.1} ± {:.1}, Kre {:.1} ± {:.1} N/mm",
        ktc.value, ktc.sigma, krc.value, krc.sigma, kte.value, kte.sigma, kre.value, kre.sigma
    );
    let (material, percent) = analysis.nearest;
    let _ = writeln!(text, "nearest row of the table of materials: {material}, its forces within {percent:.0} %");
    if let Some(worst) = analysis.prediction() {
        let _ = writeln!(text, "cuts that were not fitted are predicted within {:.1} %", 100.0 * worst);
    }
    text
}
