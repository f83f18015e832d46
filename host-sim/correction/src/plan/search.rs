//! The search: candidates of one, two and three cuts on a coarse bench, and the front of machining time against profile error.
//!
//! What the candidates follow from:
//! * the last cut brings the middle over the height to size; every cut before leaves no height below what it is to leave, because
//!   nothing puts material back, and as little more as it can;
//! * the less a cut before leaves, the less the last one is pushed; against the direction of the program the helix leans the other
//!   way, so that what the cut before left too high is taken by another part of the tooth's way;
//! * levels as deep as an axial contact ratio of one keep the force as the cutter turns; even levels shorten the tooth's way;
//! * a thin last cut stands more feed, and so does the one before it where time is short;
//! * a spring pass, with the same commands or with its own, takes what the cut before was pushed away from.
//!
//! Which of them helps on a part is found by cutting it. Work grows with the contour's length and no further.

use rayon::prelude::*;
use truepath_core::process::Aim;
use truepath_ground::units::{float, mm};
use truepath_job::job::PlanTable;

use super::bench::{Bench, Stage};
use super::limits::keeps;
use super::process::{Cut, Levels, leaving};
use super::times::Times;

/// Design steps of a pass in the search.
const TURNS: u32 = 7;
/// What a first of several cuts may leave, um.
const LEFT_FIRST: [i64; 4] = [5, 20, 60, 150];
/// What a second of three cuts may leave, um.
const LEFT_SECOND: [i64; 3] = [2, 8, 25];
/// Feeds of a second of three cuts where at the programmed feed no time is left for a third, percent: the fastest allowed.
const SECOND_FEEDS: [u16; 3] = [200, 150, 100];
/// Feeds of a last cut, percent.
const LAST_FEEDS: [u16; 4] = [100, 150, 200, 60];
/// Feeds of a single cut, percent.
const SINGLE_FEEDS: [u16; 3] = [100, 60, 30];
/// How many of the unfinished parts are gone on with.
const KEPT: usize = 3;
/// Of how many processes on the front allowances nearby are tried.
const REFINED: usize = 3;
/// Allowances nearby, as factors.
const FINER: [[i64; 2]; 2] = [[1, 2], [7, 4]];
/// A candidate that takes longer has to be better by this share.
const WORTH: f64 = 0.96;

/// Adds what last cuts make of unfinished parts.
type Finish<'w> = dyn Fn(&[Branch], &[Cut], &mut Vec<Candidate>) + Sync + 'w;
/// What cuts leave of unfinished parts, to be gone on with.
type GoOn<'w> = dyn Fn(&[Branch], &[Cut]) -> Vec<Branch> + Sync + 'w;

/// A process that was cut.
#[derive(Clone, Debug)]
pub struct Candidate {
    /// Its cuts.
    pub cuts: Vec<Cut>,
    /// Minutes it takes.
    pub minutes: f64,
    /// Its profile error on the bench it was cut on, mm.
    pub profile_mm: f64,
}

/// An unfinished part and how it came to be.
#[derive(Clone)]
struct Branch {
    cuts: Vec<Cut>,
    stage: Stage,
    /// How much more than it is meant to it leaves anywhere, mm.
    uneven_mm: f64,
}

