//! Rules of place: where a correction begins, and where it may be on.

use truepath_core::image::{Image, PathWindow};
use truepath_core::link::DeviceSettings;
use truepath_core::rewrite::{Flags, Frame, Mode, Output, Setpoint};

use super::link::Ticks;
use super::verdict::{Verdict, hold};
use crate::attack::geometry::{Path, Place};
use crate::attack::rule::{Alarm, Rule};

/// What whole nanometres and turned axes hide, nm.
const MARGIN: f64 = 5.0;

/// Farthest coordinate from the first node at its level that is a place, nm.
const ROOM: f64 = (1u64 << 31) as f64;

/// Where the correction of an arming has been.
#[derive(Clone, Debug)]
pub(super) struct Course {
    path: Path,
    smooth: bool,
    closed: bool,
    tolerance: f64,
    /// From the upper end of the pass, nm: below it, above it, above the gate.
    heights: [f64; 3],
    max_step: f64,
    stale_ticks: u32,
    fade_ticks: u32,
    frame: Frame,
    /// Frames answered since the arming.
    since_arming: u32,
    /// Whether the cutter has been in the pass.
    cut: bool,
    /// Farthest way along the path.
    farthest: f64,
    mode: Mode,
    held_at: Place,
    /// Ticks in a row in which the spindle did not turn, or nobody knew.
    dead: u32,
}

impl Course {
    pub fn new(image: &Image<'_>, settings: &DeviceSettings, ramp_ticks: u32) -> Self {
        let PathWindow { tolerance, z_low, z_high, gate_height } = image.settings().window;
        let tolerance = tolerance.nm() as f64;
        let rewriter = &settings.rewriter;
        let path = Path::of(image);
        Self {
            smooth: path.is_smooth(),
            path,
            closed: image.settings().closed,
            tolerance,
            heights: [(z_low - z_high).nm() as f64 - tolerance, tolerance, (gate_height.nm() as f64).max(tolerance)],
            max_step: rewriter.max_step.nm() as f64,
            stale_ticks: rewriter.spindle_stale_ticks,
            // And the time of the limits to follow.
            fade_ticks: rewriter.fade_ticks + ramp_ticks + 2,
            frame: Frame::identity(),
            since_arming: 0,
            cut: false,
            farthest: 0.0,
            mode: Mode::Off,
            held_at: Place::default(),
            dead: 0,
        }
    }

    pub const fn arm(&mut self, frame: Frame) {
        self.frame = frame;
        self.since_arming = 0;
        // Here and not where a correction begins: the answer to its first setpoint may be withheld.
        (self.cut, self.farthest, self.dead) = (false, 0.0, 0);
    }

    fn place(&self, setpoint: &Setpoint) -> Place {
        self.path.place(&self.frame, &setpoint.axes)
    }
    fn is_over_start(&self, at: &Place) -> bool {
        at.x.hypot(at.y) <= self.tolerance + MARGIN
    }
    /// Farther from the path than the tolerance, or far above or below the pass.
    pub fn is_off_path(&self, setpoint: &Setpoint) -> bool {
        let at = self.place(setpoint);
        let [low, _, gate] = self.heights;
        at.z > gate || at.z < low || self.path.nearest(&at).distance > self.tolerance
    }
    /// Above the upper end of the pass and not over the start.
    pub fn is_above_and_away(&self, setpoint: &Setpoint) -> bool {
        let at = self.place(setpoint);
        at.z > 0.0 && !self.is_over_start(&at)
    }

    /// An answer without a correction that follows the path.
    pub const fn stops(&mut self) {
        self.since_arming = self.since_arming.saturating_add(1);
        self.mode = Mode::Off;
    }

    /// An answer with a correction that follows the path. Says whether it began where a stricter rule has no gate: at the
    /// height of the pass.
    pub fn follows(&mut self, output: &Output, ticks: &Ticks, began: bool) -> Result<bool, Box<Alarm>> {
        let setpoint = &ticks.setpoint;
        let at = self.place(setpoint);
        let [low, high, _] = self.heights;
        self.since_arming = self.since_arming.saturating_add(1);
        if began {
            self.begins(ticks, &at)?;
        }
        let near = self.path.nearest(&at);
        let in_room = [at.x, at.y, at.z].iter().all(|nm| nm.abs() <= ROOM + MARGIN);
        hold(in_room, Rule::OffPath, || format!("on {at:?}, farther than 2.1 m from the first node"))?;
        self.jump(ticks, &at)?;
        if at.z > high + MARGIN {
            let over = !self.cut && self.is_over_start(&at) && at.z <= self.heights[2] + MARGIN;
            hold(over, Rule::AbovePass, || format!("on {:.0} nm above the pass, {}", at.z, self.cut_before()))?;
        } else {
            hold(at.z >= low - MARGIN, Rule::BelowPass, || format!("on {:.0} nm below {low:.0} nm", at.z))?;
            self.cut |= at.z < high - MARGIN;
            self.in_pass(output, setpoint, &at, near.distance)?;
            self.forwards(output, near.along)?;
        }
        self.fade(output, ticks)?;
        self.mode = output.mode;
        Ok(began && at.z <= high)
    }

