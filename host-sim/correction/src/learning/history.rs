//! The history of the parts cut by one program: `history.json`.

use serde::{Deserialize, Serialize};
use truepath_core::checksum::crc32;
use truepath_core::probe::CutWith;
use truepath_core::units::Offset;
use truepath_ground::codes::C001;
use truepath_ground::diagnostics::{Failure, InputError, Source};
use truepath_ground::units::mm;
use truepath_job::measurement::Measurement;
use truepath_job::pass::Pass;

use super::facts::Facts;
use super::nodes::{Nodes, differences, sums};
use super::points::Point;
use crate::codes::{Q001, Q003};
use crate::correct::CorrectedPass;
use crate::correction::Correction;
use crate::seal::{sealed, unsealed};

/// Its name in the folder of a part, or of one of its contours.
pub const HISTORY: &str = "history.json";
/// Parts a history keeps: when there are more, the oldest is dropped, and the summary says so.
pub const MOST_PARTS: usize = 8;
/// Version of the file.
const VERSION: u32 = 1;

/// What parts have shown, and the correction of the next one.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct History {
    /// Version of the file.
    version: u32,
    /// What must be the same from part to part.
    pub facts: Facts,
    /// The measured parts, in their order.
    pub parts: Vec<Part>,
    /// The correction the next part is cut with.
    pub next: Next,
    /// The number of the part that is measured next, where it is [said](Self::of_part).
    #[serde(skip)]
    said: Option<u32>,
    /// Whether the part after that is cut with a [new cutter](Self::before_a_new_cutter).
    #[serde(skip)]
    new_cutter: bool,
}

/// A measured part.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Part {
    /// Its number, from 1, in the order the parts were cut; those between two of a history were not touched.
    pub number: u32,
    /// CRC-32 of its probe file.
    pub probe_crc32: String,
    /// Standard deviation of one reading, mm.
    pub noise_mm: f64,
    /// Its points, in the order of the contour, then of height.
    pub points: Vec<Point>,
    /// The correction it was cut with; `None` for none.
    pub correction: Option<Nodes>,
    /// Whether fits leave it out: it came out worse, and the model cannot tell why.
    pub set_aside: bool,
    /// The first part that its cutter has cut; absent for the cutter of part 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cutter_from: Option<u32>,
}

/// The correction of the next part, and what it promises.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Next {
    /// The correction.
    pub correction: Nodes,
    /// Predicted error of the target quantity beside every sample, nm, as differences from the sample before.
    pub predicted_nm: Vec<i64>,
    /// One standard deviation of it, the same way.
    pub sigma_nm: Vec<i64>,
    /// The files it was written to.
    pub files: Vec<WrittenFile>,
    /// The first part that the cutter it is cut with has cut; absent for that of part 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cutter_from: Option<u32>,
}

/// A file that holds a correction.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WrittenFile {
    /// Its name, in the folder of the history.
    pub name: String,
    /// CRC-32 of its bytes.
    pub crc32: String,
}

impl History {
    /// After the first part, milled with no correction.
    ///
    /// # Errors
    /// Internal, when the points cannot be held.
    pub fn first(pass: &Pass, measurement: &Measurement, corrected: &CorrectedPass) -> Result<Self, Failure> {
        let part = Part::new(1, measurement, None)?;
        let (facts, next) = (Facts::of(pass), Next::of(corrected, None));
        Ok(Self { version: VERSION, facts, parts: vec![part], next, said: None, new_cutter: false })
    }

    /// After one more part.
    #[must_use]
    pub fn with(&self, part: Part, corrected: &CorrectedPass) -> Self {
        let cutter_from = if self.new_cutter { Some(part.number.saturating_add(1)) } else { part.cutter_from };
        let mut parts = self.parts.clone();
        parts.push(part);
        let dropped = parts.len().saturating_sub(MOST_PARTS);
        parts.drain(..dropped);
        let next = Next::of(corrected, cutter_from);
        Self { version: VERSION, facts: self.facts.clone(), parts, next, said: None, new_cutter: false }
    }

