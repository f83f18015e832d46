//! Heights that tell the profile of the wall: helix, bending and what repeats with the contact ratio.
//!
//! Where every height counts, and where a wall is taller than one axial contact ratio (`2πr/(N tan β)`: there the same
//! instant of a tooth comes again), even heights may all meet the same instant. So they are chosen as places are: one after the other,
//! each the one that most reduces what is uncertain of the wall over its whole height (a greedy I-optimal design), at
//! places all along the contour. What is uncertain is what the job leaves open of machine and material, by the physics of passes
//! ([`truepath_core::process`]), and a smooth share of the shape over the height that a model may miss. The
//! size of cutter and ball and the datum act on the readings of a place alike and are told from the wall by their differences.

use truepath_core::cut::{Path, WallLaw};
use truepath_core::identify::{COUNT, Parameter, Parameters};
use truepath_core::process::{ImmersionGrid, Mill, Slices};
use truepath_core::units::{Offset, Real};
use truepath_ground::diagnostics::Failure;
use truepath_ground::units::{float, mm};
use truepath_job::pass::Pass;

use crate::force_tables::force_table;
use crate::plan::bench::Bench;
use crate::plan::mounted::{Resolution, path};

/// Heights and why they were chosen.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct ProfileHeights {
    /// Above the tip, mm, from the highest down, each with what it is for.
    pub(super) above_tip_mm: Vec<(f64, &'static str)>,
    /// Why these.
    pub(super) why: String,
}

/// Fewest and most heights where the user does not say how many.
const COUNTS: [usize; 2] = [3, 5];
/// Share of the uncertainty that a further height must take to be worth its touches.
const WORTH: f64 = 0.1;
/// The wall on which heights are compared.
const LOOK: Resolution = Resolution { step_um: 1000, slices: 24, of_radius: 8 };
/// Places along the contour that are looked at.
const SITES: usize = 8;
/// Share of the contour at either end where none are.
const ENDS: f64 = 0.12;
/// Step of the difference quotients, prior standard deviations.
const STEP: Real = Real::ratio(1, 8);
/// Share of the shape over the height that a model may miss, and what it may miss at least, mm.
const MISSED: (f64, f64) = (0.05, 0.001);
/// Length over which it holds, as a share of the height.
const OVER_HEIGHT: f64 = 0.3;
/// Datum and ball, mm.
const ALIKE: f64 = 0.002;
/// Between two heights, at least: mm, and a share of the depth.
const APART: (f64, f64) = (0.5, 0.08);

/// What is uncertain at one place: the wall in every slice, then what acts on all its readings alike.
#[derive(Clone, Debug)]
struct Column(Vec<Vec<f64>>);

impl Column {
    /// By the changes of a wall per standard deviation of every unknown, mm, and what a model may miss of it.
    fn of(changes: &[Vec<f64>], missed: f64) -> Self {
        let count = changes.first().map_or(0, Vec::len);
        let height = |k: usize| (k as f64 + 0.5) / count as f64;
        let entry = |i: usize, j: usize| match (i < count, j < count) {
            (true, true) => {
                let apart = (height(i) - height(j)) / OVER_HEIGHT;
                let known: f64 = changes.iter().map(|change| change[i] * change[j]).sum();
                known + missed * missed * (-0.5 * apart * apart).exp()
            }
            (false, false) => ALIKE * ALIKE,
            _ => 0.0,
        };
        Self((0..=count).map(|i| (0..=count).map(|j| entry(i, j)).collect()).collect())
    }

    /// Covariance of everything with a reading in a slice, and the variance of that.
    fn with(&self, slice: usize, noise: f64) -> (Vec<f64>, f64) {
        let last = self.0.len() - 1;
        let with: Vec<f64> = self.0.iter().map(|row| row[slice] + row[last]).collect();
        let variance = with[slice] + with[last] + noise * noise;
        (with, variance)
    }

    /// By how much a reading lowers the variance of the wall, summed over its slices.
    fn gain(&self, slice: usize, noise: f64) -> f64 {
        let (with, variance) = self.with(slice, noise);
        with[..with.len() - 1].iter().map(|c| c * c).sum::<f64>() / variance
    }

    /// After a reading.
    fn read(&mut self, slice: usize, noise: f64) {
        let (with, variance) = self.with(slice, noise);
        for (row, a) in self.0.iter_mut().zip(&with) {
            row.iter_mut().zip(&with).for_each(|(entry, b)| *entry -= a * b / variance);
        }
    }

    fn total(&self) -> f64 {
        (0..self.0.len() - 1).map(|k| self.0[k][k].max(0.0)).sum()
    }
}

/// What is uncertain all along the contour.
#[derive(Clone, Debug)]
struct Columns(Vec<Column>);

impl Columns {
    fn after(&self, slices: &[usize], noise: f64) -> Self {
        let mut after = self.clone();
        after.0.iter_mut().for_each(|column| slices.iter().for_each(|slice| column.read(*slice, noise)));
        after
    }

