//! The stock of a pass as the roughing of its own program leaves it: the passes of the roughing cutter → the allowance along the contour.
//!
//! Beside a place of the finished wall, along its normal, the stock ends where the roughing cutter has been: at the nearest place that is no
//! farther from one of its paths than its radius. What a larger cutter does not reach in an inside corner, what it leaves
//! at the end of a stretch and what two tools leave between each other is all in it. The way to that place is walked in steps as long as the distance from the nearest path less
//! the radius, which never go past it (sphere tracing: Hart, *The Visual Computer* 12, 1996, 527–545); distances are those of the fixed point geometry,
//! so that a program that is shifted, turned by 90° or mirrored gives the same stock to the last bit.
//!
//! A roughing cutter is pushed away too: [`Pushed`] takes by how much its paths made the wall that they left.
//!
//! Limits: upright walls, alike at every height; roughing counts where it goes nearly as deep as the pass, all of it before the pass; a run
//! that goes over from roughing to the finished wall without lifting is no roughing.

use std::sync::Arc;

use truepath_core::cut::{Path, Sample};
use truepath_core::geometry::{Block, Contour, Extent, Nearby, Point, Side};
use truepath_core::job::{ContourPass, JobError};
use truepath_core::units::{Offset, Position, Real};
use truepath_ground::diagnostics::{Failure, InputError, Source};
use truepath_ground::length::{Said, Unit};
use truepath_ground::units::mm;

use crate::codes::K008;
use crate::feature::{Plan, Survey};
use crate::job::{JobFile, Roughing};
use crate::post::Post;
use crate::surface::stock_point;

/// A run of cutting moves that may have roughed.
#[derive(Clone, Debug)]
pub struct RoughRun {
    /// Its place among the runs of the program, in the order of execution, from 1.
    pub number: u32,
    /// Its height.
    pub z: Position,
    /// Its path.
    pub blocks: Vec<Block>,
}

/// A pass before which the program roughs.
pub(crate) struct RoughedPass<'a> {
    pub(crate) job: &'a JobFile,
    pub(crate) program: &'a Source,
    pub(crate) core: &'a ContourPass,
    pub(crate) plan: Option<&'a Plan>,
    pub(crate) contour: Contour<'a>,
    /// The failure for an error of the core.
    pub(crate) refused: &'a dyn Fn(&JobError) -> Failure,
}

impl RoughedPass<'_> {
    /// Gives every sample of the contour to `visit`, its stock even.
    fn walk(&self, mut visit: impl FnMut(&Sample)) -> Result<usize, Failure> {
        let needed = Path::samples_needed(&self.contour, &self.core.setup, self.core.step());
        let mut buffer = vec![Sample::BLANK; needed];
        let path = self.core.sample(&self.contour, &mut buffer, |_| ()).map_err(|error| (self.refused)(&error))?;
        let along = path.samples().get(path.first()..path.first() + path.count()).unwrap_or_default();
        along.iter().for_each(&mut visit);
        Ok(along.len())
    }
}

/// What a run left more than its path says, along it.
#[derive(Clone, Debug, PartialEq)]
pub struct Pushed {
    /// Number of the run.
    pub number: u32,
    /// The side of its travel on which it made a wall that stays.
    pub side: Side,
    /// Arc length and how much more is left there, mm, in the order of the path; not where it turns on the spot.
    pub more: Vec<[f64; 2]>,
}

/// The stock that roughing leaves.
#[derive(Clone, Debug)]
pub struct RoughedStock {
    runs: Arc<[RoughRun]>,
    radius: Offset,
    pushed: Arc<[Pushed]>,
    /// What is said of it.
    pub facts: RoughFacts,
}

/// What is said of stock that roughing leaves.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize)]
pub struct RoughFacts {
    /// Runs that leave it.
    pub runs: usize,
    /// Diameter of the cutter, mm.
    pub diameter_mm: f64,
    /// What the job says, mm.
    pub expected_mm: f64,
    /// Mean along the contour, mm.
    pub mean_mm: f64,
    /// Least along the contour, mm.
    pub least_mm: f64,
    /// Most along the contour, mm.
    pub most_mm: f64,
    /// How much of the mean the push on the roughing cutter has left, mm; `None` where that is not known.
    pub pushed_mm: Option<f64>,
}

