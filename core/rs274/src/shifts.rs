//! Where the origin of the program lies: work offset, rotation, local offset, tool.
//!
//! machine = R · (program + local) + work + tool, R being the rotation of the work offset about Z (LinuxCNC's order:
//! G92 and G52 are inside the rotation, the tool offset is not). A shift keeps the machine where it is and gives the
//! same place another name; without rotation that is exact.
//!
//! Limits: with a rotation the new name is rounded to 1 nm; X and Y are then both unknown when one of them is.

use super::Axes;
use truepath_units::{Offset, Position, Real, sin_cos};

/// Axes of LinuxCNC in their order: X Y Z A B C U V W.
pub const AXIS_LETTERS: [u8; 9] = *b"XYZABCUVW";

/// Values of nine axes: nanometres, for A B C millionths of a degree.
pub type NineAxes = [i64; 9];

/// The parts of the shift between program and machine.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Shifts {
    /// The origin of the work offset in force (G54 …).
    pub work: NineAxes,
    /// Its rotation about Z, millionths of a degree, counter-clockwise.
    pub rotation: i64,
    /// G92 and G52, as far as in force.
    pub local: NineAxes,
    /// The tool offset in force.
    pub tool: NineAxes,
}

/// One turn in millionths of a degree.
pub(super) const TURN: i64 = 360_000_000;
const QUARTER: i64 = 90_000_000;

/// (sine, cosine) of an angle in millionths of a degree; exact at quarter turns.
pub(super) fn sin_cos_degrees(angle: i64) -> (Real, Real) {
    let angle = angle.checked_rem_euclid(TURN).unwrap_or(0);
    let quarters = angle.saturating_add(QUARTER / 2) / QUARTER;
    let rest = angle.saturating_sub(quarters.saturating_mul(QUARTER));
    let (s, c) = sin_cos(Real::PI.times(Real::ratio(rest, TURN / 2)));
    match quarters {
        1 => (c, -s),
        2 => (-s, -c),
        3 => (-c, s),
        _ => (s, c),
    }
}

/// A vector in the plane, turned.
fn turned((x, y): (i64, i64), (sine, cosine): (Real, Real)) -> (i64, i64) {
    let (x, y) = (Offset::from_nm(x), Offset::from_nm(y));
    (x.blend(cosine, -y, sine).nm(), x.blend(sine, y, cosine).nm())
}

impl Shifts {
    /// No shift.
    pub(super) const NONE: Self = Self { work: [0; 9], rotation: 0, local: [0; 9], tool: [0; 9] };

    /// An element of an axis table; 0 where there is none.
    fn of(table: &NineAxes, axis: usize) -> i64 {
        table.get(axis).copied().unwrap_or(0)
    }

    /// Work and tool offset of an axis.
    fn outer(&self, axis: usize) -> i64 {
        Self::of(&self.work, axis).saturating_add(Self::of(&self.tool, axis))
    }

    /// The machine coordinates of a place of the program.
    pub fn to_machine(&self, place: Axes) -> Axes {
        place_of(Self::NONE.renamed(self, coordinates(place)))
    }

    /// The program coordinates of a place of the machine.
    pub fn to_program(&self, machine: Axes) -> Axes {
        place_of(self.renamed(&Self::NONE, coordinates(machine)))
    }

    /// The same place in other coordinates: `place` is in those of `before`.
    pub fn renamed_from(&self, before: &Self, place: Axes) -> Axes {
        place_of(self.renamed(before, coordinates(place)))
    }

    /// How much larger the coordinate of an axis that does not turn becomes from `before` to `self`.
    pub fn difference(&self, before: &Self, axis: usize) -> i64 {
        let inner = Self::of(&before.local, axis).saturating_sub(Self::of(&self.local, axis));
        inner.saturating_add(before.outer(axis).saturating_sub(self.outer(axis)))
    }

