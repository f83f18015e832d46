//! What every plan takes as given: part, probe, heights, the ball and its room, and the places that may be touched.

use std::collections::BTreeMap;

use truepath_core::cut::Path;
use truepath_core::job::Probe;
use truepath_core::units::Position;
use truepath_ground::diagnostics::{Failure, InputError};
use truepath_ground::length::Unit;
use truepath_ground::units::{float, mm};
use truepath_job::pass::Pass;

use super::approach::Ball;
use super::candidates::{KeptOff, Site, StockWall, before_the_pass, candidates, cut_away_by};
use super::estimate::Estimate;
use super::heights::{Height, heights};
use super::part_program::PartProgram;
use super::sensitivity::{Sensitivity, sensitivities, without_ramps};
use super::settings::Settings;
use crate::codes::{V001, V003, V004};

/// Part, probe and ball.
pub(super) struct ProbingSetup {
    pub(super) program: PartProgram,
    pub(super) probe: Probe,
    pub(super) heights: Vec<Height>,
    /// Why these, where they were chosen.
    pub(super) heights_why: Option<String>,
    pub(super) ball: Ball,
    pub(super) safe_z_mm: f64,
}

/// Places that may be touched.
pub(super) struct Touchable {
    pub(super) sites: Vec<Site>,
    /// What each would tell.
    pub(super) sensitivities: Vec<Sensitivity>,
    /// How many may not be touched, by reason.
    pub(super) kept_off: BTreeMap<KeptOff, usize>,
}

/// Between two places, at least: the ball's radius and this much more, mm, so that they are two places of the wall.
const APART: f64 = 1.0;
/// Above the engaged depth, when neither user nor program says how high is safe, mm.
const SAFE_ABOVE: f64 = 50.0;

impl ProbingSetup {
    /// Of a pass.
    ///
    /// # Errors
    /// A job without probe, settings out of range, a ball without room (`V002`, `V003`), and whatever is wrong with the
    /// program.
    pub(super) fn of(pass: &Pass, settings: &Settings) -> Result<Self, Failure> {
        Self::with_room(pass, settings, (settings.clearance, 2.0 * mm(pass.core.setup.radius)))
    }

    /// Of the stock before a pass. What the pass is to cut is no more than the largest allowance, so the rest of its width is
    /// free before it.
    ///
    /// # Errors
    /// As [`ProbingSetup::of`].
    pub(super) fn before(pass: &Pass, settings: &Settings, stock: StockWall) -> Result<Self, Failure> {
        let free = 2.0 * mm(pass.core.setup.radius) - stock.largest;
        Self::with_room(pass, settings, (settings.clearance, free))
    }

    /// With a clearance, and a width that is free before the wall unless the user says another.
    fn with_room(pass: &Pass, settings: &Settings, (clearance, free): (f64, f64)) -> Result<Self, Failure> {
        settings.check()?;
        let probe = pass.job.require_probe()?;
        let program = PartProgram::read(pass)?;
        let (heights, heights_why) = heights(pass, &probe, settings)?;
        let ball = Ball { radius: mm(probe.ball_diameter) / 2.0, clearance };
        let free = settings.free_width.unwrap_or(free);
        if ball.width() > free + 1e-9 {
            return Err(no_width(ball, free, settings, pass.unit()).into());
        }
        let safe_z_mm = safe_z(pass, settings, &program)?;
        Ok(Self { program, probe, heights, heights_why, ball, safe_z_mm })
    }

    /// The places that may be touched, with what they would tell, and how many may not, by reason; `others` are the other contours of
    /// the part. `progress` is told the share done, 0…1.
    ///
    /// # Errors
    /// `V004` without any.
    pub(super) fn touchable(
        &self,
        pass: &Pass,
        path: &Path,
        estimate: &Estimate,
        others: &[&Pass],
        progress: &mut dyn FnMut(f64),
    ) -> Result<Touchable, InputError> {
        let all = candidates(pass, path, estimate, self.ball, mm(self.probe.noise));
        let (all, mut kept_off) = self.beside_others(all, others)?;
        let count = all.len();
        let sensitivities = sensitivities(path, estimate, &all, &self.heights, self.probe.noise, progress);
        let (sites, sensitivities) = without_ramps(all, sensitivities, 2.0 * mm(path.setup().radius));
        if sites.len() < count {
            kept_off.insert(KeptOff::Unsteady, count - sites.len());
        }
        Ok(Touchable { sites, sensitivities, kept_off })
    }