impl RoughFacts {
    /// In a sentence.
    pub fn text(&self, program: &str, unit: Unit) -> String {
        let name = unit.name();
        let Self { runs, diameter_mm, expected_mm, mean_mm, least_mm, most_mm, pushed_mm } = self;
        let runs = if *runs == 1 { "one run".to_owned() } else { format!("{runs} runs") };
        let pushed = pushed_mm.map_or_else(
            || ", as its paths say; how far it was itself pushed away is not counted".to_owned(),
            |more| format!(", {:.3} {name} of it because it was pushed away itself", unit.of(more)),
        );
        format!(
            "{program}: {SAID} ({runs} of a cutter of {} {name}) leaves {:.3} to {:.3} {name} on the wall, mean {:.3} {name} where \
             the job says {:.3} {name}{pushed}",
            unit.of(*diameter_mm),
            unit.of(*least_mm),
            unit.of(*most_mm),
            unit.of(*mean_mm),
            unit.of(*expected_mm)
        )
    }
}

/// Cutters whose radii differ by less are one.
const ALIKE: Offset = Offset::from_um(20);
/// Roughing that ends so much of the axial depth above the tip still makes the wall.
const ABOVE: i64 = 4;
/// How what is said of it begins, behind the name of the program.
pub(crate) const SAID: &str = "roughing before this pass";
/// A step this near to the paths is there, mm.
const THERE_MM: f64 = 1e-5;
/// Steps to the stock at most.
const STEPS: u32 = 200;
/// The largest allowance, as a share of the finishing cutter's diameter.
const MOST: f64 = 0.98;
/// The least that roughing leaves, mm.
const LEAST_MM: f64 = 0.005;

impl RoughedStock {
    /// What the roughing of the pass's program leaves on its wall; its paths are followed as they are programmed.
    ///
    /// # Errors
    /// Whatever is wrong with the program; `K008` where no roughing reaches the pass, leaves nothing, or more than its cutter takes.
    pub(crate) fn read(pass: &RoughedPass<'_>, roughing: Roughing) -> Result<Self, Failure> {
        let survey = Survey::read(pass.job, pass.program)?;
        let finished: Vec<u32> =
            pass.plan.iter().flat_map(|plan| &plan.passes).map(|finishing| finishing.part.run).collect();
        let runs = survey.runs.iter().filter_map(|found| {
            let run = &found.run;
            let counts = !finished.contains(&run.number) && roughing.tool.is_none_or(|tool| run.tool == Some(tool));
            let blocks = counts.then(|| found.blocks(&survey.blocks).to_vec())?;
            Contour::new(&blocks)?;
            Some(RoughRun { number: run.number, z: run.z?, blocks })
        });
        let stock = Self {
            runs: runs.collect(),
            radius: Offset::from_nm(roughing.diameter.nm() / 2),
            pushed: Arc::default(),
            facts: RoughFacts::default(),
        };
        stock.judged(pass)
    }

    /// The runs that leave the stock of a pass: before it, and nearly as deep.
    pub(crate) fn runs_before<'s>(&'s self, pass: &RoughedPass<'_>) -> impl Iterator<Item = &'s RoughRun> {
        // Without a place among the runs it is the only one.
        let own = pass.job.numbers.part.map_or(0, |part| part.run);
        let floor = pass.core.contour.z + Offset::from_mm(pass.core.setup.axial_depth * Real::ratio(1, ABOVE));
        self.runs.iter().filter(move |run| run.number < own && run.z <= floor)
    }

    /// The same stock with what the runs left more than their paths say, within what the cutter of the pass can meet.
    ///
    /// # Errors
    /// Where the path leaves no wall.
    pub(crate) fn pushed(&self, pass: &RoughedPass<'_>, pushed: Vec<Pushed>) -> Result<Self, Failure> {
        Self { pushed: pushed.into(), ..self.clone() }.judged(pass)
    }

