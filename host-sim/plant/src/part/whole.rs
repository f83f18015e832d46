//! The part: set up once, cut by run after run.

use super::field::Field;
use super::laps::{Run, laps};
use super::march::{Equilibrium, LapFacts, LapSample, March};
use super::rays::Rays;
use super::slices::{Heights, Slice, slices};
use super::surface::Surface;
use crate::driven::driven;
use crate::error::{PlantError, require};
use crate::flutes::Flutes;
use crate::machine::Machine;
use crate::path::Path;
use crate::score::{Score, judged_trim_mm, p95};
use crate::setup::Cut;
use crate::vector::{Point, along};

/// So many different feeds of a lap have a force table each; of more, those within ¼ % share one.
const MOST_FEEDS: usize = 64;
/// Feeds that share a table, as a share of the feed.
const SAME_FEED: f64 = 0.0025;

/// A part on the machine.
///
/// Set-up and stock are those of a [`Cut`]: its feeds and speed are those of the runs instead, its axial depth is the height
/// over which the cutter bends, and its memory has no meaning here.
#[derive(Debug, Clone)]
pub struct Part {
    path: Path,
    cut: Cut,
    machine: Machine,
    slices: Vec<Slice>,
    /// The first slice of the wall; below it is stock that deeper runs cut.
    bottom: usize,
    rays: Rays,
    field: Field,
    equilibrium: Equilibrium,
    travelled_mm: f64,
    facts: Vec<LapFacts>,
    samples: Vec<Vec<LapSample>>,
}

impl Part {
    /// A part with all of its stock.
    ///
    /// # Errors
    /// A value out of range; stock deeper than the cutter's radius.
    pub fn new(path: &Path, cut: &Cut, machine: &Machine, heights: &Heights) -> Result<Self, PlantError> {
        cut.check()?;
        machine.check(cut.teeth)?;
        let slices = slices(heights)?;
        let rays = Rays::new(path, cut.radius_mm);
        let field = Field::new(path, &rays, cut, machine, &slices);
        let (most, r) = (field.most(), cut.radius_mm);
        require(most <= r, "allowance_mm", most, "up to the cutter's radius, where passes follow each other")?;
        Ok(Self {
            path: path.clone(),
            cut: cut.clone(),
            machine: machine.clone(),
            bottom: slices.partition_point(|s| s.middle() < heights.bottom_z_mm),
            slices,
            rays,
            field,
            equilibrium: Equilibrium::Instant,
            travelled_mm: 0.0,
            facts: Vec::new(),
            samples: Vec::new(),
        })
    }

    /// The same with another law for the instants.
    #[must_use]
    pub fn with(mut self, equilibrium: Equilibrium) -> Self {
        self.equilibrium = equilibrium;
        self
    }

    /// Cuts along a run; gives the number of laps that go along the contour.
    ///
    /// # Errors
    /// A value out of range.
    pub fn cut(&mut self, run: &Run) -> Result<usize, PlantError> {
        run.check()?;
        let mut found = laps(&self.path, run, self.field.most());
        for lap in &mut found {
            let told: Vec<_> = lap.steps.iter().map(|s| (s.commanded, s.nominal, s.feed_mm_per_min)).collect();
            let goes = driven(&told, &self.path, &self.machine);
            lap.steps.iter_mut().zip(goes).for_each(|(step, centre)| step.commanded = centre);
            let climb = self.cut.is_climb(&self.path) != lap.reversed;
            let mut feeds: Vec<f64> = lap.steps.iter().map(|step| step.feed_mm_per_min).collect();
            let mut each = feeds.clone();
            each.sort_unstable_by(f64::total_cmp);
            each.dedup();
            if each.len() > MOST_FEEDS {
                let step = SAME_FEED.ln_1p();
                feeds.iter_mut().for_each(|feed| *feed = ((feed.ln() / step).round() * step).exp());
                each.clone_from(&feeds);
                each.sort_unstable_by(f64::total_cmp);
                each.dedup();
            }
            let cut = Cut { spindle_rpm: run.spindle_rpm, ..self.cut.clone() };
            let flutes: Vec<Flutes> = each.iter().map(|feed| Flutes::new(&cut, &self.machine, climb, *feed)).collect();
            let which: Vec<usize> = feeds.iter().map(|feed| each.partition_point(|f| f < feed)).collect();
            let march = March {
                path: &self.path,
                cut: &self.cut,
                machine: &self.machine,
                rays: &self.rays,
                slices: &self.slices,
                equilibrium: self.equilibrium,
                climb,
                reversed: lap.reversed,
                flutes: &flutes,
                which: &which,
            };
            let (facts, samples) = march.go(lap, &mut self.field, &mut self.travelled_mm);
            self.facts.push(facts);
            self.samples.push(samples);
        }
        Ok(found.len())
    }

