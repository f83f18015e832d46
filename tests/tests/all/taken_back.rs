//! What a correction that is taken back to an earlier one is worth: it stands under the guard of the job, and where no
//! correction is better than any, that is said.

use crate::learning_support::{Shop, moved};

const DEMO: [&str; 3] = [
    include_str!("../../../host-sim/demo/corner-helix/program.nc"),
    include_str!("../../../host-sim/demo/corner-helix/job.toml"),
    include_str!("../../../host-sim/demo/corner-helix/plant.toml"),
];
const STRAIGHT: [f64; 4] = [20.0, 32.0, 68.0, 80.0];
const WITH_CORNER: [f64; 7] = [21.0, 33.0, 45.0, 49.0, 53.0, 69.0, 81.0];

#[test]
#[ignore = "slow: cargo xtask test --all"]
fn a_correction_that_is_used_again_stands_under_the_guard_of_the_job() {
    let shop = Shop::new(DEMO[0], DEMO[1], DEMO[2]);
    let (corrected, history) = shop.first(&STRAIGHT);
    let good = shop.next(&history, &corrected, &WITH_CORNER);
    let probed = shop.probe(Some(&good.corrected), &WITH_CORNER, 31);
    let aside = moved(&probed, |x, y| (x + 0.09, y - 0.07));
    // The guard is new in the job: the first correction knew none.
    let limit = 0.05;
    let guarded = Shop::new(DEMO[0], &format!("{}\nmax_gouge_mm = {limit}\n", DEMO[1]), DEMO[2]);
    let worse = guarded.learn(&good.history, &aside).unwrap();
    assert!(worse.verdict.rolled_back);
    assert!(worse.verdict.used_again.unwrap().corrected);
    let correction = &worse.corrected.correction;
    assert_eq!(correction.unguarded, corrected.correction.nodes);
    assert_ne!(correction.nodes, corrected.correction.nodes);
    let deepest = |correction: &truepath_correction::correction::Correction| {
        let walls = correction.predicted.iter().map(|p| p.after).filter(|wall| wall.on_wall);
        walls.map(|wall| (wall.margin() - wall.deepest()).nm() as f64 / 1e6).fold(0.0, f64::max)
    };
    assert!(deepest(&corrected.correction) > limit + 0.01, "{}", deepest(&corrected.correction));
    assert!(deepest(correction) < limit + 0.001, "{}", deepest(correction));
    let warnings = &worse.corrected.summary.warnings;
    assert!(warnings.iter().any(|w| w.contains("the correction that is used again goes")), "{warnings:?}");
    // What is milled next is the correction that was taken back, and the history says so.
    let held = |wanted: &[truepath_core::correct::Node]| wanted == worse.history.next.correction.nodes().unwrap();
    assert!(held(&correction.nodes));
}

#[test]
#[ignore = "slow: cargo xtask test --all"]
fn going_back_to_the_first_part_is_said_to_be_no_correction() {
    let shop = Shop::new(DEMO[0], DEMO[1], DEMO[2]);
    let (corrected, history) = shop.first(&STRAIGHT);
    let probed = shop.probe(Some(&corrected), &WITH_CORNER, 31);
    // Clamped so far aside that the part is worse than the first, which no correction was applied to.
    let aside = moved(&probed, |x, y| (x + 0.75, y - 0.7));
    let worse = shop.learn(&history, &aside).unwrap();
    assert!(worse.verdict.rolled_back);
    let again = worse.verdict.used_again.unwrap();
    assert!(again.part == 1 && !again.corrected, "{again:?}");
    assert!(worse.corrected.correction.nodes.iter().all(|node| node.total() == truepath_core::geometry::Vector::ZERO));
    let warnings = &worse.corrected.summary.warnings;
    assert!(
        warnings.iter().any(|w| w.contains("the next part is cut without correction, as part 1 was")),
        "{warnings:?}"
    );
    // That part is as wrong as the first one, and the next correction starts from it.
    assert!((shop.error(Some(&worse.corrected)) - shop.error(None)).abs() < 0.002);
    let probed = shop.probe(Some(&worse.corrected), &WITH_CORNER, 32);
    let again = shop.learn(&worse.history, &probed).unwrap();
    // As good as that of a part nobody has spoilt.
    let (fresh, _) = shop.first(&WITH_CORNER);
    let [again, fresh, uncorrected] = [Some(&again.corrected), Some(&fresh), None].map(|part| shop.error(part));
    println!("{again:.4} {fresh:.4} {uncorrected:.4}");
    // Two draws of the noise differ by that much.
    assert!(again < fresh + 0.012 && again < uncorrected / 15.0, "{again} {fresh} {uncorrected}");
}
