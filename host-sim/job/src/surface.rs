//! The surface an earlier pass left, as a line of points in the XY plane: the stock of the pass that follows.
//!
//! File: columns `x_mm,y_mm` with that header, points in the order of travel. Beside each sample of the path the stock
//! is where its normal meets the line; beyond both ends of the line, and where it has holes, the excess over the
//! nominal allowance is continued.
//!
//! Limits: a line, not a band: the height of a wall that is not upright is lost.

use truepath_core::cut::Sample;
use truepath_core::geometry::Point;
use truepath_core::units::{Offset, Position};
use truepath_ground::diagnostics::{InputError, Source};

/// The surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Surface {
    points: Vec<[f64; 2]>,
}

/// Largest number of points of a file.
const LARGEST: usize = 1 << 20;

impl Surface {
    /// From points in the order of travel, mm; `None` for fewer than two.
    pub fn new(points: Vec<[f64; 2]>) -> Option<Self> {
        (points.len() >= 2).then_some(Self { points })
    }

    /// Its points, mm.
    pub fn points(&self) -> &[[f64; 2]] {
        &self.points
    }

    /// The file that holds it.
    pub fn table(&self) -> Vec<u8> {
        let rows = self.points.iter().map(|[x, y]| format!("{x:.6},{y:.6}\n"));
        std::iter::once("x_mm,y_mm\n".to_owned()).chain(rows).collect::<String>().into_bytes()
    }

    /// Reads a file.
    ///
    /// # Errors
    /// `K001` when it is not such a table, with the place.
    pub fn read(source: &Source) -> Result<Self, InputError> {
        const HELP: &str = "write a first line x_mm,y_mm and then one point of the surface a line, decimal points, in the order of travel";
        let wrong = |found: String, line: u64| {
            let line = u32::try_from(line).unwrap_or(u32::MAX);
            let length =
                source.bytes().split(|b| *b == b'\n').nth(line.saturating_sub(1) as usize).map_or(0, <[u8]>::len);
            let span = source.span_at(line, 1, u32::try_from(length).unwrap_or(u32::MAX));
            InputError::new("K001", found, "columns x_mm and y_mm with numbers", HELP).at(source, span)
        };
        let mut reader = csv::ReaderBuilder::new().trim(csv::Trim::All).comment(Some(b'#')).from_reader(source.bytes());
        let names = reader.headers().map_err(|e| wrong(format!("the surface cannot be read: {e}"), 1))?.clone();
        let column = |name: &str| names.iter().position(|n| n == name);
        let (Some(x), Some(y)) = (column("x_mm"), column("y_mm")) else {
            return Err(wrong(format!("the columns are {}", names.iter().collect::<Vec<_>>().join(", ")), 1));
        };
        let mut points: Vec<[f64; 2]> = Vec::new();
        for record in reader.records() {
            let record = record.map_err(|e| {
                let line = e.position().map_or(1, csv::Position::line);
                wrong("this line has another number of columns than the first".to_owned(), line)
            })?;
            let line = record.position().map_or(1, csv::Position::line);
            let number = |k: usize| {
                let text = record.get(k).unwrap_or_default();
                let value = text.parse::<f64>().ok().filter(|v| v.abs() <= 1e5);
                value.ok_or_else(|| wrong(format!("`{text}` is not a coordinate in mm"), line))
            };
            let point = [number(x)?, number(y)?];
            if points.len() == LARGEST {
                return Err(wrong(format!("the surface has more than {LARGEST} points"), line));
            }
            if points.last() != Some(&point) {
                points.push(point);
            }
        }
        Self::new(points).ok_or_else(|| wrong("the surface has fewer than two points".to_owned(), 1))
    }

    /// Distance from a point along a direction to the surface, mm, the one nearest to `expected`; `None` when the surface
    /// does not pass there within `reach`.
    fn along(&self, from: [f64; 2], direction: [f64; 2], expected: f64, reach: f64) -> Option<f64> {
        let cross = |a: [f64; 2], b: [f64; 2]| a[0] * b[1] - a[1] * b[0];
        let mut best: Option<f64> = None;
        for pair in self.points.windows(2) {
            let chord = [pair[1][0] - pair[0][0], pair[1][1] - pair[0][1]];
            let to = [pair[0][0] - from[0], pair[0][1] - from[1]];
            let turn = cross(direction, chord);
            if turn == 0.0 {
                continue;
            }
            let (t, u) = (cross(to, chord) / turn, cross(to, direction) / turn);
            let nearer = best.is_none_or(|b| (t - expected).abs() < (b - expected).abs());
            if (0.0..=1.0).contains(&u) && (t - expected).abs() <= reach && nearer {
                best = Some(t);
            }
        }
        best
    }

