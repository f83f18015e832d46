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

use crate::codes::K001;

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
        let wrong = |found: String, line: u64| {
            let line = u32::try_from(line).unwrap_or(u32::MAX);
            let length =
                source.bytes().split(|b| *b == b'\n').nth(line.saturating_sub(1) as usize).map_or(0, <[u8]>::len);
            let span = source.span_at(line, 1, u32::try_from(length).unwrap_or(u32::MAX));
            K001.error(found, "columns x_mm and y_mm with numbers").at(source, span)
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

    /// Distance from a point along a direction to the surface, mm, the one nearest to `expected`; `None` when none of
    /// these segments passes there within `reach`.
    fn along(
        &self,
        segments: impl IntoIterator<Item = usize>,
        from: [f64; 2],
        direction: [f64; 2],
        expected: f64,
        reach: f64,
    ) -> Option<f64> {
        let mut best: Option<f64> = None;
        for k in segments {
            let (start, end) = (self.points[k], self.points[k + 1]);
            let chord = [end[0] - start[0], end[1] - start[1]];
            let to = [start[0] - from[0], start[1] - from[1]];
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
        let boxes = Boxes::of(&self.points);
        let seen: Vec<Option<f64>> = samples
            .iter()
            .map(|sample| {
                let from = [mm(sample.point.x), mm(sample.point.y)];
                let normal =
                    [truepath_ground::units::float(sample.normal.x), truepath_ground::units::float(sample.normal.y)];
                let near = boxes.near(from, normal, [-radius_mm, 3.0 * radius_mm]);
                self.along(near, from, normal, radius_mm, 2.0 * radius_mm)
            })
            .collect();
        let first = *seen.iter().flatten().next()?;
        // The next distance that was seen, and how many samples ahead.
        let mut ahead = vec![None; seen.len()];
        for k in (0..seen.len()).rev() {
            let later = ahead.get(k + 1).copied().flatten();
            ahead[k] =
                seen[k].map(|distance| (distance, 0u32)).or(later.map(|(distance, count)| (distance, count + 1)));
        }
        let mut last = first;
        let filled = ahead.into_iter().map(|next| {
            last = match next {
                Some((distance, 0)) => distance,
                // A hole is bridged evenly; beyond the last point the last distance goes on.
                Some((distance, count)) => last + (distance - last) / (f64::from(count) + 1.0),
                None => last,
            };
            last
        });
        Some(filled.collect())
    }
}

fn cross(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

/// Bounding boxes of consecutive segments, and boxes of pairs of boxes up to a single one: the segments near a line
/// are found without a look at all.
struct Boxes {
    segments: usize,
    /// Centre and half of the size; those of the segments first.
    levels: Vec<Vec<[[f64; 2]; 2]>>,
}

/// Segments in the smallest box.
const LEAF: usize = 8;

/// What the place where a line meets a segment may be off by rounding, mm: across the line, and along it, where a
/// segment that is nearly parallel to the line makes the error large.
const ROUNDING: [f64; 2] = [1e-6, 1.0];

impl Boxes {
    fn of(points: &[[f64; 2]]) -> Self {
        let bounds = |points: &[[f64; 2]]| {
            let start = [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]];
            points.iter().fold(start, |[low, high], p| {
                [[low[0].min(p[0]), low[1].min(p[1])], [high[0].max(p[0]), high[1].max(p[1])]]
            })
        };
        let segments = points.len().saturating_sub(1);
        let leaves = (0..segments).step_by(LEAF).map(|k| bounds(&points[k..=(k + LEAF).min(segments)]));
        let mut levels: Vec<Vec<_>> = vec![leaves.collect()];
        while let Some(below) = levels.last().filter(|below| below.len() > 1) {
            let above = below.chunks(2).map(|pair| bounds(pair.as_flattened())).collect();
            levels.push(above);
        }
        let centred = |[low, high]: [[f64; 2]; 2]| {
            [[(low[0] + high[0]) / 2.0, (low[1] + high[1]) / 2.0], [(high[0] - low[0]) / 2.0, (high[1] - low[1]) / 2.0]]
        };
        let levels = levels.into_iter().map(|level| level.into_iter().map(centred).collect()).collect();
        Self { segments, levels }
    }

    /// Every segment that may meet a line within a range of it, and few others, in their order.
    fn near(&self, from: [f64; 2], direction: [f64; 2], range: [f64; 2]) -> Vec<usize> {
        let [dx, dy] = direction;
        let square = dx * dx + dy * dy;
        let (middle, half) = ((range[0] + range[1]) / 2.0 * square, (range[1] - range[0]) / 2.0 * square);
        let meets = |[[x, y], [width, height]]: [[f64; 2]; 2]| {
            let to = [x - from[0], y - from[1]];
            let (across, along) = (cross(direction, to), dx * to[0] + dy * to[1]);
            across.abs() <= width * dy.abs() + height * dx.abs() + ROUNDING[0]
                && (along - middle).abs() <= half + width * dx.abs() + height * dy.abs() + ROUNDING[1]
        };
        let mut found = Vec::new();
        let mut open = vec![(self.levels.len() - 1, 0)];
        while let Some((level, k)) = open.pop() {
            let Some(bounds) = self.levels[level].get(k) else { continue };
            if !meets(*bounds) {
                continue;
            }
            match level.checked_sub(1) {
                Some(below) => open.extend([(below, 2 * k + 1), (below, 2 * k)]),
                None => found.extend(k * LEAF..self.segments.min((k + 1) * LEAF)),
            }
        }
        found
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

    /// Numbers in 0…1 that look like chance and are always the same.
    fn chance(seed: u64) -> impl FnMut() -> f64 {
        let mut state = seed;
        move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) as f64 / f64::from(1u32 << 31)
        }
    }

    #[test]
    fn boxes_leave_out_no_segment_that_the_line_meets_and_change_no_bit() {
        for seed in 0..40 {
            let mut next = chance(seed);
            let count = 2 + (next() * 300.0) as usize;
            let step = 10f64.powf(next() * 4.0 - 3.0);
            let mut at = [0.0, 0.0];
            let points = (0..count).map(|_| {
                // Steps along the axes too, so that lines run along segments and through their ends.
                let turn = [next(), next()].map(|v| if v < 0.3 { 0.0 } else { (v - 0.5) * step });
                at = [at[0] + turn[0], at[1] + turn[1]];
                at
            });
            let surface = Surface::new(points.collect()).expect("points");
            let boxes = Boxes::of(&surface.points);
            for _ in 0..200 {
                let angle = next() * 6.3;
                let direction = if next() < 0.3 { [0.0, 1.0] } else { [angle.cos(), angle.sin()] };
                let on = surface.points[(next() * count as f64) as usize % count];
                let from = if next() < 0.5 { [on[0], on[1] - step] } else { [next() * step, next() * step] };
                let near = boxes.near(from, direction, [-step, 3.0 * step]);
                let [some, all] = [
                    surface.along(near, from, direction, step, 2.0 * step),
                    surface.along(0..count - 1, from, direction, step, 2.0 * step),
                ]
                .map(|t| t.map(f64::to_bits));
                assert_eq!(some, all, "seed {seed}");
            }
        }
    }

    #[test]
    fn a_line_is_held_against_few_of_a_million_segments() {
        let turn = |k: u32| (f64::from(k) / f64::from(1 << 20) * std::f64::consts::TAU).sin_cos();
        let points: Vec<[f64; 2]> = (0..1 << 20).map(turn).map(|(y, x)| [50.0 * x, 30.0 * y]).collect();
        let boxes = Boxes::of(&points);
        for k in 0..1000 {
            let (y, x) = (f64::from(k) / 1000.0 * std::f64::consts::TAU).sin_cos();
            let asked = boxes.near([40.0 * x, 20.0 * y], [x, y], [-10.0, 30.0]).len();
            assert!((1..=64).contains(&asked), "{asked} segments at {k}");
        }
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