    /// The nominal path.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The set-up.
    pub fn set_up(&self) -> &Cut {
        &self.cut
    }

    /// The machine.
    pub fn machine(&self) -> &Machine {
        &self.machine
    }

    /// What the laps were, in order.
    pub fn laps(&self) -> &[LapFacts] {
        &self.facts
    }

    /// The steps of every lap.
    pub fn samples(&self) -> &[Vec<LapSample>] {
        &self.samples
    }

    /// The wall as it is now.
    pub fn surface(&self) -> Surface {
        let rows = &self.rays.rows;
        let wall = self.bottom..self.slices.len();
        let error = |k: usize| {
            let value = move |row: usize| if rows[row].on_part { self.field.row(row)[k] } else { f64::NAN };
            (0..rows.len()).map(value).collect()
        };
        Surface::new(
            rows.iter().map(|row| row.s_mm).collect(),
            rows.iter().map(|row| row.wall_mm).collect(),
            self.slices[wall.clone()].iter().map(|s| (s.lower, s.upper)).collect(),
            wall.map(error).collect(),
        )
    }

    /// Lower and upper edge of the wall, mm.
    pub fn height_mm(&self) -> [f64; 2] {
        let edge = |slice: Option<&Slice>, of: fn(&Slice) -> f64| slice.map_or(0.0, of);
        [edge(self.slices.get(self.bottom), |s| s.lower), edge(self.slices.last(), |s| s.upper)]
    }

    /// Judges the wall, in the numbers of a single pass ([`crate::Milled::score`]): the ten heights are all slices.
    pub fn score(&self) -> Score {
        let surface = self.surface();
        let means = surface.means();
        let trim = judged_trim_mm(self.cut.radius_mm);
        let judged = |i: &usize| surface.s_mm[*i] > trim && surface.s_mm[*i] < self.path.length_mm - trim;
        let places = || (0..means.len()).filter(judged).filter(|i| means[*i].is_finite());
        let errors = |i: usize| surface.errors_mm.iter().map(move |slice| slice[i]);
        let most = |of: &dyn Fn(usize) -> f64| places().map(of).fold(f64::NEG_INFINITY, f64::max);
        let squares: f64 = places().map(|i| means[i] * means[i]).sum();
        Score {
            max_error_mm: most(&|i| means[i].abs()),
            rms_error_mm: (squares / places().count() as f64).sqrt(),
            worst_height_mm: most(&|i| errors(i).map(f64::abs).fold(0.0, f64::max)),
            p95_mm: p95(&mut places()
                .flat_map(|i| errors(i).map(f64::abs))
                .filter(|e| e.is_finite())
                .collect::<Vec<f64>>()),
            gouge_mm: most(&|i| -means[i]),
            axial_form_mm: most(&|i| {
                let (least, most) =
                    errors(i).fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), e| (a.min(e), b.max(e)));
                most - least
            }),
        }
    }

    /// Wall error at each nominal sample, mean over the height, mm; NaN where no wall is.
    pub fn mean_errors(&self) -> Vec<f64> {
        let means = self.surface().means();
        let row = |i: usize| self.rays.ray(self.rays.of_sample(i)).map_or(f64::NAN, |ray| means[ray.row]);
        (0..self.path.len()).map(row).collect()
    }

    /// The wall as it is at a height, in the sense of the contour, mm. Undefined places are left out.
    pub fn wall_at(&self, z_mm: f64) -> Vec<Point> {
        let place = |(i, e): (usize, f64)| {
            e.is_finite().then(|| along(self.path.wall(i, self.cut.radius_mm), self.path.normal[i], -e))
        };
        self.errors_at(z_mm).into_iter().enumerate().filter_map(place).collect()
    }

    /// Wall error at each nominal sample at a height, between the middles of slices by proportion, mm; NaN where no wall is.
    pub fn errors_at(&self, z_mm: f64) -> Vec<f64> {
        let above = self.slices.partition_point(|s| s.middle() <= z_mm);
        let above = above.clamp(self.bottom, self.slices.len());
        let (a, b) = (above.saturating_sub(1).max(self.bottom), above.min(self.slices.len() - 1));
        let (za, zb) = (self.slices[a].middle(), self.slices[b].middle());
        let u = if b > a { (z_mm - za) / (zb - za) } else { 0.0 };
        let error = |i: usize| {
            let Some(ray) = self.rays.ray(self.rays.of_sample(i)) else { return f64::NAN };
            let (row, left) = (&self.rays.rows[ray.row], self.field.row(ray.row));
            if row.on_part { left[a] + (left[b] - left[a]) * u } else { f64::NAN }
        };
        (0..self.path.len()).map(error).collect()
    }
}