    const fn cut_before(&self) -> &'static str {
        if self.cut { "and it has cut before" } else { "and not in the gate" }
    }

    fn begins(&self, ticks: &Ticks, at: &Place) -> Verdict {
        let flags = ticks.setpoint.flags;
        let must = |holds: bool, what: &str| hold(holds, Rule::Begin, || format!("began {what}"));
        let [low, _, gate] = self.heights;
        must(self.is_over_start(at), "away from the start")?;
        must(at.z >= low - MARGIN && at.z <= gate + MARGIN, "above or below the gate")?;
        must(flags.has(Flags::DRIVES_ENABLED) && !flags.has(Flags::FEED_HOLD), "without drives, or in a feed hold")?;
        // The first setpoint after an arming only tells where the cutter is; one without an answer may have been it.
        must(self.since_arming > 1 || !ticks.is_one(), "with the first setpoint after the arming")?;
        must(!ticks.is_one() || ticks.ahead == Some(1), "behind a gap")
    }

    fn jump(&self, ticks: &Ticks, at: &Place) -> Verdict {
        let (Some(before), Some(ahead), true) = (&ticks.before, ticks.ahead, ticks.is_one()) else { return Ok(()) };
        let before = self.place(before);
        let most = self.max_step * f64::from(ahead) + MARGIN;
        let step = (at.x - before.x).abs().max((at.y - before.y).abs());
        // The setpoint before an arming was in another frame.
        hold(step <= most || self.since_arming < 2, Rule::Jump, || {
            format!("on behind a step of {step:.0} nm, {most:.0} nm permitted")
        })
    }

    /// In the pass: near the path, or in a hold near the place of it.
    fn in_pass(&mut self, output: &Output, setpoint: &Setpoint, at: &Place, distance: f64) -> Verdict {
        let most = self.tolerance + MARGIN;
        if output.mode != Mode::Hold {
            return hold(distance <= most, Rule::OffPath, || {
                format!("on {distance:.0} nm from the path, {most:.0} permitted")
            });
        }
        if self.mode != Mode::Hold {
            self.held_at = *at;
        }
        let away = at.away(&self.held_at);
        hold(away <= most || !setpoint.flags.has(Flags::FEED_HOLD), Rule::MovedInHold, || {
            format!("held {away:.0} nm from where it was, {most:.0} permitted")
        })
    }

    fn forwards(&mut self, output: &Output, along: f64) -> Verdict {
        self.farthest = self.farthest.max(along);
        let back = self.farthest - along;
        // Beside the one tolerance: the place of the servo lags by what it may be off the path, twice; around a corner the
        // nearest place jumps by as much; and in a hold the setpoint may be another tolerance from where it was held, twice.
        let corner = if self.smooth { 0.0 } else { 2.0 };
        let moved = if output.mode == Mode::Hold { 2.0 } else { 0.0 };
        let most = (3.0 + corner + moved) * self.tolerance + MARGIN;
        // A path that ends where it starts has two nearest places there.
        hold(back <= most || self.closed, Rule::Backwards, || format!("on {back:.0} nm back, {most:.0} nm permitted"))
    }

    fn fade(&mut self, output: &Output, ticks: &Ticks) -> Verdict {
        let setpoint = &ticks.setpoint;
        let dead = setpoint.spindle_millirpm == 0 || setpoint.spindle_age_ticks >= self.stale_ticks;
        self.dead = if dead && ticks.is_one() { self.dead + 1 } else { 0 };
        let gone = output.correction_nm.iter().all(|&nm| nm == 0);
        hold(self.dead <= self.fade_ticks || gone, Rule::Fade, || {
            format!("{:?} nm on, {} ticks without a spindle that turns", output.correction_nm, self.dead)
        })
    }
}
