//! One case in full: its files, for the ordinary commands, and what machine, user and fit say side by side.

use std::fmt::Write;
use std::path::Path as FilePath;

use truepath_ground::diagnostics::Failure;
use truepath_ground::output::OutputFolder;
use truepath_plant::Judged;

use super::case::Case;
use super::id::CaseId;
use super::outcome::Outcome;
use super::workflow::{FirstPart, SecondPart, described, first, second};

/// Files an export may write.
const FILES: &[&str] =
    &["program.nc", "job.toml", "plant.toml", "probe.txt", "corrected.nc", "probe-2.txt", "learned.nc", "errors.csv"];

/// A case carried through as far as it goes.
#[derive(Debug)]
pub struct Detail {
    /// The case.
    pub case: Case,
    /// Its outcome.
    pub outcome: Outcome,
    /// The correction, when there is one, or why not.
    pub first_part: Result<FirstPart, Failure>,
    /// What was learned from the corrected part, or why nothing.
    pub second_part: Option<Result<SecondPart, Failure>>,
}

/// Carries one case through.
///
/// # Errors
/// A case that cannot be drawn.
pub fn detail(id: &CaseId) -> Result<Detail, Failure> {
    let case = Case::draw(id)?;
    let mut outcome = described(&case);
    let first_part = first(&case, &mut outcome);
    if let Err(failure) = &first_part {
        outcome.failure = failure.to_string();
    }
    let second_part = first_part.as_ref().ok().map(|first_part| second(&case, first_part, &mut outcome));
    if let Some(Err(failure)) = &second_part {
        outcome.learn_failure = failure.to_string();
    }
    Ok(Detail { case, outcome, first_part, second_part })
}

/// Writes the files of a case.
///
/// # Errors
/// A folder that cannot be written, or holds something and `force` is not set.
pub fn export(detail: &Detail, folder: &FilePath, force: bool) -> Result<(), Failure> {
    let case = &detail.case;
    let out = OutputFolder::create(folder, force, FILES)?;
    out.write("program.nc", case.program.as_bytes())?;
    out.write("job.toml", case.job.as_bytes())?;
    let plant = toml::to_string(&case.machine_of(1)).map_err(|e| Failure::Internal(format!("plant.toml: {e}")))?;
    out.write("plant.toml", plant.as_bytes())?;
    out.write("probe.txt", case.probe(1, &case.first, &case.places_mm)?.as_bytes())?;
    if let Ok(first_part) = &detail.first_part {
        if let Some(program) = &first_part.corrected.program {
            out.write("corrected.nc", program)?;
        }
        let second_part = detail.second_part.as_ref().and_then(|second_part| second_part.as_ref().ok());
        if let Some(second_part) = second_part {
            out.write("probe-2.txt", second_part.probe.as_bytes())?;
            out.write("learned.nc", second_part.learned.corrected.program.as_deref().unwrap_or_default())?;
        }
        let mut errors = "s_mm,before_mm,after_mm,learned_mm\n".to_owned();
        for (k, (s, before)) in case.before.mean_mm.iter().enumerate() {
            let at = |judged: &Judged| judged.mean_mm.get(k).map_or(f64::NAN, |(_, error)| *error);
            let learned = second_part.map_or(f64::NAN, |second_part| at(&second_part.after));
            let _ = writeln!(errors, "{s:.4},{before:.6},{:.6},{learned:.6}", at(&first_part.after));
        }
        out.write("errors.csv", errors.as_bytes())?;
    }
    out.commit()?;
    Ok(())
}

/// The largest error at any height, its factor, and what had been expected with its standard deviation.
fn at_any_height(figures: [Option<f64>; 4]) -> String {
    let [error, factor, expected, sigma] = figures.map(Option::unwrap_or_default);
    format!("{error:.4} mm, factor {factor:.1}, expected {expected:.4} ± {:.4} mm (2 sigma)", 2.0 * sigma)
}

