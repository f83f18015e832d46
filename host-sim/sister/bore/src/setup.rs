//! What is set on the machine for one bore.

use std::f64::consts::TAU;

use super::envelope::{Profile, Steady};
use super::motion::{Cutter, Motion};
use super::passes::Passes;
use super::refusal::Refusal;

/// At which radius the programmed feed holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum FeedAt {
    /// The cutter's centre: how controls take an F word without cutter compensation of the feed.
    Centre,
    /// The wall of the hole.
    Wall,
}

/// A bore and how it is milled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setup {
    /// Nominal radius of the hole, `R + r`, mm.
    pub hole_mm: f64,
    /// The cutter.
    pub cutter: Cutter,
    /// Feed, mm/min.
    pub feed_mm_per_min: f64,
    /// Where the feed holds.
    pub feed_at: FeedAt,
    /// Spindle speed, rev/min; negative against the travel (climb).
    pub rpm: f64,
    /// Laps of the centre; without a number the shortest cut without a seam.
    pub laps: Option<f64>,
}

impl Setup {
    /// # Errors
    /// [`Refusal`] naming the number that is out of range.
    pub fn motion(&self) -> Result<Motion, Refusal> {
        self.cutter.check()?;
        let most = 1e5;
        Refusal::unless_in("hole radius", "mm", self.hole_mm, 1e-2, most)?;
        if self.hole_mm - self.cutter.radius_mm < 1e-3 {
            return Err(Refusal::Range {
                name: "cutter radius",
                unit: "mm",
                found: self.cutter.radius_mm,
                low: 1e-2,
                high: self.hole_mm - 1e-3,
            });
        }
        Refusal::unless_in("feed", "mm/min", self.feed_mm_per_min, 1e-6, 1e6)?;
        Refusal::unless_in("spindle speed", "rev/min", self.rpm.abs(), 1e-3, 1e6)?;
        let path = self.hole_mm - self.cutter.radius_mm;
        Motion::new(path, self.feed_mm_per_min / 60.0 / self.feed_radius(), self.rpm * TAU / 60.0)
    }
    /// The radius on which the feed holds, mm.
    pub fn feed_radius(&self) -> f64 {
        match self.feed_at {
            FeedAt::Centre => self.hole_mm - self.cutter.radius_mm,
            FeedAt::Wall => self.hole_mm,
        }
    }
    /// Feed per tooth of the cutter's centre, mm.
    pub fn feed_per_tooth(&self) -> f64 {
        let centre = self.feed_mm_per_min * (self.hole_mm - self.cutter.radius_mm) / self.feed_radius();
        centre / (self.rpm.abs() * f64::from(self.cutter.teeth))
    }
    /// The passes at `z` mm above the tip.
    ///
    /// # Errors
    /// [`Refusal`].
    pub fn passes(&self, z_mm: f64) -> Result<Passes, Refusal> {
        let motion = self.motion()?;
        Passes::new(motion, self.cutter.at(z_mm, &motion), self.laps)
    }
    /// The profile at `z` mm above the tip.
    ///
    /// # Errors
    /// [`Refusal`].
    pub fn profile(&self, z_mm: f64) -> Result<Profile, Refusal> {
        Profile::of(self.passes(z_mm)?)
    }
    /// What repeats in it.
    ///
    /// # Errors
    /// [`Refusal`].
    pub fn steady(&self, z_mm: f64) -> Result<Steady, Refusal> {
        Steady::of(self.passes(z_mm)?, self.laps.is_none())
    }
}

/// Height of the crests between equal marks, mm, to second order: `(R + r)²D²/8·(κ − 1/(R + r))` with the distance of marks
/// `D = 2πω₁/(N|ω₂ − ω₁|)` and the curvature of the tooth's path at the crest `κ = (Rω₁² + rω₂²)/(Rω₁ + rω₂)²`. A check beside
/// the exact envelope: 1–2 % low where marks are as far apart as in Urinov 2020 with one tooth.
pub fn cusp_formula(motion: &Motion, edge_mm: f64, teeth: u32) -> f64 {
    let (path, w1, w2) = (motion.path_mm, motion.omega1, motion.omega2);
    let distance = motion.spacing() / f64::from(teeth);
    let curvature = (path * w1 * w1 + edge_mm * w2 * w2) / (path * w1 + edge_mm * w2).powi(2);
    let wall = path + edge_mm;
    (wall * distance).powi(2) / 8.0 * (curvature - 1.0 / wall)
}