    /// Standard deviation of the wall, root mean square over places and heights, mm.
    fn sigma(&self) -> f64 {
        let things: usize = self.0.iter().map(|column| column.0.len() - 1).sum();
        (self.0.iter().map(Column::total).sum::<f64>() / things.max(1) as f64).sqrt()
    }

    fn gain(&self, slice: usize, noise: f64) -> f64 {
        self.0.iter().map(|column| column.gain(slice, noise)).sum()
    }
}

/// The heights of a pass between the lowest and the highest that the ball reaches, mm above the tip; `count` is what the user wants.
/// `None` where the mean force makes all heights alike, or fewer than two are reached.
///
/// # Errors
/// A contour that cannot be sampled.
pub(super) fn profile_heights(
    pass: &Pass,
    (lowest, highest): (f64, f64),
    noise_mm: f64,
    count: Option<usize>,
) -> Result<Option<ProfileHeights>, Failure> {
    let law = pass.core.setup.law;
    if law == WallLaw::Mean {
        return Ok(None);
    }
    let mut samples = Vec::new();
    let path = path(pass, law, LOOK, &mut samples)?;
    let depth = float(path.setup().axial_depth);
    let slices = Slices::new(LOOK.slices);
    let middle = |k: usize| (k as f64 + 0.5) / slices.count() as f64 * depth;
    let reached: Vec<usize> =
        (0..slices.count()).filter(|k| (lowest - 1e-9..=highest + 1e-9).contains(&middle(*k))).collect();
    let (Some(&bottom), Some(&top)) = (reached.first(), reached.last()) else { return Ok(None) };
    if bottom == top {
        return Ok(None);
    }
    let (shape, columns) = columns(pass, &path, slices);
    let apart = APART.0.max(APART.1 * depth);
    let mut chosen: Vec<usize> = Vec::new();
    let mut known = columns.clone();
    let most = count.unwrap_or(COUNTS[1]);
    while chosen.len() < most {
        let allowed = |k: &&usize| chosen.iter().all(|other| (middle(**k) - middle(*other)).abs() >= apart - 1e-9);
        let best = reached
            .iter()
            .filter(allowed)
            .max_by(|a, b| known.gain(**a, noise_mm).total_cmp(&known.gain(**b, noise_mm)));
        let Some(&best) = best else { break };
        let after = known.after(&[best], noise_mm);
        if count.is_none() && chosen.len() >= COUNTS[0] && after.sigma() > (1.0 - WORTH) * known.sigma() {
            break;
        }
        chosen.push(best);
        known = after;
    }
    // Greedy choices may end beside the best of all; even heights are never better than what is given.
    let last = chosen.len().max(2) - 1;
    let even: Vec<usize> = (0..chosen.len()).map(|k| reached[(k * (reached.len() - 1) + last / 2) / last]).collect();
    let of_even = columns.after(&even, noise_mm).sigma();
    let all = if known.sigma() <= of_even { chosen } else { even };
    let sigma = [columns.sigma(), known.sigma().min(of_even)];

    let mut all = all;
    all.sort_unstable();
    all.dedup();
    let contact = float(path.helix().pitch) / float(path.helix().lag_per_mm).max(1e-9);
    let unit = pass.unit();
    let (name, small) = (unit.name(), unit.small_name());
    let why = format!(
        "heights for the profile of the wall, {:.1} {name} deep, {:.2} axial contact ratios of {:.1} {name}: these {} leave {:.1} {small} of it open at any height (one sigma, {:.1} {small} before), even ones {:.1} {small}",
        unit.of(depth),
        depth / contact,
        unit.of(contact),
        all.len(),
        unit.small(sigma[1]),
        unit.small(sigma[0]),
        unit.small(of_even)
    );
    let heights: Vec<f64> = all.iter().map(|k| middle(*k)).collect();
    let given = all.iter().enumerate().rev().map(|(at, slice)| {
        (heights[at], reason((at, heights.len()), &shape, *slice, (&heights, contact, depth / slices.count() as f64)))
    });
    Ok(Some(ProfileHeights { above_tip_mm: given.collect(), why }))
}

/// What a height is for: `at` of how many, counted from the tip.
fn reason(
    (at, count): (usize, usize),
    shape: &[f64],
    slice: usize,
    (heights, contact, thick): (&[f64], f64, f64),
) -> &'static str {
    let extreme = |f: fn(f64, f64) -> bool| {
        let from = slice.saturating_sub(1);
        let near = &shape[from..(slice + 2).min(shape.len())];
        let all = shape.iter().copied().reduce(|a, b| if f(a, b) { a } else { b });
        near.iter().any(|v| Some(*v) == all)
    };
    let again = heights.iter().any(|other| ((heights[at] - other).abs() - contact).abs() <= thick);
    match at {
        _ if again => {
            "one contact ratio from another: the same instant of a tooth cuts both, so that bending alone differs"
        }
        0 => "lowest: with the highest it tells bending, which moves the tip most",
        k if k + 1 == count => "highest: with the lowest it tells bending, which moves the tip most",
        _ if extreme(|a, b| a > b) => "where the helix leaves most: with the others it tells helix from bending",
        _ if extreme(|a, b| a < b) => "where the helix leaves least: with the others it tells helix from bending",
        _ => "between: where the shape over the height is least certain",
    }
}

