//! The history of parts that were cut by planned programs: `plan-history.json`.
//!
//! Part 1 was cut by the program itself, without a correction; every later one by a planned program. Of each the points are kept, with
//! the passes that cut it.

use serde::{Deserialize, Serialize};
use truepath_core::checksum::crc32;
use truepath_core::correct::Node;
use truepath_core::probe::CutWith;
use truepath_core::process::{Aim, Load, Slices};
use truepath_core::units::Offset;
use truepath_ground::diagnostics::{Failure, InputError, Source};
use truepath_job::job::Route;
use truepath_job::measurement::Measurement;
use truepath_job::pass::Pass;

use super::bench::CutPass;
use super::process::{Cut, Levels};
use crate::codes::{Q001, Q002, Q003};
use crate::learning::{Facts, Nodes, Part, WrittenFile};
use crate::planned::{PlannedPass, PlannedProgram, image_name};
use crate::seal::{sealed, unsealed};
use crate::surface::draws::Predicted;

/// Parts that are kept: when there are more, the oldest planned one is dropped.
pub const MOST_PARTS: usize = 8;
/// Version of the file.
const VERSION: u32 = 1;

/// What parts have shown, and how the next one is cut.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlanHistory {
    /// Version of the file.
    version: u32,
    /// What must be the same from part to part.
    pub facts: Facts,
    /// The measured parts, in their order; the first was cut without a correction.
    pub parts: Vec<PlannedPart>,
    /// How the next part is cut.
    pub next: NextPart,
}

/// A measured part.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlannedPart {
    /// Its points.
    pub measured: Part,
    /// What it was cut with; `None` for the one pass of the program.
    pub process: Option<Process>,
}

/// The passes of a part.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Process {
    /// The cuts.
    cuts: Vec<CutRecord>,
    /// The correction of every pass of them, in the order of cutting.
    passes: Vec<Nodes>,
}

/// How the next part is cut, and what that promises.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct NextPart {
    /// Its passes.
    pub process: Process,
    /// Half the width of the tolerance that was asked for, mm.
    pub tolerance_mm: f64,
    /// The share of machines asked for, 0…1.
    pub confidence: f64,
    /// The predicted profile error, mm.
    pub profile_mm: f64,
    /// Its standard deviation, mm.
    pub sigma_mm: f64,
    /// Whether the coprocessor displaces the passes, each by an image.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub by_images: bool,
    /// The files that the program was written to, and behind them the images.
    pub files: Vec<WrittenFile>,
}

/// A cut as the file has it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct CutRecord {
    aim: AimRecord,
    levels: usize,
    /// Depth of a level as parts in a million of the wall's height, where levels are not even.
    level_millionths: Option<u32>,
    reversed: bool,
    feed_percent: u16,
    spring: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
enum AimRecord {
    Middle,
    Mean,
    LeastNm(i64),
}

impl CutRecord {
    const fn of(cut: &Cut) -> Self {
        let aim = match cut.aim {
            Aim::Middle => AimRecord::Middle,
            Aim::Mean => AimRecord::Mean,
            Aim::Least(left) => AimRecord::LeastNm(left.nm()),
        };
        let level_millionths = match cut.levels {
            Levels::Even(_) => None,
            Levels::ContactRatio { millionths, .. } => Some(millionths),
        };
        let Cut { reversed, feed_percent, spring, .. } = *cut;
        Self { aim, levels: cut.levels.count(), level_millionths, reversed, feed_percent, spring }
    }

    const fn cut(&self) -> Cut {
        let aim = match self.aim {
            AimRecord::Middle => Aim::Middle,
            AimRecord::Mean => Aim::Mean,
            AimRecord::LeastNm(nm) => Aim::Least(Offset::from_nm(nm)),
        };
        let levels = match self.level_millionths {
            None => Levels::Even(self.levels),
            Some(millionths) => Levels::ContactRatio { count: self.levels, millionths },
        };
        Cut { aim, levels, reversed: self.reversed, feed_percent: self.feed_percent, spring: self.spring }
    }

    fn is_sound(&self) -> bool {
        (1..=4).contains(&self.levels)
            && self.level_millionths.is_none_or(|depth| (1..=1_000_000).contains(&depth))
            && (1..=1000).contains(&self.feed_percent)
    }
}

impl Process {
    /// Of cuts and the passes that they became.
    pub fn of(cuts: &[Cut], passes: &[PlannedPass]) -> Self {
        let nodes = |pass: &PlannedPass| Nodes::of(&pass.nodes);
        Self { cuts: cuts.iter().map(CutRecord::of).collect(), passes: passes.iter().map(nodes).collect() }
    }

    /// Its cuts.
    pub fn cuts(&self) -> Vec<Cut> {
        self.cuts.iter().map(CutRecord::cut).collect()
    }

    /// Its passes on a wall in other slices; `placed` puts the corrections beside the samples of another path, `None` where they do
    /// not lie along this contour.
    ///
    /// # Errors
    /// `Q002` for passes of another contour.
    pub fn passes(
        &self,
        slices: Slices,
        placed: impl Fn(&[Node]) -> Option<Vec<Node>>,
    ) -> Result<Vec<CutPass>, InputError> {
        let orders: Vec<_> = self.cuts().iter().flat_map(|cut| cut.orders(slices)).collect();
        let nodes: Option<Vec<Vec<Node>>> = self.passes.iter().map(|pass| placed(&pass.nodes()?)).collect();
        let nodes = nodes.filter(|nodes| nodes.len() == orders.len() && !nodes.is_empty());
        let nodes = nodes.ok_or_else(|| {
            let help = "plan again with truepath plan";
            let expected = "one correction for every pass, along the contour of the job";
            InputError::new(Q002, "the passes of the history do not lie along this contour", expected, help)
        })?;
        let pass = |(order, nodes)| CutPass { order, nodes, load: Load::default() };
        Ok(orders.into_iter().zip(nodes).map(pass).collect())
    }
}

