//! How long processes take, and which of them a program can be written with: leads and heights decide, and the order of directions.

use std::collections::HashMap;
use std::sync::Mutex;

use truepath_core::process::Slices;
use truepath_core::units::{Offset, Real};
use truepath_job::job::PlanTable;
use truepath_job::pass::Pass;
use truepath_program::passes::{Times as Written, Turn};

use super::mounted::DIVISIONS;
use super::process::Cut;
use crate::planned;

/// Rounding of times.
const ROUNDING: f64 = 1.0001;
/// What is kept free of the limit: displaced passes and the ways between them are longer than the programmed ones, by up to 0.8 % in
/// what was tried.
const DISPLACED: f64 = 0.99;

/// The times of a contour: each process is written out along the programmed path and its moves at feed are counted, with leads and
/// ways down and up. Rapids are not counted.
#[derive(Debug)]
pub struct Times<'a> {
    pass: &'a Pass,
    /// Height of the wall, mm.
    depth: Real,
    /// Minutes along the contour at the programmed feed, with the cutter of the program and with the one that is planned for.
    along: [f64; 2],
    /// What was found out, by raise and direction of the passes; `None` where no program can be written.
    known: Mutex<HashMap<Turns, Option<Written>>>,
}

/// Raise and direction of every pass.
type Turns = Vec<(Offset, bool)>;

impl<'a> Times<'a> {
    /// Of a wall of a height, mm, with the minutes along the contour at the programmed feed, of the cutter of the program and of the
    /// one that is planned for.
    pub fn new(pass: &'a Pass, depth: Real, along: [f64; 2]) -> Self {
        Self { pass, depth, along, known: Mutex::default() }
    }

    /// Minutes that the contour of the program takes, spring passes behind it included.
    pub fn programmed(&self) -> f64 {
        let written = self.written(vec![(Offset::ZERO, false)]);
        written.map_or(self.along[0], |times| times.programmed * self.stretched(&times))
    }

    /// Minutes that cuts take; `None` where no program can be written with them. A program to which nothing can be added can be
    /// corrected, and then contours alone are counted.
    pub fn of(&self, cuts: &[Cut]) -> Option<f64> {
        let slices = Slices::new(DIVISIONS);
        let orders = cuts.iter().flat_map(|cut| cut.orders(slices));
        let turns: Turns =
            orders.map(|pass| (Offset::from_mm(self.depth * pass.raised), pass.order.reversed)).collect();
        let plain = turns == [(Offset::ZERO, false)];
        let Some(times) = self.written(turns) else { return plain.then(|| self.at_least(cuts)) };
        let wider = times.contour * (self.along[1] / self.along[0] - 1.0);
        let feeds = cuts.iter().flat_map(|cut| cut.orders(slices).into_iter().map(|_| feed(cut)));
        let passes: f64 =
            times.passes.iter().zip(feeds).map(|(pass, feed)| pass.beside + (pass.along + wider) / feed).sum();
        Some((times.kept + passes) * self.stretched(&times))
    }

    /// Minutes along the contour alone: less than any program with these cuts takes, and more cuts take no less.
    pub fn at_least(&self, cuts: &[Cut]) -> f64 {
        let slices = Slices::new(DIVISIONS);
        cuts.iter().map(|cut| cut.orders(slices).len() as f64 * self.along[1] / feed(cut)).sum()
    }

    /// Whether so many minutes are within the limit of the job.
    pub fn keeps(&self, limits: &PlanTable, minutes: f64) -> bool {
        let programmed = self.programmed();
        minutes <= (limits.max_time_ratio * DISPLACED).max(ROUNDING) * programmed
    }

    /// The feeds of the cut over the F words: where the job says other ones, all times are of these.
    fn stretched(&self, times: &Written) -> f64 {
        if times.contour > 0.0 { self.along[0] / times.contour } else { 1.0 }
    }

    fn written(&self, turns: Turns) -> Option<Written> {
        let found = |known: &Mutex<HashMap<_, _>>| known.lock().ok().and_then(|known| known.get(&turns).cloned());
        found(&self.known).unwrap_or_else(|| {
            let turn = |&(raise, reversed): &(Offset, bool)| Turn { raise, reversed, feed: 1.0 };
            let written = planned::times(self.pass, &turns.iter().map(turn).collect::<Vec<_>>(), false).ok();
            if let Ok(mut known) = self.known.lock() {
                known.insert(turns, written.clone());
            }
            written
        })
    }
}

fn feed(cut: &Cut) -> f64 {
    f64::from(cut.feed_percent) / 100.0
}