/// Searches among what a program can be written with, as `times` knows; `progress` is told the share done, 0…1. Candidates come in the
/// order of their time, each better than all before.
pub fn search(
    bench: &Bench,
    (limits, times): (&PlanTable, &Times<'_>),
    progress: &(dyn Fn(f64) + Sync),
) -> Vec<Candidate> {
    let setup = bench.path().setup();
    let (wall, allowance_um) = (float(setup.axial_depth), (mm(setup.allowance) * 1e3) as i64);
    let helix = bench.path().helix();
    let contact = float(helix.pitch) / float(helix.lag_per_mm);
    let deep =
        |levels: &Levels| wall / levels.count() as f64 >= limits.min_level_mm && levels.count() <= limits.max_levels;
    let contact = Levels::of_contact_ratio(contact, wall).filter(deep);
    let even: Vec<Levels> = (1..=limits.max_levels.max(1)).map(Levels::Even).filter(deep).collect();
    let every: Vec<Levels> = even.iter().copied().chain(contact).collect();
    let few: Vec<Levels> = even.iter().copied().take(2).chain(contact).collect();
    let shallow: Vec<Levels> = even.iter().copied().take(1).chain(contact).collect();
    let ways: &[bool] = if limits.reverse { &[false, true] } else { &[false] };
    let [slowest, fastest] = limits.percent;
    let allowed =
        |feeds: &[u16]| -> Vec<u16> { feeds.iter().copied().filter(|f| (slowest..=fastest).contains(f)).collect() };

    let mut found: Vec<Candidate> = Vec::new();
    let all = |branch: &Branch, cut: &Cut| -> Vec<Cut> { branch.cuts.iter().copied().chain([*cut]).collect() };
    let in_time = |minutes: &f64| times.keeps(limits, *minutes);
    let finish = |from: &[Branch], cuts: &[Cut], found: &mut Vec<Candidate>| {
        let tasks: Vec<(&Branch, &Cut)> = from.iter().flat_map(|b| cuts.iter().map(move |c| (b, c))).collect();
        let possible = |(branch, cut): (&'_ Branch, &Cut)| {
            let cuts = all(branch, cut);
            in_time(&times.at_least(&cuts)).then(|| times.of(&cuts)).flatten().filter(in_time)
        };
        let tasks: Vec<_> = tasks.into_iter().filter_map(|task| Some((task, possible(task)?))).collect();
        let cut = |((branch, cut), minutes): &((&Branch, &Cut), f64)| {
            let stage = bench.cut(branch.stage.clone(), cut, TURNS);
            let profile_mm = bench.figures(&stage.left).profile_mm;
            keeps(limits, bench, &stage).then_some(Candidate { cuts: all(branch, cut), minutes: *minutes, profile_mm })
        };
        found.extend(tasks.par_iter().filter_map(cut).collect::<Vec<_>>());
    };
    let go_on = |from: &[Branch], cuts: &[Cut]| -> Vec<Branch> {
        let tasks: Vec<(&Branch, &Cut)> = from.iter().flat_map(|b| cuts.iter().map(move |c| (b, c))).collect();
        let tasks: Vec<_> = tasks.into_iter().filter(|(b, cut)| in_time(&times.at_least(&all(b, cut)))).collect();
        let cut = |(branch, cut): &(&Branch, &Cut)| {
            let stage = bench.cut(branch.stage.clone(), cut, TURNS);
            let least = if let Aim::Least(least) = cut.aim { mm(least) } else { 0.0 };
            let uneven_mm = bench.figures(&stage.left).left_mm - least;
            keeps(limits, bench, &stage).then_some(Branch { cuts: all(branch, cut), stage, uneven_mm })
        };
        tasks.par_iter().filter_map(cut).collect()
    };
    let last = |levels: &[Levels], ways: &[bool], feeds: &[u16]| -> Vec<Cut> {
        let cut = |levels: Levels, reversed: bool, feed_percent: u16| Cut {
            levels,
            reversed,
            feed_percent,
            ..Cut::whole(Aim::Middle)
        };
        let each = |l: &Levels| {
            let l = *l;
            ways.iter().flat_map(move |w| feeds.iter().map(move |f| cut(l, *w, *f)))
        };
        levels.iter().flat_map(each).collect()
    };

    // One cut.
    let mut begun = vec![Branch { cuts: Vec::new(), stage: bench.raw(), uneven_mm: 0.0 }];
    finish(&begun, &last(&every, &[false], &allowed(&SINGLE_FEEDS)), &mut found);
    progress(0.15);
    if limits.max_cuts >= 2 {
        // Two cuts.
        let lefts = LEFT_FIRST.iter().filter(|um| **um * 10 < allowance_um * 6);
        let before = |um: i64, levels: Levels| Cut { levels, ..Cut::whole(leaving(um)) };
        let mut before: Vec<Cut> = lefts.flat_map(|um| shallow.iter().map(move |l| before(*um, *l))).collect();
        // Half the depth shortens the tooth's way where no contact ratio does.
        if let ([_, half], None) = (few.as_slice(), contact) {
            before.push(Cut { levels: *half, ..Cut::whole(leaving(LEFT_FIRST[0])) });
        }
        let mut first = go_on(&begun, &before);
        progress(0.25);
        finish(&first, &last(&even[..1], ways, &allowed(&LAST_FEEDS)), &mut found);
        progress(0.5);
        first.sort_by(|a, b| a.uneven_mm.total_cmp(&b.uneven_mm));
        first.truncate(KEPT);
        let more: Vec<Levels> = few.iter().copied().filter(|l| l.count() > 1).collect();
        finish(&first, &last(&more, ways, &allowed(&LAST_FEEDS[..3])), &mut found);
        progress(0.7);
        if limits.max_cuts >= 3 {
            // Three cuts.
            let cuts = |feed_percent: u16| -> Vec<Cut> {
                let cut = |um: i64, reversed: bool| Cut { reversed, feed_percent, ..Cut::whole(leaving(um)) };
                LEFT_SECOND.iter().flat_map(|um| ways.iter().map(move |w| cut(*um, *w))).collect()
            };
            let quickest = Cut { feed_percent: fastest.min(LAST_FEEDS[2]), ..Cut::whole(Aim::Middle) };
            let leaves_time = |branch: &Branch| {
                let cuts = [&branch.cuts[..], &[Cut::whole(leaving(LEFT_SECOND[0])), quickest]].concat();
                times.of(&cuts).is_none_or(|minutes| in_time(&minutes))
            };
            let (usual, late): (Vec<Branch>, Vec<Branch>) = first.iter().cloned().partition(leaves_time);
            let mut second = go_on(&usual, &cuts(100));
            second.extend(go_on(&late, &cuts(allowed(&SECOND_FEEDS).first().copied().unwrap_or(100))));
            progress(0.8);
            second.sort_by(|a, b| a.uneven_mm.total_cmp(&b.uneven_mm));
            second.truncate(KEPT + 1);
            finish(&second, &last(&even[..1], ways, &allowed(&LAST_FEEDS)), &mut found);
            finish(&second, &last(&more, ways, &allowed(&LAST_FEEDS[2..3])), &mut found);
            begun.extend(second);
        }
        begun.extend(first);
    }
    progress(0.9);
    refine(&begun, &mut found, limits.max_cuts, &finish, &go_on);
    progress(1.0);
    front(found)
}

/// Looks at allowances between those that were tried, of the processes on the front of several cuts, and at a spring pass behind the
/// best of each number of passes. What they begin with is taken from what has `begun`.
fn refine(begun: &[Branch], found: &mut Vec<Candidate>, max_cuts: usize, finish: &Finish<'_>, go_on: &GoOn<'_>) {
    let best = front(found.clone());
    let several = best.iter().rev().filter(|candidate| candidate.cuts.len() > 1).take(REFINED);
    let between: Vec<Vec<Cut>> = several.flat_map(|candidate| nearby(&candidate.cuts)).collect();
    let one_after_the_other = |cuts: &[Cut]| -> Vec<Candidate> {
        let Some((last, before)) = cuts.split_last() else { return Vec::new() };
        let starts = begun.iter().filter(|branch| before.starts_with(&branch.cuts));
        let start = starts.max_by_key(|branch| branch.cuts.len()).cloned();
        let rest = start.as_ref().map_or(before, |start| &before[start.cuts.len()..]);
        let so_far = rest.iter().fold(Vec::from_iter(start), |branches, cut| go_on(&branches, &[*cut]));
        let mut found = Vec::new();
        finish(&so_far, &[*last], &mut found);
        found
    };
    let springs = best.iter().filter(|candidate| candidate.cuts.len() < max_cuts).take(REFINED);
    let springs = springs.filter_map(|candidate| {
        let last = candidate.cuts.last()?;
        Some(candidate.cuts.iter().copied().chain([Cut { spring: true, ..*last }]).collect::<Vec<_>>())
    });
    let own = best.iter().filter(|candidate| candidate.cuts.len() == 1 && max_cuts > 1).take(1);
    let own = own.map(|candidate| [candidate.cuts[0], candidate.cuts[0]].to_vec());
    let all: Vec<Vec<Cut>> = between.into_iter().chain(springs).chain(own).collect();
    found.extend(all.par_iter().flat_map_iter(|cuts| one_after_the_other(cuts)).collect::<Vec<_>>());
}

/// The same cuts with other allowances left by the one before the last.
fn nearby(cuts: &[Cut]) -> Vec<Vec<Cut>> {
    let Some(at) = cuts.len().checked_sub(2) else { return Vec::new() };
    let Aim::Least(left) = cuts[at].aim else { return Vec::new() };
    let other = |[times, over]: [i64; 2]| {
        let um = (left.nm() / 1000 * times / over).max(1);
        let mut cuts = cuts.to_vec();
        cuts[at].aim = leaving(um);
        (leaving(um) != Aim::Least(left)).then_some(cuts)
    };
    FINER.into_iter().filter_map(other).collect()
}

/// Those of which none faster is as good.
fn front(mut found: Vec<Candidate>) -> Vec<Candidate> {
    found.sort_by(|a, b| a.minutes.total_cmp(&b.minutes).then(a.profile_mm.total_cmp(&b.profile_mm)));
    let mut best = f64::INFINITY;
    found.retain(|candidate| {
        let better = candidate.profile_mm < best * WORTH;
        if better {
            best = candidate.profile_mm;
        }
        better
    });
    found
}
