//! All times at which a tooth is on a given line through the axis: the roots of Urinov 2020, eqs 5 to 7.
//!
//! Dividing by sin φ and cos φ, as the paper does, loses the rays along the axes and mixes the ray with its opposite. Here a
//! root is a place on one of the monotone pieces of a pass ([`super::arc`]) where its polar angle is φ (on the ray) or φ + π (on
//! the opposite one); every piece is searched once for every multiple of π it spans, so none is missed and the work is bounded
//! by three pieces a pass. A ray that touches a pass where it turns back is a double root and is counted as rounding decides.

use std::f64::consts::PI;

use super::passes::Passes;

/// A tooth on the line.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Root {
    /// When, s from the beginning of the circle; a pass at either end of the cut may reach beyond it.
    pub tau_s: f64,
    /// Which tooth, from 1.
    pub tooth: usize,
    /// `x sin φ + y cos φ`, mm: negative on the opposite ray.
    pub radius_mm: f64,
    /// Whether the tooth is on the ray φ itself.
    pub on_ray: bool,
    /// Whether this root is the wall.
    pub chosen: bool,
}

/// All roots on the line of φ, by time.
pub fn roots(passes: &Passes, phi: f64) -> Vec<Root> {
    let relative = passes.motion.omega2 - passes.motion.omega1;
    let mut found = Vec::new();
    for pass in &passes.passes {
        let arc = passes.arc(pass);
        let turn = arc.turn();
        let pieces: &[(f64, f64)] = if turn < PI { &[(-PI, -turn), (-turn, turn), (turn, PI)] } else { &[(-PI, PI)] };
        for &(from, to) in pieces {
            let (a, b) = (arc.angle(from), arc.angle(to));
            let (low, high) = (a.min(b), a.max(b));
            // φ − crest + nπ within (low, high]: half open, so that a root where two pieces join is found once.
            let offset = phi - pass.crest;
            let first = ((low - offset) / PI).floor() as i64 + 1;
            let last = ((high - offset) / PI).floor() as i64;
            for n in first..=last {
                let u = arc.solve(offset + n as f64 * PI, from, to, f64::NAN);
                let on_ray = n.rem_euclid(2) == 0;
                let radius_mm = if on_ray { arc.radius(u) } else { -arc.radius(u) };
                let tau_s = pass.tau + u / relative;
                found.push(Root { tau_s, tooth: pass.tooth + 1, radius_mm, on_ray, chosen: false });
            }
        }
    }
    found.sort_by(|a, b| a.tau_s.total_cmp(&b.tau_s));
    if let Some(wall) = found.iter_mut().filter(|r| r.on_ray).max_by(|a, b| a.radius_mm.total_cmp(&b.radius_mm)) {
        wall.chosen = true;
    }
    found
}