    /// Reads the file.
    ///
    /// # Errors
    /// `Q001` when it is not a history of this version, or was changed after it was written.
    pub fn read(file: &Source) -> Result<Self, InputError> {
        let help =
            "name a folder that truepath correct or truepath learn has written; if the file was changed, correct again";
        let wrong = |found: String| {
            InputError::new(Q001, found, format!("a history of version {VERSION}"), help).in_file(file.name().as_ref())
        };
        let body = unsealed(file.bytes()).map_err(|why| wrong(format!("{} {why}", file.name())))?;
        let history: Self = serde_json::from_slice(&body)
            .map_err(|error| wrong(format!("{} is not a history ({error})", file.name())))?;
        if history.version != VERSION {
            return Err(wrong(format!("{} is a history of version {}", file.name(), history.version)));
        }
        if history.parts.is_empty() || history.parts.len() > MOST_PARTS {
            return Err(wrong(format!("{} holds {} parts", file.name(), history.parts.len())));
        }
        if let Some(part) = history.parts.iter().find(|part| !part.is_sound()) {
            return Err(wrong(format!("part {} of {} holds impossible numbers", part.number, file.name())));
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

    /// The number of the part that is measured next: the one that is cut next, where it is not said.
    pub fn next_number(&self) -> u32 {
        self.said.unwrap_or_else(|| self.last_number().saturating_add(1))
    }

    fn last_number(&self) -> u32 {
        self.parts.last().map_or(0, |part| part.number)
    }

    /// The same, of which a part of a given number is measured next: those between were cut with the same correction and not
    /// touched.
    ///
    /// # Errors
    /// `C001` where that part was cut before the last one that it holds.
    pub fn of_part(self, number: Option<u32>) -> Result<Self, InputError> {
        let last = self.last_number();
        match number {
            Some(number) if number <= last => {
                let help = "give the number of the part in the order they were cut, or leave it out for the next one";
                let expected = format!("a number above {last}, that of the last part which was learned from");
                Err(InputError::new(C001, format!("--part {number}"), expected, help))
            }
            number => Ok(Self { said: number, ..self }),
        }
    }

    /// The same, where the part after the one that is measured next is cut with a new cutter, or is not.
    #[must_use]
    pub fn before_a_new_cutter(self, new_cutter: bool) -> Self {
        Self { new_cutter, ..self }
    }

    /// Whether the part whose correction is designed next is cut with a new cutter.
    pub const fn is_before_a_new_cutter(&self) -> bool {
        self.new_cutter
    }

    /// CRC-32 of the files that hold the correction of the next part.
    fn written(&self) -> impl Iterator<Item = u32> + '_ {
        self.next.files.iter().filter_map(|file| u32::from_str_radix(&file.crc32, 16).ok())
    }

    /// The correction that the next part has to be cut with, as a probe file names it.
    pub fn cut_with(&self) -> CutWith {
        let mut written = self.written();
        CutWith::Correction([written.next(), written.next()])
    }

    /// The same, as a verification program for that part names it.
    pub fn correction(&self) -> Option<u32> {
        self.written().next()
    }

    /// Refuses a measurement that the history already holds.
    ///
    /// # Errors
    /// `Q003` with the part it is of.
    pub fn refuse_known(&self, new: &Part) -> Result<(), InputError> {
        let number = self.next_number();
        let help =
            format!("touch the part that was cut with the correction of --from (part {number}) and give that file");
        let expected = format!("the points of part {number}");
        for part in &self.parts {
            let found = if part.probe_crc32 == new.probe_crc32 {
                format!("this probe file is that of part {}", part.number)
            } else {
                let known = new.points.iter().filter(|p| part.points.contains(p)).count();
                // Two parts agree in a point to the nanometre now and then, in half of them never.
                if known * 2 < new.points.len() {
                    continue;
                }
                format!("{known} of {} points are those of part {}, to the nanometre", new.points.len(), part.number)
            };
            return Err(InputError::new(Q003, found, expected, help));
        }
        Ok(())
    }
}

impl Part {
    /// A measured part.
    ///
    /// # Errors
    /// Internal, when the points cannot be held.
    pub fn new(number: u32, measurement: &Measurement, correction: Option<Nodes>) -> Result<Self, Failure> {
        Ok(Self {
            number,
            probe_crc32: format!("{:08x}", measurement.crc),
            noise_mm: mm(measurement.noise),
            points: measurement.observations()?.iter().map(|o| Point::of(o, measurement.noise)).collect(),
            correction,
            set_aside: false,
            cutter_from: None,
        })
    }
}

impl Part {
    /// Whether noise and points can be those of a probe.
    fn is_sound(&self) -> bool {
        let noise = self.noise_mm > 0.0 && self.noise_mm <= 1.0;
        noise && !self.points.is_empty() && self.points.iter().all(Point::is_sound)
    }
}

impl Next {
    fn of(corrected: &CorrectedPass, cutter_from: Option<u32>) -> Self {
        let Correction { nodes, predicted, sigma, wanted, .. } = &corrected.correction;
        let file = |name: &str, bytes: &Option<Vec<u8>>| {
            bytes.as_ref().map(|b| WrittenFile { name: name.to_owned(), crc32: format!("{:08x}", crc32(b)) })
        };
        let files = [file("corrected.nc", &corrected.program), file("correction.tpi", &corrected.image)];
        Self {
            correction: Nodes::of(nodes),
            predicted_nm: differences(predicted.iter().map(|p| p.after.aim(wanted.target, None).nm())),
            sigma_nm: differences(sigma.iter().map(|s| s.nm())),
            files: files.into_iter().flatten().collect(),
            cutter_from,
        }
    }

    /// Predicted error of the target quantity and its standard deviation beside every sample.
    pub fn promised(&self) -> Vec<(Offset, Offset)> {
        let nm = Offset::from_nm;
        sums(&self.predicted_nm).into_iter().zip(sums(&self.sigma_nm)).map(|(e, s)| (nm(e), nm(s))).collect()
    }
}
