//! A touched point as a history keeps it.

use serde::{Deserialize, Serialize};
use truepath_core::geometry::Direction;
use truepath_core::identify::Observation;
use truepath_core::units::Offset;
use truepath_ground::units::{float, mm, nm, real};

/// A touched point of a part. Every number is exact: nanometres have six decimals, and the others fit into a `f64`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Point {
    /// Arc length of the contour, mm; one for all heights of a place.
    pub s_mm: f64,
    /// Height above the tip as a share of the engaged depth, 0…1.
    pub height: f64,
    /// Measured wall error, mm: positive, material left.
    pub error_mm: f64,
    /// Nominal normal towards the wall.
    pub normal: [f64; 2],
    /// Arc length of the wall across, mm, where the error is the mean of two walls: half of what a width shows.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub across_s_mm: Option<f64>,
    /// Number of the pair of which it is a half, where the error is the mean of two walls of two contours; that contour's points
    /// have the other one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pair: Option<u32>,
    /// Standard deviation of its measurement, mm, where it is not that of the points of its part.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub noise_mm: Option<f64>,
}

impl Point {
    /// Of an observation; `noise` is the standard deviation of the points of its part.
    pub fn of(o: &Observation, noise: Offset) -> Self {
        Self {
            s_mm: mm(o.s),
            height: float(o.height),
            error_mm: mm(o.error),
            normal: [float(o.normal.x), float(o.normal.y)],
            across_s_mm: o.across().map(mm),
            pair: o.pair(),
            noise_mm: (o.noise != noise).then(|| mm(o.noise)),
        }
    }

    /// As an observation again; `noise` is the standard deviation of the points of its part.
    pub fn observation(&self, noise: Offset) -> Observation {
        let [x, y] = self.normal.map(real);
        let noise = self.noise_mm.map_or(noise, nm);
        let point = Observation::new(nm(self.s_mm), real(self.height), nm(self.error_mm), noise, Direction { x, y });
        let point = self.across_s_mm.map_or(point, |across| point.with_across(nm(across)));
        self.pair.map_or(point, |pair| point.paired(pair))
    }

    /// Whether it can be one: on a contour, within the engaged depth, with a normal of one.
    pub(super) fn is_sound(&self) -> bool {
        let [x, y] = self.normal;
        (-1e5..=1e7).contains(&self.s_mm)
            && (-0.5..=1.5).contains(&self.height)
            && self.error_mm.abs() <= 100.0
            && (0.9..=1.1).contains(&x.hypot(y))
            && self.across_s_mm.is_none_or(|across| (-1e5..=1e7).contains(&across))
            && self.noise_mm.is_none_or(|noise| noise > 0.0 && noise <= 1.0)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use truepath_core::units::Real;

    use super::*;

    proptest! {
        #[test]
        fn a_point_comes_back_from_its_text(s in -1_000_000_000i64..10_000_000_000, e in -900_000i64..900_000,
                                           h in 0i64..(1 << 32), x in -(1i64 << 32)..(1 << 32),
                                           across in prop::option::of(-1_000_000_000i64..10_000_000_000),
                                           pair in prop::option::of(any::<u32>()),
                                           its_noise in 1_000i64..4_000) {
            let normal = Direction { x: Real::from_bits(x), y: Real::from_bits(-h) };
            let (noise, its_noise) = (Offset::from_nm(2000), Offset::from_nm(its_noise));
            let o = Observation::new(Offset::from_nm(s), Real::from_bits(h), Offset::from_nm(e), its_noise, normal);
            let o = across.map_or(o, |across| o.with_across(Offset::from_nm(across)));
            let o = pair.map_or(o, |pair| o.paired(pair));
            let text = serde_json::to_string(&Point::of(&o, noise)).unwrap();
            let point: Point = serde_json::from_str(&text).unwrap();
            prop_assert_eq!(point.observation(noise), o);
        }
    }
}
