//! What a new part teaches: the model of all parts together, and whether to trust it.

use truepath_core::correct::Node;
use truepath_core::cut::Path;
use truepath_core::units::Offset;
use truepath_ground::diagnostics::Failure;
use truepath_ground::length::Remark;
use truepath_ground::units::float;
use truepath_job::pass::Pass;

use super::cutter::{Level, new_cutter};
use super::holdout::{Holdout, Residuals};
use super::joint::{Companion, Joint, PartPoints, joint};
use super::monitor::Monitor;
use super::moved::moved;
use super::uncorrected::refuse_uncorrected;
use super::verdict::{NewCutter, Promise, UnmodelledError, Verdict};
use crate::discrepancy::Along;

/// What follows for the next part.
#[derive(Clone, Debug)]
pub struct Update {
    /// Machine and material.
    pub joint: Joint,
    /// What is beside the deflection that the model predicts, along the contour.
    pub beside: Along,
    /// Level of force of the next part over that of the newest that counts, where it is cut with a new cutter.
    pub new_cutter: Option<Level>,
    /// The correction to use again, when this part came out worse or nothing explains it.
    pub kept: Option<Vec<Node>>,
    /// Whether fits leave the part out from now on.
    pub set_aside: bool,
    /// How the part came out.
    pub verdict: Verdict,
}

/// Weight of a point that fits.
const FITTING: f64 = 0.3;

/// Learns from the newest part, beside the earlier ones; `companions` are the other contours of all of them; the next part may be cut with
/// a new cutter. `promised` is the predicted error of its correction with the
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
    (promised, is_new): (&[(Offset, Offset)], bool),
    progress: &mut dyn FnMut(f64),
) -> Result<Update, Failure> {
    let before = joint(pass, path, &earlier, companions, None, &mut |share| progress(0.3 * share));
    refuse_uncorrected(path, &newest, &before, pass.unit())?;
    let mut parts = earlier;
    parts.push(newest);
    let after = joint(pass, path, &parts, companions, None, &mut |share| progress(0.3 + 0.3 * share));
    // Levels are counted from that of the newest part.
    let level = parts.len().checked_sub(2).and_then(|previous| after.own.get(previous)).map_or(0.0, |own| -own.level);
    let moved = parts.last().and_then(|newest| moved(path, newest, &before, (level, pass.unit())));
    let holdout = Holdout::of(&parts).map(|held| {
        let less = held.without(&parts);
        let updated =
            joint(pass, path, &less, companions, Some(after.core.law), &mut |share| progress(0.6 + 0.3 * share));
        Residuals {
            places: held.places.clone(),
            before_mm: held.residual(path, &parts, &before),
            after_mm: held.residual(path, &parts, &updated),
        }
    });
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
    let mut chosen = if set_aside { before } else { after };
    let all: Vec<_> = chosen.observations.iter().flatten().copied().collect();
    chosen.core.check(&all).map_err(|error| pass.refused(&error))?;
    let mut verdict = Verdict::of(&parts, &monitor, promise, holdout, set_aside.then_some(again), (fits, pass.unit()));
    let beside = chosen.beside.take();
    verdict.residual = beside.as_ref().and_then(UnmodelledError::of);
    let beside = beside.map(|beside| beside.along).unwrap_or_default();
    verdict.cut_with(level);
    verdict.say(moved);
    if set_aside {
        parts.pop();
    }
    let new_cutter = is_new.then(|| new_cutter(&parts, &chosen.own, pass.job.parts_cut));
    verdict.new_cutter = new_cutter.map(NewCutter::of);
    verdict.say(new_cutter.map(|level| before_a_new_cutter(&parts, level, kept.is_some())));
    let beside = match new_cutter {
        Some(level) => beside.of_next_level(level.sigma),
        None => beside,
    };
    Ok(Update { joint: chosen, beside, new_cutter, kept, set_aside, verdict })
}

/// What the correction of a part that is cut with a new cutter is designed for.
fn before_a_new_cutter(parts: &[PartPoints], level: Level, is_kept: bool) -> Remark {
    let newest = parts.last().map_or(0, |part| part.number);
    if is_kept {
        return format!("the next correction is one that was cut before: it is not for a new cutter, as part {newest} is the last that is understood").into();
    }
    let percent = 100.0 * level.mean.exp_m1();
    let more = if percent < 0.0 { "less" } else { "more" };
    let sigma = 200.0 * level.sigma;
    format!(
        "the next correction is for a new cutter, {:.0} % {more} force than part {newest}, ± {sigma:.0} % (2 sigma)",
        percent.abs()
    )
    .into()
}
