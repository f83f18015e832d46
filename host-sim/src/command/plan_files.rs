//! The files of planned passes: what `plan`, and `learn` from a part cut with them, may write.

use super::correction_files::CONTOURS;

/// Files that these commands may write.
pub const FILES: &[&str] = &[
    "summary.json",
    REPORT,
    PROGRAM,
    "difference.txt",
    MAP,
    NAMED,
    VERIFY,
    PLAN_HISTORY,
    PROBED,
    "planned-#.tpi",
    CONTOURS,
];
/// The written program, beside the one of its own name.
pub const PROGRAM: &str = "planned.nc";
/// Stands for that name when the folder is claimed.
const NAMED: &str = "*.planned*";
/// What touches its wall.
pub(super) const VERIFY: &str = "verify.nc";
/// The wall unrolled as it is expected.
pub(super) const MAP: &str = "wall-map.csv";
/// The page.
pub(super) const REPORT: &str = "report.html";
/// The parts so far; see [`truepath_correction::plan::history`].
pub(super) const PLAN_HISTORY: &str = "plan-history.json";
/// The points it was made from.
pub(super) const PROBED: &str = "probe-raw.txt";
