//! Readings that are not judged, and whether they leave a doubt about the wall.

use truepath_core::probe::Rejected;
use truepath_core::units::Offset;

/// Readings set aside.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SetAside {
    /// All of them.
    pub all: usize,
    /// Those that may have touched, or missed, this wall where it is far off. A part with such readings cannot pass.
    pub doubtful: usize,
}

impl SetAside {
    /// Those of two walls.
    #[must_use]
    pub const fn and(self, other: Self) -> Self {
        Self { all: self.all + other.all, doubtful: self.doubtful + other.doubtful }
    }
    /// Of the reasons of all readings set aside; a reading nearer than `near` to the wall may be of it.
    pub fn of<'a>(reasons: impl IntoIterator<Item = &'a Rejected>, near: Offset) -> Self {
        reasons.into_iter().fold(Self::default(), |so_far, reason| Self {
            all: so_far.all + 1,
            doubtful: so_far.doubtful + usize::from(is_doubtful(reason, near)),
        })
    }
}

fn is_doubtful(reason: &Rejected, near: Offset) -> bool {
    match reason {
        Rejected::OffTheWall { distance } => distance.abs() < near,
        Rejected::Missed | Rejected::Normal { .. } => true,
        // Another touch of the place counts, or it is no place of this wall.
        Rejected::Superseded | Rejected::Repeat { .. } | Rejected::OffHeight { .. } => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_reading_near_the_wall_a_miss_and_a_strange_normal_leave_a_doubt() {
        let um = Offset::from_um;
        let reasons = [
            (Rejected::OffTheWall { distance: um(1_500) }, 1),
            (Rejected::OffTheWall { distance: um(-1_500) }, 1),
            (Rejected::OffTheWall { distance: um(10_000) }, 0),
            (Rejected::OffTheWall { distance: Offset::MAX }, 0),
            (Rejected::Missed, 1),
            (Rejected::Normal { opposite: true }, 1),
            (Rejected::Superseded, 0),
            (Rejected::Repeat { of: 3 }, 0),
            (Rejected::OffHeight { height: um(-200) }, 0),
        ];
        for (reason, doubtful) in &reasons {
            assert_eq!(SetAside::of([reason], um(10_000)), SetAside { all: 1, doubtful: *doubtful }, "{reason:?}");
        }
        assert_eq!(SetAside::of(reasons.iter().map(|(r, _)| r), um(10_000)), SetAside { all: 9, doubtful: 4 });
    }
}
