//! A cutter in the spindle: the wall's pass as that cutter runs it, and the machine with it.
//!
//! The machine was identified with the cutter of the job. Another one runs along a path of its own, beside that of the program by the
//! difference of the radii; chip and engagement follow from its teeth, helix and radius, the stiffness from what the job says of it.
//! What the points cannot tell of it stands with the unknown: its size and how stiff it is.

use std::sync::Arc;

use std::borrow::Cow;

use truepath_core::cut::{Cantilever, ForceTable, Path, Sample, WallLaw};
use truepath_core::geometry::{Block, Contour, Curve, Direction, FACET_TURN_LIMIT, Shape, Side};
use truepath_core::identify::Parameters;
use truepath_core::process::{ImmersionGrid, Mill, Slices};
use truepath_core::units::{Offset, Real};
use truepath_ground::diagnostics::Failure;
use truepath_ground::units::mm;
use truepath_job::job::{CutterStiffness, PlanCutter};
use truepath_job::pass::Pass;

use super::bench::Bench;
use crate::correction::Identification;

/// How finely a bench looks.
#[derive(Clone, Copy, Debug)]
pub struct Resolution {
    /// Along the contour, um.
    pub step_um: i64,
    /// The most slices.
    pub slices: usize,
    /// No step is longer than this share of the cutter's radius, an n-th: a small cutter's engagement stands no more.
    pub of_radius: i64,
}

/// Where a choice is looked at closely.
pub(super) const MIDDLE: Resolution = Resolution { step_um: 500, slices: 24, of_radius: 8 };
/// Where a program is designed.
pub(super) const FINE: Resolution = Resolution { step_um: 250, slices: 48, of_radius: 8 };
/// Levels that slices are divided by: 2, 3 and 4.
pub const DIVISIONS: usize = 12;
/// A machine with another cutter is no stiffer than this many times, whatever the stick-outs say.
const STIFFEST: i64 = 5;

impl Resolution {
    /// The slices of a wall.
    pub fn slices(self, path: &Path) -> Slices {
        let wanted = Slices::of(path.setup(), DIVISIONS).count();
        Slices::new(wanted.min(self.slices))
    }
}

/// A cutter and the machine with it.
#[derive(Clone, Debug)]
pub struct Mounted<'a> {
    pass: Cow<'a, Pass>,
    known: Identification,
    /// `None` for that of the job.
    cutter: Option<PlanCutter>,
}

impl<'a> Mounted<'a> {
    /// The cutter of the job.
    pub const fn own(pass: &'a Pass, known: Identification) -> Self {
        Self { pass: Cow::Borrowed(pass), known, cutter: None }
    }

    /// Another cutter; why it cannot run along the wall, where it cannot.
    ///
    /// # Errors
    /// In words: it does not fit an inside corner, or the path has a sharp corner that another radius does not follow.
    pub fn other(pass: &Pass, known: &Identification, cutter: PlanCutter) -> Result<Self, String> {
        let mut pass = pass.clone();
        let radius = Offset::from_nm(cutter.diameter.nm() / 2);
        let unit = pass.unit();
        let setup = &mut pass.core.setup;
        let wider = radius - Offset::from_nm(pass.job.numbers.tool.diameter.nm() / 2);
        if wider != Offset::ZERO {
            pass.blocks = beside(&pass.blocks, setup.wall, wider).map_err(|why| {
                let left = format!("T{} (diameter {} mm) is left out: {why}", cutter.number, mm(cutter.diameter));
                unit.retold(&left).into_owned()
            })?;
        }
        if setup.allowance >= radius + radius {
            return Err(format!("T{} is left out: the allowance is no less than its diameter", cutter.number));
        }
        (setup.radius, setup.teeth, setup.helix_deg) = (radius, cutter.teeth, cutter.helix_deg);
        if !setup.fits_force_table() {
            return Err(format!("T{} is left out: too many of its teeth are in the stock at once", cutter.number));
        }
        Ok(Self { pass: Cow::Owned(pass), known: known.clone(), cutter: Some(cutter) })
    }

    /// The cutter; `None` for that of the job.
    pub const fn cutter(&self) -> Option<&PlanCutter> {
        self.cutter.as_ref()
    }
    /// Its pass.
    pub fn pass(&self) -> &Pass {
        &self.pass
    }
    /// Machine and material as they were identified, with the cutter of the job.
    pub const fn known(&self) -> &Identification {
        &self.known
    }
    /// The force table of the identified material.
    pub fn table(&self) -> Arc<ForceTable> {
        self.known.table()
    }

