//! What a new part teaches: the model of all parts together, and whether to trust it.

use truepath_core::correct::Node;
use truepath_core::cut::Path;
use truepath_core::units::Offset;
use truepath_ground::diagnostics::Failure;
use truepath_ground::units::{float, mm};
use truepath_job::pass::Pass;

use super::holdout::{Holdout, Residuals};
use super::joint::{Companion, Joint, PartPoints, joint};
use super::monitor::Monitor;
use super::moved::moved;
use super::residual::Residual;
use super::uncorrected::refuse_uncorrected;
use super::verdict::{Promise, UnmodelledError, Verdict};

/// What follows for the next part.
#[derive(Clone, Debug)]
pub struct Update {
    /// Machine and material.
    pub joint: Joint,
    /// Wall error beside the deflection that the model predicts, one entry per sample of the contour.
    pub residual: Vec<Offset>,
    /// Its standard deviation.
    pub residual_sigma: Vec<Offset>,
    /// The correction to use again, when this part came out worse or nothing explains it.
    pub kept: Option<Vec<Node>>,
    /// Whether fits leave the part out from now on.
    pub set_aside: bool,
    /// How the part came out.
    pub verdict: Verdict,
}

/// Weight of a point that fits.
const FITTING: f64 = 0.3;

/// Learns from the newest part, beside the earlier ones; `companions` are the other contours of all of them. `promised` is the predicted error of its correction with the
/// standard deviation, beside every sample. `progress` is told the share done.
///
/// # Errors
/// Points of a part that no correction was applied to, and points most of which do not fit, in the first part as well.
pub fn update(
    pass: &Pass,
    path: &Path,
    earlier: Vec<PartPoints>,
    newest: PartPoints,
    companions: &[Companion<'_>],
    promised: &[(Offset, Offset)],
    progress: &mut dyn FnMut(f64),
) -> Result<Update, Failure> {
    let before = joint(pass, path, &earlier, companions, None, &mut |share| progress(0.3 * share));
    let before_beside = Residual::of(path, &earlier, &before);
    refuse_uncorrected(path, &newest, &before, before_beside.as_ref())?;
    let moved = moved(path, &newest, &before);
    let mut parts = earlier;
    parts.push(newest);
    let after = joint(pass, path, &parts, companions, None, &mut |share| progress(0.3 + 0.3 * share));
    let after_beside = Residual::of(path, &parts, &after);
    let holdout = Holdout::of(&parts).map(|held| {
        let less = held.without(&parts);
        let updated =
            joint(pass, path, &less, companions, Some(after.core.law), &mut |share| progress(0.6 + 0.3 * share));
        let beside = after_beside.as_ref().and_then(|_| Residual::of(path, &less, &updated));
        Residuals {
            places: held.places.clone(),
            before_mm: held.residual(path, &parts, &before, before_beside.as_ref()),
            after_mm: held.residual(path, &parts, &updated, None),
            after_with_residual_mm: beside.map(|beside| held.residual(path, &parts, &updated, Some(&beside))),
        }
    });
    // A residual that makes unseen places worse, beyond the noise of a reading, is not learned.
    let noise = parts.last().map_or(0.0, |part| mm(part.noise));
    let spoils = |h: &Residuals| h.after_with_residual_mm.is_some_and(|with| with > h.after_mm + noise);
    let after_beside = after_beside.filter(|_| !holdout.as_ref().is_some_and(spoils));
    let monitor = Monitor::of(pass, path, &parts, &after);
    let promise = Promise::of(path, &monitor, promised);
    let all: Vec<_> = after.observations.iter().flatten().copied().collect();
    let fits = after.core.check(&all).is_ok();
    // A part that came out worse is explained when most of its own points fit, and those that the fit has not seen are
    // predicted.
    let own = after.observations.last().map_or(&[][..], Vec::as_slice);
    let own_fit = 2 * own.iter().filter(|o| float(o.weight) < FITTING).count() <= own.len();
    let explained = fits && own_fit && holdout.as_ref().is_some_and(|h| h.after_mm * 2.0 < monitor.now.rms_mm);
    let set_aside = !fits || (monitor.is_worse() && !explained);
    // A part that no model explains beside the others may still have come out better: its correction is then kept.
    let again = if monitor.is_worse() { monitor.better } else { parts.len().saturating_sub(1) };
    let kept = set_aside.then(|| {
        let again = parts.get(again).map(|p| p.nodes.clone()).unwrap_or_default();
        if again.is_empty() { vec![Node::default(); path.count()] } else { again }
    });
    let (chosen, beside) = if set_aside { (before, before_beside) } else { (after, after_beside) };
    let all: Vec<_> = chosen.observations.iter().flatten().copied().collect();
    chosen.core.check(&all).map_err(|error| pass.refused(&error))?;
    let mut verdict = Verdict::of(&parts, &monitor, promise, holdout, set_aside.then_some(again), fits);
    let along = beside.map(|residual| (residual.amplitudes(), residual.along(path, &chosen)));
    verdict.residual = along.as_ref().map(|(amplitudes, (mean, _))| UnmodelledError::of(*amplitudes, mean));
    let (residual, residual_sigma) = along.map(|(_, along)| along).unwrap_or_default();
    verdict.say(moved);
    Ok(Update { joint: chosen, residual, residual_sigma, kept, set_aside, verdict })
}
