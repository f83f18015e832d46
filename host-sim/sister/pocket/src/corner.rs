//! From shifts along the normal to vectors without a jump at sharp corners.
//!
//! Two walls that meet at a corner are shifted by u₁ and u₂ along their own normals. The corner of the path goes to
//! where the shifted legs meet: the vector w with w·n₁ = u₁ and w·n₂ = u₂. Its share along a leg only lengthens or
//! shortens that leg; it comes and goes over a stretch of it, so that stations keep their order.

use super::station::Station;

/// Cosine of the turn from which two stations at one place are a corner: 1°.
const TURN: f64 = 0.99985;
/// Stretch of a leg, at least, over which the share along it comes, mm.
const STRETCH_MM: f64 = 2.0;
/// A share along the leg never moves two stations towards each other by more than a part in so many.
const STEEP: f64 = 20.0;

/// The vectors, mm, one per station.
pub(super) fn vectors(stations: &[Station], shift: &[f64]) -> Vec<[f64; 2]> {
    let along = |i: usize, u: f64| stations[i].normal.map(|n| u * n);
    let mut vectors: Vec<[f64; 2]> = (0..stations.len()).map(|i| along(i, shift[i])).collect();
    let mut at = 0;
    while at < stations.len() {
        let same = |j: &usize| stations[*j].point == stations[at].point;
        let end = at + (at..stations.len()).take_while(same).count();
        if end - at > 1
            && let Some(meet) = meeting(&stations[at], shift[at], &stations[end - 1], shift[end - 1])
        {
            vectors[at..end].fill(meet);
            stretch(stations, &mut vectors, (at, meet), |k| at.checked_sub(k));
            stretch(stations, &mut vectors, (end - 1, meet), |k| (end - 1 + k < stations.len()).then_some(end - 1 + k));
        }
        at = end;
    }
    vectors
}

/// Where the shifted legs meet; `None` for parallel ones.
fn meeting(a: &Station, ua: f64, b: &Station, ub: f64) -> Option<[f64; 2]> {
    let turn = a.normal[0] * b.normal[0] + a.normal[1] * b.normal[1];
    let det = a.normal[0] * b.normal[1] - a.normal[1] * b.normal[0];
    if turn > TURN || det.abs() < 1e-2 {
        return None;
    }
    Some([(ua * b.normal[1] - ub * a.normal[1]) / det, (ub * a.normal[0] - ua * b.normal[0]) / det])
}

/// Lets the share of a corner along its leg come or go.
fn stretch(
    stations: &[Station],
    vectors: &mut [[f64; 2]],
    (corner, meet): (usize, [f64; 2]),
    step: impl Fn(usize) -> Option<usize>,
) {
    let heading = stations[corner].heading;
    let share = meet[0] * heading[0] + meet[1] * heading[1];
    let length = STRETCH_MM.max(STEEP * share.abs());
    for i in (1..).map_while(step) {
        let station = &stations[i];
        let away = (station.s_mm - stations[corner].s_mm).abs();
        let straight = station.heading[0] * heading[0] + station.heading[1] * heading[1] > TURN;
        if away >= length || !straight {
            break;
        }
        let part = share * (1.0 - away / length);
        vectors[i] = [vectors[i][0] + part * heading[0], vectors[i][1] + part * heading[1]];
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two legs of 20 mm that meet at a right angle, wall on the right: +x, then +y.
    fn corner() -> Vec<Station> {
        let leg = |block: usize, k: i32| {
            let x = f64::from(k) * 0.1;
            let (point, heading) = if block == 0 { ([x, 0.0], [1.0, 0.0]) } else { ([20.0, x], [0.0, 1.0]) };
            Station {
                s_mm: 20.0 * block as f64 + x,
                point,
                normal: [heading[1], -heading[0]],
                heading,
                block,
                line: block as u32,
                feed_mm_per_min: 100.0,
                turns: false,
                held: false,
            }
        };
        (0..=200).map(|k| leg(0, k)).chain((0..=200).map(|k| leg(1, k))).collect()
    }

    #[test]
    fn the_corner_goes_to_where_the_shifted_legs_meet_and_no_step_of_the_path_jumps() {
        let stations = corner();
        let shift: Vec<f64> = stations.iter().map(|s| if s.block == 0 { 0.05 } else { -0.03 }).collect();
        let vectors = vectors(&stations, &shift);
        let (a, b) = (vectors[200], vectors[201]);
        assert_eq!(a, b);
        // Normals are −y and +x: leg 1 goes to y = −0.05, leg 2 to x = 20 − 0.03.
        assert!((a[0] + 0.03).abs() < 1e-12 && (a[1] + 0.05).abs() < 1e-12, "{a:?}");
        let moved: Vec<[f64; 2]> =
            stations.iter().zip(&vectors).map(|(s, v)| [s.point[0] + v[0], s.point[1] + v[1]]).collect();
        for pair in moved.windows(2) {
            let step = (pair[1][0] - pair[0][0]).hypot(pair[1][1] - pair[0][1]);
            assert!(step < 0.12, "{pair:?}");
        }
        // The legs stay straight lines.
        assert!(moved[..=200].iter().all(|p| (p[1] + 0.05).abs() < 1e-12));
        assert!(moved[201..].iter().all(|p| (p[0] - 19.97).abs() < 1e-12));
        assert!(moved[..=200].windows(2).all(|w| w[1][0] > w[0][0]));
    }
}