/// The detail in words.
pub fn words(detail: &Detail) -> String {
    let (case, o) = (&detail.case, &detail.outcome);
    let (machine, cut) = (&case.machine_of(1), &case.part.cut);
    let mut text = format!(
        "{}: {:?} wall, {:?} spindle, {:.1} mm\n",
        case.id, case.part.contour.side, case.part.spindle, case.first.path.length_mm
    );
    let mut line = |name: &str, value: String| {
        let _ = writeln!(text, "  {name:<22} {value}");
    };
    line("cutter", format!("radius {} mm, {} teeth, {} degrees", cut.radius_mm, cut.teeth, cut.helix_deg));
    line(
        "cut",
        format!("depth {} mm, allowance {} mm, S{} F{}", cut.depth_mm, cut.allowance_mm, cut.rpm, cut.feed_mm_per_min),
    );
    line("places", format!("{:?} mm at {:?}", case.places_mm, case.levels));
    line("places added later", format!("{:?} mm", case.more_mm));
    line(
        "Kt, Kr, Kte, Kre, m",
        format!(
            "{:.0} {:.0} {:.1} {:.1} {:.2}",
            machine.ktc_n_per_mm2,
            machine.krc_n_per_mm2,
            machine.kte_n_per_mm,
            machine.kre_n_per_mm,
            machine.size_exponent
        ),
    );
    let c = machine.compliance_mm_per_n.map(|row| row.map(|v| (v * 1e9).round() / 1e6));
    line("compliance", format!("{c:?} µm/N, bend {:.2}", machine.bend));
    let runout: Vec<f64> = machine.runout_mm.iter().map(|r| (r * 1e5).round() / 1e2).collect();
    line("runout", format!("{runout:?} µm"));
    line(
        "wear, stock, noise",
        format!(
            "{:.2} per m, {:.3} mm, {:.4} mm",
            machine.edge_wear_per_m, machine.stock_variation_mm, machine.probe_noise_mm
        ),
    );
    if let Some(nuisance) = case.id.nuisance {
        line("nuisance", nuisance.title().to_owned());
    }
    let mm = |v: Option<f64>| v.map_or_else(|| "-".to_owned(), |v| format!("{v:.4} mm"));
    line("error before", format!("{} (worst height {})", mm(o.before_mm), mm(o.worst_height_before_mm)));
    match &detail.first_part {
        Err(failure) => line("refused", failure.to_string()),
        Ok(first_part) => {
            line(
                "error after",
                format!(
                    "{}, factor {:.1}, predicted {}, sigma up to {}",
                    mm(o.after_mm),
                    o.factor.unwrap_or_default(),
                    mm(o.predicted_mm),
                    mm(o.sigma_mm)
                ),
            );
            line("within 2 sigma", format!("{:.1} % of the contour", 100.0 * o.coverage.unwrap_or_default()));
            line(
                "worst at any height",
                at_any_height([
                    o.worst_height_mm,
                    o.worst_height_factor,
                    o.worst_height_predicted_mm,
                    o.worst_height_sigma_mm,
                ]),
            );
            line("wall law found", o.law.clone());
            for (name, p) in &first_part.corrected.summary.identified {
                let seen = if p.observable { "" } else { "  (not decided)" };
                line(
                    name,
                    format!(
                        "{:.5} ± {:.5}, prior {:.5} ± {:.5} {}{seen}",
                        p.value, p.sigma, p.prior, p.prior_sigma, p.unit
                    ),
                );
            }
            for warning in &first_part.corrected.summary.warnings {
                line("warning", warning.to_string());
            }
        }
    }
    match &detail.second_part {
        None => {}
        Some(Err(failure)) => line("learning refused", failure.to_string()),
        Some(Ok(second_part)) => {
            line(
                "after learning",
                format!(
                    "{}, factor {:.1}, predicted {}",
                    mm(o.learned_mm),
                    o.learned_factor.unwrap_or_default(),
                    mm(o.learned_predicted_mm)
                ),
            );
            line("within 2 sigma", format!("{:.1} % of the contour", 100.0 * o.learned_coverage.unwrap_or_default()));
            line(
                "worst at any height",
                at_any_height([
                    o.learned_worst_height_mm,
                    o.learned_worst_height_factor,
                    o.learned_worst_height_predicted_mm,
                    o.learned_worst_height_sigma_mm,
                ]),
            );
            for remark in second_part.learned.verdict.remarks() {
                line("remark", remark.to_string());
            }
        }
    }
    text
}
