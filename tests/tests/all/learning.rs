//! Part after part: what a corrected part teaches about the next, when a correction is taken back, and that all of it
//! turns with the part.

use crate::learning_support::{Shop, moved};

macro_rules! demo {
    ($part:literal, $file:literal) => {
        include_str!(concat!("../../../host-sim/demo/", $part, "/", $file))
    };
}

const HELIX: [&str; 3] =
    [demo!("corner-helix", "program.nc"), demo!("corner-helix", "job.toml"), demo!("corner-helix", "plant.toml")];
const POCKET: [&str; 3] = [demo!("pocket", "program.nc"), demo!("pocket", "job.toml"), demo!("pocket", "plant.toml")];

fn shop([program, job, plant]: [&str; 3]) -> Shop {
    Shop::new(program, job, plant)
}

/// Places on the straight walls of the corner, and three more in it.
const STRAIGHT: [f64; 4] = [20.0, 32.0, 68.0, 80.0];
const WITH_CORNER: [f64; 7] = [20.0, 32.0, 46.0, 49.0, 52.0, 68.0, 80.0];

#[test]
#[ignore = "slow: more than nine seconds of processor time"]
fn three_places_in_the_corner_of_the_second_part_bring_the_third_to_a_twentieth() {
    let shop = shop(HELIX);
    let before = shop.error(None);
    let (corrected, history) = shop.first(&STRAIGHT);
    let first = shop.error(Some(&corrected));
    let learned = shop.next(&history, &corrected, &WITH_CORNER);
    let second = shop.error(Some(&learned.corrected));
    println!("{before:.4} -> {first:.4} -> {second:.4} mm");
    assert!(first < before / 8.0 && second < before / 20.0);
    let verdict = &learned.verdict;
    assert!(!verdict.rolled_back && verdict.part == 2 && verdict.measured_error_mm.places == 7);
    // What was measured is what the plant cut, as far as three heights and the noise of the probe tell.
    assert!((verdict.measured_error_mm.max_mm - first).abs() < 0.4 * first);
    let held = verdict.holdout_residual_mm.as_ref().unwrap();
    assert_eq!(held.places.len(), 1);
    assert!(held.after_mm < held.before_mm);
    assert_eq!(learned.history.parts.len(), 2);
    assert_eq!(learned.history.next_number(), 3);
}

#[test]
#[ignore = "slow: more than nine seconds of processor time"]
fn a_pocket_is_closer_after_every_part_and_the_history_survives_its_file() {
    let shop = shop(POCKET);
    let before = shop.error(None);
    let places = [15.0, 45.0, 90.0, 140.0, 180.0];
    let (corrected, history) = shop.first(&places);
    let first = shop.error(Some(&corrected));
    let text = history.text().unwrap();
    let read =
        truepath_correction::learning::History::read(&truepath_ground::diagnostics::Source::new("history.json", text))
            .unwrap();
    assert_eq!(read, history);
    let more = [15.0, 29.0, 45.0, 66.0, 90.0, 126.0, 140.0, 180.0];
    let learned = shop.next(&read, &corrected, &more);
    let second = shop.error(Some(&learned.corrected));
    let again = shop.next(&learned.history, &learned.corrected, &more);
    let third = shop.error(Some(&again.corrected));
    println!("{before:.4} -> {first:.4} -> {second:.4} -> {third:.4} mm");
    assert!(second < before / 30.0 && second < first);
    assert!(third < before / 30.0);
    assert!(!again.verdict.rolled_back);
}

#[test]
#[ignore = "slow: cargo xtask test --all"]
fn an_error_that_no_machine_of_the_model_makes_is_learned_beside_it() {
    // Edges that wear fast, an allowance that varies, compliance that is not symmetric.
    let plant = HELIX[2]
        .replace("[[0.00083, 0.00007], [0.00007, 0.00105]]", "[[0.00083, 0.00022], [-0.00010, 0.00105]]")
        .replace("seed = 2", "seed = 2\nedge_wear_per_m = 4.0\nstock_variation_mm = 0.04\nstock_wavelength_mm = 60.0");
    let mut shop = Shop::new(HELIX[0], HELIX[1], &plant);
    let places = [12.0, 20.0, 28.0, 36.0, 42.0, 45.0, 48.0, 51.0, 54.0, 60.0, 68.0, 76.0, 84.0, 92.0];
    let before = shop.error(None);
    // At the second of these chances of the probe, machine and what is beside it come to rest only by shorter steps.
    for chance in [0, 600] {
        shop.chance = chance;
        let (corrected, history) = shop.first(&places);
        let first = shop.error(Some(&corrected));
        let learned = shop.next(&history, &corrected, &places);
        let second = shop.error(Some(&learned.corrected));
        println!("{chance}: {before:.4} -> {first:.4} -> {second:.4} mm, {:?}", learned.verdict);
        let residual = learned.verdict.residual.unwrap();
        assert!(residual.max_mm > 0.002, "{chance}");
        // Touches in the corner tell of it at once: the first correction cancels most of it already.
        assert!(first < before / 30.0 && second < before / 40.0, "{chance}");
        let held = learned.verdict.holdout_residual_mm.unwrap();
        assert!(held.after_mm < before / 100.0, "{chance}: {held:?}");
    }
}

