//! What is done to long rows of numbers many times over: drawn walls, their largest errors and quantiles.
//!
//! In this room because it is built optimised in every profile, whoever calls.

/// Adds `by` times the numbers of another row.
pub fn add_scaled(to: &mut [f64], from: &[f64], by: f64) {
    for (to, from) in to.iter_mut().zip(from) {
        *to += from * by;
    }
}

/// Numbers of a block.
const BLOCK: usize = 8;

/// Rows that are added to others many times over, each times a number. A block of every row lies behind that of the row before, so that
/// sums stay in registers and memory is read from start to end.
#[derive(Clone, Debug)]
pub struct Weighable {
    rows: usize,
    blocks: Vec<[f64; BLOCK]>,
}

impl Weighable {
    /// Of rows as long as `length`; a shorter one ends with zeros.
    pub fn of<'a>(rows: impl Iterator<Item = &'a [f64]> + Clone, length: usize) -> Self {
        let block = |at: usize| {
            rows.clone().map(move |row| {
                let mut block = [0.0; BLOCK];
                let part = row.get(at * BLOCK..length.min(row.len())).unwrap_or_default();
                block.iter_mut().zip(part).for_each(|(slot, number)| *slot = *number);
                block
            })
        };
        Self { rows: rows.clone().count(), blocks: (0..length.div_ceil(BLOCK)).flat_map(block).collect() }
    }

    /// Adds every row times its weight to a row as long as they, one after the other.
    pub fn add(&self, to: &mut [f64], weights: &[f64]) {
        let mut places = self.blocks.chunks(self.rows.max(1));
        let (whole, end) = to.as_chunks_mut();
        for (to, blocks) in whole.iter_mut().zip(&mut places) {
            *to = added(*to, blocks, weights);
        }
        if let Some(blocks) = places.next() {
            let mut last = [0.0; BLOCK];
            last.iter_mut().zip(&*end).for_each(|(slot, number)| *slot = *number);
            end.iter_mut().zip(added(last, blocks, weights)).for_each(|(to, sum)| *to = sum);
        }
    }
}

fn added(mut sums: [f64; BLOCK], blocks: &[[f64; BLOCK]], weights: &[f64]) -> [f64; BLOCK] {
    for (block, by) in blocks.iter().zip(weights) {
        sums.iter_mut().zip(block).for_each(|(sum, number)| *sum += number * by);
    }
    sums
}

/// Adds one number to all of a row.
pub fn add(to: &mut [f64], number: f64) {
    for to in to {
        *to += number;
    }
}

/// Sorts numbers, the smallest first.
pub fn ascending(row: &mut [f64]) {
    row.sort_unstable_by(f64::total_cmp);
}

/// Sorts numbers; the one in the middle, the larger of two, 0 of none.
pub fn median(row: &mut [f64]) -> f64 {
    ascending(row);
    row.get(row.len() / 2).copied().unwrap_or(0.0)
}

/// The largest magnitude; zero of none.
pub fn largest(row: &[f64]) -> f64 {
    row.iter().fold(0.0, |most, value| most.max(value.abs()))
}

/// The largest magnitude of the means of so many neighbours each; zero of none.
pub fn largest_mean(row: &[f64], neighbours: usize) -> f64 {
    let mean = |part: &[f64]| part.iter().sum::<f64>() / part.len() as f64;
    row.chunks(neighbours.max(1)).fold(0.0, |most, part| most.max(mean(part).abs()))
}

/// Writes the magnitudes of a row.
pub fn magnitudes(row: &[f64], to: &mut Vec<f64>) {
    to.clear();
    to.extend(row.iter().map(|value| value.abs()));
}

/// 95 of 100 of some magnitudes are at most this; zero of none. Their order is lost.
pub fn p95(magnitudes: &mut [f64]) -> f64 {
    let [p95, _] = p95_and_largest(magnitudes);
    p95
}

/// What 95 of 100 of some magnitudes are at most, and the largest; zeros of none. Their order is lost.
pub fn p95_and_largest(magnitudes: &mut [f64]) -> [f64; 2] {
    if magnitudes.is_empty() {
        return [0.0; 2];
    }
    let at = (magnitudes.len() * 95 / 100).min(magnitudes.len() - 1);
    // The bits of numbers that are not negative ascend as they do.
    let (_, p95, larger) = magnitudes.select_nth_unstable_by_key(at, |m| m.to_bits());
    [*p95, p95.max(largest(larger))]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_added_to_and_asked() {
        let mut row = [1.0, -4.0, 2.0, 3.0, -1.0];
        add_scaled(&mut row, &[1.0, 1.0, 0.0, 0.0, 2.0], 0.5);
        assert_eq!(row, [1.5, -3.5, 2.0, 3.0, 0.0]);
        add(&mut row[..2], 0.5);
        let start: Vec<f64> = (0..19).map(|k| f64::from(k) / 7.0).collect();
        let (mut together, mut each) = (start.clone(), start.clone());
        let (rows, weights) = ([&start[..], &[3.0, 0.1], &start], [0.1, -0.3, 1.7]);
        Weighable::of(rows.into_iter(), start.len()).add(&mut together, &weights);
        rows.iter().zip(weights).for_each(|(row, by)| add_scaled(&mut each, row, by));
        assert_eq!(together, each);
        assert_eq!((largest(&row), largest_mean(&row, 2)), (3.0, 2.5));
        let mut all = Vec::new();
        magnitudes(&row, &mut all);
        assert_eq!((p95_and_largest(&mut all), p95_and_largest(&mut [])), ([3.0; 2], [0.0; 2]));
        assert_eq!((largest(&[]), largest_mean(&[], 3)), (0.0, 0.0));
        let mut hundred: Vec<f64> = (0..100).rev().map(f64::from).collect();
        assert_eq!((p95_and_largest(&mut hundred), p95(&mut hundred)), ([95.0, 99.0], 95.0));
    }
}
