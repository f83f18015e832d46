//! `forces.toml`: a `[force]` table as a job takes it, the same as a prior with standard deviations, and the laws.

use std::fmt::Write;

use crate::analysis::Analysis;

/// The file.
pub fn forces_toml(analysis: &Analysis) -> String {
    const KEYS: [&str; 4] = ["ktc_n_per_mm2", "krc_n_per_mm2", "kte_n_per_mm", "kre_n_per_mm"];
    let linear = &analysis.linear;
    let mut text = format!(
        "# Force coefficients from measured forces, between {:.4} and {:.4} mm per tooth.\n\
         # In a job: [force] with from = \"forces.toml\", or this table itself.\nversion = 1\n\n[force]\n",
        linear.feeds_mm[0], linear.feeds_mm[1]
    );
    for (key, coefficient) in KEYS.iter().zip(&linear.coefficients) {
        let _ = writeln!(text, "{key} = {:.3}", coefficient.value);
    }
    text.push_str(
        "\n[prior]                 # standard deviations of the four, and their correlation in the same order\n",
    );
    for (key, coefficient) in KEYS.iter().zip(&linear.coefficients) {
        let _ = writeln!(text, "{key} = {:.3}", coefficient.sigma);
    }
    let rows = linear.correlation.iter().map(|row| format!("[{}]", row.map(|r| format!("{r:.4}")).join(", ")));
    let _ = writeln!(text, "correlation = [{}]", rows.collect::<Vec<_>>().join(", "));
    let believed = analysis.cuts.iter().filter_map(|cut| {
        let shape = cut.shape.as_ref().filter(|shape| shape.believed)?;
        Some((cut.cut.teeth, shape))
    });
    let mut runouts: Vec<_> = believed.collect();
    runouts.sort_by(|a, b| a.1.runout_mm.total_cmp(&b.1.runout_mm));
    if let Some((teeth, middle)) = runouts.get(runouts.len() / 2) {
        // Which tooth a record begins with is not known, and not needed: teeth are alike.
        let behind = middle.runout_deg.rem_euclid(360.0 / f64::from(*teeth));
        let (offset, sigma) = (middle.runout_mm, middle.runout_sigma_mm);
        let _ = write!(
            text,
            "\n[runout]                # of the cutter as it was clamped, the middle of the records; the coefficients are without it\n\
             # In a job: [tool] with runout_from = \"forces.toml\", as long as the cutter stays in its holder.\n\
             offset_mm = {offset:.5}\nsigma_mm = {sigma:.5}\nbehind_deg = {behind:.2}\n"
        );
    }
    for fitted in analysis.laws.iter().filter(|f| f.weight > 0.005) {
        let [tangential, radial] = fitted.model.laws;
        let list = |values: &[f64]| values.iter().map(|v| format!("{v:.5}")).collect::<Vec<_>>().join(", ");
        let _ = write!(
            text,
            "\n[[law]]                 # {:.1} %: {} tangential, {} radial\nprobability = {:.4}\n\
             tangential = [{}]\nradial = [{}]\nsigma = [{}]\nsize_exponent = [{}]\n",
            100.0 * fitted.weight,
            tangential.words(),
            radial.words(),
            fitted.weight,
            list(fitted.model.of(0)),
            list(fitted.model.of(1)),
            list(&fitted.sigma),
            list(
                &[tangential, radial]
                    .iter()
                    .enumerate()
                    .map(|(d, law)| law.exponent(fitted.model.of(d)))
                    .collect::<Vec<_>>()
            )
        );
    }
    text
}
