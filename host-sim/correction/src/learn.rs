//! `learn`: from the measurement of a part that was cut with a correction to the correction of the next part.

use truepath_core::correct::Law;
use truepath_core::cut::Path;
use truepath_core::identify::Observation;
use truepath_core::job::LawName;
use truepath_ground::diagnostics::{Failure, InputError};
use truepath_ground::length::Remark;
use truepath_ground::units::real;
use truepath_job::job::Route;
use truepath_job::measurement::Measurement;
use truepath_job::pass::{Pass, PathBuffer};

use crate::as_milled::WholeContour;
use crate::codes::{Q002, Q006};
use crate::correct::{CorrectedPass, IdentifiedWall, correct_identified};
use crate::correction::{DesignRequest, Identification};
use crate::learning::{Companion, History, MOST_PARTS, Part, PartPoints, Verdict, update};
use crate::remarks::{MeasuredPart, Remarks};
use crate::summary::{ContourSummary, CorrectSummary};
use crate::surface::expected::Surface;
use crate::surface::touched::TouchedSurface;
use crate::told::{self, Told};

/// The correction of the next part.
#[derive(Clone, Debug)]
pub struct Learned {
    /// The correction, as `correct` gives it.
    pub corrected: CorrectedPass,
    /// The history with one part more.
    pub history: History,
    /// How the part came out, and what was made of it.
    pub verdict: Verdict,
}

/// Summary of `learn`: that of `correct`, and the verdict on the part.
#[derive(Clone, Debug, serde::Serialize, schemars::JsonSchema)]
pub struct LearnSummary {
    /// Of the correction for the next part.
    #[serde(flatten)]
    pub correct: CorrectSummary,
    /// Of the part that was measured.
    #[serde(flatten)]
    pub verdict: Verdict,
    /// The part that was measured, along the whole contour, as the model of all parts has it.
    pub whole_contour_error_mm: WholeContour,
    /// Its wall at every height, as the model of all parts has it.
    pub whole_surface: Surface,
    /// Its wall at the touched heights, as measured.
    pub measured_surface: TouchedSurface,
    /// Each of several contours; the rest is the worst of them, or the sum. Absent for one.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub contours: Vec<ContourLearned>,
}

/// One of several contours that were learned from together.
#[derive(Clone, Debug, serde::Serialize, schemars::JsonSchema)]
pub struct ContourLearned {
    /// Its name.
    pub contour: String,
    /// Its figures, as those of a single contour.
    #[serde(flatten)]
    pub summary: LearnSummary,
}

impl LearnSummary {
    /// Of several contours: the verdict is that of the one that came out worst, the figures of the next correction are those
    /// of the worst. `None` without any.
    pub fn of_every(contours: Vec<ContourLearned>, warnings: Vec<Remark>) -> Option<Self> {
        let error = |one: &ContourLearned| one.summary.whole_contour_error_mm.max_mm;
        let worst = contours.iter().max_by(|a, b| error(a).total_cmp(&error(b)))?.summary.clone();
        let corrected = contours.iter().map(|one| ContourSummary {
            contour: one.contour.clone(),
            corrected: true,
            lines: [0, 0],
            summary: Some(one.summary.correct.clone()),
        });
        let correct = CorrectSummary::of_every(corrected.collect(), warnings)?;
        Some(Self { correct: CorrectSummary { contours: Vec::new(), ..correct }, contours, ..worst })
    }
}

/// A wall of a part that was cut with a correction.
#[derive(Clone, Copy, Debug)]
pub struct CorrectedWall<'a> {
    /// The pass that cut it.
    pub pass: &'a Pass,
    /// What was learned before.
    pub history: &'a History,
    /// Its points.
    pub measurement: &'a Measurement,
    /// Sentences for its summary.
    pub remarks: &'a [Remark],
}

/// Learns from the part that was cut with the history's correction, in memory, for one or both routes.
///
/// # Errors
/// A history of another cut, a measurement it already holds or of a part without its correction, and what [`correct_pass`](crate::correct::correct_pass) refuses.
pub fn learn(
    pass: &Pass,
    history: &History,
    measurement: &Measurement,
    remarks: &[Remark],
    routes: &[Route],
    progress: &mut dyn FnMut(f64),
) -> Result<Learned, Failure> {
    let learned = learn_every(&[CorrectedWall { pass, history, measurement, remarks }], routes, progress)?;
    learned.into_iter().next().ok_or_else(|| Failure::Internal("a pass that taught nothing".to_owned()))
}

