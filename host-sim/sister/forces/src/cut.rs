//! One cut under a dynamometer: cutter, engagement, feed and speed, and the integrals its mean forces are made of.
//!
//! Frame of Altintas, Manufacturing Automation (2nd ed.), ch. 2: feed along the travel of the cutter, across to the left of it,
//! spindle clockwise seen from above. Immersion φ is measured clockwise from the direction across, so that a tooth cuts most
//! at 90°, ahead of the cutter: up (conventional) milling begins at 0°, down (climb) milling ends at 180°, a slot has all of it.
//! Forces are those on the tool: feed `−Ft cos φ − Fr sin φ`, across `Ft sin φ − Fr cos φ`.

use std::f64::consts::{PI, TAU};

/// Cells of two points (Gauss) in a mean over the engaged arc.
const CELLS: usize = 32;

/// A cut at constant engagement.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Cut {
    /// Diameter of the cutter, mm.
    pub diameter_mm: f64,
    /// Teeth, equally pitched.
    pub teeth: u32,
    /// Helix angle, degrees.
    pub helix_deg: f64,
    /// Axial depth, mm.
    pub axial_depth_mm: f64,
    /// Immersion at which a tooth enters and leaves, rad, 0…π.
    pub arc_rad: [f64; 2],
    /// Feed per tooth, mm.
    pub feed_per_tooth_mm: f64,
    /// Spindle speed, rev/min.
    pub spindle_rpm: f64,
}

/// Part of a force per unit of depth that goes with one coefficient, as a function of the chip thickness h, mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Term {
    /// `h`: its coefficient is in N/mm².
    Chip,
    /// 1, of the edge: its coefficient is in N/mm.
    Edge,
    /// `h·(h/0.05 mm)^(−m)`: N/mm² at a chip of 0.05 mm.
    Power(f64),
    /// `h₀(1 − exp(−h/h₀))`: N/mm² at the thinnest chip.
    Saturating(f64),
}

/// Chip at which the coefficient of a power law is stated, mm; that of the virtual machine.
pub const REFERENCE_CHIP_MM: f64 = 0.05;

impl Term {
    /// The force per unit depth and coefficient at a chip of `h` mm; nothing without a chip.
    pub fn at(self, h: f64) -> f64 {
        match self {
            _ if h <= 0.0 => 0.0,
            Self::Chip => h,
            Self::Edge => 1.0,
            Self::Power(m) => h.powf(1.0 - m) * REFERENCE_CHIP_MM.powf(m),
            Self::Saturating(h0) => -h0 * (-h / h0).exp_m1(),
        }
    }
}

/// `N·b/2π · ∫ g(f sin φ)·{cos φ, sin φ, 1} dφ` over the engaged arc.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Integrals {
    /// With cos φ.
    pub cos: f64,
    /// With sin φ.
    pub sin: f64,
    /// With 1, for the torque.
    pub one: f64,
}

impl Cut {
    /// Radius, mm.
    pub fn radius_mm(&self) -> f64 {
        0.5 * self.diameter_mm
    }

    /// Time of a revolution, s.
    pub fn revolution_s(&self) -> f64 {
        60.0 / self.spindle_rpm
    }

    /// Lag of the edge per height, rad/mm.
    pub fn lag_rad_per_mm(&self) -> f64 {
        self.helix_deg.to_radians().tan() / self.radius_mm()
    }

    /// The mean of a term over a revolution. The helix has no part in it.
    pub fn mean(&self, term: Term) -> Integrals {
        let [a, b] = self.arc_rad;
        let f = self.feed_per_tooth_mm;
        let scale = f64::from(self.teeth) * self.axial_depth_mm / TAU;
        let between = |antiderivative: &dyn Fn(f64) -> f64| scale * (antiderivative(b) - antiderivative(a));
        match term {
            // Altintas, eqs (2.21)–(2.23).
            Term::Edge => Integrals { cos: between(&f64::sin), sin: between(&|x| -x.cos()), one: between(&|x| x) },
            Term::Chip => Integrals {
                cos: f * between(&|x| -0.25 * (2.0 * x).cos()),
                sin: f * between(&|x| 0.5 * x - 0.25 * (2.0 * x).sin()),
                one: f * between(&|x| -x.cos()),
            },
            Term::Power(_) | Term::Saturating(_) => {
                let mut sum = Integrals::default();
                for k in 0..2 * CELLS {
                    // Denser towards the ends, where a power of the chip has no slope.
                    let off = if k % 2 == 0 { -0.5 } else { 0.5 } / 3f64.sqrt();
                    let u = ((k / 2) as f64 + 0.5 + off) / CELLS as f64;
                    let phi = a + (b - a) * u * u * (3.0 - 2.0 * u);
                    let weight = scale * (b - a) * 3.0 * u * (1.0 - u) / CELLS as f64;
                    let (s, c) = phi.sin_cos();
                    let g = weight * term.at(f * s);
                    sum.cos += g * c;
                    sum.sin += g * s;
                    sum.one += g;
                }
                sum
            }
        }
    }

