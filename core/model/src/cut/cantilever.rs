//! The cutter's own share of the compliance: a cantilever with the load spread over the engaged depth.
//!
//! LG03: δ = P·L³/3EI with an equivalent diameter for the fluted section (0.89, 0.82, 0.75 of D for 2, 3, 4 flutes;
//! 0.8 where it is not known: the ratios are from the later literature, not from LG03). A load at the middle of the
//! depth moves the tip by u²(3 − u)/2 of that, u = 1 − b/2L; here the load is integrated over its depth, and the
//! displacement is known at every height, because the tip moves most.

use super::compliance::Compliance;
use truepath_units::{Offset, Real};

/// What the cutter is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ToolMaterial {
    /// High-speed steel, E = 215 kN/mm².
    HighSpeedSteel,
    /// Cemented carbide, E = 600 kN/mm².
    Carbide,
}

/// A cutter clamped at one end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cantilever {
    /// Free length, mm.
    pub stickout: Real,
    /// Engaged depth, mm.
    pub axial_depth: Real,
    /// Bending stiffness E·I, kN·mm².
    pub rigidity: Real,
}

/// Slices over which the load is spread.
const SLICES: i64 = 16;

impl Cantilever {
    /// From the cutter's dimensions.
    pub fn new(diameter: Offset, teeth: u8, stickout: Offset, axial_depth: Real, material: ToolMaterial) -> Self {
        let ratio = match teeth {
            2 => Real::ratio(89, 100),
            3 => Real::ratio(82, 100),
            4 => Real::ratio(75, 100),
            _ => Real::ratio(80, 100),
        };
        let modulus = match material {
            ToolMaterial::HighSpeedSteel => Real::from_int(215),
            ToolMaterial::Carbide => Real::from_int(600),
        };
        let d = diameter.mm() * ratio;
        let second_moment = Real::PI / Real::from_int(64) * (d * d) * (d * d);
        Self { stickout: stickout.mm(), axial_depth, rigidity: modulus * second_moment }
    }

    /// Displacement at a height above the tip (mm) per newton spread evenly over the engaged depth, µm/N.
    pub fn at(&self, height: Real) -> Real {
        let x = self.stickout - height;
        let mut sum = Real::ZERO;
        for k in 0..SLICES {
            let load = self.stickout
                - self.axial_depth * Real::ratio(k.saturating_mul(2).saturating_add(1), SLICES.saturating_mul(2));
            let (near, far) = if x < load { (x, load) } else { (load, x) };
            // P·near²·(3·far − near)/6EI at `near` from a load at `far`, and the other way round.
            sum += near * near / self.rigidity * (far * Real::from_int(3) - near);
        }
        sum * Real::ratio(1, SLICES.saturating_mul(6))
    }

    /// The compliance of a machine with this cutter in it: stiffness adds in series, bending over the engaged depth
    /// follows from the cutter.
    pub fn mounted_in(&self, machine: Compliance) -> Compliance {
        let (tip, top) = (self.at(Real::ZERO), self.at(self.axial_depth));
        let mean = machine.mean + top;
        Compliance { mean, bend: (tip - top) / mean, ..machine }
    }
}
