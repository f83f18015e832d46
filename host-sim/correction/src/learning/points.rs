//! A touched point as a history keeps it.

use serde::{Deserialize, Serialize};
use truepath_core::geometry::Direction;
use truepath_core::identify::Observation;
use truepath_core::units::{Offset, Real};
use truepath_ground::units::{float, mm, nm};

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
}

impl Point {
    /// Of an observation.
    pub fn of(o: &Observation) -> Self {
        Self {
            s_mm: mm(o.s),
            height: float(o.height),
            error_mm: mm(o.error),
            normal: [float(o.normal.x), float(o.normal.y)],
        }
    }

    /// As an observation again, with the standard deviation of its measurement.
    pub fn observation(&self, noise: Offset) -> Observation {
        let [x, y] = self.normal.map(real);
        Observation::new(nm(self.s_mm), real(self.height), nm(self.error_mm), noise, Direction { x, y })
    }

    /// Whether it can be one: on a contour, within the engaged depth, with a normal of one.
    pub(super) fn is_sound(&self) -> bool {
        let [x, y] = self.normal;
        (-1e5..=1e7).contains(&self.s_mm)
            && (-0.5..=1.5).contains(&self.height)
            && self.error_mm.abs() <= 100.0
            && (0.9..=1.1).contains(&x.hypot(y))
    }
}

fn real(v: f64) -> Real {
    Real::from_bits((v * 4_294_967_296.0).round() as i64)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn a_point_comes_back_from_its_text(s in -1_000_000_000i64..10_000_000_000, e in -900_000i64..900_000,
                                           h in 0i64..(1 << 32), x in -(1i64 << 32)..(1 << 32)) {
            let normal = Direction { x: Real::from_bits(x), y: Real::from_bits(-h) };
            let noise = Offset::from_nm(2000);
            let o = Observation::new(Offset::from_nm(s), Real::from_bits(h), Offset::from_nm(e), noise, normal);
            let text = serde_json::to_string(&Point::of(&o)).unwrap();
            let point: Point = serde_json::from_str(&text).unwrap();
            prop_assert_eq!(point.observation(noise), o);
        }
    }
}
