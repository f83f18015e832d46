//! The cut: cutter, speeds and the stock on the wall. What the machinist chooses, as opposed to what the machine is.

use super::error::{PlantError, require};
use super::path::{Path, Side};
use super::vector::Point;

/// Sense of rotation of the spindle, seen from above.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Spindle {
    /// M3.
    #[default]
    Clockwise,
    /// M4, for a left-hand cutter.
    CounterClockwise,
}

/// From a place along the path on, another feed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FeedChange {
    /// Distance along the nominal path, mm.
    pub from_s_mm: f64,
    /// Feed from there on, mm/min.
    pub feed_mm_per_min: f64,
}

/// Set-up of one pass.
#[derive(Debug, Clone, PartialEq)]
pub struct Cut {
    /// Cutter radius, 0.05…100 mm.
    pub radius_mm: f64,
    /// Teeth, 1…64.
    pub teeth: usize,
    /// Helix angle, 0…75°; the edge trails with height, whatever the hand of the cutter.
    pub helix_deg: f64,
    /// Axial depth of cut, mm.
    pub axial_depth_mm: f64,
    /// Feed at the start, mm/min.
    pub feed_mm_per_min: f64,
    /// Feeds that take over along the path, in ascending order.
    pub feed_changes: Vec<FeedChange>,
    /// Spindle speed, rev/min.
    pub spindle_rpm: f64,
    /// Sense of rotation.
    pub spindle: Spindle,
    /// Stock left on the finished wall, along the normal, 0…2·radius mm.
    pub allowance_mm: f64,
    /// Actual surface to be cut, in the sense of travel, mm; it takes the place of the parallel curve at `allowance_mm`.
    pub surface: Option<Vec<Point>>,
    /// How much of the cutter's past the stock remembers, mm of path; `None`: everything. 3 mm is enough where the path
    /// never comes back to a place, and gives a closed contour no seam.
    pub memory_mm: Option<f64>,
}

impl Cut {
    /// Checks the ranges above.
    ///
    /// # Errors
    /// `OutOfRange` with the key.
    pub fn check(&self) -> Result<(), PlantError> {
        let r = self.radius_mm;
        require((0.05..=100.0).contains(&r), "radius_mm", r, "0.05 to 100 mm")?;
        require((1..=64).contains(&self.teeth), "teeth", self.teeth as f64, "1 to 64")?;
        require((0.0..=75.0).contains(&self.helix_deg), "helix_deg", self.helix_deg, "0 to 75 degrees")?;
        let b = self.axial_depth_mm;
        require(b > 0.0 && b <= 500.0, "axial_depth_mm", b, "more than 0, up to 500 mm")?;
        let n = self.spindle_rpm;
        require(n > 0.0 && n <= 1e6, "spindle_rpm", n, "more than 0, up to 1e6 rev/min")?;
        let h = self.allowance_mm;
        require((0.0..=2.0 * r).contains(&h), "allowance_mm", h, "0 to the cutter's diameter")?;
        let feeds = std::iter::once(self.feed_mm_per_min).chain(self.feed_changes.iter().map(|c| c.feed_mm_per_min));
        for feed in feeds {
            let ok = feed > 0.0 && feed <= 1e6;
            require(ok, "feed_mm_per_min", feed, "more than 0, up to 1e6 mm/min")?;
        }
        Ok(())
    }

    /// Feed at the place `s_mm`, mm/min.
    pub fn feed_at(&self, s_mm: f64) -> f64 {
        let change = self.feed_changes.iter().take_while(|c| c.from_s_mm <= s_mm).last();
        change.map_or(self.feed_mm_per_min, |c| c.feed_mm_per_min)
    }

    /// Feed per tooth at a feed in mm/min, mm.
    pub fn feed_per_tooth_mm(&self, feed_mm_per_min: f64) -> f64 {
        feed_mm_per_min / (self.spindle_rpm * self.teeth as f64)
    }

    /// Climb (down) milling: the wall on the right of travel with M3, or on the left with M4.
    pub fn is_climb(&self, path: &Path) -> bool {
        (path.side == Side::Right) == (self.spindle == Spindle::Clockwise)
    }
}
