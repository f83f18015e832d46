//! Points of a part that was not cut with the correction they are said to be of.
//!
//! Learning from such points would add the correction once more: the wall error that it already cancels would be taken
//! for one that it has left. The points are held against both: the model of the parts before, with the correction and
//! without any. They are refused when they agree with the wall that no correction leaves, and with the other one far less.
//! A correction moves the wall by about its own size, so a part that was cut with it looks uncorrected only
//! where the correction is small, and there the two do not differ.

use truepath_core::cut::Path;

use super::holdout::missed;
use super::joint::{Joint, PartPoints};
use super::residual::Residual;
use crate::diagnostics::InputError;
use crate::report::mm;

/// The correction must explain the points this many times worse than none does.
const CLEARLY: f64 = 3.0;
/// What it misses must be this many standard deviations of a reading.
const BEYOND_NOISE: f64 = 5.0;

/// Refuses a part that looks as if no correction had been applied to it; `before` is what the parts before it say.
///
/// # Errors
/// `Q007` with both distances.
pub(super) fn refuse_uncorrected(
    path: &Path,
    part: &PartPoints,
    before: &Joint,
    beside: Option<&Residual>,
) -> Result<(), InputError> {
    let plain = PartPoints { nodes: Vec::new(), ..part.clone() };
    let with = missed(path, part, &part.observations, before, beside);
    let without = missed(path, &plain, &part.observations, before, beside);
    if with <= CLEARLY * without || with <= BEYOND_NOISE * mm(part.noise) {
        return Ok(());
    }
    let found = format!(
        "the points lie {without:.4} mm (rms) from the wall that no correction leaves, and {with:.4} mm from that of the correction in --from"
    );
    let expected = format!("the points of part {}, cut with that correction", part.number);
    let help = "touch the part that the corrected program has cut; if this is that part, the control ran the original program, or the coprocessor was not armed";
    Err(InputError::new("Q007", found, expected, help))
}
