//! What the height of the waviness depends on: number of teeth, feed, runout, direction, helix.

use truepath_ground::rows::ascending;

use super::depth::generatrix_wavelength;
use super::envelope::Steady;
use super::refusal::Refusal;
use super::setup::{Setup, cusp_formula};

/// One number of teeth.
#[derive(Clone, Copy, Debug, serde::Serialize)]
pub struct TeethRow {
    /// Teeth.
    pub teeth: u32,
    /// Pt with conventional milling, mm; none where passes do not meet.
    pub conventional_mm: Option<f64>,
    /// Pt with climb milling, mm.
    pub climb_mm: Option<f64>,
    /// The second-order formula for conventional milling, mm.
    pub formula_mm: f64,
    /// Feed per tooth, mm: the feed stays as it is.
    pub feed_per_tooth_mm: f64,
}

fn height(setup: &Setup) -> Option<f64> {
    setup.steady(0.0).ok().map(|steady| steady.height_mm)
}

/// Heights for 1…`most` teeth that run true, everything else unchanged.
///
/// # Errors
/// [`Refusal`] when the setup itself is out of range.
pub fn on_teeth(setup: &Setup, most: u32) -> Result<Vec<TeethRow>, Refusal> {
    let motion = setup.motion()?;
    let row = |teeth: u32| {
        let mut true_running = *setup;
        true_running.cutter.teeth = teeth;
        true_running.cutter.runout_mm = 0.0;
        let turning = |sign: f64| Setup { rpm: setup.rpm.abs() * sign, ..true_running };
        let conventional = super::motion::Motion { omega2: motion.omega2.abs(), ..motion };
        TeethRow {
            teeth,
            conventional_mm: height(&turning(1.0)),
            climb_mm: height(&turning(-1.0)),
            formula_mm: cusp_formula(&conventional, setup.cutter.radius_mm, teeth),
            feed_per_tooth_mm: true_running.feed_per_tooth(),
        }
    };
    Ok((1..=most).map(row).collect())
}

/// The exponent of the power law through heights over numbers of teeth, by least squares of logarithms.
pub fn exponent(points: impl Iterator<Item = (f64, f64)>) -> Option<f64> {
    let (mut n, mut sx, mut sy, mut sxx, mut sxy) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for (x, y) in points.filter(|p| p.0 > 0.0 && p.1 > 0.0).map(|(x, y)| (x.ln(), y.ln())) {
        n += 1.0;
        sx += x;
        sy += y;
        sxx += x * x;
        sxy += x * y;
    }
    let spread = n * sxx - sx * sx;
    (n >= 2.0 && spread > 0.0).then(|| (n * sxy - sx * sy) / spread)
}

/// One runout.
#[derive(Clone, Copy, Debug, serde::Serialize)]
pub struct RunoutRow {
    /// Offset of the axes, mm.
    pub runout_mm: f64,
    /// Pt, mm.
    #[serde(rename = "Pt_mm")]
    pub height_mm: f64,
    /// Teeth that leave a mark.
    pub cutting_teeth: usize,
    /// Largest radius of the wall, mm.
    pub largest_radius_mm: f64,
}

/// Heights for a runout from none to what leaves one tooth cutting, and for the given one; what has no wall is left
/// out. `progress` is told the share done.
///
/// # Errors
/// [`Refusal`].
pub fn on_runout(setup: &Setup, progress: &mut dyn FnMut(f64)) -> Result<Vec<RunoutRow>, Refusal> {
    let single = Setup { cutter: super::motion::Cutter { teeth: 1, runout_mm: 0.0, ..setup.cutter }, ..*setup };
    // Runout matters against what one tooth alone would leave.
    let scale = single.steady(0.0)?.height_mm;
    let mut amounts: Vec<f64> = (0..=24).map(|n| scale * 1.2 * f64::from(n * n) / 576.0).collect();
    amounts.push(setup.cutter.runout_mm);
    amounts.retain(|a| *a <= setup.cutter.radius_mm / 2.0);
    ascending(&mut amounts);
    amounts.dedup();
    let mut rows = Vec::with_capacity(amounts.len());
    for (n, runout_mm) in amounts.iter().copied().enumerate() {
        let mut with = *setup;
        with.cutter.runout_mm = runout_mm;
        if let Ok(Steady { height_mm, cutting_teeth, highest_mm }) = with.steady(0.0) {
            rows.push(RunoutRow { runout_mm, height_mm, cutting_teeth, largest_radius_mm: highest_mm });
        }
        progress((n + 1) as f64 / amounts.len() as f64);
    }
    Ok(rows)
}

/// One feed.
#[derive(Clone, Copy, Debug, serde::Serialize)]
pub struct FeedRow {
    /// Feed, mm/min, as the given one is meant.
    pub feed_mm_per_min: f64,
    /// Feed per tooth of the centre, mm.
    pub feed_per_tooth_mm: f64,
    /// Pt as the cutter turns, mm.
    #[serde(rename = "Pt_mm")]
    pub height_mm: Option<f64>,
}

/// Heights for feeds from a quarter to four times the given one.
pub fn on_feed(setup: &Setup) -> Vec<FeedRow> {
    let row = |n: i32| {
        let with = Setup { feed_mm_per_min: setup.feed_mm_per_min * (f64::from(n) / 4.0).exp2(), ..*setup };
        FeedRow {
            feed_mm_per_min: with.feed_mm_per_min,
            feed_per_tooth_mm: with.feed_per_tooth(),
            height_mm: height(&with),
        }
    };
    (-8..=8).map(row).collect()
}

/// One helix angle.
#[derive(Clone, Copy, Debug, serde::Serialize)]
pub struct HelixRow {
    /// Helix angle, degrees.
    pub helix_deg: f64,
    /// How far the profile turns along the travel over 1 mm of height, degrees.
    pub turn_deg_per_mm: f64,
    /// Distance of marks along a generatrix, mm; none for straight teeth.
    pub wavelength_mm: Option<f64>,
}

/// The turn of the profile for common helix angles and the given one; the height of the waviness stays.
///
/// # Errors
/// [`Refusal`].
pub fn on_helix(setup: &Setup) -> Result<Vec<HelixRow>, Refusal> {
    let motion = setup.motion()?;
    let mut angles = vec![0.0, 15.0, 30.0, 38.0, 45.0, 60.0, setup.cutter.helix_deg];
    ascending(&mut angles);
    angles.dedup();
    let row = |helix_deg: f64| {
        let mut with = *setup;
        with.cutter.helix_deg = helix_deg;
        HelixRow {
            helix_deg,
            turn_deg_per_mm: (motion.advance() * with.cutter.lag(1.0, &motion)).to_degrees(),
            wavelength_mm: generatrix_wavelength(&with),
        }
    };
    Ok(angles.into_iter().map(row).collect())
}