    /// The places where the stock before the pass may be touched, and how many may not, by reason.
    ///
    /// # Errors
    /// `V004` without any.
    pub(super) fn stock_sites(
        &self,
        pass: &Pass,
        path: &Path,
        stock: StockWall,
        others: &[&Pass],
    ) -> Result<(Vec<Site>, BTreeMap<KeptOff, usize>), InputError> {
        self.beside_others(before_the_pass(pass, path, self.ball, stock), others)
    }

    /// The places that no other contour of the part takes away.
    fn beside_others(
        &self,
        (mut sites, mut kept_off): (Vec<Site>, Vec<KeptOff>),
        others: &[&Pass],
    ) -> Result<(Vec<Site>, BTreeMap<KeptOff, usize>), InputError> {
        let highest = self.heights.first().map_or(f64::NEG_INFINITY, |h| h.z_mm);
        sites.retain(|site| {
            let gone = others
                .iter()
                .any(|other| (deepest(other).nm() as f64) < highest * 1e6 && cut_away_by(other, site.wall));
            if gone {
                kept_off.push(KeptOff::NoWall);
            }
            !gone
        });
        let mut counts = BTreeMap::new();
        for reason in kept_off {
            *counts.entry(reason).or_insert(0) += 1;
        }
        if sites.is_empty() { Err(no_place(&counts)) } else { Ok((sites, counts)) }
    }

    /// Whether another contour is cut in the same work offset.
    pub(super) const fn shares_offset(&self, other: &Self) -> bool {
        self.program.work_offset == other.program.work_offset
    }

    /// Between two places, at least, mm.
    pub(super) fn apart(&self) -> f64 {
        self.ball.radius + APART
    }
}

/// How deep a contour is cut.
fn deepest(pass: &Pass) -> Position {
    let levels = pass.plan.iter().flat_map(|plan| &plan.passes).filter_map(|level| level.z);
    levels.fold(pass.core.contour.z, Position::min)
}

/// Height of the moves between places: above the engaged depth, and no lower than the part's program ever moved.
fn safe_z(pass: &Pass, settings: &Settings, program: &PartProgram) -> Result<f64, InputError> {
    let top = pass.core.contour.z.nm() as f64 / 1e6 + float(pass.core.setup.axial_depth);
    let highest = program.highest_nm.map_or(f64::NEG_INFINITY, |z| z as f64 / 1e6);
    match settings.safe_z {
        None => Ok((top + SAFE_ABOVE).max(highest)),
        Some(z) if z > top => Ok(z),
        Some(z) => Err(InputError::new(
            V001,
            format!("--safe-z {z} is not above the wall, which ends at Z{top}"),
            format!("a height above Z{top} and above every clamp"),
            "give a higher one, or leave it out",
        )),
    }
}

fn no_width(ball: Ball, free: f64, settings: &Settings, unit: Unit) -> InputError {
    let (free, name) = (unit.of(free), unit.name());
    let (found, help) = if settings.free_width.is_some() {
        (format!("--free-width {free}"), "use a smaller ball, or a smaller --clearance")
    } else {
        (format!("the pass has cleared {free} {name} before the wall, the cutter's diameter"), V003.remedy)
    };
    let expected = [ball.width(), 2.0 * ball.radius].map(|mm| unit.of(mm));
    let expected = format!("{} {name}: the ball of {} {name} and its clearance", expected[0], expected[1]);
    InputError::new(V003, found, expected, help)
}

fn no_place(kept_off: &BTreeMap<KeptOff, usize>) -> InputError {
    let reasons: Vec<String> = kept_off.iter().map(|(reason, n)| format!("{n} {}", reason.words())).collect();
    V004.error(
        format!("no place of the contour may be touched; of those looked at, {}", reasons.join(", ")),
        "a place where wall and engagement are steady and the ball's way is free",
    )
}
