//! Where a ball end touches a plane surface over a program: the span of polar angles, cutting radii and lags.
//!
//! Taken at the ends of the moves, in constant memory. Near the tip the cutting radius goes to zero: the tool rubs where it
//! should cut, which the smallest radius shows.

use serde::Serialize;

use super::super::machine::{Joints, Machine};
use super::super::vector::Vector;
use super::BallEnd;

/// The span of what was found.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ContactSpan {
    /// Ends of moves at which the ball touches.
    pub places: u64,
    /// Ends of moves at which the shank would touch, more than 90° from the tip.
    pub on_shank: u64,
    /// Smallest and largest polar angle from the tip, degrees.
    pub polar_deg: [f64; 2],
    /// Smallest and largest distance of the contact point from the tool axis, mm.
    pub cutting_radius_mm: [f64; 2],
    /// Smallest and largest lag of the edge at the contact point, degrees.
    pub lag_deg: [f64; 2],
}

/// Follows the contact point of a ball end on a surface of one normal.
#[derive(Clone, Debug)]
pub struct Contacts {
    ball: BallEnd,
    normal: Vector,
    span: ContactSpan,
}

impl Contacts {
    /// For the tool of a machine and a normal that points out of the part; `None` without a ball end or a direction.
    pub fn new(machine: &Machine, normal: Vector) -> Option<Self> {
        let ball = BallEnd::of(machine)?;
        let long = normal.iter().all(|x| x.is_finite()) && normal.iter().any(|x| x.abs() > 1e-6);
        let none = [f64::INFINITY, f64::NEG_INFINITY];
        let span = ContactSpan { places: 0, on_shank: 0, polar_deg: none, cutting_radius_mm: none, lag_deg: none };
        long.then_some(Self { ball, normal, span })
    }

    /// Takes in a position.
    pub fn add(&mut self, machine: &Machine, joints: &Joints) {
        let Some(contact) = self.ball.contact(&machine.forward(joints), self.normal) else {
            self.span.on_shank += 1;
            return;
        };
        self.span.places += 1;
        let widen = |span: &mut [f64; 2], x: f64| *span = [span[0].min(x), span[1].max(x)];
        widen(&mut self.span.polar_deg, contact.polar.to_degrees());
        widen(&mut self.span.cutting_radius_mm, contact.local_radius_mm);
        widen(&mut self.span.lag_deg, contact.lag.to_degrees());
    }

    /// The span so far; `None` before the ball has touched.
    pub fn span(&self) -> Option<ContactSpan> {
        (self.span.places > 0).then_some(self.span)
    }
}
