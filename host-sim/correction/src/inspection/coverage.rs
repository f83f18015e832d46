//! Which parts of the wall lie farther from every touched place than a point speaks for: along the contour, and over its height.
//!
//! Distances are along the contour; on a closed one also across its seam. How far a point speaks for is the user's to say
//! (`part.reach_mm`, `part.reach_height_mm`). Where nothing is said it is the cutter's diameter along the contour, because over
//! that length the engagement, and with it the deflection, changes in a corner; and a quarter of the depth of cut up and
//! down, so that it takes touches near the tip, in the middle and near the top to have the whole height.

use truepath_core::units::Offset;
use truepath_ground::units::mm;

use super::face::{Face, face};

/// A stretch of the contour, or of the height of its wall.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Stretch {
    /// Its beginning, mm along the contour, or above the cutter's tip.
    pub from_mm: f64,
    /// Its end.
    pub to_mm: f64,
}

impl Stretch {
    pub(super) fn of((from, to): (Offset, Offset)) -> Self {
        Self { from_mm: mm(from), to_mm: mm(to) }
    }
}

/// A touched place of the wall.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Touched {
    /// Arc length of the contour.
    pub s: Offset,
    /// Height above the cutter's tip.
    pub height: Offset,
}

/// The wall that is judged.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Extent {
    /// Length of the contour.
    pub length: Offset,
    /// Height of the wall: the depth of cut.
    pub depth: Offset,
    /// Whether the contour closes.
    pub closed: bool,
}

/// How far a point speaks for the wall.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Reach {
    /// Along the contour.
    pub along: Offset,
    /// Up and down.
    pub height: Offset,
}

/// What no point speaks for.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Coverage {
    /// How far a point speaks for, mm along the contour.
    pub reach_mm: f64,
    /// Length of the contour, mm.
    pub length_mm: f64,
    /// Length of the stretches together, mm.
    pub farther_mm: f64,
    /// The stretches that no point speaks for at any height, in the order of the contour.
    pub stretches: Vec<Stretch>,
    /// The same over the height.
    pub face: Face,
}

/// Finds what no point speaks for. The places may come in any order.
pub fn coverage(places: &[Touched], wall: Extent, reach: Reach) -> Coverage {
    let open = left_open(reached(places.iter().map(|p| p.s), wall, reach.along), wall.length);
    Coverage {
        reach_mm: mm(reach.along),
        length_mm: mm(wall.length),
        farther_mm: mm(together(&open)),
        stretches: open.into_iter().map(Stretch::of).collect(),
        face: face(places, wall, reach),
    }
}

/// What places speak for along the contour, in any order; on a closed one also across its seam.
pub(super) fn reached(
    places: impl IntoIterator<Item = Offset>,
    wall: Extent,
    reach: Offset,
) -> impl Iterator<Item = (Offset, Offset)> {
    let turns = [Offset::ZERO, wall.length, -wall.length].into_iter().take(if wall.closed { 3 } else { 1 });
    places.into_iter().flat_map(move |s| turns.clone().map(move |turn| (s + turn - reach, s + turn + reach)))
}

/// What stretches leave open of a length, in its order.
pub(super) fn left_open(
    stretches: impl IntoIterator<Item = (Offset, Offset)>,
    length: Offset,
) -> Vec<(Offset, Offset)> {
    let mut stretches: Vec<(Offset, Offset)> = stretches.into_iter().collect();
    stretches.sort_unstable();
    let mut open = Vec::new();
    let mut until = Offset::ZERO;
    for (from, to) in stretches {
        if from > until && until < length {
            open.push((until, from.min(length)));
        }
        until = until.max(to);
    }
    if until < length {
        open.push((until, length));
    }
    open
}

/// Length of stretches.
pub(super) fn together(stretches: &[(Offset, Offset)]) -> Offset {
    stretches.iter().fold(Offset::ZERO, |sum, (from, to)| sum + (*to - *from))
}

/// Stretches named in a sentence at most; the summary holds all of them.
pub(super) const NAMED: usize = 6;

impl Coverage {
    /// What it means for the verdict along the contour, in words; [`Face::words`] has the height.
    pub fn words(&self) -> String {
        let Self { reach_mm, length_mm, farther_mm, stretches, .. } = self;
        if stretches.is_empty() {
            return format!(
                "Every place of the contour ({length_mm:.1} mm) lies within {reach_mm} mm of a measured one."
            );
        }
        let named: Vec<String> =
            stretches.iter().take(NAMED).map(|s| format!("{:.1} to {:.1}", s.from_mm, s.to_mm)).collect();
        let more = stretches.len().saturating_sub(NAMED);
        let more = match more {
            0 => String::new(),
            1 => ", and 1 more stretch".to_owned(),
            more => format!(", and {more} more stretches"),
        };
        format!(
            "{farther_mm:.1} of {length_mm:.1} mm of the contour lie farther than {reach_mm} mm from any measured place: s = {} mm{more}.",
            named.join(", ")
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const REACH: Reach = Reach { along: Offset::from_um(10_000), height: Offset::from_um(10_000) };

    fn um(um: i64) -> Offset {
        Offset::from_um(um)
    }

    fn at(mm: i64) -> Touched {
        Touched { s: um(mm * 1000), height: um(5_000) }
    }

    fn of(places: &[i64], closed: bool) -> Vec<(f64, f64)> {
        let places: Vec<Touched> = places.iter().map(|mm| at(*mm)).collect();
        let found = coverage(&places, Extent { length: um(100_000), depth: um(10_000), closed }, REACH);
        let stretches: Vec<(f64, f64)> = found.stretches.iter().map(|s| (s.from_mm, s.to_mm)).collect();
        let sum: f64 = stretches.iter().map(|(from, to)| to - from).sum();
        assert!((found.farther_mm - sum).abs() < 1e-9);
        stretches
    }

    #[test]
    fn what_lies_beyond_the_reach_of_every_point_is_found_and_nothing_else() {
        assert_eq!(of(&[50, 30, 35], false), [(0.0, 20.0), (60.0, 100.0)]);
        assert_eq!(of(&[10, 30, 50, 70, 90], false), []);
        assert_eq!(of(&[], false), [(0.0, 100.0)]);
        assert_eq!(of(&[0, 100], false), [(10.0, 90.0)]);
    }

    #[test]
    fn on_a_closed_contour_a_point_speaks_across_the_seam() {
        assert_eq!(of(&[2], true), [(12.0, 92.0)]);
        assert_eq!(of(&[98], true), [(8.0, 88.0)]);
        assert_eq!(of(&[2], false), [(12.0, 100.0)]);
    }

    #[test]
    fn the_words_name_a_few_stretches_and_count_the_rest() {
        let far: Vec<Touched> = (0..20).map(|k| at(k * 1000)).collect();
        let found = coverage(&far, Extent { length: um(19_000_000), depth: um(10_000), closed: false }, REACH);
        assert_eq!(found.stretches.len(), 19);
        assert!(
            found.words().contains("10.0 to 990.0") && found.words().contains("mm, and 13 more stretches."),
            "{}",
            found.words()
        );
    }
}
