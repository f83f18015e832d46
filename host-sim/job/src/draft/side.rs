//! On which side the wall of a contour lies, where no G41 or G42 says it.
//!
//! | sign | then the wall is |
//! |---|---|
//! | an arc tighter than the cutter, round which no wall could be left | on the side without it |
//! | leads: the path comes from a place beside the contour, and leaves to one | on the other side of it |
//! | an arc of the same radius at either end of an open path, which turns to one side | on the other side |
//! | an earlier pass all along beside the contour | on the other side of it |
//! | a comment that speaks of the outside or of a pocket, and a closed path | where the turning of the path puts it |
//!
//! Signs that contradict each other are none.

use truepath_core::gcode::{Criteria, Found, Role};
use truepath_core::geometry::{Block, Contour, FACET_TURN_LIMIT, Point, Side};
use truepath_core::units::Offset;
use truepath_ground::length::Unit;
use truepath_ground::units::mm;

use crate::drawn::turns_left;
use crate::feature::{LARGEST_SEARCH, Survey};
use crate::post::{Post, plain};

/// What shows it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Shown {
    pub(super) side: Side,
    pub(super) why: String,
    pub(super) line: Option<u32>,
}

/// How far beside a contour a lead begins, at least.
const BESIDE: Offset = Offset::from_um(20);
/// Lines before a contour in which a comment speaks of it.
const NEAR: u32 = 40;

/// Words for the outside of a part, and for what is inside.
const OUTSIDE: [&str; 9] =
    ["OUTSIDE", "AUSSEN", "OUTER", "EXTERIOR", "BOSS", "ISLAND", "INSEL", "ZAPFEN", "AUSSENKONTUR"];
const INSIDE: [&str; 14] = [
    "INSIDE",
    "INNEN",
    "INNER",
    "POCKET",
    "TASCHE",
    "BORE",
    "HOLE",
    "LOCH",
    "FENSTER",
    "WINDOW",
    "BOHRUNG",
    "INTERIOR",
    "INNENKONTUR",
    "HOLES",
];

/// The side of a contour's wall; `None` when nothing shows it. `known` is whether the diameter is that of the cutter, and no
/// stand-in.
pub(super) fn side(found: &Found, survey: &Survey, post: &Post, (criteria, known): (&Criteria, bool)) -> Option<Shown> {
    let lines = found.run.lines;
    if let Some(side) = found.run.wall {
        let word = if side == Side::Right { "G41" } else { "G42" };
        return Some(Shown { side, why: format!("{word} says it"), line: Some(lines.first) });
    }
    let contour = found.blocks(&survey.blocks);
    let arcs = if found.run.closed { None } else { by_arcs(contour, criteria.diameter) };
    let leads = by_leads(found, survey, contour).or(arcs);
    let leads = leads.map(|(side, why)| Shown { side, why: why.to_owned(), line: Some(lines.first) });
    let rough = by_rough(found, survey, criteria);
    let radius = Offset::from_nm(criteria.diameter.nm() / 2);
    let tight = if known { by_tight(contour, radius, post.unit.told()) } else { None };
    let signs = [tight.clone(), leads, rough];
    let mut seen = signs.iter().flatten();
    let first = seen.next();
    // What no cutter can follow is no sign among others, but a proof.
    if tight.is_some() || first.is_some_and(|first| seen.all(|other| other.side == first.side)) {
        return first.cloned();
    }
    if first.is_some() { None } else { by_comment(found, contour, post) }
}

/// The arcs of a path, with the side they turn round.
fn arcs(contour: &[Block]) -> impl Iterator<Item = (&Block, Offset, Side)> {
    contour.iter().filter_map(|block| {
        let radius = block.curve.signed_radius()?;
        Some((block, radius.abs(), if radius > Offset::ZERO { Side::Left } else { Side::Right }))
    })
}

/// An arc that turns round one side more tightly than the cutter: there can be no wall on it.
fn by_tight(contour: &[Block], radius: Offset, unit: Unit) -> Option<Shown> {
    let tight = |side: Side| {
        let least = radius - Offset::from_nm(radius.nm() / 100);
        arcs(contour).find(|(_, r, within)| *within == side && *r < least)
    };
    let (side, (block, r, _)) = match (tight(Side::Left), tight(Side::Right)) {
        (Some(arc), None) => (Side::Right, arc),
        (None, Some(arc)) => (Side::Left, arc),
        _ => return None,
    };
    let (radius, name) = (unit.of(mm(r)), unit.name());
    let why = format!("round an arc of radius {radius} {name} the cutter can leave no wall on the other side");
    Some(Shown { side, why, line: Some(block.line) })
}