    fn renamed(&self, before: &Self, place: [Option<i64>; 3]) -> [Option<i64>; 3] {
        let [x, y, z] = place;
        let z = z.map(|z| z.saturating_add(self.difference(before, 2)));
        if self.rotation == 0 && before.rotation == 0 {
            let shifted = |v: Option<i64>, axis| v.map(|v| v.saturating_add(self.difference(before, axis)));
            return [shifted(x, 0), shifted(y, 1), z];
        }
        let (Some(x), Some(y)) = (x, y) else { return [None, None, z] };
        let inside = |v: i64, axis| v.saturating_add(Self::of(&before.local, axis));
        let (mx, my) = turned((inside(x, 0), inside(y, 1)), sin_cos_degrees(before.rotation));
        let outside = |v: i64, axis| v.saturating_add(before.outer(axis)).saturating_sub(self.outer(axis));
        let back = sin_cos_degrees(self.rotation.saturating_neg());
        let (x, y) = turned((outside(mx, 0), outside(my, 1)), back);
        let [lx, ly, ..] = self.local;
        [Some(x.saturating_sub(lx)), Some(y.saturating_sub(ly)), z]
    }

    /// The work offset that gives the machine's place the program coordinates `named`, everything else kept. What is
    /// unknown keeps its offset.
    pub fn work_naming(&self, machine: Axes, named: Axes) -> NineAxes {
        let unshifted = Self { work: [0; 9], ..*self };
        let there = coordinates(unshifted.to_machine(named));
        let mut work = self.work;
        for ((work, there), at) in work.iter_mut().zip(there).zip(coordinates(machine)) {
            if let (Some(there), Some(at)) = (there, at) {
                *work = at.saturating_sub(there);
            }
        }
        work
    }
}

fn coordinates(place: Axes) -> [Option<i64>; 3] {
    [place.x, place.y, place.z].map(|p| p.map(Position::nm))
}

fn place_of([x, y, z]: [Option<i64>; 3]) -> Axes {
    Axes { x: x.map(Position::from_nm), y: y.map(Position::from_nm), z: z.map(Position::from_nm) }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::arithmetic_side_effects)]
    use super::*;
    use proptest::prelude::*;

    const MM: i64 = 1_000_000;

    fn at(x: i64, y: i64, z: i64) -> Axes {
        place_of([Some(x), Some(y), Some(z)])
    }

    fn shifts(work: (i64, i64), degrees: i64, local: i64) -> Shifts {
        let mut shifts = Shifts { rotation: degrees * 1_000_000, ..Shifts::default() };
        shifts.work[0] = work.0 * MM;
        shifts.work[1] = work.1 * MM;
        shifts.local[0] = local * MM;
        shifts
    }

    #[test]
    fn a_rotated_work_offset_turns_the_local_offset_too() {
        let turned = shifts((10, 0), 90, 1);
        assert_eq!(turned.to_machine(at(0, 5 * MM, 7)), at(5 * MM, MM, 7));
        assert_eq!(turned.to_program(at(5 * MM, MM, 7)), at(0, 5 * MM, 7));
    }

    #[test]
    fn what_is_unknown_stays_unknown() {
        let x_unknown = Axes { x: None, ..at(0, 1, 2) };
        assert_eq!(shifts((1, 1), 0, 0).to_machine(x_unknown), Axes { x: None, ..at(0, MM + 1, 2) });
        assert_eq!(shifts((1, 1), 30, 0).to_machine(x_unknown), Axes { x: None, y: None, ..at(0, 0, 2) });
    }

    #[test]
    fn an_offset_is_found_that_gives_the_place_its_name() {
        let before = shifts((10, 0), 90, 1);
        let machine = at(10 * MM, MM, 0);
        let mut after = before;
        after.work = before.work_naming(machine, at(3 * MM, 0, 0));
        assert_eq!(after.to_program(machine), at(3 * MM, 0, 0));
        assert_eq!(after.work[..2], [10 * MM, -3 * MM]);
    }

    proptest! {
        #[test]
        fn there_and_back_is_the_same_place_to_a_nanometre(
            x in -1_000_000_000i64..1_000_000_000, y in -1_000_000_000i64..1_000_000_000,
            degrees in -400i64..400, w in -900i64..900, l in -900i64..900,
        ) {
            let s = shifts((w, -w), degrees, l);
            let back = coordinates(s.to_program(s.to_machine(at(x, y, 0))));
            prop_assert!((back[0].unwrap() - x).abs() <= 1 && (back[1].unwrap() - y).abs() <= 1);
            if degrees % 90 == 0 {
                prop_assert_eq!((back[0], back[1]), (Some(x), Some(y)));
            }
        }
    }
}
