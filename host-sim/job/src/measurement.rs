//! A probe file → contacts on the wall, and what was set aside.

use std::ops::Range;

use truepath_core::checksum::crc32;
use truepath_core::geometry::Direction;
use truepath_core::identify::Observation;
use truepath_core::job::{self, ContourPass};
use truepath_core::probe::{Contact, Outcome, Reading, Rejected};
use truepath_core::units::{Offset, Position, Real};
use truepath_ground::diagnostics::{Failure, Source};
use truepath_ground::length::{Remark, Unit};
use truepath_ground::units::{mm, nm};

use crate::codes::M040;
use crate::dimension::{Dimensions, Placed};
use crate::levels;
use crate::otherwise::otherwise;
use crate::pass::Pass;
use crate::probe_format::{LARGEST_FILE, Settled, settled};
use crate::refusal::why;

/// Points that machine and material are identified from at most: the fit cuts the contour around every place some hundred
/// times, which takes a minute for as many. A tenth of them says all that the model has room for.
pub const MOST_POINTS: usize = 2_000;

/// A reading set aside.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Aside {
    /// Its line.
    pub line: u32,
    /// Where the probe was, work coordinates.
    pub position: [Position; 3],
    /// Why it is not used.
    pub reason: Rejected,
}

/// What a probe file says about a pass.
#[derive(Clone, Debug)]
pub struct Measurement {
    /// Contacts in the order of the contour, then of height.
    pub contacts: Vec<Contact>,
    /// Readings set aside, in the order of the file.
    pub rejected: Vec<Aside>,
    /// Its readings, in the order of the file: all of them, or those of its own wall where there are several.
    pub readings: Vec<Reading>,
    /// Lines of the file's readings that have a number in the probing program.
    pub numbered: Vec<u32>,
    /// Standard deviation of one reading.
    pub noise: Offset,
    /// The unit in which it is told of: that of the program.
    pub unit: Unit,
    /// Whether the points are taken although they may not fit the job.
    pub taken_as_is: bool,
    /// The file; of a QIF document its points, each in its line.
    pub source: Source,
    /// CRC-32 of the file.
    pub crc: u32,
    /// Its name.
    pub file: String,
    /// What is said of its format, where it is not that of the job.
    pub read_as: Option<String>,
    /// The dimensions among the contacts.
    pub dimensions: Option<Dimensions>,
}

/// Lines of readings that have a number in the probing program: every place that it goes to has one, touched or not, and of
/// two touches of one place the second counts.
pub(crate) fn numbered(readings: &[Reading]) -> Vec<u32> {
    readings.iter().filter(|r| r.outcome != Outcome::Superseded).map(|r| r.line).collect()
}

impl Measurement {
    /// Reads a probe file. Points at other depths of the same wall, cut alike, are points of this one.
    ///
    /// # Errors
    /// What is wrong with the file, and a wrong unit, frame or ball, named, when most readings are off the wall.
    pub fn read(pass: &Pass, file: &Source) -> Result<Self, Failure> {
        Self::of(pass, &levels::with_alike(pass, &levels::depths(pass)?), file)
    }

    /// The same, with the points at the depths that `core` names.
    fn of(pass: &Pass, core: &ContourPass, file: &Source) -> Result<Self, Failure> {
        let Settled { probe, read_as, text } = settled(&pass.job, file)?;
        let (crc, file) = (crc32(file.bytes()), &text);
        let mut core = core.clone();
        core.job.probe = Some(probe);
        let lines = file.bytes().iter().filter(|b| matches!(b, b'\n' | b'\r')).count() + 1;
        let most = lines.min(LARGEST_FILE);
        let mut readings = vec![Reading::default(); most];
        let mut contacts = vec![Contact::BLANK; most];
        let mut rejected = Vec::new();
        let contour = pass.path_contour();
        let set_aside = |reading: &Reading, reason| {
            rejected.push(Aside { line: reading.line, position: reading.position, reason });
        };
        let used =
            job::contacts(&core, contour, file.bytes(), &mut readings, &mut contacts, set_aside).map_err(|error| {
                otherwise(pass, file, &error).map_or_else(|| pass.refused_of(file, &error), Failure::from)
            })?;
        contacts.truncate(used);
        rejected.sort_by_key(|aside| aside.line);
        // Every reading has a line, which is never 0.
        readings.truncate(readings.iter().take_while(|reading| reading.line > 0).count());
        let (source, file) = (file.clone(), file.name().to_owned());
        Ok(Self {
            contacts,
            rejected,
            numbered: numbered(&readings),
            readings,
            noise: probe.noise,
            unit: pass.unit(),
            taken_as_is: pass.job.force_data,
            source,
            crc,
            file,
            read_as,
            dimensions: None,
        })
    }

    /// The same, to be taken whether the points fit the job or not.
    #[must_use]
    pub const fn taken_as_is(mut self, taken: bool) -> Self {
        self.taken_as_is = taken;
        self
    }

    /// The number that a point has in the probing program, from 1.
    pub fn number(&self, line: u32) -> usize {
        self.numbered.partition_point(|numbered| *numbered < line) + 1
    }

