//! The plan of a program that touches the stock, before the finishing pass.
//!
//! What roughing has left is no parameter of a machine: no place tells it for another. So the places are spread along the contour,
//! evenly but for one in the middle of each inside corner, where a roughing cutter gives way most. The wall that is expected
//! is the nominal one and the allowance on it; the stock may differ from that by a margin, from which stand-off, search and proof
//! follow.

use std::collections::BTreeMap;

use truepath_ground::diagnostics::{Failure, InputError};
use truepath_ground::units::mm;
use truepath_job::pass::{Pass, PathBuffer};

use super::candidates::{Form, Site, StockWall};
use super::plan::{Place, Plan, in_short, name, other_offset};
use super::probing_setup::ProbingSetup;
use super::reason;
use super::settings::Settings;
use crate::codes::V001;

/// Heights that are usual.
pub const STOCK_HEIGHTS: u32 = 2;
/// Way along the contour that is usual for a place, in cutter diameters: of the shortest waves that a roughing cutter of the
/// same size leaves, some four diameters long, five places tell.
const WAY: f64 = 0.75;
/// Places that are usual, at least and at most.
const USUAL: (u32, u32) = (12, 40);
/// How far the stock may be from the expected one, unless the user says it: a share of the allowance, and mm.
const MARGIN: (f64, f64) = (0.5, 0.3);
/// Share of the places that corners may have.
const CORNERS: f64 = 0.5;

/// A contour with the places where its stock may be touched.
struct Wall<'a> {
    pass: &'a Pass,
    setup: ProbingSetup,
    stock: StockWall,
    sites: Vec<Site>,
    length_mm: f64,
}

