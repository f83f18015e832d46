//! Force coefficients of named workpiece materials: a prior for the identification, never a result.
//!
//! Published coefficients of one nominal alloy differ by a factor of two (Al 7075: Ktc 600…1319 N/mm²), with cutter,
//! edge and coolant. They only say where the fit to the probe points begins.

/// A row of the table.
#[derive(Clone, Copy, Debug)]
pub struct Material {
    /// The name used in a job.
    pub name: &'static str,
    /// Ktc, Krc (N/mm²), Kte, Kre (N/mm), as decimal text.
    pub coefficients: [&'static str; 4],
    /// Where the numbers come from.
    pub source: &'static str,
}

/// Liu et al., *Milling force model for aviation aluminium alloy*, Chin. J. Mech. Eng. 34 (2021), table 5.
const CJME: &str = "Chin. J. Mech. Eng. 34 (2021), doi 10.1186/s10033-021-00536-9, table 5";

/// The same, cut with high-speed steel.
const CJME_HSS: &str = "Chin. J. Mech. Eng. 34 (2021), doi 10.1186/s10033-021-00536-9, table 5 (high-speed steel)";

/// The table.
pub const MATERIALS: [Material; 7] = [
    Material {
        name: "steel-40",
        coefficients: ["1147.7", "344.3", "0", "0"],
        source: "fitted to the forces read off Petrakov & Romanov 2023, fig. 5 (150 N straight, Krc = 0.3·Ktc, no edge force)",
    },
    Material { name: "al-6061-t6", coefficients: ["243.77", "113.5", "7.53", "7.83"], source: CJME },
    Material { name: "al-6082-t6", coefficients: ["631", "99", "13", "10"], source: CJME },
    Material { name: "al-7075-t6", coefficients: ["767.01", "168.8", "27.7", "26.6"], source: CJME },
    Material { name: "al-7075-t6-light", coefficients: ["600.46", "180.96", "17.9", "20.42"], source: CJME },
    Material { name: "al-7075-hss", coefficients: ["951.365", "262.597", "11.115", "11.314"], source: CJME_HSS },
    Material { name: "al-7075-heavy", coefficients: ["1319.41", "788.83", "19.65", "26.77"], source: CJME },
];
