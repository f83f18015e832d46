//! What is said of batches, against what happened.

use truepath_batch::batch::{Alarm, Batch, Cause, Request};
use truepath_batch::control::Chart;
use truepath_batch::series::Series;

use crate::drawn::Shop;

fn followed(series: &Series, tolerance: f64) -> Batch {
    Batch::of(series, &Request { tolerance_mm: Some([-tolerance, tolerance]), ..Request::default() }).unwrap()
}

/// What is said after every part, as in a shop.
fn each(series: &Series, tolerance: f64) -> Vec<(u32, Batch)> {
    let upto = |n: usize| Series { parts: series.parts[..n].to_vec(), ..series.clone() };
    (2..=series.parts.len()).map(|n| (series.parts[n - 1].number, followed(&upto(n), tolerance))).collect()
}

#[test]
fn a_batch_in_which_nothing_happens_is_left_alone() {
    let (mut false_ones, mut parts) = (Vec::new(), 0);
    for seed in 0..20 {
        let warming = if seed % 2 == 0 { 0.0 } else { 0.0004 };
        let series = Shop { warming_mm: warming, ..Shop::default() }.mill(60, seed);
        for (part, batch) in each(&series, 0.1) {
            parts += 1;
            false_ones.extend(batch.alarms.into_iter().map(|alarm| (seed, part, alarm)));
        }
    }
    println!("{} of {parts}: {false_ones:?}", false_ones.len());
    assert!(false_ones.len() * 500 <= parts, "{} of {parts}: {false_ones:?}", false_ones.len());
}

#[test]
fn a_step_of_the_force_level_is_told_within_two_parts_and_named() {
    let mut told = 0;
    for seed in 100..140 {
        let at = 12 + (seed % 7) as u32;
        let series = Shop { step: Some((at, 0.10)), ..Shop::default() }.mill(at + 1, seed);
        let alarms: Vec<Alarm> = each(&series, 0.1).into_iter().flat_map(|(_, batch)| batch.alarms).collect();
        let named = |alarm: &Alarm| matches!(alarm, Alarm::Step { part, cause: Cause::ForceLevel, change } if (at..=at + 1).contains(part) && (change.value - 0.10).abs() < 0.03);
        told += usize::from(alarms.iter().any(named));
    }
    println!("{told} of 40");
    assert!(told >= 38, "{told} of 40");
}

#[test]
fn a_datum_that_moves_at_once_is_told_as_that() {
    let mut told = 0;
    for seed in 200..220 {
        let series = Shop { moved: Some((15, 0.02)), ..Shop::default() }.mill(16, seed);
        let alarms: Vec<Alarm> = each(&series, 0.1).into_iter().flat_map(|(_, batch)| batch.alarms).collect();
        told += usize::from(alarms.iter().any(|a| matches!(a, Alarm::Step { part: 15..=16, cause: Cause::Datum, .. })));
    }
    println!("{told} of 20");
    assert!(told >= 18, "{told} of 20");
}

#[test]
fn wear_is_followed_and_the_part_that_leaves_the_tolerance_foretold() {
    let (mut inside, mut all, mut off, mut ahead) = (0, 0, Vec::new(), Vec::new());
    for seed in 300..320 {
        let shop = Shop { wear: 0.003, ..Shop::default() };
        let series = shop.mill(60, seed);
        // Parts that leave ±0.03 mm: the corners, 0.3 mm of deflection at 0.3 % a part, by about part 30.
        let tolerance = 0.03;
        let leaves = |part: u32| {
            (0..series.places.len()).any(|at| {
                let own = series.at(at);
                // Its own offset, by the mean of the batch without what was drawn to move it.
                let offset = own.iter().map(|(n, d)| d - shop.level(*n) * series.places[at].deflection_mm).sum::<f64>()
                    / own.len() as f64;
                (offset + shop.level(part) * series.places[at].deflection_mm).abs() > tolerance
            })
        };
        let truth = (1..=60).find(|part| leaves(*part)).unwrap();
        let mut first = None;
        for (part, batch) in each(&series, tolerance) {
            let state = batch.states.last().unwrap();
            all += 1;
            inside += usize::from((state.force_level.value - shop.level(part)).abs() <= 2.0 * state.force_level.sigma);
            let told = batch.alarms.iter().find_map(|alarm| match alarm {
                Alarm::Leaving { part, .. } | Alarm::OutOfTolerance { part, .. } => Some(*part),
                _ => None,
            });
            first = first.or(told.map(|told| (part, told)));
        }
        let (when, told) = first.unwrap();
        off.push(i64::from(told) - i64::from(truth));
        ahead.push(i64::from(truth) - i64::from(when));
    }
    off.sort_unstable();
    println!("level within 2 sigma {inside} of {all}; told − true: {off:?}, parts ahead: {ahead:?}");
    // A single reading may be out by its noise before.
    assert!(ahead.iter().all(|parts| *parts >= 0), "{ahead:?}");
    assert!(inside * 100 >= all * 88, "{inside} of {all}");
    assert!(off[2] >= -6 && off[17] <= 6, "{off:?}");
}

/// The probe may be better or worse than the job says.
#[test]
fn the_parts_say_how_noisy_they_are() {
    for noise in [0.001, 0.006] {
        let (mut alarms, mut last) = (0, 0.0);
        for seed in 600..605 {
            let shop = Shop { noise_mm: noise, ..Shop::default() };
            let said = each(&shop.mill(40, seed), 0.2);
            // From the tenth part on.
            alarms += said.iter().filter(|(part, batch)| *part > 10 && !batch.alarms.is_empty()).count();
            last = said.last().map_or(0.0, |(_, batch)| batch.noise_mm);
        }
        println!("{noise}: {last}, {alarms} alarms");
        assert!((last / noise - 1.0).abs() < 0.35 && alarms <= 3, "{noise}: {last}, {alarms} alarms");
    }
}

