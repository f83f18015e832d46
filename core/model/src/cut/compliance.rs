//! Compliance of machine and cutter: how far a force pushes the cutter.

use truepath_units::geometry::{Direction, Vector};
use truepath_units::{Offset, Real};

/// A symmetric 2 × 2 compliance of the XY plane, µm/N, and how it grows towards the cutter's tip.
///
/// It is held as mean, difference and cross term because these keep their value or only change sign when the part is
/// turned by 90° or mirrored: cxx = mean + difference, cyy = mean − difference.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Compliance {
    /// (cxx + cyy)/2, µm/N.
    pub mean: Real,
    /// (cxx − cyy)/2, µm/N.
    pub difference: Real,
    /// cxy = cyx, µm/N.
    pub cross: Real,
    /// How much farther the tip of the cutter moves than its section at the top of the engaged depth, as a share.
    pub bend: Real,
}

impl Compliance {
    /// From stiffnesses in N/mm along x and y.
    pub fn from_stiffness(kx: Real, ky: Real) -> Self {
        let (x, y) = (Real::from_int(1000) / kx, Real::from_int(1000) / ky);
        Self { mean: (x + y) * Real::HALF, difference: (x - y) * Real::HALF, ..Self::default() }
    }
    /// Compliance along x, µm/N.
    pub fn xx(&self) -> Real {
        self.mean + self.difference
    }
    /// Compliance along y, µm/N.
    pub fn yy(&self) -> Real {
        self.mean - self.difference
    }
    /// Displacement under a force given by its components along a normal and a travel direction, N.
    pub fn displacement(&self, normal: Direction, heading: Direction, force: (Real, Real)) -> Vector {
        let fx = Real::dot(force.0, normal.x, force.1, heading.x);
        let fy = Real::dot(force.0, normal.y, force.1, heading.y);
        let micrometres = |a: Real, b: Real, c: Real, d: Real| {
            Offset::from_nm(Real::from_bits(Real::dot(a, b, c, d).bits().saturating_mul(1000)).round_to_int())
        };
        Vector { x: micrometres(self.xx(), fx, self.cross, fy), y: micrometres(self.cross, fx, self.yy(), fy) }
    }
    /// The factor on the displacement at a height, as a fraction 0…1 of the engaged depth above the tip.
    pub fn height_factor(&self, fraction: Real) -> Real {
        Real::ONE + self.bend * (Real::ONE - fraction)
    }
    /// The mean of [`height_factor`](Self::height_factor) over the engaged depth.
    pub fn mean_factor(&self) -> Real {
        Real::ONE + self.bend * Real::HALF
    }
}