impl NextPart {
    /// Of a process, what was asked and what it promises; `program` is in the files of these names, its images are in those of
    /// [`image_name`].
    pub fn of(
        process: Process,
        (tolerance_mm, confidence): (f64, f64),
        predicted: Predicted,
        (program, names): (&PlannedProgram, &[&str]),
    ) -> Self {
        let file = |name: String, bytes: &[u8]| WrittenFile { name, crc32: format!("{:08x}", crc32(bytes)) };
        let texts = names.iter().map(|name| file((*name).to_owned(), &program.text));
        let images = program.images.iter().zip(1..).map(|(image, number)| file(image_name(number), &image.bytes));
        let files = texts.chain(images).collect();
        let Predicted { profile_mm, sigma_mm } = predicted;
        let by_images = !program.images.is_empty();
        Self { process, tolerance_mm, confidence, profile_mm, sigma_mm, by_images, files }
    }

    /// Where the passes are displaced.
    pub const fn route(&self) -> Route {
        if self.by_images { Route::Coprocessor } else { Route::Program }
    }
}

impl PlanHistory {
    /// After the part that was cut without a correction.
    ///
    /// # Errors
    /// Internal, when the points cannot be held.
    pub fn first(pass: &Pass, measurement: &Measurement, next: NextPart) -> Result<Self, Failure> {
        let part = PlannedPart { measured: Part::new(1, measurement, None)?, process: None };
        Ok(Self { version: VERSION, facts: Facts::of(pass), parts: vec![part], next })
    }

    /// After one more part.
    #[must_use]
    pub fn with(&self, part: PlannedPart, next: NextPart) -> Self {
        let mut parts = self.parts.clone();
        parts.push(part);
        // The first tells what a full cut does, which no later one does.
        let dropped = parts.len().saturating_sub(MOST_PARTS);
        parts.drain(1..1 + dropped);
        Self { version: VERSION, facts: self.facts.clone(), parts, next }
    }

    /// Reads the file.
    ///
    /// # Errors
    /// `Q001` when it is not a history of this version, or was changed after it was written.
    pub fn read(file: &Source) -> Result<Self, InputError> {
        let wrong = |found: String| {
            let help = "name a folder that truepath plan --write or truepath learn has written; if the file was changed, plan again";
            let expected = format!("a history of planned parts, version {VERSION}");
            InputError::new(Q001, found, expected, help).in_file(file.name().as_ref())
        };
        let body = unsealed(file.bytes()).map_err(|why| wrong(format!("{} {why}", file.name())))?;
        let history: Self = serde_json::from_slice(&body)
            .map_err(|error| wrong(format!("{} is not a history ({error})", file.name())))?;
        if history.version != VERSION {
            return Err(wrong(format!("{} is a history of version {}", file.name(), history.version)));
        }
        let processes = history.parts.iter().map(|part| part.process.as_ref());
        let in_order = processes.enumerate().all(|(k, process)| process.is_some() == (k > 0));
        if !(1..=MOST_PARTS).contains(&history.parts.len()) || !in_order {
            return Err(wrong(format!("{} does not hold an uncorrected part and planned ones after it", file.name())));
        }
        let processes = history.parts.iter().filter_map(|part| part.process.as_ref()).chain([&history.next.process]);
        if !processes.flat_map(|process| &process.cuts).all(CutRecord::is_sound)
            || !history.parts.iter().all(|part| part.measured.noise_mm > 0.0 && !part.measured.points.is_empty())
        {
            return Err(wrong(format!("{} holds impossible numbers", file.name())));
        }
        Ok(history)
    }

    /// The file.
    ///
    /// # Errors
    /// Internal, when it cannot be written.
    pub fn text(&self) -> Result<Vec<u8>, Failure> {
        let body = serde_json::to_vec(self).map_err(|e| Failure::Internal(format!("JSON: {e}")))?;
        Ok(sealed(&body))
    }

    /// The number of the part that is cut next.
    pub fn next_number(&self) -> u32 {
        self.parts.last().map_or(1, |part| part.measured.number.saturating_add(1))
    }

    /// CRC-32 of the planned program of the next part.
    pub fn program(&self) -> Option<u32> {
        self.next.files.first().and_then(|file| u32::from_str_radix(&file.crc32, 16).ok())
    }

    /// What the next part has to be cut with, as a probe file names it.
    pub fn cut_with(&self) -> CutWith {
        CutWith::Correction([self.program(), None])
    }

    /// Refuses a measurement that the history already holds.
    ///
    /// # Errors
    /// `Q003` with the part it is of.
    pub fn refuse_known(&self, new: &Part) -> Result<(), InputError> {
        let known = self.parts.iter().map(|part| &part.measured).find(|part| {
            let same = new.points.iter().filter(|point| part.points.contains(point)).count();
            // Two parts agree in a point to the nanometre now and then, in half of them never.
            part.probe_crc32 == new.probe_crc32 || 2 * same >= new.points.len()
        });
        let Some(part) = known else { return Ok(()) };
        let number = self.next_number();
        let help = format!(
            "touch the part that was cut with the planned program of --from (part {number}) and give that file"
        );
        let found = format!("these are the points of part {}", part.number);
        Err(InputError::new(Q003, found, format!("the points of part {number}"), help))
    }
}