#[test]
fn what_is_new_before_the_first_part_changes_nothing() {
    let series = Shop { wear: 0.004, ..Shop::default() }.mill(12, 3);
    let mut with = series.clone();
    with.parts[0].events = vec![truepath_batch::series::Event::Cutter];
    let [a, b] = [&series, &with].map(|s| followed(s, 0.2).states.pop().unwrap());
    assert_eq!((a.force_level, a.radius_lost_mm), (b.force_level, b.radius_lost_mm));
}

#[test]
fn parts_milled_since_count_and_a_new_cutter_ends_what_was_foretold() {
    let series = Shop { wear: 0.003, ..Shop::default() }.mill(24, 300);
    let leaves = |series: &Series| followed(series, 0.03).alarms.iter().any(|a| matches!(a, Alarm::Leaving { .. }));
    let part = followed(&series, 0.03).leaves_at_part.unwrap();
    let short = Series { parts: series.parts[..12].to_vec(), ..series.clone() };
    assert!(part > 24 && !leaves(&short));
    assert!(
        leaves(&Series { milled: Some((part - 2, Vec::new())), ..short.clone() })
            || followed(&short, 0.03).leaves_at_part.is_none()
    );
    let changed = Series { milled: Some((25, vec![truepath_batch::series::Event::Cutter])), ..series };
    assert!(!leaves(&changed) && followed(&changed, 0.03).leaves_at_part.is_none());
}

#[test]
fn a_new_cutter_that_is_told_is_no_alarm_and_one_that_is_not_is() {
    let with = |told: bool, seed: u64| {
        let series = Shop { wear: 0.004, cutter: Some((25, told)), ..Shop::default() }.mill(27, seed);
        let all = each(&series, 0.2).into_iter();
        all.flat_map(|(_, b)| b.alarms).filter(|a| matches!(a, Alarm::Step { part: 25..=27, .. })).count()
    };
    let silent = (400..410).map(|seed| with(true, seed)).sum::<usize>();
    let heard = (400..410).filter(|seed| with(false, *seed) > 0).count();
    println!("{silent} {heard}");
    assert!(silent == 0 && heard >= 9, "{silent} {heard}");
}

#[test]
fn every_fifth_part_touched_still_follows() {
    let shop = Shop { wear: 0.003, every: 5, ..Shop::default() };
    let (mut inside, mut all) = (0, 0);
    for seed in 500..510 {
        for (part, batch) in each(&shop.mill(51, seed), 0.2) {
            let known = batch.states.last().unwrap().force_level;
            all += 1;
            inside += usize::from((known.value - shop.level(part)).abs() <= 2.0 * known.sigma);
            assert!(known.sigma < 0.02, "{known:?}");
        }
    }
    println!("{inside} of {all}");
    assert!(inside * 100 >= all * 88, "{inside} of {all}");
}

#[test]
fn a_wild_touch_is_set_aside_and_moves_nothing() {
    let series = Shop::default().mill(12, 7);
    let mut wild = series.clone();
    wild.parts[10].readings[3].1 += 0.2;
    let [plain, with] = [&series, &wild].map(|s| followed(s, 0.1));
    let [a, b] = [&plain, &with].map(|batch| batch.states[10].clone());
    assert_eq!((a.wild, b.wild, b.step), (0, 1, false));
    // It moves nothing, and is not passed over.
    assert!(plain.alarms.is_empty());
    let told = |wild: &Series| followed(wild, 0.1).alarms;
    let last = |k: usize| Series { parts: wild.parts[..k].to_vec(), ..wild.clone() };
    assert!(matches!(
        told(&last(11))[..],
        [Alarm::OutOfTolerance { part: 11, .. }, Alarm::Wild { part: 11, readings: 1, .. }]
    ));
    // Two places of eight that are off are no wild touches.
    let mut two = Shop { places: 8, ..Shop::default() }.mill(12, 8);
    two.parts[11].readings.iter_mut().take(2).for_each(|(_, error)| *error += 0.05);
    assert!(told(&two).iter().any(|alarm| matches!(alarm, Alarm::Step { part: 12, .. })), "{:?}", told(&two));
    // The only place of a part neither.
    let mut only = Shop { places: 1, ..Shop::default() }.mill(12, 9);
    only.parts[11].readings[0].1 += 0.05;
    assert!(!told(&only).is_empty());
    assert!((a.force_level.value - b.force_level.value).abs() < 0.3 * a.force_level.sigma);
}

#[test]
fn chart_and_capability_are_those_of_the_book() {
    // Montgomery's individuals: mean, mean moving range over 1.128, three of them to either side.
    let deviations = [0.001, 0.003, 0.002, 0.004, 0.002, 0.003];
    let chart = Chart::of(&deviations, Some([-0.01, 0.01]), 100.0).unwrap();
    let sigma = (0.002 + 0.001 + 0.002 + 0.002 + 0.001) / 5.0 / 1.128;
    assert!((chart.mean_mm - 0.0025).abs() < 1e-12 && (chart.sigma_mm - sigma).abs() < 1e-12);
    assert!((chart.limits_mm[1] - (0.0025 + 3.0 * sigma)).abs() < 1e-12);
    let capable = chart.capability.unwrap();
    assert!((capable.cp - 0.02 / (6.0 * sigma)).abs() < 1e-9);
    assert!((capable.cpk - 0.0075 / (3.0 * sigma)).abs() < 1e-9);
    assert!(capable.cpk_95[0] < capable.cpk && capable.cpk < capable.cpk_95[1]);
    assert!(Chart::of(&deviations[..4], None, 100.0).is_none());
}