    /// The dimension that a contact of this line is.
    pub fn dimension(&self, line: u32) -> Option<&Placed> {
        self.dimensions.as_ref().and_then(|dimensions| dimensions.of_line(line))
    }

    /// Whether a contact of this line repeats a dimension between two contours, the other one of which has it already.
    pub fn is_second_half(&self, line: u32) -> bool {
        self.dimension(line).and_then(|placed| placed.half).is_some_and(|half| half.is_second)
    }

    /// File and place of a line.
    pub fn place_of(&self, line: u32) -> (&Source, Range<usize>) {
        match (&self.dimensions, self.dimension(line)) {
            (Some(dimensions), Some(placed)) => (&dimensions.source, placed.span()),
            _ => (&self.source, self.source.line_span(line)),
        }
    }

    /// A point as messages name it: its line in the file and its number in the probing program; a dimension by its name.
    pub fn name_of(&self, line: u32) -> String {
        if let (Some(dimensions), Some(placed)) = (&self.dimensions, self.dimension(line)) {
            return placed.words(dimensions.source.name());
        }
        format!("line {line} (point {})", self.number(line))
    }

    /// Reads a probe file that may be of any depth of the pass's feature: the one with most readings on its wall is
    /// given with them, and with those at the depths that are cut alike. A depth that the user names is kept.
    ///
    /// # Errors
    /// As [`Self::read`], when it cannot be used with any of them.
    pub fn of_any_depth(pass: Pass, file: &Source) -> Result<(Pass, Self), Failure> {
        let named = pass.job.which.pass.is_some();
        let depths = if named { Vec::new() } else { levels::depths(&pass)? };
        if depths.len() < 2 {
            let measurement = Self::read(&pass, file)?;
            return Ok((pass, measurement));
        }
        let mut best: Option<(&Pass, usize)> = None;
        let mut refused = None;
        for depth in &depths {
            match Self::of(depth, &depth.core, file) {
                Ok(found) if best.is_none_or(|(_, most)| most < found.contacts.len()) => {
                    best = Some((depth, found.contacts.len()));
                }
                Ok(_) => {}
                Err(failure) => refused = refused.or(Some(failure)),
            }
        }
        let none = || Failure::Internal("a feature without a finishing pass".to_owned());
        let (depth, _) = best.ok_or_else(|| refused.unwrap_or_else(none))?;
        let measurement = Self::of(depth, &levels::with_alike(depth, &depths), file)?;
        Ok((depth.clone(), measurement))
    }

    /// The contacts as observations for the fit.
    ///
    /// # Errors
    /// `M040` for more than [`MOST_POINTS`].
    pub fn observations(&self) -> Result<Vec<Observation>, Failure> {
        if self.contacts.len() > MOST_POINTS {
            let found = format!("{} holds {} points on the wall", self.file, self.contacts.len());
            let expected = format!("at most {MOST_POINTS} to identify machine and material from");
            return Err(M040.error(found, expected).in_file(self.file.as_ref()).into());
        }
        let blank = Observation::new(Offset::ZERO, Real::ZERO, Offset::ZERO, Offset::ZERO, Direction::X);
        let mut observations = vec![blank; self.contacts.len()];
        job::observations(&self.contacts, self.noise, &mut observations)
            .map_err(|error| Failure::Internal(error.to_string()))?;
        for (observation, contact) in observations.iter_mut().zip(&self.contacts) {
            let Some(placed) = self.dimension(contact.line) else { continue };
            observation.noise = placed.noise;
            *observation = match (placed.half, placed.across) {
                // Two readings in place of one, each as good as half of it.
                (Some(half), _) => {
                    observation.noise = nm(mm(placed.noise) * std::f64::consts::SQRT_2);
                    observation.paired(half.pair)
                }
                (None, Some(across)) => observation.with_across(across.s),
                (None, None) => *observation,
            };
        }
        Ok(observations)
    }

    /// One sentence for every reading set aside, and one for widths.
    pub fn remarks(&self, file: &Source) -> Vec<Remark> {
        let aside = self.rejected.iter().map(|aside| {
            let number = self.number(aside.line);
            self.unit.remark(|unit| {
                format!("{}:{}: point {number} set aside: {}", file.name(), aside.line, why(&aside.reason, unit))
            })
        });
        let placed = || self.dimensions.iter().flat_map(|dimensions| &dimensions.placed);
        let widths = placed().filter(|placed| placed.across.is_some() && placed.half.is_none()).count();
        let of_two = (widths > 0).then(|| {
            let which = if widths == 1 {
                "1 reading is a dimension between two walls: it".to_owned()
            } else {
                format!("{widths} readings are dimensions between two walls: each")
            };
            format!("{which} stands at the first of them, with the mean error of both").into()
        });
        let halves = placed().filter(|placed| placed.half.is_some()).count();
        let of_another = (halves > 0).then(|| {
            let which = if halves == 1 {
                "1 reading is a dimension between a wall of this contour and one of another: it".to_owned()
            } else {
                format!("{halves} readings are dimensions between a wall of this contour and one of another: each")
            };
            format!("{which} stands at both of them, with the mean error of both").into()
        });
        self.read_as.iter().map(|said| said.as_str().into()).chain(aside).chain(of_two).chain(of_another).collect()
    }
}