    /// Whether the cutter that roughs is that of a pass.
    pub(crate) fn is_of_the_cutter_of(&self, pass: &RoughedPass<'_>) -> bool {
        (self.radius - pass.core.setup.radius).abs() <= ALIKE
    }

    /// Numbers of the runs whose paths lie beside the contour of a pass, in their order.
    ///
    /// # Errors
    /// Where the path leaves no wall.
    pub(crate) fn runs_beside(&self, pass: &RoughedPass<'_>) -> Result<Vec<u32>, Failure> {
        let mut swept = self.swept(pass);
        let mut runs = Vec::new();
        pass.walk(|sample| runs.push(swept.left(sample).run))?;
        runs.sort_unstable();
        runs.dedup();
        Ok(runs)
    }

    /// A run with its depth in the stock: what is between it and the next higher one, where that is less than the pass is deep.
    pub(crate) fn run(&self, number: u32, pass: &RoughedPass<'_>) -> Option<(&RoughRun, Offset)> {
        let run = self.runs.iter().find(|run| run.number == number)?;
        let higher = self.runs.iter().map(|other| other.z - run.z).filter(|step| *step > Offset::from_um(1)).min();
        let whole = Offset::from_mm(pass.core.setup.axial_depth);
        let step = higher.map_or(whole, |step| step.min(whole));
        Some((run, step))
    }

    /// On which side of a run the wall of a pass lies.
    pub(crate) fn side(&self, run: &RoughRun, pass: &RoughedPass<'_>) -> Option<Side> {
        let mut nearby = Nearby::new(Contour::new(&run.blocks)?);
        let cutter_mm = mm(pass.core.setup.radius);
        let mut left = 0i64;
        let count = pass.walk(|sample| {
            let foot = nearby.nearest(stock_point(sample, cutter_mm)).filter(|foot| foot.beside);
            left += foot.map_or(0, |foot| if foot.left > Offset::ZERO { 1 } else { -1 });
        });
        count.ok().map(|_| if left > 0 { Side::Left } else { Side::Right })
    }

    /// What is before a run, mean along it.
    ///
    /// # Errors
    /// Where the path leaves no wall.
    pub(crate) fn mean_before(&self, rough: &RoughedPass<'_>) -> Result<Offset, Failure> {
        let mut swept = self.swept(rough);
        let (cutter_mm, mut sum) = (swept.cutter_mm, 0.0);
        let count = rough.walk(|sample| sum += cutter_mm - swept.distance(sample))?;
        Ok(Offset::from_nm((sum / count.max(1) as f64 * 1e6).round() as i64))
    }

    /// By how much two of them differ at most in what is said of them, mm.
    pub(crate) fn largest_change(&self, other: &Self) -> f64 {
        let figures = |facts: &RoughFacts| [facts.mean_mm, facts.least_mm, facts.most_mm];
        let both = figures(&self.facts).into_iter().zip(figures(&other.facts));
        both.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    }

