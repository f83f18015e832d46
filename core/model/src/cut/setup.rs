//! What is cut, with what, and how: the facts the model takes as given.

use truepath_units::geometry::Side;
use truepath_units::{Offset, Real, pow, sin_cos};

/// How the teeth meet the wall.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Milling {
    /// Down milling: the tooth leaves at the finished wall. Wall on the right with the spindle clockwise.
    Climb,
    /// Up milling: the tooth enters at the finished wall. Wall on the left with the spindle clockwise.
    Conventional,
}

/// The force coefficients of a tooth (Altintas, *Manufacturing Automation*, ch. 2; physics of P23 eq. 3 with edges).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Coefficients {
    /// Tangential chip coefficient at a chip of 0.05 mm, N/mm².
    pub ktc: Real,
    /// Radial chip coefficient at a chip of 0.05 mm, N/mm².
    pub krc: Real,
    /// Tangential edge coefficient, N/mm.
    pub kte: Real,
    /// Radial edge coefficient, N/mm.
    pub kre: Real,
    /// Size exponent m: the chip coefficients grow as (h/0.05 mm)^(−m). 0…0.5.
    pub size_exponent: Real,
}

/// Which force makes the wall at a height.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum WallLaw {
    /// The mean force over a revolution makes the whole wall (the simplification of P23).
    Mean,
    /// The force at the instant a tooth passes the wall at that height makes it.
    Helical,
}

/// How far the axis of the cutter stands off that of the spindle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Runout {
    /// Radial offset, at most 1 mm.
    pub offset: Offset,
    /// Its direction behind a tooth, rad: at 0 a tooth reaches farther by all of the offset. Teeth are alike: a pitch more is the
    /// same.
    pub behind: Real,
}

/// The cutter, the allowance and the cutting conditions of one pass.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CutSetup {
    /// Cutter radius.
    pub radius: Offset,
    /// Number of teeth.
    pub teeth: u8,
    /// Helix angle, degrees, 0…60.
    pub helix_deg: Real,
    /// Axial depth of cut, mm.
    pub axial_depth: Real,
    /// Stock on the wall before the pass, along the normal (radial depth of cut on a straight wall).
    pub allowance: Offset,
    /// Spindle speed, rev/min.
    pub spindle_rpm: Real,
    /// Side of travel of the finished wall.
    pub wall: Side,
    /// Climb or conventional.
    pub milling: Milling,
    /// Which force makes the wall.
    pub law: WallLaw,
    /// How the cutter runs out; radius is that of its middle tooth, without it.
    pub runout: Runout,
}

/// How the edges of a cutter wind, derived once from a [`CutSetup`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Helix {
    /// How far a tooth lags per millimetre of height, rad/mm.
    pub lag_per_mm: Real,
    /// Its inverse, mm/rad.
    pub mm_per_lag: Real,
    /// Angle between two teeth, rad.
    pub pitch: Real,
    /// Engaged depth of all teeth over a turn, N·b/2π, mm/rad: what the mean force of a revolution counts of an immersion.
    pub mm_in_mean: Real,
}

/// Teeth of a cutter.
pub(super) const MAX_TEETH: usize = 12;
/// Flutes in the stock at once that the force is summed over: 12 teeth at 60° helix over an axial depth of 15 radii.
pub(super) const MAX_FLUTES: i64 = 64;
/// Chip thickness at which the chip coefficients are stated, mm.
const REFERENCE_CHIP: Real = Real::ratio(5, 100);
/// The least turn of a tooth over the engaged depth that is distinguished from a straight flute, rad.
const STRAIGHT_FLUTE_LAG: Real = Real::ratio(2, 100);

impl Milling {
    /// For a wall on a side of travel and a spindle that turns clockwise (M3) or not (M4).
    pub fn of(wall: Side, spindle_clockwise: bool) -> Self {
        if (wall == Side::Right) == spindle_clockwise { Self::Climb } else { Self::Conventional }
    }
}

impl Runout {
    /// A cutter that runs true.
    pub const NONE: Self = Self { offset: Offset::ZERO, behind: Real::ZERO };

    /// How much farther than the middle a tooth reaches; teeth are counted in the order in which they pass a place.
    pub fn reach(&self, tooth: u8, teeth: u8) -> Offset {
        let turn = Real::TAU * Real::ratio(tooth.into(), teeth.into());
        self.offset.scaled(sin_cos(turn - self.behind).1)
    }

    /// How much farther the tooth reaches that does so most: without force it makes the wall alone.
    pub fn longest(&self, teeth: u8) -> Offset {
        (0..teeth).map(|tooth| self.reach(tooth, teeth)).max().unwrap_or_default()
    }
}

impl CutSetup {
    /// Feed per tooth, mm, for a feed in mm/min.
    pub fn feed_per_tooth(&self, feed: Real) -> Real {
        feed / (self.spindle_rpm * Real::from_int(self.teeth.into()))
    }
    /// Whether so few flutes are in the stock at once that all of them are summed.
    pub fn fits_force_table(&self) -> bool {
        let helix = self.helix();
        self.axial_depth * helix.lag_per_mm + Real::PI <= helix.pitch * Real::from_int(MAX_FLUTES as i32)
    }
    /// The edges of the cutter. A straight flute is given a lag of 0.02 rad over the engaged depth, which changes its
    /// force by less than the tooth entry it smooths.
    pub fn helix(&self) -> Helix {
        let (sine, cosine) = sin_cos(self.helix_deg * Real::PI / Real::from_int(180));
        let lag = sine / cosine / self.radius.mm();
        let lag_per_mm = lag.max(STRAIGHT_FLUTE_LAG / self.axial_depth);
        let teeth = Real::from_int(self.teeth.into());
        let mm_in_mean = teeth * self.axial_depth / Real::TAU;
        Helix { lag_per_mm, mm_per_lag: Real::ONE / lag_per_mm, pitch: Real::TAU / teeth, mm_in_mean }
    }
}

impl Coefficients {
    /// What a feed per tooth (mm) contributes to the chip force, mm: f·(f/0.05)^(−m).
    pub fn chip_scale(&self, feed_per_tooth: Real) -> Real {
        if self.size_exponent == Real::ZERO {
            return feed_per_tooth;
        }
        feed_per_tooth * pow(feed_per_tooth / REFERENCE_CHIP, -self.size_exponent)
    }
    /// The feed per tooth, mm, of a [chip scale](Self::chip_scale).
    pub(super) fn feed_of(&self, chip_scale: Real) -> Real {
        if self.size_exponent == Real::ZERO {
            return chip_scale;
        }
        REFERENCE_CHIP * pow(chip_scale / REFERENCE_CHIP, Real::ONE / (Real::ONE - self.size_exponent))
    }
}
