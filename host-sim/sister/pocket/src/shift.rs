//! Shifts along the normal: by the predicted error, station by station or one value a section.

use super::process::Cutting;
use super::section::{Kind, Section};
use super::station::Station;

/// Stretch over which two constants, or a constant and nothing, go over into each other, mm.
const STRETCH_MM: f64 = 4.0;

/// One refinement of the profile: towards the near wall by what the error is above its target.
pub(super) fn refine(shift: &mut [f64], cut: &[Cutting], target: &[f64], shares: &[f64]) -> f64 {
    let mut worst = 0.0f64;
    let more: Vec<f64> =
        (0..shift.len()).map(|i| if shares[i] > 0.0 { cut[i].walls.position() - target[i] } else { 0.0 }).collect();
    for (shift, more) in shift.iter_mut().zip(&more) {
        if more.is_finite() {
            *shift += more;
            worst = worst.max(more.abs());
        }
    }
    fill(shift, &more);
    worst
}

/// Stations without a wall follow their neighbours: on a straight line between them.
fn fill(shift: &mut [f64], more: &[f64]) {
    let mut at = 0;
    while at < shift.len() {
        let gap = more[at..].iter().take_while(|m| m.is_nan()).count();
        if gap > 0 {
            let before = at.checked_sub(1).map(|i| shift[i]);
            let after = shift.get(at + gap).copied();
            let (from, to) = (before.or(after).unwrap_or(0.0), after.or(before).unwrap_or(0.0));
            for k in 0..gap {
                shift[at + k] = from + (to - from) * (k + 1) as f64 / (gap + 1) as f64;
            }
        }
        at += gap + 1;
    }
}

/// Middle of the errors of a section: what one value can take away.
pub(super) fn middle(section: &Section, cut: &[Cutting]) -> f64 {
    let errors = || cut[section.from..section.to].iter().map(|c| c.walls.position()).filter(|e| e.is_finite());
    let (low, high) = errors().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), e| (l.min(e), h.max(e)));
    if low <= high { 0.5 * (low + high) } else { 0.0 }
}

/// Constants as shifts: they go over into each other inside the shifted sections, half of the way on either side, or all
/// of it where the neighbour stays as it is.
pub(super) fn constants(stations: &[Station], sections: &[Section], value: &[Option<f64>], closed: bool) -> Vec<f64> {
    let count = sections.len();
    let mut shift = vec![0.0; stations.len()];
    for (k, section) in sections.iter().enumerate() {
        let Some(own) = value[k] else { continue };
        let (start, end) = (stations[section.from].s_mm, stations[section.to - 1].s_mm);
        let stretch = STRETCH_MM.min(0.34 * (end - start)).max(1e-9);
        // What the shift is at the border to a neighbour.
        let border = |neighbour: Option<usize>| match neighbour.map(|i| (sections[i].kind, value[i])) {
            None | Some((Kind::Sharp, _)) => own,
            Some((_, None)) => 0.0,
            Some((_, Some(other))) => 0.5 * (own + other),
        };
        let before = k.checked_sub(1).or(closed.then_some(count - 1));
        let behind = Some(k + 1).filter(|i| *i < count).or(closed.then_some(0));
        let [first, last] = [border(before), border(behind)];
        for i in section.from..section.to {
            let s = stations[i].s_mm;
            let part = |at: f64, away: f64| (at - own) * (1.0 - (away / stretch).min(1.0));
            shift[i] = own + part(first, s - start) + part(last, end - s);
        }
    }
    shift
}

/// Around a sharp corner the shift of the wall before is held up to it, that of the wall behind from it on.
pub(super) fn hold(stations: &[Station], sections: &[Section], shift: &mut [f64]) {
    for section in sections.iter().filter(|s| s.kind == Kind::Sharp) {
        let turned = |i: &usize| {
            let (a, b) = (&stations[*i], &stations[i + 1]);
            a.point == b.point
        };
        let last = section.to - 1;
        let corner = (section.from..last).find(turned).unwrap_or(last);
        let before = section.from.checked_sub(1).map(|i| shift[i]);
        let behind = shift.get(section.to).copied();
        shift[section.from..=corner].fill(before.or(behind).unwrap_or(0.0));
        // Several stations stand on the spot while the normal turns; they count to the wall behind.
        shift[corner + 1..section.to].fill(behind.or(before).unwrap_or(0.0));
    }
}
