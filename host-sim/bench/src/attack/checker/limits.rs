//! Rules of what goes out: axes, size, speed, acceleration, joint limits, ramps.
//!
//! Corrections are told in whole nanometres, half a one of rounding each, which the bounds of their changes have room for.

use truepath_core::image::CorrectionLimits;
use truepath_core::link::DeviceSettings;
use truepath_core::rewrite::{AXES, Mode, Output, Reason, Setpoint, Status};

use super::link::{Link, Ticks};
use super::verdict::{Verdict, hold, is_on};
use crate::attack::rule::{Alarm, Rule};

/// The limits and what went out last.
#[derive(Clone, Debug)]
pub(super) struct Bounds {
    axes: usize,
    joints: [(i64, i64); AXES],
    clamp_nm: i64,
    /// Per tick, and per tick squared, nm.
    velocity_nm: f64,
    acceleration_nm: f64,
    ramp_ticks: u32,
    correction: [i64; AXES],
    /// Change of one tick before the last answer; none where more may have passed, or a limit held something back.
    change: Option<[i64; AXES]>,
    /// The last answer was held back at a joint limit: what it would have been is not known.
    held: bool,
    /// Answered ticks on the way out.
    ending: u32,
    used: [u64; 3],
}

impl Bounds {
    pub fn new(limits: &CorrectionLimits, settings: &DeviceSettings, ramp_ticks: u32) -> Self {
        let hz = f64::from(settings.rewriter.tick_hz);
        Self {
            axes: usize::from(settings.axes).min(AXES),
            joints: settings.rewriter.joint_limits_nm,
            clamp_nm: limits.clamp.nm(),
            velocity_nm: f64::from(limits.slew_nm_per_s) / hz,
            acceleration_nm: limits.acceleration_nm_per_s2 as f64 / (hz * hz),
            ramp_ticks,
            correction: [0; AXES],
            change: Some([0; AXES]),
            held: false,
            ending: 0,
            used: [0; 3],
        }
    }

    /// Nothing is on.
    pub fn at_zero(&mut self) {
        self.correction = [0; AXES];
        self.change = Some([0; AXES]);
        self.held = false;
        self.ending = 0;
    }
    pub const fn used(&self) -> [u64; 3] {
        self.used
    }

    /// On the axes of what is armed only.
    pub fn axes(&self, output: &Output, plane: Option<[usize; 2]>) -> Verdict {
        for (axis, &nm) in output.correction_nm.iter().enumerate() {
            let armed = plane.is_some_and(|plane| plane.contains(&axis));
            hold(nm == 0 || armed, Rule::Axis, || format!("{nm} nm on axis {axis}, armed are {plane:?}"))?;
        }
        Ok(())
    }

    /// Size and joint limits.
    pub fn size(&mut self, output: &Output, setpoint: &Setpoint) -> Verdict {
        for axis in 0..self.axes {
            let nm = i64::from(output.correction_nm[axis]);
            hold(nm.abs() <= self.clamp_nm, Rule::Clamp, || {
                format!("{nm} nm on axis {axis}, the clamp is {} nm", self.clamp_nm)
            })?;
            self.used[0] = self.used[0].max((nm.abs() * 1_000 / self.clamp_nm).unsigned_abs());
            let (low, high) = self.joints[axis];
            let beyond =
                |at: i64| i128::from(low).saturating_sub(at.into()).max(i128::from(at) - i128::from(high)).max(0);
            let (from, to) = (setpoint.axes[axis], output.axes[axis]);
            hold(nm == 0 || beyond(to) <= beyond(from), Rule::Joint, || {
                format!("axis {axis} is carried from {from} to {to} nm, its limits are {low} and {high}")
            })?;
        }
        Ok(())
    }

    /// A correction that was on is told to be out: the answer before had nothing left of it.
    pub fn ramped_out(&self, link: &Link) -> Verdict {
        let gone = self.correction == [0; AXES] || self.held || link.hid_ticks();
        hold(gone, Rule::RampCut, || format!("Bypass with {:?} nm on in the tick before", self.correction))
    }

    /// Changes from answer to answer, and the length of a ramp.
    pub fn changes(&mut self, output: &Output, ticks: &Ticks, was_on: bool) -> Verdict {
        if !is_on(output.mode) {
            // What `Bypass` cut off was judged; in `Off` the drives are without power.
            let cut = was_on && output.mode == Mode::Bypass && !self.held;
            if cut {
                self.speed(&[0; AXES], ticks)?;
            }
            self.at_zero();
            return Ok(());
        }
        let now = output.correction_nm.map(i64::from);
        let held = output.status.has(Status::JOINT_LIMITED);
        if held || self.held {
            self.change = None;
        } else {
            let change = self.speed(&now, ticks)?;
            if let (Some(before), true) = (self.change, ticks.is_one()) {
                self.acceleration(&change, &before)?;
            }
            self.change = ticks.is_one().then_some(change);
        }
        (self.correction, self.held) = (now, held);
        let ends = output.mode == Mode::Fault || output.reason != Reason::None;
        self.ending = if ends { self.ending + 1 } else { 0 };
        hold(self.ending <= self.ramp_ticks + 1, Rule::RampLong, || {
            format!("on its way out for {} ticks, {} permitted", self.ending, self.ramp_ticks)
        })
    }

    fn speed(&mut self, now: &[i64; AXES], ticks: &Ticks) -> Result<[i64; AXES], Box<Alarm>> {
        let mut change = [0; AXES];
        let most = self.velocity_nm * f64::from(ticks.most) + 1.0;
        for axis in 0..AXES {
            change[axis] = now[axis] - self.correction[axis];
            let nm = change[axis].unsigned_abs();
            hold(nm as f64 <= most, Rule::Speed, || {
                format!("axis {axis} changes by {nm} nm in {} ticks, {most:.1} nm permitted", ticks.most)
            })?;
            self.used[1] = self.used[1].max((nm as f64 * 1_000.0 / most) as u64);
        }
        Ok(change)
    }

    fn acceleration(&mut self, change: &[i64; AXES], before: &[i64; AXES]) -> Verdict {
        let most = self.acceleration_nm + 2.0;
        for axis in 0..AXES {
            let nm = (change[axis] - before[axis]).unsigned_abs();
            hold(nm as f64 <= most, Rule::Acceleration, || {
                format!("the change of axis {axis} changes by {nm} nm, {most:.1} nm permitted")
            })?;
            self.used[2] = self.used[2].max((nm as f64 * 1_000.0 / most) as u64);
        }
        Ok(())
    }
}
