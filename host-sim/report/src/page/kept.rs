//! Which samples of a contour a page shows: all, or of a very long one every n-th and the last.

/// Samples of a contour on a page at most: some 12 MB, which a browser still draws smoothly.
pub const MOST_SAMPLES: usize = 100_000;
/// Nodes of the wall error over the height at most.
const MOST_NODES: usize = 1_500;

/// The samples that are shown.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Kept {
    count: usize,
    every: usize,
}

impl Kept {
    /// Of so many samples.
    pub(super) fn of(count: usize) -> Self {
        // One more may come for the last sample.
        Self { count, every: count.div_ceil(MOST_SAMPLES - 1).max(1) }
    }

    /// Their indices, rising, the first and the last one among them.
    pub(super) fn indices(&self) -> impl Iterator<Item = usize> + Clone {
        let last = self.count.saturating_sub(1);
        let on_stride = self.count > 0 && last.is_multiple_of(self.every);
        let behind = (self.count > 0 && !on_stride).then_some(last);
        (0..self.count).step_by(self.every).chain(behind)
    }

    /// How many kept samples lie from one node of the wall error over the height to the next.
    pub(super) fn stride(&self) -> usize {
        self.indices().count().div_ceil(MOST_NODES).max(1)
    }

    /// The indices of the nodes.
    pub(super) fn nodes(&self) -> impl Iterator<Item = usize> + Clone {
        self.indices().step_by(self.stride())
    }

    /// A sentence when not all samples are kept.
    pub(super) fn note(&self) -> Option<String> {
        (self.every > 1).then(|| {
            format!(
                "the report shows one in {} of {} samples along the contour; the tables have all",
                self.every, self.count
            )
        })
    }
}

#[cfg(test)]
mod tests {
    use super::{Kept, MOST_NODES, MOST_SAMPLES};

    #[test]
    fn a_contour_of_ordinary_length_is_shown_whole() {
        let kept = Kept::of(1933);
        assert!(kept.indices().eq(0..1933));
        assert_eq!((kept.stride(), kept.note()), (2, None));
        assert_eq!(kept.nodes().last(), Some(1932));
    }

    #[test]
    fn no_length_gives_more_than_the_limits() {
        for count in [0, 1, 2, 99_999, 100_000, 100_001, 199_998, 200_000, 1_234_567, usize::MAX / 2] {
            // The bound itself, without walking along astronomically many samples.
            let kept = Kept::of(count);
            assert!(count.div_ceil(kept.every) < MOST_SAMPLES, "{count}");
            if count > 10_000_000 {
                continue;
            }
            let shown = kept.indices().count();
            assert!(shown <= MOST_SAMPLES, "{count}: {shown}");
            assert_eq!(kept.indices().last(), count.checked_sub(1));
            assert!(kept.nodes().count() <= MOST_NODES);
            assert_eq!(kept.note().is_some(), shown < count);
        }
    }
}
