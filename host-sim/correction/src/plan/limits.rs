//! Whether a finishing process keeps what the job's `[plan]` table asks.

use truepath_ground::units::float;
use truepath_job::job::PlanTable;

use super::bench::{Bench, CutPass, Stage};

/// Whether the passes of a part keep the limits on load and feed.
pub fn keeps(limits: &PlanTable, bench: &Bench, stage: &Stage) -> bool {
    let fastest = bench.path().samples().iter().map(|s| float(s.feed)).fold(0.0, f64::max);
    let above = |limit: Option<f64>, value: f64| limit.is_some_and(|limit| value > limit);
    let fine = |pass: &CutPass| {
        !above(limits.max_force_n, float(pass.load.force))
            && !above(limits.max_engagement_deg, float(pass.load.engaged).to_degrees())
            && !above(limits.max_feed_mm_per_min, fastest * float(pass.order.order.feed))
            && limits.min_chip_mm.is_none_or(|least| float(pass.load.chip) >= least)
    };
    stage.passes.iter().all(fine)
}