#[test]
#[ignore = "slow: cargo xtask test --all"]
fn a_machine_that_the_model_describes_leaves_nothing_to_learn_beside_it() {
    // What is left is chance of the probe: of five chances, each small, and most of them under 4 µm.
    let mut shop = shop(HELIX);
    let before = shop.error(None);
    let left = [0, 100, 200, 300, 500].map(|chance| {
        shop.chance = chance;
        let (corrected, history) = shop.first(&WITH_CORNER);
        let learned = shop.next(&history, &corrected, &WITH_CORNER);
        let residual = learned.verdict.residual.map_or(0.0, |residual| residual.max_mm);
        let error = shop.error(Some(&learned.corrected));
        println!("{chance}: beside it {residual:.4}, wall {before:.4} -> {error:.4} mm");
        assert!(residual < 0.008 && error < before / 30.0, "{chance}: {residual}, {before} -> {error}");
        residual
    });
    assert!(left.iter().filter(|residual| **residual < 0.004).count() > 2, "{left:?}");
}

#[test]
#[ignore = "slow: cargo xtask test --all"]
fn a_part_that_came_out_worse_for_no_reason_of_the_machine_takes_the_correction_back() {
    let shop = shop(HELIX);
    let (corrected, history) = shop.first(&STRAIGHT);
    let good = shop.next(&history, &corrected, &WITH_CORNER);
    let probed = shop.probe(Some(&good.corrected), &WITH_CORNER, 31);
    // The third part was clamped 0.09 mm aside before it was probed.
    let aside = moved(&probed, |x, y| (x + 0.09, y - 0.07));
    let worse = shop.learn(&good.history, &aside).unwrap();
    assert!(worse.verdict.rolled_back);
    assert!(worse.corrected.summary.warnings.iter().any(|w| w.contains("set aside")));
    // Part 2 was cut with the first correction, part 1 with none: the first correction is the better one measured.
    assert_eq!(worse.corrected.correction.nodes, corrected.correction.nodes);
    assert!(worse.history.parts[2].set_aside);
    // The next honest part goes on from there.
    let probed = shop.probe(Some(&worse.corrected), &WITH_CORNER, 32);
    let again = shop.learn(&worse.history, &probed).unwrap();
    assert!(!again.verdict.rolled_back);
    assert!(shop.error(Some(&again.corrected)) < shop.error(None) / 20.0);
}

#[test]
#[ignore = "slow: cargo xtask test --all"]
fn what_is_learned_turns_with_the_part_to_the_last_bit() {
    let shop = shop(HELIX);
    let quarter = |x: f64, y: f64| (-y, x);
    let program = HELIX[0]
        .replace("X34. Y80. M08", "X-80. Y34. M08")
        .replace("X34. Y35.", "X-35. Y34.")
        .replace("X39. Y30. I5. J0", "X-30. Y39. I0 J5.")
        .replace("X90. Y30.", "X-30. Y90.");
    let job = HELIX[1]
        .replace("stiffness_x_n_per_mm = 880", "stiffness_x_n_per_mm = 1500")
        .replace("stiffness_y_n_per_mm = 1500      ", "stiffness_y_n_per_mm = 880")
        .replacen("stiffness_y_n_per_mm = 1500", "stiffness_y_n_per_mm = 880", 1);
    let turned = Shop::new(&program, &job, HELIX[2]);
    let (corrected, _) = shop.first(&STRAIGHT);
    let texts = [shop.probe(None, &STRAIGHT, 41), shop.probe(Some(&corrected), &WITH_CORNER, 42)];
    let nodes = |shop: &Shop, texts: &[String]| {
        let measurement = shop.measured(&texts[0]);
        let routes = [truepath_job::job::Route::Program];
        let corrected =
            truepath_correction::correct::correct_pass(&shop.pass, &measurement, &[], &routes, &mut |_| ()).unwrap();
        let history = truepath_correction::learning::History::first(&shop.pass, &measurement, &corrected).unwrap();
        let learned = shop.learn(&history, &texts[1]).unwrap();
        let vectors = learned.corrected.correction.nodes.iter().map(|n| {
            let v = n.total();
            (v.x.nm(), v.y.nm())
        });
        vectors.collect::<Vec<_>>()
    };
    let one = nodes(&shop, &texts);
    let other = nodes(&turned, &texts.map(|text| moved(&text, quarter)));
    assert_eq!(one.len(), other.len());
    for ((x, y), turned) in one.into_iter().zip(other) {
        assert_eq!((-y, x), turned);
    }
}