/// Learns from the walls of a part that was cut with the corrections of their histories: of each, what its own points show
/// beside the machine that all of them tell of.
///
/// # Errors
/// As [`learn`].
pub fn learn_every(
    walls: &[CorrectedWall<'_>],
    routes: &[Route],
    progress: &mut dyn FnMut(f64),
) -> Result<Vec<Learned>, Failure> {
    let mut parts = Vec::new();
    for wall in walls {
        wall.history.facts.agree(wall.pass)?;
        refuse_other_laws(wall.pass)?;
        refuse_feeds(wall.pass)?;
        let part = Part::new(wall.history.next_number(), wall.measurement, Some(wall.history.next.correction.clone()))?;
        wall.history.refuse_known(&part)?;
        parts.push(Part { cutter_from: wall.history.next.cutter_from, ..part });
    }
    let passes = as_told(walls, &parts)?;
    let walls: Vec<CorrectedWall> =
        walls.iter().zip(&passes).map(|(wall, pass)| CorrectedWall { pass, ..*wall }).collect();
    let mut buffers: Vec<PathBuffer> = walls.iter().map(|_| PathBuffer::default()).collect();
    let (mut sampled, mut points) = (Vec::new(), Vec::<Vec<PartPoints>>::new());
    for ((wall, buffer), part) in walls.iter().zip(&mut buffers).zip(&parts) {
        let path = wall.pass.sample(buffer)?;
        points.push(part_points(wall.history, part, &path)?);
        sampled.push(path);
    }
    let count = walls.len() as f64;
    let mut taught = Vec::new();
    for (at, ((wall, path), part)) in walls.iter().zip(&sampled).zip(&mut parts).enumerate() {
        let others = sampled.iter().zip(&points).enumerate().filter(|(other, _)| *other != at);
        let companions: Vec<Companion> = others.map(|(_, (path, parts))| Companion { path, parts }).collect();
        let mut earlier = points.get(at).cloned().unwrap_or_default();
        let Some(newest) = earlier.pop() else { continue };
        let told = &mut |share| progress(0.5 * (at as f64 + share) / count);
        let promised = wall.history.next.promised();
        let next = (&promised[..], wall.history.is_before_a_new_cutter());
        let update = update(wall.pass, path, earlier, newest, &companions, next, told)?;
        part.set_aside = update.set_aside;
        let mut texts = wall.remarks.to_vec();
        texts.extend_from_slice(update.verdict.remarks());
        if let Some(oldest) = wall.history.parts.first().filter(|_| wall.history.parts.len() >= MOST_PARTS) {
            let said = format!("part {} is dropped from the history, which keeps {MOST_PARTS} parts", oldest.number);
            texts.push(said.into());
        }
        taught.push((update, texts));
    }
    let mut identified = Vec::new();
    for ((wall, path), (update, texts)) in walls.iter().zip(&sampled).zip(&taught) {
        let observations = update.joint.observations.last().cloned().unwrap_or_default();
        let request = DesignRequest { law: Law::Model, beside: &update.beside, kept: update.kept.as_deref() };
        let remarks = Remarks::of(wall.measurement, texts, MeasuredPart::Corrected);
        let mut known = Identification { core: update.joint.core, observations };
        if let Some(level) = update.new_cutter.filter(|_| update.kept.is_none()) {
            // Force and compliance have one scale.
            known.core.fit.parameters = known.core.fit.parameters.with_force(real(level.mean));
        }
        identified.push(IdentifiedWall { pass: wall.pass, path, identified: known, request, remarks });
    }
    let later = &mut |share| progress(0.5 + 0.5 * share);
    let corrected = correct_identified(identified, routes, later)?;
    let done = walls.iter().zip(parts).zip(corrected).zip(taught).zip(&points);
    let done = done.map(|((((wall, part), corrected), (update, _)), points)| {
        // The first part was cut without a correction: it yielded otherwise.
        let left = points.iter().zip(&update.joint.observations).filter(|(part, _)| !part.nodes.is_empty());
        let left: Vec<&[Observation]> = left.map(|(_, left)| left.as_slice()).collect();
        let floor = corrected.summary.floor.shown_by(&left);
        // The parts that were cut are those of their own level.
        let identified = Identification { core: update.joint.core, ..corrected.identified };
        let corrected = CorrectedPass { summary: corrected.summary.with_floor(floor), identified, ..corrected };
        let history = wall.history.with(part, &corrected);
        Learned { corrected, history, verdict: update.verdict }
    });
    Ok(done.collect())
}

/// The passes of the walls as the points of all their parts have them.
fn as_told(walls: &[CorrectedWall<'_>], newest: &[Part]) -> Result<Vec<Pass>, Failure> {
    let passes: Vec<&Pass> = walls.iter().map(|wall| wall.pass).collect();
    told::passes(&passes, false, &|k, path| {
        let (Some(wall), Some(part)) = (walls.get(k), newest.get(k)) else {
            return Err(Failure::Internal("points of no wall".to_owned()));
        };
        let parts = part_points(wall.history, part, path)?;
        Ok(parts.into_iter().map(Told::from).collect())
    })
    .map(|heard| heard.passes)
}

/// The parts of a history that count, then the newest.
fn part_points(history: &History, newest: &Part, path: &Path) -> Result<Vec<PartPoints>, InputError> {
    let of = |part: &Part| {
        PartPoints::of(part, path).ok_or_else(|| {
            let found = format!("the correction of part {} does not lie along this contour", part.number);
            Q002.error(found, format!("one entry for each of {} samples", path.count()))
        })
    };
    history.parts.iter().filter(|p| !p.set_aside).chain([newest]).map(of).collect()
}

/// The papers' laws are made from one measurement and know nothing of a second.
fn refuse_other_laws(pass: &Pass) -> Result<(), InputError> {
    let name = match pass.job.numbers.correct.law {
        LawName::Model => return Ok(()),
        LawName::Mirror => "mirror",
        LawName::Paper => "paper",
    };
    let found = format!("correct.law is \"{name}\"");
    let error = InputError::new(Q006, found, "a law that can learn", "set law = \"model\", or leave it out");
    Err(error.at(pass.job.source(), pass.job.span("correct.law")))
}

/// The fit over parts takes every part as cut at the feeds of the program.
pub fn refuse_feeds(pass: &Pass) -> Result<(), InputError> {
    if pass.job.feed.is_none() {
        return Ok(());
    }
    let help = "learn without [feed], or correct the next part anew with truepath correct";
    let error = InputError::new(Q006, "[feed] is given", "parts that are all cut at the feeds of the program", help);
    Err(error.at(pass.job.source(), pass.job.span("feed")))
}