/// The side that is likely where nothing shows it: within arcs of the cutter's own radius, as CAM systems roll round sharp
/// corners, else on the right, where a climbing cutter with M3 has it.
pub(super) fn likely(contour: &[Block], diameter: Offset) -> (Side, &'static str) {
    let radius = Offset::from_nm(diameter.nm() / 2);
    let near = |r: Offset| (r - radius).abs().nm() <= radius.nm() / 100;
    let mut rolled = arcs(contour).filter(|(_, r, _)| near(*r)).map(|(_, _, side)| side);
    match rolled.next() {
        Some(side) if rolled.all(|other| other == side) => {
            (side, "the path rolls round arcs of the cutter's own radius, as it does round sharp outside corners")
        }
        _ => (Side::Right, "a climbing cutter with M3 has it on the right"),
    }
}

fn by_leads(found: &Found, survey: &Survey, contour: &[Block]) -> Option<(Side, &'static str)> {
    let [before, after] = survey.leads(found);
    let path = Contour::new(contour)?;
    let free = |point: Point| {
        let mut nearest: Option<Offset> = None;
        path.feet(point, |foot| {
            if nearest.is_none_or(|n| foot.left.abs() < n.abs()) {
                nearest = Some(foot.left);
            }
        });
        nearest.filter(|left| left.abs() > BESIDE).map(|left| left > Offset::ZERO)
    };
    let first = before.first().and_then(|block| free(block.curve.start()));
    let last = after.last().and_then(|block| free(block.curve.end()));
    let left = match (first, last) {
        (Some(a), Some(b)) if a != b => return None,
        (Some(a), _) | (None, Some(a)) => a,
        (None, None) => return None,
    };
    Some((opposite(left), "the leads come from the other side"))
}

/// Leads that are still a part of the run: an arc at either end, or one move farther in, of one radius and one turn.
fn by_arcs(contour: &[Block], diameter: Offset) -> Option<(Side, &'static str)> {
    let arc = |outer: Option<&Block>, inner: Option<&Block>, forward: bool| {
        let (outer, inner) = (outer?, inner?);
        let radius = outer.curve.signed_radius()?;
        let (from, to) = if forward { (outer, inner) } else { (inner, outer) };
        let tangent = from.curve.end_heading().dot(to.curve.start_heading()) >= FACET_TURN_LIMIT;
        (tangent && radius.abs() <= diameter + diameter).then_some(radius)
    };
    let short = |k: Option<&Block>| k.is_some_and(|b| b.curve.length().nm() <= diameter.nm() / 2);
    let from_end = |k: usize| contour.len().checked_sub(k + 1).and_then(|i| contour.get(i));
    if contour.len() < 5 {
        return None;
    }
    let first = arc(contour.first(), contour.get(1), true)
        .or_else(|| arc(contour.get(1), contour.get(2), true).filter(|_| short(contour.first())))?;
    let last = arc(from_end(0), from_end(1), false)
        .or_else(|| arc(from_end(1), from_end(2), false).filter(|_| short(from_end(0))))?;
    let alike = (first - last).abs() <= Offset::from_um(10);
    alike.then(|| (opposite(first > Offset::ZERO), "the arcs of the leads turn to the other side"))
}

/// An earlier pass all along one side.
fn by_rough(found: &Found, survey: &Survey, criteria: &Criteria) -> Option<Shown> {
    if survey.runs.len() > LARGEST_SEARCH {
        return None;
    }
    let beside = |side: Side| {
        let mut runs = survey.runs.clone();
        survey.sort(&mut runs, &Criteria { wall: Some(side), ..*criteria });
        let own = runs.iter().position(|f| f.run.number == found.run.number)?;
        runs.iter().find_map(|f| match f.role {
            Role::Rough { nearer, parallel: true, .. } if nearer == own => Some(f.run.lines),
            _ => None,
        })
    };
    let (side, lines) = match (beside(Side::Left), beside(Side::Right)) {
        (Some(lines), None) => (Side::Left, lines),
        (None, Some(lines)) => (Side::Right, lines),
        _ => return None,
    };
    let why = format!("the pass of lines {}-{} lies all along the other side", lines.first, lines.last);
    Some(Shown { side, why, line: Some(lines.first) })
}

fn by_comment(found: &Found, contour: &[Block], post: &Post) -> Option<Shown> {
    if !found.run.closed {
        return None;
    }
    let line = found.run.lines.first;
    let before = post.remarks.iter().rev().filter(|(at, _)| *at <= line && *at + NEAR >= line);
    let said = before.into_iter().find_map(|(at, text)| {
        let upper = plain(text);
        let words: Vec<&str> = upper.split(|c: char| !c.is_alphabetic()).collect();
        let has = |list: &[&str]| words.iter().any(|word| list.contains(word));
        match (has(&OUTSIDE), has(&INSIDE)) {
            (true, false) => Some((*at, text, true)),
            (false, true) => Some((*at, text, false)),
            _ => None,
        }
    });
    let (at, text, outside) = said?;
    let why = format!("the comment \"{text}\"");
    // Round a part the wall is within the loop, on the side to which the path turns.
    Some(Shown { side: opposite(turns_left(contour) != outside), why, line: Some(at) })
}

/// The side opposite of the free one.
const fn opposite(free_is_left: bool) -> Side {
    if free_is_left { Side::Right } else { Side::Left }
}
