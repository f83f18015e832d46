//! Travel of the joints: which one a position takes beyond its end.

use super::{Joints, Machine};

/// Positions beyond the end of a travel by less than this (mm, degrees) are rounding.
const ROUNDING: f64 = 1e-9;

/// A joint beyond the end of its travel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Beyond {
    /// Its letter: X, Y, Z, A, B or C.
    pub letter: char,
    /// Where it should go, mm or degrees.
    pub position: f64,
    /// Its travel.
    pub travel: [f64; 2],
}

impl Machine {
    /// The first joint that a position takes beyond its travel.
    pub fn beyond(&self, joints: &Joints) -> Option<Beyond> {
        let linear = ['X', 'Y', 'Z'].into_iter().zip(joints.xyz).zip(self.travel_mm);
        let letters = self.rotary.map(|axis| axis.letter.name());
        let rotary = letters.into_iter().zip(joints.rotary_deg()).zip(self.rotary.map(|axis| axis.limits_deg));
        linear.chain(rotary).find_map(|((letter, position), travel)| {
            let travel = travel?;
            let inside = position >= travel[0] - ROUNDING && position <= travel[1] + ROUNDING;
            (!inside).then_some(Beyond { letter, position, travel })
        })
    }
}
