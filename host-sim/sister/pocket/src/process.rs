//! What a method of cutting tells about a pocket: the walls that a shifted path leaves.

use super::error::PocketError;
use super::station::Station;

/// Mean errors of the walls over the height, mm; positive: material left. NaN where there is none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Walls {
    /// On the side of the job's wall.
    pub near: f64,
    /// On the other side; NaN in a finishing pass.
    pub far: f64,
}

/// The cut at one station.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cutting {
    /// Engaged angle, rad.
    pub engaged_rad: f64,
    /// Mean force over a revolution on the tool: along the normal to the near wall and along the travel, N.
    pub force_n: [f64; 2],
    /// Mean deflection over the engaged depth, along the normal, mm.
    pub deflection_mm: f64,
    /// Deflection of the tip under the mean force, magnitude, mm.
    pub tip_mm: f64,
    /// What the correction aims at; a slot has two walls.
    pub walls: Walls,
    /// Largest difference between the errors of two heights of one wall, mm; NaN where there is none.
    pub height_mm: f64,
}

impl Walls {
    /// The error that a shift towards the near wall takes away, mm: of the wall, or of the position of the slot.
    pub fn position(&self) -> f64 {
        match (self.near.is_nan(), self.far.is_nan()) {
            (false, false) => 0.5 * (self.near - self.far),
            (false, true) => self.near,
            (true, false) => -self.far,
            (true, true) => f64::NAN,
        }
    }
    /// The larger error of the two walls, mm; NaN where there is no wall.
    pub fn worst(&self) -> f64 {
        self.near.abs().max(self.far.abs())
    }
    /// How much narrower than the cutter a slot is, mm: no shift changes it.
    pub fn narrow(&self) -> f64 {
        self.near + self.far
    }
}

/// A way of cutting: a finishing pass or a slot.
pub trait Process {
    /// Where the walls are looked at, in the order of the path.
    fn stations(&self) -> &[Station];
    /// The engagement that the program intends, rad, one per station.
    fn nominal(&self) -> &[f64];
    /// The cut with the path shifted by a vector at every station, mm; `force` multiplies all force coefficients.
    ///
    /// # Errors
    /// [`PocketError`] when force and deflection do not settle.
    fn cut(&self, shifts: &[[f64; 2]], force: f64) -> Result<Vec<Cutting>, PocketError>;
    /// What a deflection must stay below, mm.
    fn limit_mm(&self) -> f64;
    /// Deflection along the normal at a station under the cut that the program intends, mm. The real one is smaller where
    /// the cutter yields, and says nothing of a cutter that cannot stand the cut.
    fn intended_mm(&self, station: usize) -> f64;
}
