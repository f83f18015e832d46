//! The edge of a ball-end cutter and the point at which it cuts a given surface (T eqs 5–9).
//!
//! The edge is where the helicoid `(R sin θ cos φ, R sin θ sin φ, Pφ/2π)` (eq 5) meets the sphere
//! `(R sin θ cos φ, R sin θ sin φ, R(1 − cos θ))` (eq 6): `R(1 − cos θ) = Pφ/2π` (eq 7), and with `tan β₀ = 2πR/P`
//! the lag of the edge is `φ = tan β₀ (1 − cos θ)` (eq 8). θ is the polar angle from the tip, φ the angle by which the
//! edge has turned there; the origin is the tip, z up the tool axis.
//!
//! A surface with the unit normal n, pointing out of the part, is touched at `centre − R n`, at the polar angle
//! `cos θ = u·n` (u the tool axis). The radius that counts for the cutting speed is `R sin θ`: nothing at the tip.
//!
//! Limits: the ball only, θ up to 90°; above that the shank touches, and there is no contact point.

mod contacts;

use std::f64::consts::{FRAC_PI_2, TAU};

use super::kinematics::Pose;
use super::machine::Machine;
use super::vector::{Vector, add_scaled, angle, unit};

pub use contacts::{ContactSpan, Contacts};

/// A ball end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BallEnd {
    radius_mm: f64,
    tan_helix: f64,
}

/// Where a ball end touches a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// The point, in the part's frame, mm.
    pub place: Vector,
    /// Polar angle from the tip, rad, 0…π/2.
    pub polar: f64,
    /// Distance from the tool axis, mm: 0 at the tip, where nothing cuts.
    pub local_radius_mm: f64,
    /// Lag of the edge behind its place at the tip, rad.
    pub lag: f64,
}

impl BallEnd {
    /// A ball of a radius above 0 mm whose edge has the helix angle `helix` at the equator, 0…75° in rad. `None` outside
    /// these ranges.
    pub fn new(radius_mm: f64, helix: f64) -> Option<Self> {
        let fits = radius_mm > 0.0 && radius_mm.is_finite() && (0.0..=75f64.to_radians() + 1e-12).contains(&helix);
        fits.then(|| Self { radius_mm, tan_helix: helix.tan() })
    }

    /// The ball end of a machine's tool, when it has one.
    pub fn of(machine: &Machine) -> Option<Self> {
        let tool = machine.tool();
        Self::new(tool.ball_radius_mm?, tool.helix_deg.to_radians())
    }

    /// Its radius, mm.
    pub fn radius_mm(&self) -> f64 {
        self.radius_mm
    }

    /// Rise of the helicoid in one turn, mm; `None` for straight edges (eq 8's `P = 2πR/tan β₀`).
    pub fn lead_mm(&self) -> Option<f64> {
        (self.tan_helix > 0.0).then(|| TAU * self.radius_mm / self.tan_helix)
    }

    /// Lag of the edge at a polar angle, rad (eq 8).
    pub fn lag(&self, polar: f64) -> f64 {
        // 1 − cos θ without cancellation.
        self.tan_helix * 2.0 * (polar / 2.0).sin().powi(2)
    }

    /// The point of the edge at a polar angle, mm, in the tool's frame (eq 9).
    pub fn edge(&self, polar: f64) -> Vector {
        let (sin, cos) = self.lag(polar).sin_cos();
        let around = self.radius_mm * polar.sin();
        [around * cos, around * sin, self.radius_mm * 2.0 * (polar / 2.0).sin().powi(2)]
    }

    /// Where the ball touches a surface whose normal points out of the part. `None` for a normal without direction, and
    /// where the shank would touch (more than 90° from the tip).
    pub fn contact(&self, pose: &Pose, normal: Vector) -> Option<Contact> {
        let normal = unit(normal)?;
        let polar = angle(pose.axis, normal);
        if polar.is_nan() || polar > FRAC_PI_2 + 1e-12 {
            return None;
        }
        let centre = add_scaled(pose.tip, pose.axis, self.radius_mm);
        Some(Contact {
            place: add_scaled(centre, normal, -self.radius_mm),
            polar,
            local_radius_mm: self.radius_mm * polar.sin(),
            lag: self.lag(polar),
        })
    }

    /// Cutting speed at a polar angle, m/min.
    pub fn speed_m_per_min(&self, polar: f64, spindle_rpm: f64) -> f64 {
        TAU * self.radius_mm * polar.sin() * spindle_rpm / 1000.0
    }
}
