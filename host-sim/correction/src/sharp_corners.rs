//! What is left beside and in the sharp inside corners of a contour, and what arcs there would leave.

use truepath_core::cut::Path;
use truepath_core::job;
use truepath_core::units::Offset;
use truepath_ground::diagnostics::{Failure, Source};
use truepath_ground::length::Unit;
use truepath_ground::units::{mm, nm, rounded};
use truepath_job::pass::{Pass, PathBuffer};

use crate::correction::{Correction, DesignRequest, Identification, design_correction};
use crate::fillet;

/// Arcs that are proposed have this share of the cutter's radius on its path: the correction has a way to turn on then.
const SHARE: f64 = 1.0 / 3.0;

/// The sharp inside corners of a contour, of the target quantity.
#[derive(Clone, Debug, serde::Serialize, schemars::JsonSchema)]
pub struct SharpCorners {
    /// Line of the program that begins in the first.
    pub line: u32,
    /// How many there are.
    pub count: usize,
    /// Largest error of the walls beside them without correction, mm.
    pub before_mm: f64,
    /// The same with it, mm.
    pub after_mm: f64,
    /// Material that the correction leaves in a corner's own rounding, mm: it lets no cutter into a wall beside it.
    pub left_in_corner_mm: f64,
    /// How far the cutter goes too deep there, mm: as far as it is sent into both walls, where it springs back.
    pub cut_into_corner_mm: f64,
    /// What arcs would leave; absent where that was not reckoned.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub with_arcs: Option<WithArcs>,
}

/// What is predicted for the same contour with arcs in its sharp inside corners.
#[derive(Clone, Copy, Debug, serde::Serialize, schemars::JsonSchema)]
pub struct WithArcs {
    /// Radius of the wall's corners, mm.
    pub corner_radius_mm: f64,
    /// Largest error of the whole contour without correction, mm.
    pub before_mm: f64,
    /// The same with it, mm.
    pub after_mm: f64,
}

impl SharpCorners {
    /// Of a corrected contour; `None` where it has none.
    pub fn of(pass: &Pass, path: &Path, correction: &Correction) -> Option<Self> {
        let samples = path.samples().get(path.first()..).unwrap_or_default();
        samples.iter().find(|sample| sample.near_corner)?;
        // Behind the turn on the spot the next line begins.
        let turns = correction.turning.iter().position(|turning| *turning).unwrap_or(0);
        let behind = turns + correction.turning.iter().skip(turns).take_while(|turning| **turning).count();
        let target = correction.wanted.target;
        let near = || correction.walls().filter(|(at, _)| samples.get(*at).is_some_and(|s| s.near_corner));
        let in_corner = || {
            let turning = correction.predicted.iter().zip(&correction.turning).filter(|(_, turning)| **turning);
            turning.map(|(p, _)| p.after.aim(target, None))
        };
        let largest = |values: &mut dyn Iterator<Item = Offset>| mm(values.max().unwrap_or_default()).max(0.0);
        Some(Self {
            line: samples.get(behind).and_then(|s| pass.blocks.get(s.block as usize)).map_or(0, |block| block.line),
            count: correction.turning.windows(2).filter(|pair| *pair == [false, true]).count(),
            before_mm: largest(&mut near().map(|(_, p)| p.before.aim(target, None).abs())),
            after_mm: largest(&mut near().map(|(_, p)| p.after.aim(target, None).abs())),
            left_in_corner_mm: largest(&mut in_corner()),
            cut_into_corner_mm: largest(&mut in_corner().map(|error| -error)),
            with_arcs: None,
        })
    }

    /// In words.
    pub fn text(&self, unit: Unit) -> String {
        let Self { line, count, left_in_corner_mm, cut_into_corner_mm, .. } = self;
        let name = unit.name();
        let [before, after, left, cut] =
            [self.before_mm, self.after_mm, *left_in_corner_mm, *cut_into_corner_mm].map(|mm| unit.of(mm));
        let corners = match count {
            0 | 1 => format!("a sharp inside corner at line {line}"),
            count => format!("{count} sharp inside corners, the first at line {line}"),
        };
        let rounding = if cut_into_corner_mm > left_in_corner_mm {
            format!("the corner itself is cut {cut:.3} {name} too deep where the cutter springs back")
        } else {
            format!("{left:.3} {name} stay in the corner itself")
        };
        let mut text = format!(
            "{corners}: the load ends there the moment the direction changes, so the walls beside are predicted to be {before:.3} {name} off without and {after:.3} {name} with the correction, and {rounding}"
        );
        if let Some(WithArcs { corner_radius_mm, after_mm, .. }) = self.with_arcs {
            text += &format!(
                "; if the drawing allows corners of {} {name}, truepath fillet JOB --corner-radius {} -o DIR puts arcs there, with which {:.3} {name} are predicted along the whole contour",
                unit.of(corner_radius_mm),
                unit.typed(corner_radius_mm),
                unit.of(after_mm)
            );
        }
        text
    }
}

/// What the contour with arcs of a third of the cutter's radius would come to on the machine that was identified. `None` where its
/// corners have no room for them.
pub fn with_arcs(pass: &Pass, identified: &Identification) -> Option<WithArcs> {
    let cutter = mm(pass.core.setup.radius);
    // Round in the unit of the drawing: up to a tenth of a millimetre, a hundredth of an inch.
    let step = if pass.unit() == Unit::Inch { Unit::Inch.in_mm(0.01) } else { 0.1 };
    let radius = rounded((cutter * SHARE / step).ceil() * step, 4);
    predicted(pass, identified, radius).ok().flatten()
}

fn predicted(pass: &Pass, identified: &Identification, radius: f64) -> Result<Option<WithArcs>, Failure> {
    // Features named by their lines stand elsewhere in the program with arcs.
    if !pass.job.features.is_empty() || pass.job.measured_stock().is_some() {
        return Ok(None);
    }
    let (written, corners, _) = fillet::rewritten(&[pass], nm(radius))?;
    if corners.iter().any(|corner| corner.radius_mm < radius) {
        return Ok(None);
    }
    let mut job = pass.job.clone();
    job.which.pass = pass.plan.as_ref().map(|_| pass.level());
    // The program with arcs has no G41 or G42 that says it.
    job.numbers.wall = Some(pass.core.setup.wall);
    let other = pass.of_text(job, Source::new(pass.program.name(), written.text))?;
    let mut buffer = PathBuffer::default();
    let path = other.sample(&mut buffer)?.with_law(identified.law());
    let table = identified.table();
    let machine = identified.machine(&path, &table);
    let law = job::law(&other.core, &machine, &[]);
    let correction = design_correction(&other, &machine, identified, &DesignRequest::of(law), |_| ())?;
    let largest = |error: &dyn Fn(&truepath_core::correct::Predicted) -> Offset| {
        mm(correction.walls().map(|(_, p)| error(p).abs()).max().unwrap_or_default())
    };
    let target = correction.wanted.target;
    Ok(Some(WithArcs {
        corner_radius_mm: rounded(radius + mm(pass.core.setup.radius), 4),
        before_mm: largest(&|p| p.before.aim(target, None)),
        after_mm: largest(&|p| p.after.aim(target, None)),
    }))
}