    /// Where the roughing cutter has been, for the samples of a pass one after the other.
    pub(crate) fn swept(&self, pass: &RoughedPass<'_>) -> Swept<'_> {
        let runs = self.runs_before(pass).filter_map(|run| {
            Some(SweptRun {
                number: run.number,
                extent: Extent::of(&run.blocks),
                nearby: Nearby::new(Contour::new(&run.blocks)?),
                pushed: self.pushed.iter().find(|pushed| pushed.number == run.number),
            })
        });
        Swept { runs: runs.collect(), radius: self.radius, cutter_mm: mm(pass.core.setup.radius) }
    }

    /// The same with what is said of it.
    fn judged(mut self, pass: &RoughedPass<'_>) -> Result<Self, Failure> {
        let failed = |found: String, help: &'static str| -> Failure {
            let error = InputError::new(K008, found, "passes of the program that leave the stock of this one", help);
            error.at(pass.job.source(), pass.job.span("stock.roughing_diameter_mm")).into()
        };
        let unit = Unit::from(pass.core.contour.units);
        let runs = self.runs_before(pass).count();
        if runs == 0 {
            let z = unit.of(pass.core.contour.z.nm() as f64 / 1e6);
            let tool = pass.job.roughing.and_then(|r| r.tool).map_or_else(String::new, |t| format!(" of tool {t}"));
            let lines = pass.core.contour.lines;
            let found = format!("no cut{tool} before lines {}-{} goes down to about Z{z}", lines.first, lines.last);
            return Err(failed(
                found,
                "correct roughing_tool, or leave roughing_diameter_mm out for an even allowance",
            ));
        }
        let mut swept = self.swept(pass);
        let limit = MOST * 2.0 * mm(pass.core.setup.radius);
        let (mut least, mut most, mut sum, mut more) = (f64::INFINITY, 0.0f64, 0.0, 0.0);
        let mut wrong: Option<(bool, Point)> = None;
        let count = pass.walk(|sample| {
            let left = swept.left(sample);
            if left.mm < LEAST_MM || left.mm >= limit {
                wrong = wrong.or(Some((left.mm < LEAST_MM, sample.point)));
            }
            let mm = left.mm.clamp(LEAST_MM, limit);
            (least, most) = (least.min(mm), most.max(mm));
            sum += mm;
            more += left.pushed_mm;
        })?;
        // What a machine that is only believed in would have pushed too far is no fault of the program.
        if let Some((nothing, point)) = wrong.filter(|_| self.pushed.is_empty()) {
            let [x, y] = [point.x, point.y].map(|p| unit.of(p.nm() as f64 / 1e6));
            let (what, help) = if nothing {
                let help = "correct roughing_diameter_mm; name the tool in roughing_tool where other cuts of the program are no roughing";
                ("nothing on the finished wall", help)
            } else {
                let help = "correct roughing_diameter_mm or roughing_tool, or leave both out for an even allowance";
                ("more than the cutter of this pass takes", help)
            };
            return Err(failed(format!("roughing leaves {what} beside X{x:.3} Y{y:.3}"), help));
        }
        let count = count.max(1) as f64;
        self.facts = RoughFacts {
            runs,
            diameter_mm: 2.0 * mm(self.radius),
            expected_mm: if self.facts.runs == 0 { mm(pass.job.numbers.allowance) } else { self.facts.expected_mm },
            mean_mm: sum / count,
            least_mm: least,
            most_mm: most,
            pushed_mm: (!self.pushed.is_empty()).then_some(more / count),
        };
        Ok(self)
    }
}

/// Rows of a program among which the cutter that roughs is looked for, at most.
const MOST_ROWS: usize = 100;
/// Stock that differs by more from what the job says is worth a word, as a share of it.
const UNEVEN: f64 = 0.1;

/// That the program's own roughing leaves something else than the even stock of the job, where it does.
pub(crate) fn hint(pass: &RoughedPass<'_>) -> Option<Said> {
    let plan = pass.plan.filter(|plan| plan.rows.len() <= MOST_ROWS)?;
    let own = plan.tool.or(pass.job.numbers.tool.number);
    let of = |role: &'static str| plan.rows.iter().filter(move |row| row.role == role);
    let roughing = if of("semi").chain(of("rough")).next().is_some() {
        Roughing { diameter: pass.job.numbers.tool.diameter, tool: own }
    } else {
        let mut others: Vec<u32> = of("other tool").filter_map(|row| row.tool).collect();
        others.sort_unstable();
        others.dedup();
        let [tool] = others[..] else { return None };
        let post = Post::read(pass.program);
        let note = post.mills().into_iter().find(|note| note.number == Some(tool))?;
        Roughing { diameter: note.diameter(), tool: Some(tool) }
    };
    let RoughFacts { least_mm, most_mm, expected_mm, diameter_mm, .. } = RoughedStock::read(pass, roughing).ok()?.facts;
    let off = (most_mm - expected_mm).abs().max((least_mm - expected_mm).abs());
    let tool = roughing.tool.filter(|tool| Some(*tool) != own);
    let tool = tool.map_or_else(String::new, |tool| format!(" and roughing_tool = {tool}"));
    let said = |unit: Unit| {
        format!(
            "{}: its own roughing leaves {:.3} to {:.3} {name} on this wall, where the job says {:.3} {name} all along: \
             roughing_diameter_mm = {diameter_mm}{tool} in [stock] takes that into account",
            pass.program.name(),
            unit.of(least_mm),
            unit.of(most_mm),
            unit.of(expected_mm),
            name = unit.name()
        )
    };
    (off > UNEVEN * expected_mm).then(|| Said::of(said))
}