/// Plans the touches of the stock of the contours of a part; `places` in all, where the user says how many, and stock no farther
/// than `margin` from the allowance, mm.
///
/// # Errors
/// As [`super::plan`]; `V001` for a margin out of range.
pub fn plan_stock(
    passes: &[Pass],
    settings: &Settings,
    (places, margin): (Option<u32>, Option<f64>),
) -> Result<Plan, Failure> {
    let (mut walls, mut refused, mut warnings) = (Vec::<Wall<'_>>::new(), None, Vec::new());
    let mut kept_off = BTreeMap::new();
    // One for all: the program has one stand-off.
    let usual = |pass: &Pass| (MARGIN.0 * mm(pass.core.setup.allowance)).max(MARGIN.1);
    let margin = margin.unwrap_or_else(|| passes.iter().map(usual).fold(0.0, f64::max));
    for pass in passes {
        let others: Vec<&Pass> = passes.iter().filter(|other| !std::ptr::eq(*other, pass)).collect();
        let mut found = || {
            let (setup, stock) = before(pass, settings, margin)?;
            let mut buffer = PathBuffer::default();
            let path = pass.sample(&mut buffer)?;
            let (sites, kept) = setup.stock_sites(pass, &path, stock, &others)?;
            for (reason, count) in kept {
                *kept_off.entry(reason).or_insert(0) += count;
            }
            Ok(Wall { pass, setup, stock, sites, length_mm: mm(path.length()) })
        };
        match found() {
            Ok(wall) => match walls.first().filter(|first| !first.setup.shares_offset(&wall.setup)) {
                Some(first) => warnings.push(other_offset(pass, first.pass).into()),
                None => walls.push(wall),
            },
            Err(failure) if passes.len() > 1 => {
                warnings.push(format!("{} is not touched: {}", name(pass), in_short(&failure)).into());
                refused = refused.or(Some(failure));
            }
            Err(failure) => return Err(failure),
        }
    }
    let nothing = || Failure::Internal("a plan of no contour".to_owned());
    let usual = || {
        let way = |wall: &Wall<'_>| wall.length_mm / (WAY * 2.0 * mm(wall.pass.core.setup.radius));
        (walls.iter().map(way).sum::<f64>().ceil() as u32).clamp(USUAL.0, USUAL.1)
    };
    let count = places.unwrap_or_else(usual);
    let settings = Settings { places: count, ..settings.clone() };
    let all: f64 = walls.iter().map(|wall| wall.length_mm).sum();
    let several = passes.len() > 1;
    let mut plans = Vec::new();
    for wall in walls {
        let share = (f64::from(count) * wall.length_mm / all).round().max(2.0) as usize;
        let unit = wall.pass.unit();
        let chosen = spread(&wall.sites, share, wall.setup.apart());
        let place = |(rank, site): (usize, &Site)| Place {
            contour: several.then(|| name(wall.pass)),
            s_mm: mm(site.s),
            line: site.line,
            wall: site.wall,
            normal: site.normal.map(|v| -v),
            what: reason::place(site, unit),
            why: format!(
                "{}, {:.3} {in_unit} of stock expected, at most {:.3} {in_unit} more or less",
                if matches!(site.form, Form::InsideArc(_)) {
                    "a roughing cutter gives way most in a corner"
                } else {
                    "uneven stock shows between neighbours"
                },
                unit.of(wall.stock.expected),
                unit.of(margin),
                in_unit = unit.name()
            ),
            rank,
            gain: None,
            heights: wall.setup.heights.clone(),
        };
        let places = chosen.iter().map(|at| &wall.sites[*at]).enumerate().map(place).collect();
        // The ball comes down before the largest stock, and is led on to behind the least.
        let (clearance, overtravel) = (settings.clearance + margin, settings.overtravel + margin);
        let settings = Settings { clearance, overtravel, ..settings.clone() };
        plans.push(Plan { before_the_pass: true, ..Plan::of(wall.setup, wall.pass, &settings, places) });
    }
    let mut plan = Plan::joint(plans).ok_or_else(|| refused.unwrap_or_else(nothing))?;
    plan.kept_off = kept_off;
    plan.warnings.extend(warnings);
    if plan.places.len() < count as usize {
        let said = format!("{} places instead of {count}: no more of them may be touched", plan.places.len());
        plan.warnings.push(said.into());
    }
    if settings.free_width.is_some() {
        plan.warnings.push("--free-width is taken on trust: nothing else than the contour's wall is known".into());
    }
    Ok(plan)
}

/// Ball, probe and expected stock of a pass.
fn before(pass: &Pass, settings: &Settings, margin: f64) -> Result<(ProbingSetup, StockWall), Failure> {
    let expected = mm(pass.core.setup.allowance);
    let most = 2.0 * mm(pass.core.setup.radius) - expected;
    if !(margin > 0.0 && margin < most) {
        let found = format!("--stock-margin is {margin}");
        let (most, name) = (pass.unit().of(most), pass.unit().name());
        let expected = format!("more than 0, less than {most} {name}: the cutter's diameter without the allowance");
        return Err(InputError::new(V001, found, expected, "give --stock-margin a value in this range").into());
    }
    let stock = StockWall { expected, largest: expected + margin };
    Ok((ProbingSetup::before(pass, settings, stock)?, stock))
}

/// Chooses up to `count` sites of a contour, no nearer to each other than `least` along it, mm: its first and last one, the middles
/// of its inside corners, the tightest first, and the rest so that the longest stretch without one becomes as short as it can.
fn spread(sites: &[Site], count: usize, least: f64) -> Vec<usize> {
    let s = |k: usize| mm(sites[k].s);
    let mut chosen: Vec<usize> = Vec::new();
    let take = |chosen: &mut Vec<usize>, k: usize| {
        let room = chosen.len() < count && chosen.iter().all(|c| (s(*c) - s(k)).abs() >= least);
        if room {
            chosen.push(k);
        }
        room
    };
    for end in [0, sites.len().saturating_sub(1)] {
        if !sites.is_empty() {
            take(&mut chosen, end);
        }
    }
    let corners = (CORNERS * count as f64) as usize;
    for (_, middle) in inside_corners(sites).into_iter().take(corners) {
        take(&mut chosen, middle);
    }
    // Into the stretch whose parts would be longest, one more; its parts are made even in the end.
    chosen.sort_unstable();
    let mut parts: Vec<usize> = vec![1; chosen.len().saturating_sub(1)];
    let part = |parts: &[usize], chosen: &[usize], k: usize| (s(chosen[k + 1]) - s(chosen[k])) / parts[k] as f64;
    for _ in chosen.len()..count {
        let widest = (0..parts.len()).max_by(|a, b| part(&parts, &chosen, *a).total_cmp(&part(&parts, &chosen, *b)));
        let Some(widest) = widest else { break };
        parts[widest] += 1;
    }
    let stretches: Vec<(usize, usize, usize)> =
        chosen.windows(2).zip(&parts).map(|(ends, parts)| (ends[0], ends[1], *parts)).collect();
    for (from, to, parts) in stretches {
        for k in 1..parts {
            let wanted = s(from) + (s(to) - s(from)) * k as f64 / parts as f64;
            let nearest = (from..=to).min_by(|a, b| (s(*a) - wanted).abs().total_cmp(&(s(*b) - wanted).abs()));
            if let Some(nearest) = nearest {
                take(&mut chosen, nearest);
            }
        }
    }
    chosen.sort_unstable();
    chosen
}

/// Sites in the middle of the inside corners, with the radius of the wall there, the tightest first.
fn inside_corners(sites: &[Site]) -> Vec<(f64, usize)> {
    let mut corners: Vec<(f64, usize)> = Vec::new();
    let mut from = 0;
    for run in sites.chunk_by(|a, b| a.form == b.form) {
        if let Some(Site { form: Form::InsideArc(radius), .. }) = run.first() {
            corners.push((*radius, from + run.len() / 2));
        }
        from += run.len();
    }
    corners.sort_by(|a, b| a.0.total_cmp(&b.0));
    corners
}

#[cfg(test)]
mod tests {
    use truepath_core::units::Offset;

    use super::*;

    fn sites(forms: &[(u32, Form)]) -> Vec<Site> {
        let runs = forms.iter().flat_map(|(count, form)| std::iter::repeat_n(*form, *count as usize));
        let site = |(k, form): (usize, Form)| Site {
            s: Offset::from_um(500 * k as i64),
            wall: [0.0; 2],
            normal: [0.0, 1.0],
            form,
            line: 1,
            unsteady: Offset::ZERO,
        };
        runs.enumerate().map(site).collect()
    }

    #[test]
    fn places_are_spread_evenly_and_every_corner_has_one() {
        let sites = sites(&[(80, Form::Straight), (11, Form::InsideArc(9.0)), (110, Form::Straight)]);
        let chosen = spread(&sites, 12, 3.0);
        assert_eq!((chosen.len(), chosen[0], chosen[11]), (12, 0, 200));
        assert!(chosen.contains(&85), "{chosen:?}");
        let gaps: Vec<f64> = chosen.windows(2).map(|pair| mm(sites[pair[1]].s - sites[pair[0]].s)).collect();
        let longest = gaps.iter().copied().fold(0.0, f64::max);
        assert!(longest < 100.0 / 11.0 * 1.25, "{gaps:?}");
    }

    #[test]
    fn places_keep_apart_where_many_are_asked_for() {
        let sites = sites(&[(40, Form::Straight)]);
        let chosen = spread(&sites, 30, 3.0);
        assert!(chosen.len() < 8 && chosen.windows(2).all(|pair| mm(sites[pair[1]].s - sites[pair[0]].s) >= 3.0));
        assert!(spread(&[], 5, 3.0).is_empty());
        assert_eq!(spread(&sites[..1], 5, 3.0), [0]);
    }
}