    /// Chip thickness averaged over the engaged arc, mm.
    pub fn mean_chip_mm(&self) -> f64 {
        let [a, b] = self.arc_rad;
        self.feed_per_tooth_mm * (a.cos() - b.cos()) / (b - a)
    }

    /// Teeth in the cut at once, as a mean over the depth.
    pub fn teeth_engaged(&self) -> f64 {
        let [a, b] = self.arc_rad;
        f64::from(self.teeth) * (b - a + self.lag_rad_per_mm() * self.axial_depth_mm) / TAU
    }

    /// Whether the whole circumference ahead of the cutter is in the material.
    pub fn is_slot(&self) -> bool {
        let [a, b] = self.arc_rad;
        a < 1e-3 && b > PI - 1e-3
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cut() -> Cut {
        Cut {
            diameter_mm: 20.0,
            teeth: 6,
            helix_deg: 30.0,
            axial_depth_mm: 10.0,
            arc_rad: [0.0, 45.573f64.to_radians()],
            feed_per_tooth_mm: 400.0 / 9000.0,
            spindle_rpm: 1500.0,
        }
    }

    #[test]
    fn the_general_mean_meets_the_closed_one_where_both_hold() {
        for arc_rad in [[0.0, PI], [0.0, 0.8], [2.1, PI], [0.4, 2.0]] {
            let cut = Cut { arc_rad, ..cut() };
            let apart = |a: Integrals, b: Integrals| {
                [a.cos - b.cos, a.sin - b.sin, a.one - b.one].into_iter().fold(0.0, |m: f64, d| m.max(d.abs()))
            };
            let (power, chip) = (cut.mean(Term::Power(0.0)), cut.mean(Term::Chip));
            assert!(apart(power, chip) < 1e-5, "{power:?} {chip:?}");
            let (late, chip) = (cut.mean(Term::Saturating(1e4)), cut.mean(Term::Chip));
            assert!(apart(late, chip) < 1e-5, "{late:?} {chip:?}");
        }
    }

    #[test]
    fn a_slot_has_the_means_of_the_textbook() {
        let slot = Cut { teeth: 2, axial_depth_mm: 3.0, arc_rad: [0.0, PI], feed_per_tooth_mm: 0.125, ..cut() };
        let (chip, edge) = (slot.mean(Term::Chip), slot.mean(Term::Edge));
        assert!((958.86 * chip.sin + 15.758 * edge.sin - 209.882).abs() < 0.002);
        assert!((250.863 * chip.sin + 19.434 * edge.sin - 84.152).abs() < 0.002);
        assert!(chip.cos.abs() < 1e-12 && edge.cos.abs() < 1e-12);
    }

    #[test]
    fn down_milling_has_the_published_mean() {
        // D20, 6 teeth, 10 mm deep, 45.573° at the wall, climb: 139.83 N along the feed, 264.95 N across.
        let down = Cut { arc_rad: [PI - 45.573f64.to_radians(), PI], ..cut() };
        let (chip, edge) = (down.mean(Term::Chip), down.mean(Term::Edge));
        let (kt, ke, rt, re) = (958.86, 15.758, 250.863, 19.434);
        let feed = -(kt * chip.cos + ke * edge.cos) - (rt * chip.sin + re * edge.sin);
        let across = kt * chip.sin + ke * edge.sin - (rt * chip.cos + re * edge.cos);
        assert!((feed - 139.83).abs() < 0.02 && (across - 264.95).abs() < 0.02, "{feed} {across}");
    }
}