/// What is left on the wall beside a sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Left {
    /// All of it, mm.
    pub(crate) mm: f64,
    /// How much of it was left by the push, mm.
    pub(crate) pushed_mm: f64,
    /// The run that leaves it.
    pub(crate) run: u32,
}

/// Where the roughing cutter has been.
pub(crate) struct Swept<'s> {
    runs: Vec<SweptRun<'s>>,
    radius: Offset,
    /// Radius of the cutter of the pass.
    cutter_mm: f64,
}

struct SweptRun<'s> {
    number: u32,
    extent: Extent,
    nearby: Nearby<'s>,
    pushed: Option<&'s Pushed>,
}

impl Swept<'_> {
    /// Distance of the stock from the centre of the cutter along the normal of a sample, mm.
    pub(crate) fn distance(&mut self, sample: &Sample) -> f64 {
        let most = MOST * 2.0 * self.cutter_mm;
        self.cutter_mm - self.left(sample).mm.clamp(LEAST_MM, most)
    }

    /// What is left on the wall beside a sample.
    pub(crate) fn left(&mut self, sample: &Sample) -> Left {
        let mut left = Left { mm: 0.0, pushed_mm: 0.0, run: 0 };
        if self.runs.is_empty() {
            // Into the full.
            return Left { mm: 2.0 * self.cutter_mm, ..left };
        }
        for _ in 0..STEPS {
            let Some((gap, run, pushed)) = self.gap(stock_point(sample, self.cutter_mm - left.mm)) else { break };
            (left.run, left.pushed_mm) = (run, pushed);
            if gap <= THERE_MM || left.mm >= 2.0 * self.cutter_mm {
                break;
            }
            left.mm += gap;
        }
        left.mm += left.pushed_mm;
        left
    }

    /// How far a point is from where the cutter has been, mm, with the run that came nearest and what it left more there.
    fn gap(&mut self, point: Point) -> Option<(f64, u32, f64)> {
        let mut best: Option<(Offset, usize, Offset, Side)> = None;
        for (k, run) in self.runs.iter_mut().enumerate() {
            if best.is_some_and(|(reach, ..)| run.extent.is_farther(point, reach)) {
                continue;
            }
            let Some(foot) = run.nearby.nearest(point) else { continue };
            if best.is_none_or(|(reach, ..)| foot.left.abs() < reach) {
                let side = if foot.left > Offset::ZERO { Side::Left } else { Side::Right };
                best = Some((foot.left.abs(), k, foot.s, side));
            }
        }
        let (distance, k, s, side) = best?;
        let run = self.runs.get(k)?;
        let pushed = run.pushed.filter(|pushed| pushed.side == side);
        let pushed = pushed.map_or(0.0, |pushed| pushed.at(mm(s), 2.0 * mm(self.radius)));
        Some((mm(distance - self.radius), run.number, pushed))
    }
}

impl Pushed {
    /// How much more is left at an arc length, mm; nothing where it is not known within `reach_mm` of way: a row that ends
    /// before the wall.
    fn at(&self, s_mm: f64, reach_mm: f64) -> f64 {
        let after = self.more.partition_point(|[s, _]| *s < s_mm);
        match (after.checked_sub(1).and_then(|k| self.more.get(k)), self.more.get(after)) {
            (Some([a, left]), Some([b, right])) if b > a && b - a <= 1.3 * reach_mm => {
                left + (right - left) * (s_mm - a) / (b - a)
            }
            (Some([a, last]), None) if s_mm - a <= reach_mm => *last,
            (None, Some([b, first])) if b - s_mm <= reach_mm => *first,
            _ => 0.0,
        }
    }
}
