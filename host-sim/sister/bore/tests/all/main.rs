//! Bores of a circling cutter: the reference numbers to all their digits, and the same found by brute force.

mod dependence;
mod envelope;
mod parameters;
mod reference;

use std::f64::consts::PI;

use truepath_bore::envelope::Profile;
use truepath_bore::motion::{Cutter, Motion};
use truepath_bore::passes::Passes;
use truepath_bore::setup::{FeedAt, Setup};

/// R = 80, r = 10, ω₁ = 0.1; the case of Urinov 2020.
fn paper(omega2: f64, teeth: u32) -> Profile {
    let motion = Motion::new(80.0, 0.1, omega2).expect("in range");
    let teeth = Cutter::plain(10.0, teeth).at(0.0, &motion);
    Profile::of(Passes::new(motion, teeth, None).expect("a wall")).expect("closes")
}

/// The paper's case as it is set on a machine: F480 at the centre, 10 rad/s.
fn setup(teeth: u32) -> Setup {
    Setup {
        hole_mm: 90.0,
        cutter: Cutter::plain(10.0, teeth),
        feed_mm_per_min: 480.0,
        feed_at: FeedAt::Centre,
        rpm: 300.0 / PI,
        laps: None,
    }
}