    /// The path at a resolution.
    ///
    /// # Errors
    /// A contour that cannot be sampled.
    pub fn path<'p>(&self, resolution: Resolution, samples: &'p mut Vec<Sample>) -> Result<Path<'p>, Failure> {
        path(&self.pass, self.known.law(), resolution, samples)
    }

    /// The machine on a path of it.
    pub fn bench<'p>(
        &self,
        path: &'p Path<'p>,
        table: &'p ForceTable,
        grid: &'p ImmersionGrid,
        resolution: Resolution,
    ) -> Bench<'p> {
        let slices = resolution.slices(path);
        let machine = self.with(&self.known.fit().parameters).machine(path, table);
        Bench::new(Mill::new(machine, grid, slices), slices)
    }

    /// Machine and material, stated with the cutter of the job, with this one.
    pub fn with(&self, found: &Parameters) -> Parameters {
        let mut with = *found;
        let Some(cutter) = &self.cutter else { return with };
        with.undersize = Offset::ZERO;
        let compliance = &mut with.compliance;
        match (cutter.stiffness, self.pass.job.numbers.tool.cantilever) {
            (CutterStiffness::Stickout(stickout), Some(own)) => {
                let (tool, depth) = (&self.pass.job.numbers.tool, self.pass.core.setup.axial_depth);
                let own = Cantilever::new(tool.diameter, tool.teeth, own.length, depth, own.material);
                let new = Cantilever::new(cutter.diameter, cutter.teeth, stickout.length, depth, stickout.material);
                let lean = compliance.bend * compliance.mean + new.at(Real::ZERO) - new.at(depth) - own.at(Real::ZERO)
                    + own.at(depth);
                let mean = compliance.mean + new.at(depth) - own.at(depth);
                compliance.mean = mean.max(compliance.mean * Real::ratio(1, STIFFEST));
                compliance.bend = (lean / compliance.mean).max(Real::ZERO);
            }
            (CutterStiffness::Factor(factor), _) => {
                let softer = Real::ratio((1e6 / factor).round() as i64, 1_000_000);
                compliance.mean = compliance.mean * softer;
                compliance.difference = compliance.difference * softer;
                compliance.cross = compliance.cross * softer;
            }
            (CutterStiffness::Stickout(_), None) => {}
        }
        with
    }

    /// Machines that no point has told from the one that was found, beside what a model lacks. With the cutter of the job: its size by
    /// three fifths of what was found of it, because a size that no cutter has stands for something else, which a pass of another
    /// thickness meets otherwise. With another one: its stiffness by 5 %, its size by 4 um.
    pub fn unknown(&self, found: &Parameters) -> impl Iterator<Item = Parameters> + use<> {
        let (mut softer, mut smaller) = (*found, *found);
        let size = if self.cutter.is_some() {
            softer.compliance.mean = found.compliance.mean * Real::ratio(105, 100);
            Offset::from_um(4)
        } else {
            found.undersize.abs().scaled(Real::ratio(6, 10))
        };
        smaller.undersize = found.undersize + size;
        // One that is no other machine changes nothing.
        [softer, smaller].into_iter()
    }
}

/// The path of a pass at a resolution, under a wall law.
///
/// # Errors
/// A contour that cannot be sampled.
pub fn path<'p>(
    pass: &Pass,
    law: WallLaw,
    resolution: Resolution,
    samples: &'p mut Vec<Sample>,
) -> Result<Path<'p>, Failure> {
    let (contour, setup): (Contour, _) = (pass.path_contour(), &pass.core.setup);
    let finest = Offset::from_nm(setup.radius.nm() / resolution.of_radius);
    let step = Offset::from_um(resolution.step_um).min(finest);
    samples.resize(Path::samples_needed(&contour, setup, step), Sample::BLANK);
    let path = pass.core.sample_every(step, &contour, samples, |_| ());
    let path = path.map_err(|error| pass.refused(&error))?;
    Ok(path.with_law(law))
}

