//! What wrong force coefficients do to a compensated pocket: without a probe it is as good as they are.

use super::design::{Designed, worst};
use super::error::PocketError;
use super::process::Process;

/// Errors of the coefficients that are looked at: 20 % to either side, all four together.
pub const FACTORS: [f64; 2] = [0.8, 1.2];

/// The walls if all force coefficients are so many times those of the job.
#[derive(Clone, Copy, Debug, serde::Serialize)]
pub struct Sensitivity {
    /// Factor on the coefficients.
    pub factor: f64,
    /// Largest error of the program as it is, mm.
    pub max_error_before_mm: f64,
    /// Largest error of the compensated path, mm.
    pub max_error_after_mm: f64,
    /// Sections out of the band, of those that are judged.
    pub sections_out: usize,
}

/// Cuts program and compensated path with other coefficients.
///
/// # Errors
/// As [`Process::cut`].
pub fn sensitivity(
    process: &dyn Process,
    designed: &Designed,
    tolerance_mm: f64,
) -> Result<Vec<Sensitivity>, PocketError> {
    let still = vec![[0.0; 2]; designed.vectors.len()];
    let judged = || designed.sections.iter().filter(|s| s.kind != super::section::Kind::Sharp);
    let one = |factor: f64| {
        let [before, after] = [process.cut(&still, factor)?, process.cut(&designed.vectors, factor)?];
        let largest = |cut| judged().map(|s| worst(s, cut)).fold(0.0, f64::max);
        Ok(Sensitivity {
            factor,
            max_error_before_mm: largest(&before),
            max_error_after_mm: largest(&after),
            sections_out: judged().filter(|s| worst(s, &after) > tolerance_mm).count(),
        })
    };
    FACTORS.into_iter().map(one).collect()
}
