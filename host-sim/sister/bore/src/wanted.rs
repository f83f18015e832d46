//! The feed for a wanted waviness.
//!
//! With equal teeth neighbouring marks meet halfway, `k·u + A(u) = π|k|/N` with `u` given by the wanted height, which is linear in
//! `k`: a closed form. With runout the height lies between that of one tooth of the longest radius and that of N such teeth;
//! these two bracket the feed, and the height rises with the feed in between. Whatever is found is put through the envelope again.

use std::f64::consts::{PI, TAU};

use super::refusal::Refusal;
use super::setup::Setup;

/// Relative accuracy of the height.
const ACCURACY: f64 = 1e-9;

/// The setup with the feed at which the height of its profile is `wanted_mm`; laps as by default.
///
/// # Errors
/// [`Refusal::OutOfReach`] when no feed gives that height; others when the setup has faults of its own.
pub fn feed_for(setup: &Setup, wanted_mm: f64) -> Result<Setup, Refusal> {
    Refusal::unless_in("wanted waviness", "mm", wanted_mm, 1e-9, 2.0 * setup.cutter.radius_mm)?;
    // Any feed will do to know the teeth: a turn of the cutter moves the centre by a ten-thousandth of a lap.
    let slow = 1e-4 * setup.rpm.abs() * TAU * setup.feed_radius();
    let mut trial = Setup { laps: None, feed_mm_per_min: slow.clamp(1e-6, 1e6), ..*setup };
    let motion = trial.motion()?;
    let teeth = trial.cutter.at(0.0, &motion);
    let longest = teeth.iter().fold(0.0, |m: f64, t| m.max(t.radius_mm));
    let feed = |teeth: u32| {
        let advance = equal_advance(motion.path_mm, longest, teeth, wanted_mm, setup.rpm > 0.0)?;
        // k = ω₁/(ω₂ − ω₁).
        Some(motion.omega2 * advance / (1.0 + advance) * 60.0 * trial.feed_radius())
    };
    let out_of_reach = || Refusal::OutOfReach { wanted_mm, largest_mm: largest(setup) };
    let fast = feed(trial.cutter.teeth).ok_or_else(out_of_reach)?;
    let slow = if setup.cutter.runout_mm == 0.0 { fast } else { feed(1).ok_or_else(out_of_reach)? };
    let mut height = |feed: f64| {
        trial.feed_mm_per_min = feed;
        trial.steady(0.0).map(|steady| steady.height_mm - wanted_mm)
    };
    let found = if slow == fast { fast } else { crossing(&mut height, slow, fast)? };
    let miss = height(found).map_err(|e| match e {
        Refusal::Apart { .. } | Refusal::Range { .. } => out_of_reach(),
        other => other,
    })?;
    if miss.abs() > 1e3 * ACCURACY * wanted_mm {
        return Err(out_of_reach());
    }
    Ok(trial)
}

/// The advance `k` at which equal teeth leave crests of a height.
fn equal_advance(path: f64, edge: f64, teeth: u32, height: f64, conventional: bool) -> Option<f64> {
    // h = 4Ra sin²(u/2)/(R + a + ρ) with ρ = R + a − h.
    let sine = (height * (2.0 * (path + edge) - height) / (4.0 * path * edge)).sqrt();
    if !(sine > 0.0 && sine < 1.0) {
        return None;
    }
    let u = 2.0 * sine.asin();
    let angle = (edge * u.sin()).atan2(path + edge * u.cos());
    let half = PI / f64::from(teeth);
    match conventional {
        true => (half > u).then(|| angle / (half - u)),
        false => Some(-angle / (half + u)).filter(|k| *k > -1.0),
    }
}

/// Where a rising function crosses zero between two places (Illinois' regula falsi).
fn crossing(value: &mut impl FnMut(f64) -> Result<f64, Refusal>, low: f64, high: f64) -> Result<f64, Refusal> {
    let (mut a, mut b) = (low, high);
    // Beyond the feed at which passes part the height counts as boundless.
    let mut value = |at: f64| match value(at) {
        Err(Refusal::Apart { .. } | Refusal::Range { .. }) => Ok(f64::INFINITY),
        other => other,
    };
    let (mut at_a, mut at_b) = (value(a)?, value(b)?);
    for _ in 0..60 {
        if at_a >= 0.0 || (b - a) <= ACCURACY * 1e-3 * b {
            return Ok(a);
        }
        if at_b <= 0.0 {
            return Ok(b);
        }
        let middle = (a * at_b - b * at_a) / (at_b - at_a);
        let middle = if middle > a && middle < b { middle } else { 0.5 * (a + b) };
        let at = value(middle)?;
        if at == 0.0 {
            return Ok(middle);
        }
        if at < 0.0 {
            (a, at_a, at_b) = (middle, at, 0.5 * at_b);
        } else {
            (b, at_b, at_a) = (middle, at, 0.5 * at_a);
        }
    }
    Ok(a)
}

/// The height at the highest feed at which passes still meet, mm.
fn largest(setup: &Setup) -> f64 {
    let (mut low, mut high) = (1e-6f64, 1e6f64);
    let mut best = 0.0;
    for _ in 0..60 {
        let feed = (low * high).sqrt();
        match (Setup { laps: None, feed_mm_per_min: feed, ..*setup }).steady(0.0) {
            Ok(steady) => {
                best = steady.height_mm;
                low = feed;
            }
            // Too slow for the limit of passes is still a wall.
            Err(Refusal::Passes { .. } | Refusal::Comparisons { .. }) => low = feed,
            Err(_) => high = feed,
        }
    }
    best
}
