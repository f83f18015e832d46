//! The wall of a slot: the envelope of the displaced circles, `e = min (v·n − √(r² − (v·t)²))`, v from centre to wall.
//!
//! The same as the core's wall, in float and on either side; circles within a radius of path make it.

use super::station::Station;
use super::swept::Cells;

/// A nominal wall point that the nominal path itself cuts away by more than this is not on the part, mm.
const UNDERCUT_MM: f64 = 0.002;

/// One side of a slot.
#[derive(Clone, Debug)]
pub(super) struct Side {
    /// +1 for the near wall, −1 for the other.
    sign: f64,
    radius: f64,
    /// Whether a wall stands beside each station.
    stands: Vec<bool>,
}

impl Side {
    pub(super) fn new(stations: &[Station], radius: f64, sign: f64) -> Self {
        let mut cells = Cells::new(radius);
        for station in stations {
            cells.push(station.point);
        }
        let inside = (radius - UNDERCUT_MM).max(0.0).powi(2);
        let stands = |s: &Station| {
            let wall = wall(s, radius, sign);
            !cells.near(wall).any(|p| (p[0] - wall[0]).powi(2) + (p[1] - wall[1]).powi(2) < inside)
        };
        Self { sign, radius, stands: stations.iter().map(stands).collect() }
    }

    /// Errors at one height for circles at these centres; NaN where no wall stands.
    pub(super) fn errors(&self, stations: &[Station], centres: &[[f64; 2]]) -> Vec<f64> {
        let mut from = 0;
        let mut to = 0;
        let one = |(i, station): (usize, &Station)| {
            while stations[from].s_mm < station.s_mm - self.radius {
                from += 1;
            }
            while to < stations.len() && stations[to].s_mm <= station.s_mm + self.radius {
                to += 1;
            }
            if !self.stands[i] {
                return f64::NAN;
            }
            let wall = wall(station, self.radius, self.sign);
            let rr = self.radius * self.radius;
            let gap = |c: &[f64; 2]| {
                let v = [wall[0] - c[0], wall[1] - c[1]];
                let ahead = self.sign * (v[0] * station.normal[0] + v[1] * station.normal[1]);
                let square = rr - (v[0] * v[0] + v[1] * v[1] - ahead * ahead);
                if square > 0.0 { ahead - square.sqrt() } else { f64::INFINITY }
            };
            centres[from..to].iter().map(gap).fold(f64::INFINITY, f64::min)
        };
        let errors: Vec<f64> = stations.iter().enumerate().map(one).collect();
        errors.into_iter().map(|e| if e.is_finite() { e } else { f64::NAN }).collect()
    }
}

fn wall(station: &Station, radius: f64, sign: f64) -> [f64; 2] {
    let reach = sign * radius;
    [station.point[0] + reach * station.normal[0], station.point[1] + reach * station.normal[1]]
}
