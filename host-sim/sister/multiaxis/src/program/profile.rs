//! The largest error along the program, before and after, in a fixed number of stretches of equally many moves.
//!
//! The number of moves is not known while they pass by: when the stretches are full, neighbours are joined and each
//! covers twice as many. So the profile of a program of any length takes the same memory, and no peak is lost.

/// Stretches at most.
const STRETCHES: usize = 1024;

/// The errors of a stretch of moves, mm: the largest before, the largest after.
pub type Peak = (f64, f64);

/// Largest errors along the program.
#[derive(Clone, Debug)]
pub struct Profile {
    peaks: Vec<Peak>,
    /// Moves in a full stretch.
    width: u64,
    /// Moves in the last one.
    filled: u64,
}

impl Default for Profile {
    fn default() -> Self {
        Self { peaks: Vec::new(), width: 1, filled: 1 }
    }
}

impl Profile {
    /// Adds the next move.
    pub fn add(&mut self, before: f64, after: f64) {
        if self.filled == self.width || self.peaks.is_empty() {
            if self.peaks.len() == STRETCHES {
                let joined = |pair: &[Peak]| pair.iter().fold((0.0f64, 0.0f64), |m, p| (m.0.max(p.0), m.1.max(p.1)));
                self.peaks = self.peaks.chunks(2).map(joined).collect();
                self.width *= 2;
            }
            self.peaks.push((0.0, 0.0));
            self.filled = 0;
        }
        self.filled += 1;
        if let Some(last) = self.peaks.last_mut() {
            *last = (last.0.max(before), last.1.max(after));
        }
    }

    /// The stretches: number of the first move, counted from 1, and the largest errors.
    pub fn stretches(&self) -> impl Iterator<Item = (f64, Peak)> + '_ {
        let width = self.width as f64;
        self.peaks.iter().enumerate().map(move |(k, &peak)| (k as f64 * width + 1.0, peak))
    }
    /// Moves in a stretch.
    pub fn width(&self) -> u64 {
        self.width
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn peaks_stay_where_they_are_and_memory_stays_bounded() {
        let mut profile = Profile::default();
        for k in 1..=100_000u32 {
            let peak = if k == 77_777 { 5.0 } else { 1.0 };
            profile.add(peak, 0.1);
        }
        let stretches: Vec<_> = profile.stretches().collect();
        assert!(stretches.len() <= STRETCHES && stretches.len() > STRETCHES / 2 - 1);
        let at = stretches.iter().position(|s| s.1.0 == 5.0).unwrap();
        let width = profile.width() as f64;
        assert!(stretches[at].0 <= 77_777.0 && 77_777.0 < stretches[at].0 + width);
        assert_eq!(stretches.iter().filter(|s| s.1.0 == 5.0).count(), 1);
    }
}