    /// Distance of the stock beside every sample, along its normal, mm, for a cutter of `radius_mm`; `None` when the
    /// surface lies beside none of them.
    pub fn beside(&self, samples: &[Sample], radius_mm: f64) -> Option<Vec<f64>> {
        let mm = |p: Position| p.nm() as f64 / 1e6;
        let seen: Vec<Option<f64>> = samples
            .iter()
            .map(|sample| {
                let from = [mm(sample.point.x), mm(sample.point.y)];
                let normal =
                    [truepath_ground::units::float(sample.normal.x), truepath_ground::units::float(sample.normal.y)];
                self.along(from, normal, radius_mm, 2.0 * radius_mm)
            })
            .collect();
        let first = *seen.iter().flatten().next()?;
        let mut filled = Vec::with_capacity(seen.len());
        let mut last = first;
        for (k, distance) in seen.iter().enumerate() {
            last = match distance {
                Some(d) => *d,
                // A hole is bridged evenly; beyond the last point the last distance goes on.
                None => match seen[k..].iter().position(Option::is_some) {
                    Some(ahead) => last + (seen[k + ahead].unwrap_or(last) - last) / (ahead as f64 + 1.0),
                    None => last,
                },
            };
            filled.push(last);
        }
        Some(filled)
    }
}

/// The stock point of a sample at a distance along its normal, mm.
pub fn stock_point(sample: &Sample, distance_mm: f64) -> Point {
    sample.point + sample.normal.times(Offset::from_nm((distance_mm * 1e6).round() as i64))
}

#[cfg(test)]
mod tests {
    use truepath_core::geometry::Direction;

    use super::*;

    fn source(text: &str) -> Source {
        Source::new("first-pass.csv", text.as_bytes().to_vec())
    }

    fn sample(x_mm: i64) -> Sample {
        let point = Point::from_nm(x_mm * 1_000_000, 0);
        Sample { s: Offset::from_nm(x_mm * 1_000_000), point, normal: Direction::X.left(), ..Sample::BLANK }
    }

    #[test]
    fn the_stock_is_where_the_normal_meets_the_surface() {
        let surface = Surface::read(&source("x_mm,y_mm\n0,8\n10,9\n20,9\n")).expect("a surface");
        let beside = surface.beside(&[sample(-5), sample(0), sample(5), sample(15), sample(25)], 10.0).expect("beside");
        assert_eq!(beside, [8.0, 8.0, 8.5, 9.0, 9.0]);
    }

    #[test]
    fn a_hole_is_bridged_evenly_and_a_surface_elsewhere_is_none() {
        let two = Surface::new(vec![[0.0, 8.0], [1.0, 8.0], [1.0, 90.0], [4.0, 90.0], [4.0, 9.0], [5.0, 9.0]])
            .expect("points");
        let beside = two.beside(&[sample(1), sample(2), sample(3), sample(4)], 10.0).expect("beside");
        assert!((beside[1] - beside[0] - (beside[2] - beside[1])).abs() < 1e-9 && beside[1] > 8.0, "{beside:?}");
        assert_eq!(two.beside(&[sample(50)], 10.0), None);
    }

    #[test]
    fn a_table_of_another_kind_is_refused_with_its_place() {
        for (text, line, found) in [
            ("x,y\n1,2\n", 1, "the columns are x, y"),
            ("x_mm,y_mm\n1,2\n1,two\n", 3, "`two` is not a coordinate in mm"),
            ("x_mm,y_mm\n1,2\n", 1, "fewer than two points"),
            ("x_mm,y_mm\n1,2\n1;3\n", 3, "another number of columns"),
        ] {
            let error = Surface::read(&source(text)).expect_err(text);
            assert!(error.found().contains(found), "{}", error.found());
            assert_eq!(error.line_column().map(|(l, _)| l), Some(line), "{text}");
        }
    }
}
