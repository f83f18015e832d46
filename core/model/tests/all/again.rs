//! A pass that keeps what the correction has not changed is the one that keeps nothing.

use std::cell::Cell;

use super::corner::{chain, corner, designed_by, machine, path, point, real, setup};
use truepath_model::correct::{Again, Band, InOrder, Law, Profile, Scratch, WallReader};
use truepath_model::cut::{Compliance, ForceTable, Loop, Milling, Passage, State, WallLaw};
use truepath_units::geometry::{Block, Curve, Vector};

/// Reads as [`InOrder`], and counts the samples whose cutter may have moved; knows nothing of the pass before, if so asked.
struct Counted<'c> {
    forgets: bool,
    moved: &'c Cell<usize>,
}

impl WallReader for Counted<'_> {
    fn run(
        &mut self,
        machine: &Loop,
        from: usize,
        states: &mut [State],
        again: Again,
        commanded: impl Fn(usize) -> Vector + Sync,
        seen: &mut dyn FnMut(usize, bool),
    ) -> Passage {
        let again = if self.forgets { Again::Afresh } else { again };
        InOrder.run(machine, from, states, again, commanded, &mut |index, moved| {
            self.moved.set(self.moved.get() + usize::from(moved));
            seen(index, moved);
        })
    }

    fn profile(
        &mut self,
        machine: &Loop,
        states: &[State],
        band: Band,
        displacements: &mut [Vector],
        profiles: &mut [Profile],
    ) {
        InOrder.profile(machine, states, band, displacements, profiles);
    }

    fn each(&mut self, slots: &mut [Scratch], length: usize, work: impl Fn(usize, &mut [Scratch]) + Sync) {
        InOrder.each(slots, length, work);
    }
}

/// Straight legs of a sharp inside corner, and a closed contour of four rounded ones, which both take many refinements.
fn contours() -> [Vec<Block>; 3] {
    let sharp = [
        Curve::line(point(34.0, 70.0), point(34.0, 30.0)).unwrap(),
        Curve::line(point(34.0, 30.0), point(74.0, 30.0)).unwrap(),
    ];
    let arc = |from: (f64, f64), to: (f64, f64), centre: (f64, f64)| {
        Curve::arc(point(from.0, from.1), point(to.0, to.1), point(centre.0, centre.1), true).unwrap()
    };
    let line = |from: (f64, f64), to: (f64, f64)| Curve::line(point(from.0, from.1), point(to.0, to.1)).unwrap();
    let round = [
        line((20.0, 0.0), (36.0, 0.0)),
        arc((36.0, 0.0), (40.0, 4.0), (36.0, 4.0)),
        line((40.0, 4.0), (40.0, 26.0)),
        arc((40.0, 26.0), (36.0, 30.0), (36.0, 26.0)),
        line((36.0, 30.0), (4.0, 30.0)),
        arc((4.0, 30.0), (0.0, 26.0), (4.0, 26.0)),
        line((0.0, 26.0), (0.0, 4.0)),
        arc((0.0, 4.0), (4.0, 0.0), (4.0, 4.0)),
        line((4.0, 0.0), (20.0, 0.0)),
    ];
    [corner(), chain(&sharp, 400.0), chain(&round, 400.0)]
}

#[test]
fn what_is_kept_from_one_pass_to_the_next_changes_no_bit_and_spares_most_of_the_work() {
    let table = ForceTable::new(real(0.15));
    for blocks in contours() {
        for milling in [Milling::Climb, Milling::Conventional] {
            let setup = truepath_model::cut::CutSetup { milling, ..setup(WallLaw::Helical) };
            let path = path(&blocks, &setup, 200);
            let mut machine = machine(&path, &table, Compliance::from_stiffness(real(1150.0), real(2300.0)));
            machine.coefficients.size_exponent = real(0.15);
            let by = |forgets: bool| {
                let moved = Cell::new(0);
                let made = designed_by(&machine, Law::Model, Counted { forgets, moved: &moved });
                (made, moved.get())
            };
            let (all, every) = by(true);
            let (kept, some) = by(false);
            assert_eq!(all, kept);
            let passes = every / path.working().len();
            println!("{passes} passes, {some} of {every} samples");
            assert!(passes < 6 || some * 10 < every * 9, "{some} of {every} in {passes} passes");
        }
    }
}
