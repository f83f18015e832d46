//! The cutter as a beam: its diameters and what it is made of.
//!
//! Flutes weaken a cutter. Kops & Vo (*Determination of the equivalent diameter of an end mill based on its compliance*,
//! CIRP Annals 39 (1990) 93–96) measured and computed, for two and for four flutes, a solid bar of about 0.8 D of the
//! same compliance; a maker of cutters (Mitsubishi Materials, *Training: end mills, rigidity*) states 0.7…0.8 D. The
//! ratios by tooth count, 0.89, 0.82 and 0.75 for 2, 3 and 4 flutes, are those the model of the device uses
//! ([`truepath_core::cut::Cantilever`]); with another count, 0.8. They differ between makers by more than between
//! counts: the compliance goes with the fourth power, so 0.75 instead of 0.8 is 29 %. `core_ratio` in the job is for a
//! cutter whose core is known.
//!
//! Young's modulus: 215 kN/mm² for high-speed steel, 600 kN/mm² for cemented carbide, as in the model of the device. Others
//! reckon with 200 and 580; a maker's own value goes into `modulus_kn_per_mm2`.

use truepath_core::cut::ToolMaterial;

use super::beam::{Beam, second_moment};

/// Dimensions of a cutter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tool {
    /// Cutting diameter, mm.
    pub diameter_mm: f64,
    /// Teeth.
    pub teeth: u8,
    /// Free length from the collet to the tip, mm.
    pub stickout_mm: f64,
    /// Length of the fluted part, 0 to the free length, mm.
    pub flute_length_mm: f64,
    /// Diameter of the shank, mm.
    pub shank_diameter_mm: f64,
    /// Equivalent diameter of the fluted part over the cutting diameter, 0.3…1.
    pub core_ratio: f64,
    /// Young's modulus, kN/mm².
    pub modulus_kn_per_mm2: f64,
}

/// Equivalent diameter over cutting diameter, by tooth count.
pub const fn core_ratio(teeth: u8) -> f64 {
    match teeth {
        2 => 0.89,
        3 => 0.82,
        4 => 0.75,
        _ => 0.80,
    }
}

/// Young's modulus, kN/mm².
pub const fn modulus(material: ToolMaterial) -> f64 {
    match material {
        ToolMaterial::HighSpeedSteel => 215.0,
        ToolMaterial::Carbide => 600.0,
    }
}

impl Tool {
    /// The cutter as a beam.
    pub fn beam(&self) -> Beam {
        let stiff = |d: f64| 1000.0 * self.modulus_kn_per_mm2 * second_moment(d);
        let shank = self.stickout_mm - self.flute_length_mm;
        Beam::new(self.stickout_mm, shank, [stiff(self.shank_diameter_mm), stiff(self.core_ratio * self.diameter_mm)])
    }
}

#[cfg(test)]
mod tests {
    use truepath_core::cut::Cantilever;
    use truepath_core::units::{Offset, Real};

    use super::super::beam::Load;
    use super::*;

    fn cutter(teeth: u8) -> Tool {
        Tool {
            diameter_mm: 16.0,
            teeth,
            stickout_mm: 60.0,
            flute_length_mm: 60.0,
            shank_diameter_mm: 16.0,
            core_ratio: core_ratio(teeth),
            modulus_kn_per_mm2: modulus(ToolMaterial::Carbide),
        }
    }

    #[test]
    fn a_cutter_fluted_to_the_collet_is_the_cantilever_of_the_device() {
        for teeth in [2, 3, 4, 6] {
            let depth = Real::from_int(10);
            let (diameter, length) = (Offset::from_um(16_000), Offset::from_um(60_000));
            let device = Cantilever::new(diameter, teeth, length, depth, ToolMaterial::Carbide);
            for height in [0, 5, 10] {
                let theirs = device.at(Real::from_int(height)).bits() as f64 / 4_294_967_296.0 / 1000.0;
                let ours = cutter(teeth).beam().deflection(f64::from(height), Load::Spread(0.0, 10.0));
                // It sums 16 slices in fixed point.
                assert!((ours / theirs - 1.0).abs() < 1e-3, "{teeth} {height}: {ours} {theirs}");
            }
        }
    }

    #[test]
    fn a_solid_shank_makes_the_cutter_stiffer_than_flutes_to_the_collet() {
        let load = Load::Spread(0.0, 10.0);
        let fluted = cutter(4).beam().deflection(0.0, load);
        let stepped = Tool { flute_length_mm: 26.0, ..cutter(4) }.beam().deflection(0.0, load);
        let solid = Tool { flute_length_mm: 0.0, ..cutter(4) }.beam().deflection(0.0, load);
        assert!(solid < stepped && stepped < fluted);
        assert!((fluted / solid - 0.75f64.powi(-4)).abs() < 1e-9);
    }
}
