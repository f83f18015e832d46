//! The table of force coefficients, with its sources: `truepath pocket --materials`.
//!
//! Coefficients of one nominal alloy spread twofold between publications. The table says so beside every row that has
//! relatives, because without a probe nothing corrects them.

use truepath_job::job::MATERIALS;

/// A row, as printed.
#[derive(Clone, Debug, serde::Serialize)]
pub struct MaterialRow {
    /// The name used in a job.
    pub name: &'static str,
    /// Ktc, N/mm².
    pub ktc_n_per_mm2: f64,
    /// Krc, N/mm².
    pub krc_n_per_mm2: f64,
    /// Kte, N/mm.
    pub kte_n_per_mm: f64,
    /// Kre, N/mm.
    pub kre_n_per_mm: f64,
    /// Smallest and largest Ktc among the rows of the same alloy, N/mm².
    pub ktc_of_the_alloy_n_per_mm2: [f64; 2],
    /// Where the numbers come from.
    pub source: &'static str,
}

/// Family and number of an alloy, `al-7075` of `al-7075-t6`.
fn alloy(name: &str) -> &str {
    let end = name.match_indices('-').nth(1).map_or(name.len(), |(at, _)| at);
    name.get(..end).unwrap_or(name)
}

/// The table.
pub fn materials() -> Vec<MaterialRow> {
    let number = |text: &str| text.parse::<f64>().unwrap_or(f64::NAN);
    let ktc = |name: &'static str| {
        let alike = MATERIALS.iter().filter(move |m| alloy(m.name) == alloy(name));
        alike.map(|m| number(m.coefficients[0])).fold([f64::INFINITY, 0.0], |[l, h], k| [k.min(l), k.max(h)])
    };
    let row = |m: &truepath_job::job::Material| {
        let [ktc_n_per_mm2, krc_n_per_mm2, kte_n_per_mm, kre_n_per_mm] = m.coefficients.map(number);
        let ktc_of_the_alloy_n_per_mm2 = ktc(m.name);
        MaterialRow {
            name: m.name,
            ktc_n_per_mm2,
            krc_n_per_mm2,
            kte_n_per_mm,
            kre_n_per_mm,
            ktc_of_the_alloy_n_per_mm2,
            source: m.source,
        }
    };
    MATERIALS.iter().map(row).collect()
}

/// The table for the terminal.
pub fn materials_text(rows: &[MaterialRow]) -> String {
    let mut text = "material             Ktc       Krc     Kte     Kre  Ktc of the alloy  source\n\
                    \u{20}                  N/mm²     N/mm²    N/mm    N/mm  N/mm²\n"
        .to_owned();
    for row in rows {
        let [low, high] = row.ktc_of_the_alloy_n_per_mm2;
        let spread = if low == high { "one source".to_owned() } else { format!("{low:.0}…{high:.0}") };
        text += &format!(
            "{:<16} {:>8} {:>9} {:>7} {:>7}  {:<16}  {}\n",
            row.name, row.ktc_n_per_mm2, row.krc_n_per_mm2, row.kte_n_per_mm, row.kre_n_per_mm, spread, row.source
        );
    }
    text.push_str(
        "\nThe same alloy differs twofold between publications, with cutter, edge, coolant and temper: where a part matters,\n\
         measure (truepath probe, truepath correct) instead of trusting a row.\n",
    );
    text
}
