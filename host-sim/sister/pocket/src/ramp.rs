//! Where a shifted section meets one that stays as it is: how much of the shift is applied.
//!
//! The shift comes and goes inside the shifted section, so that the other keeps its path to the last point and no jump
//! occurs. At the border the error is within the band (the neighbour is); inside, the share is at least 1 − m·T/|e|, with
//! which an error e is left with no more than m·T of the tolerance T: no place of the section leaves the band. The rest
//! of the share rises smoothly over a stretch.

use super::section::Section;
use super::station::Station;

/// Stretch over which a shift comes, mm, and at most this share of the section.
const STRETCH_MM: f64 = 6.0;
const STRETCH_SHARE: f64 = 0.34;
/// Part of the tolerance that the ramp uses: at least, and, where the wall beside it leaves no more, at most.
const MARGIN: f64 = 0.9;
const MOST: f64 = 0.995;

/// Whether the neighbours of a section, before and behind, stay as they are.
pub(super) type Neighbours = [bool; 2];

/// Share of the shift at every station of a section, 0…1; `errors` are those before, NaN where there is no wall.
pub(super) fn shares(
    stations: &[Station],
    section: &Section,
    beside: Neighbours,
    errors: &[f64],
    tolerance: f64,
) -> Vec<f64> {
    let range = section.from..section.to;
    let (start, end) = (stations[section.from].s_mm, stations[section.to - 1].s_mm);
    let stretch = STRETCH_MM.min(STRETCH_SHARE * (end - start)).max(1e-9);
    let borders = [(beside[0], section.from), (beside[1], section.to - 1)];
    let at_border = borders.iter().filter(|(there, _)| *there).map(|(_, i)| errors[*i].abs()).filter(|e| e.is_finite());
    // An error at the border that already fills the band lets the share begin from nothing all the same.
    let kept = tolerance * at_border.map(|e| (e / tolerance).min(MOST)).fold(MARGIN, f64::max);
    range
        .map(|i| {
            let from = |there: bool, away: f64| if there { smooth(away / stretch) } else { 1.0 };
            let s = stations[i].s_mm;
            let share = from(beside[0], s - start).min(from(beside[1], end - s));
            let error = errors[i].abs();
            let needed = if error > kept { 1.0 - kept / error } else { 0.0 };
            if beside == [false, false] { 1.0 } else { share.max(needed) }
        })
        .collect()
}

fn smooth(u: f64) -> f64 {
    let u = u.clamp(0.0, 1.0);
    u * u * (3.0 - 2.0 * u)
}

#[cfg(test)]
mod tests {
    use super::super::section::Kind;
    use super::*;

    #[test]
    fn what_a_ramp_leaves_is_within_the_band_everywhere_and_begins_at_nothing() {
        let station = |k: usize| Station {
            s_mm: 0.1 * k as f64,
            point: [0.0; 2],
            normal: [1.0, 0.0],
            heading: [0.0, 1.0],
            block: 0,
            line: 1,
            feed_mm_per_min: 100.0,
            turns: false,
            held: false,
        };
        let stations: Vec<Station> = (0..300).map(station).collect();
        let section = Section { name: "C1".to_owned(), kind: Kind::Corner, from: 0, to: 300 };
        for (border, peak, tolerance) in [(0.015, 0.1, 0.02), (0.0198, 0.3, 0.02), (0.0, 0.05, 0.01)] {
            // Rises within 3 mm, falls again at the end.
            let errors: Vec<f64> = stations
                .iter()
                .map(|s| border + (peak - border) * (s.s_mm / 3.0).min((29.9 - s.s_mm) / 3.0).clamp(0.0, 1.0))
                .collect();
            let shares = shares(&stations, &section, [true, true], &errors, tolerance);
            assert!(shares[0] == 0.0 && shares[299] < 1e-12);
            for (i, (share, error)) in shares.iter().zip(&errors).enumerate() {
                assert!(error * (1.0 - share) <= tolerance * 1.0001, "{i}: {share} {error}");
            }
            // The shift never changes faster than the error itself and a smooth rise over the stretch together.
            let shift: Vec<f64> = shares.iter().zip(&errors).map(|(share, error)| share * error).collect();
            for (w, e) in shift.windows(2).zip(errors.windows(2)) {
                assert!((w[1] - w[0]).abs() <= 1.05 * (e[1] - e[0]).abs() + 0.03 * peak, "{w:?} {e:?}");
            }
            assert!((shares[150] - 1.0).abs() < 1e-12);
        }
    }
}
