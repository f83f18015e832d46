//! Cutter and spindle: from what is set on the machine to angular speeds and to the teeth of one height.
//!
//! The angle φ of the wall is counted **along the travel of the cutter's centre** from where its circle begins. A cutter that
//! turns in the sense of the travel mills conventionally (ω₂ > 0), one that turns against it climbs (ω₂ < 0): with a right-hand
//! cutter (M3) G2 inside a bore is conventional, G3 is climb. (Urinov 2020 has only the former.)
//!
//! Runout is a parallel offset of the cutter's axis from the spindle's. Both turn together, so the teeth keep turning about the
//! spindle axis, each with a radius and an angle of its own; that is exact, not a first-order correction. At height z the edge of
//! a helical cutter lags by `z·tan β / r`, so with runout the radii change over the height as well.

use std::f64::consts::TAU;

use super::arc::Arc;
use super::refusal::Refusal;

/// The cutter's centre on its circle and the cutter about it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    /// Radius of the centre's path, `R`, mm.
    pub path_mm: f64,
    /// Angular speed of the centre, `ω₁` > 0, rad/s.
    pub omega1: f64,
    /// Angular speed of the cutter, `ω₂`, rad/s: positive conventional, negative climb.
    pub omega2: f64,
}

/// The fewest turns of the cutter against its path in one lap. With fewer a "mark" is a good part of the hole.
pub const FEWEST_TURNS: f64 = 4.0;

impl Motion {
    /// # Errors
    /// [`Refusal`] when a number is not finite or out of range, or the cutter does not turn against the path.
    pub fn new(path_mm: f64, omega1: f64, omega2: f64) -> Result<Self, Refusal> {
        Refusal::unless_in("radius of the centre's path", "mm", path_mm, 1e-3, 1e5)?;
        Refusal::unless_in("angular speed of the centre", "rad/s", omega1, 1e-12, 1e6)?;
        Refusal::unless_in("angular speed of the cutter", "rad/s", omega2.abs(), 1e-9, 1e7)?;
        if (omega2 - omega1).abs() <= 1e-9 * omega2.abs().max(omega1) {
            return Err(Refusal::NoRelativeTurn);
        }
        let turns = (omega2 - omega1).abs() / omega1;
        Refusal::unless_in("turns of the cutter against its path in one lap:", "", turns, FEWEST_TURNS, 1e12)?;
        Ok(Self { path_mm, omega1, omega2 })
    }
    /// `k = ω₁/(ω₂ − ω₁)`.
    pub fn advance(&self) -> f64 {
        self.omega1 / (self.omega2 - self.omega1)
    }
    /// Distance of successive crests of one tooth on the wall, rad: `2π|k|`.
    pub fn spacing(&self) -> f64 {
        TAU * self.advance().abs()
    }
    /// The curve of a pass of a tooth.
    pub fn arc(&self, tooth: &Tooth) -> Arc {
        Arc::new(self.path_mm, tooth.radius_mm, self.advance())
    }
}

/// One edge at one height, as it turns about the spindle axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tooth {
    /// Distance from the spindle axis, mm.
    pub radius_mm: f64,
    /// Angle `β` at τ = 0 in the frame of φ, rad.
    pub angle: f64,
}

/// The most teeth a cutter may have.
pub const MAX_TEETH: u32 = 64;

/// The cutter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cutter {
    /// Radius, mm.
    pub radius_mm: f64,
    /// Teeth, 1…[`MAX_TEETH`], equally pitched.
    pub teeth: u32,
    /// Helix angle, degrees, −85…85.
    pub helix_deg: f64,
    /// Offset of the cutter's axis from the spindle's, mm, 0…half the radius.
    pub runout_mm: f64,
    /// Direction of the offset against tooth 1, degrees, in the sense of φ.
    pub runout_deg: f64,
    /// Angle of tooth 1 when the circle begins, degrees, in the sense of φ; 0 points straight at the wall.
    pub phase_deg: f64,
}

impl Cutter {
    /// A cutter with straight teeth that runs true.
    pub const fn plain(radius_mm: f64, teeth: u32) -> Self {
        Self { radius_mm, teeth, helix_deg: 0.0, runout_mm: 0.0, runout_deg: 0.0, phase_deg: 0.0 }
    }
    /// # Errors
    /// [`Refusal`] naming the number that is out of range.
    pub fn check(&self) -> Result<(), Refusal> {
        Refusal::unless_in("cutter radius", "mm", self.radius_mm, 1e-2, 1e4)?;
        Refusal::unless_in("number of teeth", "", f64::from(self.teeth), 1.0, f64::from(MAX_TEETH))?;
        Refusal::unless_in("helix angle", "°", self.helix_deg, -85.0, 85.0)?;
        Refusal::unless_in("runout", "mm", self.runout_mm, 0.0, self.radius_mm / 2.0)?;
        Refusal::unless_in("runout angle", "°", self.runout_deg, -360.0, 360.0)?;
        Refusal::unless_in("tooth phase", "°", self.phase_deg, -360.0, 360.0)
    }
    /// How far the edge lags `z` mm above the tip, rad, in the sense of φ.
    pub fn lag(&self, z_mm: f64, motion: &Motion) -> f64 {
        motion.omega2.signum() * z_mm * self.helix_deg.to_radians().tan() / self.radius_mm
    }
    /// The teeth at `z` mm above the tip; tooth `i` lags behind the first by `2π(i − 1)/N` (Urinov 2020, eq. 6).
    pub fn at(&self, z_mm: f64, motion: &Motion) -> Vec<Tooth> {
        let (offset, direction) = (self.runout_mm, self.runout_deg.to_radians());
        let phase = self.phase_deg.to_radians();
        let lag = self.lag(z_mm, motion);
        let tooth = |i: u32| {
            let own = -TAU * f64::from(i) / f64::from(self.teeth) - lag;
            if offset == 0.0 {
                return Tooth { radius_mm: self.radius_mm, angle: phase + own };
            }
            let x = self.radius_mm * own.sin() + offset * direction.sin();
            let y = self.radius_mm * own.cos() + offset * direction.cos();
            Tooth { radius_mm: x.hypot(y), angle: phase + x.atan2(y) }
        };
        (0..self.teeth).map(tooth).collect()
    }
}
