//! Passes as their points have them, before machine and material are found: whether the shop's belief holds, the cutter's runout and
//! what roughing left.

use truepath_core::correct::Node;
use truepath_core::cut::Path;
use truepath_core::identify::Observation;
use truepath_ground::diagnostics::Failure;
use truepath_job::pass::{Pass, PathBuffer};

use crate::discrepancy::PartCut;
use crate::identification::Found;
use crate::shop::{Agreement, after, agreement};
use crate::{roughing, runout};

/// Stock and machine are found in turn so often at most.
const ROUNDS: u32 = 4;
/// Stock that changes by less is settled, mm.
const SETTLED_MM: f64 = 0.002;

/// The points of one part on a pass, with the correction it was cut with.
pub struct Told {
    /// Empty for none.
    pub nodes: Vec<Node>,
    /// Its points.
    pub observations: Vec<Observation>,
}

/// The passes of walls, and what is known of their machine already.
#[derive(Clone, Debug)]
pub struct Heard {
    /// The passes.
    pub passes: Vec<Pass>,
    /// The [`plain`](crate::discrepancy::plain) fit of each group that is fitted together; empty where they were not made.
    pub fits: Vec<Found>,
}

/// The passes of walls with the cutter and over the stock that their points speak for. `points` gives the parts of a wall, told by its
/// number and path; with `together` the walls are those of one part and have one machine.
///
/// # Errors
/// What `points` answers, and what is wrong with a program.
pub fn passes(walls: &[&Pass], together: bool, points: &Points<'_>) -> Result<Heard, Failure> {
    let mut passes: Vec<Pass> = walls.iter().map(|pass| (*pass).clone()).collect();
    if walls.iter().any(|pass| pass.core.believed.is_some()) {
        passes = with_cuts(&passes, together, points, &|walls, groups| Ok(as_they_agree(walls, groups)))?;
    }
    if walls.iter().any(|pass| pass.is_roughed_by_its_cutter()) {
        for _ in 0..ROUNDS {
            let found = with_cuts(&passes, together, points, &|walls, groups| roughing::pushed(walls, groups))?;
            let Some((next, change)) = found else { break };
            passes = next;
            if change < SETTLED_MM {
                break;
            }
        }
        for pass in &mut passes {
            pass.say_roughing();
        }
    }
    let (passes, fits) = with_cuts(&passes, together, points, &|walls, groups| Ok(runout::passes(walls, groups)))?;
    Ok(Heard { passes, fits })
}

/// The passes of walls of one uncorrected part, told by their numbers, which begin at what the shop believes only where the points of all
/// agree with it.
///
/// # Errors
/// What `points` answers, and what is wrong with a program.
pub fn agreed(
    walls: &[&Pass],
    points: &dyn Fn(usize) -> Result<Vec<Observation>, Failure>,
) -> Result<Vec<Pass>, Failure> {
    let passes: Vec<Pass> = walls.iter().map(|pass| (*pass).clone()).collect();
    if passes.iter().all(|pass| pass.core.believed.is_none()) {
        return Ok(passes);
    }
    let told = |k: usize, _: &Path| Ok(vec![Told { nodes: Vec::new(), observations: points(k)? }]);
    with_cuts(&passes, true, &told, &|walls, groups| Ok(as_they_agree(walls, groups)))
}

/// Passes that begin at what the shop believes only where the points of their group agree with it.
fn as_they_agree(walls: &[&Pass], groups: &[Group<'_>]) -> Vec<Pass> {
    let each: Vec<Option<Agreement>> = groups.iter().map(|(pass, cuts)| agreement(pass, cuts)).collect();
    walls.iter().enumerate().map(|(k, pass)| after(pass, each.get(k).or(each.first()).copied().flatten())).collect()
}

/// Gives the parts of a wall, told by its number and path.
type Points<'p> = dyn Fn(usize, &Path) -> Result<Vec<Told>, Failure> + 'p;
/// Cuts that are fitted together, with the first pass of them.
type Group<'g> = (&'g Pass, Vec<PartCut<'g>>);
/// What is made of passes and their cuts.
type Of<'o, T> = dyn Fn(&[&Pass], &[Group<'_>]) -> Result<T, Failure> + 'o;

fn with_cuts<T>(passes: &[Pass], together: bool, points: &Points<'_>, of: &Of<'_, T>) -> Result<T, Failure> {
    let mut buffers: Vec<PathBuffer> = passes.iter().map(|_| PathBuffer::default()).collect();
    let mut own = Vec::new();
    for (k, (pass, buffer)) in passes.iter().zip(&mut buffers).enumerate() {
        let path = pass.sample(buffer)?;
        own.push((pass, path, points(k, &path)?));
    }
    let cuts = |contour: usize, k: usize| {
        let (_, path, parts) = &own[k];
        parts.iter().enumerate().map(move |(part, told)| PartCut {
            path: *path,
            contour,
            part,
            parts_ago: u32::try_from(parts.len() - part).unwrap_or(u32::MAX),
            nodes: &told.nodes,
            observations: &told.observations,
        })
    };
    let walls: Vec<&Pass> = passes.iter().collect();
    let groups: Vec<Group<'_>> = if together {
        let all = (0..own.len()).flat_map(|k| cuts(k, k)).collect();
        walls.first().map(|first| (*first, all)).into_iter().collect()
    } else {
        (0..own.len()).map(|k| (own[k].0, cuts(0, k).collect())).collect()
    };
    of(&walls, &groups)
}