/// The path of a cutter that is wider by so much in radius, beside the same wall.
fn beside(blocks: &[Block], wall: Side, wider: Offset) -> Result<Vec<Block>, String> {
    let away = |heading: Direction| wall.other().normal(heading);
    let closed = blocks.first().zip(blocks.last()).is_some_and(|(a, b)| a.curve.start() == b.curve.end());
    for block in blocks {
        // A curve that turns away from the wall is an inside corner.
        let inside = block.curve.signed_radius().filter(|radius| (*radius > Offset::ZERO) == (wall == Side::Right));
        if let Some(radius) = inside.map(Offset::abs).filter(|radius| *radius <= wider) {
            return Err(format!(
                "the inside corner of line {} leaves no room for it: the path of the program has a radius of {:.3} mm there, and \
                 its own would be {:.3} mm",
                block.line,
                mm(radius),
                mm(radius - wider)
            ));
        }
    }
    // Where two blocks meet, half way between their directions.
    let joint = |before: Option<&Block>, after: Option<&Block>| {
        let (from, to) = (before.map(|b| b.curve.end_heading()), after.map(|b| b.curve.start_heading()));
        let (from, to) = (from.or(to)?, to.or(from)?);
        let at = after.map(|b| b.curve.start()).or(before.map(|b| b.curve.end()))?;
        if from.dot(to) < FACET_TURN_LIMIT {
            return None;
        }
        let half = (Real::ONE + from.dot(to)) * Real::HALF;
        let (a, b) = (away(from).times(wider), away(to).times(wider));
        Some(at + (a + b).scaled(Real::HALF / half))
    };
    let mut moved: Vec<Block> = Vec::with_capacity(blocks.len());
    let mut s = blocks.first().map_or(Offset::ZERO, |block| block.s);
    for (k, block) in blocks.iter().enumerate() {
        let last = k + 1 == blocks.len();
        let before = if k > 0 { blocks.get(k - 1) } else { blocks.last().filter(|_| closed) };
        let after = if last { blocks.first().filter(|_| closed) } else { blocks.get(k + 1) };
        let sharp =
            || format!("the path has a sharp corner at line {}, which only the program's diameter follows", block.line);
        let start = joint(before, Some(block)).ok_or_else(sharp)?;
        let end = joint(Some(block), after).ok_or_else(sharp)?;
        let curve = match block.curve.shape() {
            Shape::Line => Curve::line(start, end),
            Shape::Arc { centre, sweep } => Curve::arc(start, end, centre, sweep > Real::ZERO).ok(),
        };
        let curve = curve.ok_or_else(|| format!("line {} is too short for its radius", block.line))?;
        // What turns round has been overrun: the wall there is shorter than the cutter needs.
        if curve.start_heading().dot(block.curve.start_heading()) <= Real::ZERO {
            return Err(format!("line {} is too short for its radius", block.line));
        }
        moved.push(Block { curve, s, ..*block });
        s += curve.length();
    }
    Ok(moved)
}

#[cfg(test)]
mod tests {
    use super::*;
    use truepath_core::geometry::Point;

    /// A line, an inside corner of a path radius of 5 mm (wall on the right, turning left), a line.
    fn corner() -> Vec<Block> {
        let p = |x: i64, y: i64| Point::from_nm(x * 1_000_000, y * 1_000_000);
        let curves = [
            Curve::line(p(0, 0), p(30, 0)).expect("a line"),
            Curve::arc(p(30, 0), p(35, 5), p(30, 5), true).expect("an arc"),
            Curve::line(p(35, 5), p(35, 30)).expect("a line"),
        ];
        let mut s = Offset::ZERO;
        let block = |(curve, line): (Curve, u32)| {
            let block = Block { curve, s, feed: Real::from_int(100), line };
            s += curve.length();
            block
        };
        curves.into_iter().zip(7..).map(block).collect()
    }

    #[test]
    fn a_wider_cutter_runs_beside_the_path_and_an_arc_stays_about_its_centre() {
        let moved = beside(&corner(), Side::Right, Offset::from_um(2_000)).expect("room");
        assert!(Contour::new(&moved).is_some(), "end to end");
        assert_eq!(moved[0].curve.start(), Point::from_nm(0, 2_000_000));
        assert_eq!(moved[1].curve.signed_radius(), Some(Offset::from_um(3_000)));
        assert_eq!(moved[2].curve.end(), Point::from_nm(33_000_000, 30_000_000));
        let narrower = beside(&corner(), Side::Right, Offset::from_um(-2_000)).expect("room");
        assert_eq!(narrower[1].curve.signed_radius(), Some(Offset::from_um(7_000)));
    }

    #[test]
    fn a_cutter_wider_than_an_inside_corner_is_told_where() {
        let why = beside(&corner(), Side::Right, Offset::from_um(5_000)).expect_err("no room");
        assert!(why.contains("line 8") && why.contains("5.000 mm"), "{why}");
        // The same corner is an outside one for a wall on the other side.
        assert!(beside(&corner(), Side::Left, Offset::from_um(5_000)).is_ok());
    }
}