/// The shape over the height that the helix makes, without mean and lean, and what is uncertain at places along the contour.
fn columns(pass: &Pass, path: &Path, slices: Slices) -> (Vec<f64>, Columns) {
    let prior = pass.core.prior(path.setup().law);
    let grid = ImmersionGrid::new();
    let walls = |parameters: &Parameters| -> Vec<Vec<f64>> {
        let table = force_table(parameters);
        let machine = parameters.machine(path, &table);
        let left = Bench::new(Mill::new(machine, &grid, slices), slices).as_programmed().left;
        let column =
            |index: &usize| left[index * slices.count()..(index + 1) * slices.count()].iter().map(|e| mm(*e)).collect();
        sites(path).iter().map(column).collect()
    };
    let expected = walls(&prior.mean);
    let at = |k: usize, by: Real| {
        let mut theta = [Real::ZERO; COUNT];
        theta[k] = by;
        prior.at(&theta)
    };
    let wall = |k: &usize| {
        let of_wall = !matches!(Parameter::ALL[*k], Parameter::Undersize | Parameter::DatumX | Parameter::DatumY);
        of_wall && prior.sigma[*k] != Real::ZERO
    };
    let changes: Vec<Vec<Vec<f64>>> = (0..COUNT)
        .filter(wall)
        .map(|k| {
            let (above, below) = (walls(&at(k, STEP)), walls(&at(k, -STEP)));
            let change = |(a, b): (&Vec<f64>, &Vec<f64>)| -> Vec<f64> {
                a.iter().zip(b).map(|(a, b)| (a - b) / (2.0 * float(STEP))).collect()
            };
            above.iter().zip(&below).map(change).collect()
        })
        .collect();
    let mut shape = vec![0.0; slices.count()];
    let column = |(site, wall): (usize, &Vec<f64>)| {
        let bare = bare(wall);
        shape.iter_mut().zip(&bare).for_each(|(sum, v)| *sum += v);
        let size = (bare.iter().map(|v| v * v).sum::<f64>() / bare.len() as f64).sqrt();
        let of_site: Vec<Vec<f64>> = changes.iter().map(|change| change[site].clone()).collect();
        Column::of(&of_site, (MISSED.0 * size).max(MISSED.1))
    };
    let columns = expected.iter().enumerate().map(column).collect();
    (shape, Columns(columns))
}

/// Samples of the path at places spread along its wall.
fn sites(path: &Path) -> Vec<usize> {
    let length = mm(path.length());
    let (from, to) = if path.is_closed() { (0.0, length) } else { (ENDS * length, (1.0 - ENDS) * length) };
    let at = |k: usize| from + (to - from) * (k as f64 + 0.5) / SITES as f64;
    let index = |s: f64| path.index_at(Offset::from_nm((s * 1e6) as i64));
    let stands = |index: &usize| path.samples().get(*index).is_some_and(|s| s.on_wall && !s.near_corner);
    (0..SITES).map(|k| index(at(k))).filter(stands).collect()
}

/// A shape over the height without its mean and its lean.
fn bare(wall: &[f64]) -> Vec<f64> {
    let count = wall.len() as f64;
    let place = |k: usize| (2.0 * k as f64 + 1.0) / count - 1.0;
    let mean = wall.iter().sum::<f64>() / count;
    let square: f64 = (0..wall.len()).map(|k| place(k) * place(k)).sum();
    let lean = wall.iter().enumerate().map(|(k, e)| place(k) * (e - mean)).sum::<f64>() / square.max(1e-12);
    wall.iter().enumerate().map(|(k, e)| e - mean - lean * place(k)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lean_asks_for_the_ends_and_a_wave_for_its_crests() {
        let slices = 24;
        let place = |k: usize| (2.0 * k as f64 + 1.0) / f64::from(slices) - 1.0;
        let lean: Vec<f64> = (0..slices as usize).map(|k| 0.05 * place(k)).collect();
        let wave: Vec<f64> = (0..slices as usize).map(|k| 0.02 * (std::f64::consts::PI * place(k)).sin()).collect();
        let most = |columns: &Columns| {
            (0..slices as usize).max_by(|a, b| columns.gain(*a, 0.002).total_cmp(&columns.gain(*b, 0.002))).unwrap()
        };
        let leaning = Columns(vec![Column::of(std::slice::from_ref(&lean), 0.0005)]);
        assert!([0, 23].contains(&most(&leaning)));
        // The lean known, the wave is open: its crests lie at a quarter and three quarters.
        let both = Columns(vec![Column::of(&[lean.iter().map(|v| 0.1 * v).collect(), wave], 0.0005)]);
        assert!([5, 6, 17, 18].contains(&most(&both)), "{}", most(&both));
        // What is read is known; what was read tells nothing more.
        let after = both.after(&[5, 18], 0.0001);
        assert!(after.sigma() < 0.3 * both.sigma());
        assert!(after.gain(5, 0.002) < 0.01 * both.gain(5, 0.002));
    }
}
