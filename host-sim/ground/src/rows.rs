//! What is done to long rows of numbers many times over: drawn walls, their largest errors and quantiles.
//!
//! In this room because it is built optimised in every profile, whoever calls.

/// Adds `by` times the numbers of another row.
pub fn add_scaled(to: &mut [f64], from: &[f64], by: f64) {
    for (to, from) in to.iter_mut().zip(from) {
        *to += from * by;
    }
}

/// Adds every one of some rows, each times a number, one after the other; rows are as long as the one they are added to.
pub fn add_all_scaled(to: &mut [f64], rows: &[(&[f64], f64)]) {
    // Block by block, so that the sums stay in registers: every number is added to in the order of the rows all the same.
    const BLOCK: usize = 8;
    let (blocks, rest) = to.as_chunks_mut::<BLOCK>();
    for (at, sums) in blocks.iter_mut().enumerate() {
        for (row, by) in rows {
            if let Some(part) = row.get(at * BLOCK..).and_then(|rest| rest.first_chunk::<BLOCK>()) {
                sums.iter_mut().zip(part).for_each(|(sum, from)| *sum += from * by);
            }
        }
    }
    let done = blocks.len() * BLOCK;
    rows.iter().for_each(|(row, by)| add_scaled(rest, row.get(done..).unwrap_or_default(), *by));
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
    // The bits of numbers that are not negative ascend as they do.
    let at = (magnitudes.len() * 95 / 100).min(magnitudes.len().saturating_sub(1));
    if magnitudes.is_empty() { 0.0 } else { *magnitudes.select_nth_unstable_by_key(at, |m| m.to_bits()).1 }
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
        let rows: Vec<(&[f64], f64)> = [0.1, -0.3, 1.7].iter().map(|by| (start.as_slice(), *by)).collect();
        add_all_scaled(&mut together, &rows);
        rows.iter().for_each(|(row, by)| add_scaled(&mut each, row, *by));
        assert_eq!(together, each);
        assert_eq!((largest(&row), largest_mean(&row, 2)), (3.0, 2.5));
        let mut all = Vec::new();
        magnitudes(&row, &mut all);
        assert_eq!((p95(&mut all), p95(&mut []), largest(&[]), largest_mean(&[], 3)), (3.0, 0.0, 0.0, 0.0));
        let mut hundred: Vec<f64> = (0..100).rev().map(f64::from).collect();
        assert_eq!(p95(&mut hundred), 95.0);
    }
}
