//! Points of a part that was not cut with the correction they are said to be of, or with one where none is expected.
//!
//! Learning from such points would add the correction once more: the wall error that it already cancels would be taken
//! for one that it has left. The points are held against both: the model of the parts before, with the correction and
//! without any. They are refused when they agree with the wall that no correction leaves, and with the other one far less.
//! Points that are to correct anew, as if of a part without correction, are refused the other way round. A correction
//! moves the wall by about its own size, so a part that was cut with it looks uncorrected only
//! where the correction is small, and there the two do not differ.

use truepath_core::correct::Node;
use truepath_core::cut::Path;
use truepath_ground::diagnostics::InputError;
use truepath_ground::length::Unit;
use truepath_ground::units::mm;
use truepath_job::pass::Pass;

use super::history::{History, Part};
use super::holdout::missed;
use super::joint::{Joint, PartPoints, joint};
use super::nodes::Nodes;
use crate::codes::{Q007, Q008};

/// The one must explain the points this many times worse than the other does.
const CLEARLY: f64 = 3.0;
/// What it misses must be this many standard deviations of a reading.
const BEYOND_NOISE: f64 = 5.0;

/// Refuses a part that looks as if no correction had been applied to it; `before` is what the parts before it say.
///
/// # Errors
/// `Q007` with both distances.
pub fn refuse_uncorrected(path: &Path, part: &PartPoints, before: &Joint, unit: Unit) -> Result<(), InputError> {
    let [with, without] = distances(path, part, before);
    if !is_clear(with, without, part) {
        return Ok(());
    }
    let ([with, without], name) = ([with, without].map(|rms| unit.of(rms)), unit.name());
    let found = format!(
        "the points lie {without:.4} {name} (rms) from the wall that no correction leaves, and {with:.4} {name} from that of the correction in --from"
    );
    let expected = format!("the points of part {}, cut with that correction", part.number);
    Err(Q007.error(found, expected))
}

/// Refuses a part that looks as if the correction of a history had been applied to it, although it is to be corrected as
/// if it had been cut with none.
///
/// # Errors
/// `Q008`, when the history holds these very points as those of a corrected part, or they lie where its next correction
/// leaves the wall.
pub fn refuse_corrected(pass: &Pass, path: &Path, history: &History, new: &Part) -> Result<(), InputError> {
    let refused = |found: String| Err(Q008.error(found, "the points of a part that no correction was applied to"));
    let is_corrected = |part: &Part| {
        let nodes = part.correction.as_ref().and_then(Nodes::nodes).unwrap_or_default();
        nodes.iter().any(|node| *node != Node::default())
    };
    let known = history.parts.iter().find(|part| part.probe_crc32 == new.probe_crc32);
    if let Some(part) = known {
        if is_corrected(part) {
            return refused(format!(
                "this probe file is that of part {}, which was cut with a correction",
                part.number
            ));
        }
        // The same points, corrected once more: their history says that the program itself has cut them.
        return Ok(());
    }
    let given = Part { correction: Some(history.next.correction.clone()), ..new.clone() };
    let known: Option<Vec<PartPoints>> =
        history.parts.iter().filter(|part| !part.set_aside).map(|part| PartPoints::of(part, path)).collect();
    let (Some(known), Some(part)) = (known, PartPoints::of(&given, path)) else { return Ok(()) };
    if known.is_empty() {
        return Ok(());
    }
    let before = joint(pass, path, &known, &[], None, &mut |_| ());
    let [with, without] = distances(path, &part, &before);
    if !is_clear(without, with, &part) {
        return Ok(());
    }
    let unit = pass.unit();
    let ([with, without], name) = ([with, without].map(|rms| unit.of(rms)), unit.name());
    refused(format!(
        "the points lie {with:.4} {name} (rms) from the wall of the correction that is in the output folder, and {without:.4} {name} from the one that no correction leaves"
    ))
}

/// How far the points of a part are from the wall of its correction, and from the one that none leaves, mm (rms).
fn distances(path: &Path, part: &PartPoints, before: &Joint) -> [f64; 2] {
    let plain = PartPoints { nodes: Vec::new(), ..part.clone() };
    [part, &plain].map(|cut| missed(path, cut, &part.observations, before))
}

/// Whether points are clearly not at the one distance, and at the other one they may be.
fn is_clear(far: f64, near: f64, part: &PartPoints) -> bool {
    far > CLEARLY * near && far > BEYOND_NOISE * mm(part.noise)
}
