//! Which stretches of the contour lie farther from every touched place than a point speaks for.
//!
//! Distances are along the contour; on a closed one also across its seam. How far a point speaks for is the user's to say
//! (`part.reach_mm`); the cutter's diameter where nothing is said, because over that length the engagement, and with it the
//! deflection, changes in a corner.

use truepath_core::units::Offset;

use crate::report::mm;

/// A stretch of the contour.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Stretch {
    /// Its beginning, mm along the contour.
    pub from_mm: f64,
    /// Its end.
    pub to_mm: f64,
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
    /// The stretches, in the order of the contour.
    pub stretches: Vec<Stretch>,
}

/// Finds the stretches. `places` are arc lengths in any order.
pub fn coverage(places: impl IntoIterator<Item = Offset>, length: Offset, reach: Offset, closed: bool) -> Coverage {
    let mut reached: Vec<(Offset, Offset)> = Vec::new();
    for s in places {
        let (from, to) = (s - reach, s + reach);
        reached.push((from, to));
        if closed {
            reached.push((from + length, to + length));
            reached.push((from - length, to - length));
        }
    }
    reached.sort_unstable();
    let mut stretches = Vec::new();
    let mut until = Offset::ZERO;
    for (from, to) in reached {
        if from > until && until < length {
            stretches.push((until, from.min(length)));
        }
        until = until.max(to);
    }
    if until < length {
        stretches.push((until, length));
    }
    let farther: Offset = stretches.iter().fold(Offset::ZERO, |sum, (from, to)| sum + (*to - *from));
    let stretches = stretches.into_iter().map(|(from, to)| Stretch { from_mm: mm(from), to_mm: mm(to) });
    Coverage { reach_mm: mm(reach), length_mm: mm(length), farther_mm: mm(farther), stretches: stretches.collect() }
}

/// Stretches named in a sentence at most; the summary holds all of them.
const NAMED: usize = 6;

impl Coverage {
    /// What it means for the verdict, in words.
    pub fn words(&self) -> String {
        let Self { reach_mm, length_mm, farther_mm, stretches } = self;
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

    fn of(places: &[i64], closed: bool) -> Vec<(f64, f64)> {
        let places = places.iter().map(|mm| Offset::from_um(mm * 1000));
        let found = coverage(places, Offset::from_um(100_000), Offset::from_um(10_000), closed);
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
        let far = |k: i64| Offset::from_um(k * 1_000_000);
        let found = coverage((0..20).map(far), Offset::from_um(19_000_000), Offset::from_um(10_000), false);
        assert_eq!(found.stretches.len(), 19);
        assert!(
            found.words().contains("10.0 to 990.0") && found.words().contains("mm, and 13 more stretches."),
            "{}",
            found.words()
        );
    }
}
