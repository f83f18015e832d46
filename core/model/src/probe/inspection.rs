//! Inspection results: `G800` nominal, `G801` measured, as Autodesk's posts write them and DPRNT of Haas and Fanuc sends
//! them.
//!
//! ```text
//! START
//! G800 N1 X24. Y50. Z-10. I1. J0. K0. O0. U0.05 L0.05     nominal contact, outward normal, offset, tolerances
//! G801 N1 X27.0882 Y50. Z-10. R3.                         measured: ball centre and radius, or R0 and the surface
//! END
//! ```
//!
//! Work coordinates, unit of the program unless a line `UNIT MM` or `UNIT INCH` says otherwise. A `G800` that no `G801`
//! follows is a miss. A missing `END` is a file cut off; `END N` says how many points there are. DPRNT pads numbers with
//! blanks, also behind the sign (`X-  12.345`), and sends NUL, DC1 to DC4 and `%` around the text: they are blanks here.
//! Lines of X Y Z words alone, as `DPRNT[X#185[53]*Y#186[53]*Z#187[53]]` prints them, are surface values in `dprnt`.

use super::error::{ProbeError, ProbeErrorKind};
use super::format::{Format, Given};
use super::heading::Heading;
use super::number::Number;
use super::reading::{Outcome, Reading, Sink, unit_normal};
use super::row::position;
use super::words::{Words, is_filler};
use truepath_rs274::{Line, Lines};
use truepath_units::Offset;
use truepath_units::geometry::Direction;

/// Lines of posts that say nothing about points.
const REMARKS: [&str; 9] =
    ["RESULTSFILE", "DOCUMENTID", "MODELVERSION", "TIMESTAMP", "TOOLPATHID", "TOOLPATH", "G330", "G331", "G802"];
const HEADINGS: [&str; 5] = ["PROGRAM", "CORRECTION", "UNIT", "BALL", "POINTS"];

/// A nominal point that waits for its measured one.
struct Nominal<'a> {
    line: Line<'a>,
    number: Option<u32>,
    coordinates: [Number; 3],
    normal: Option<Direction>,
}

struct Reader<'a, 'g, 's, 'b> {
    given: &'g Given,
    heading: Heading<'g>,
    sink: &'s mut Sink<'b>,
    nominal: Option<Nominal<'a>>,
    /// The last line since START, until END.
    open: Option<Line<'a>>,
}

pub(super) fn read(file: &[u8], given: &Given, sink: &mut Sink) -> Result<(), ProbeError> {
    let mut reader = Reader { given, heading: Heading::new(given), sink, nominal: None, open: None };
    for line in Lines::new(file) {
        reader.line(line)?;
    }
    reader.missed()?;
    match reader.open {
        Some(line) => Err(ProbeError::of_line(ProbeErrorKind::CutOff { expected: "END" }, &line)),
        None => Ok(()),
    }
}

impl<'a> Reader<'a, '_, '_, '_> {
    fn line(&mut self, line: Line<'a>) -> Result<(), ProbeError> {
        let start = line.text.iter().position(|b| !is_filler(*b)).unwrap_or(line.text.len());
        let end = line.text.iter().rposition(|b| !is_filler(*b)).map_or(start, |last| last.saturating_add(1));
        let text = line.text.get(start..end).unwrap_or_default();
        let key = text.split(|b| is_filler(*b)).next().unwrap_or_default();
        let is = |name: &str| key.eq_ignore_ascii_case(name.as_bytes());
        if self.open.is_some() && !text.is_empty() {
            self.open = Some(line);
        }
        if text.is_empty() || matches!(text.first(), Some(b'(')) || REMARKS.into_iter().any(is) {
            return Ok(());
        }
        if HEADINGS.into_iter().any(is) {
            return self.heading.note(text, &line).map(|_| ());
        }
        if is("START") {
            self.missed()?;
            self.open = Some(line);
            return Ok(());
        }
        if is("END") {
            self.missed()?;
            self.open = None;
            return self.heading.note(text, &line).map(|_| ());
        }
        let mut words = Words::of(line, start)?;
        match words.take(b'G').and_then(Number::whole) {
            Some(code @ (800 | 801)) => {
                if self.open.is_none() && self.given.format == Format::Inspection {
                    let kind = ProbeErrorKind::Malformed { expected: "START before the first point" };
                    return Err(ProbeError::of_line(kind, &line));
                }
                if code == 800 { self.nominal(&mut words) } else { self.measured(&mut words, false) }
            }
            None if self.given.format == Format::Dprnt && words.has(b'X') => self.measured(&mut words, true),
            _ => {
                let kind = ProbeErrorKind::Malformed { expected: "START, G800, G801 or END" };
                Err(ProbeError::of_line(kind, &line))
            }
        }
    }

    fn nominal(&mut self, words: &mut Words<'a>) -> Result<(), ProbeError> {
        self.missed()?;
        let number = words.number()?;
        let coordinates = [words.need(b'X')?, words.need(b'Y')?, words.need(b'Z')?];
        let (i, j) = (words.take(b'I'), words.take(b'J'));
        words.ignore(b"KOUL");
        let line = words.finish()?;
        // A normal along Z is of a floor, not of a wall; the point will be off it.
        let normal = i.zip(j).and_then(|(i, j)| unit_normal(i.real(), j.real()));
        self.nominal = Some(Nominal { line, number, coordinates, normal });
        Ok(())
    }

    /// A measured point: with `G801` and a radius, or words alone.
    fn measured(&mut self, words: &mut Words<'a>, alone: bool) -> Result<(), ProbeError> {
        let nominal = self.nominal.take();
        let number = words.number()?;
        let (x, y) = (words.need(b'X')?, words.need(b'Y')?);
        let z = match (alone, words.take(b'Z'), &nominal) {
            (_, Some(z), _) => z,
            (true, None, Some(Nominal { coordinates: [.., z], .. })) => *z,
            _ => words.need(b'Z')?,
        };
        let radius = if alone { words.take(b'R') } else { Some(words.need(b'R')?) };
        let line = words.finish()?;
        if let Some((nominal, measured)) = nominal.as_ref().and_then(|n| n.number).zip(number).filter(|(a, b)| a != b) {
            return Err(ProbeError::of_line(ProbeErrorKind::NumbersDiffer { nominal, measured }, &line));
        }
        let radius = match radius {
            Some(number) => number.nm(self.heading.unit()).map_err(|kind| ProbeError::of_line(kind, &line))?,
            None => 0,
        };
        let radius = Offset::from_nm(radius);
        if radius != Offset::ZERO && self.given.is_other_ball(radius + radius) {
            let (file, job) = (radius + radius, self.given.ball_diameter);
            return Err(ProbeError::of_line(ProbeErrorKind::BallDiffers { file, job }, &line));
        }
        let position = position([x, y, z], self.heading.unit(), &line)?;
        let normal = nominal.and_then(|n| n.normal);
        let outcome = Outcome::Touched;
        self.heading.count();
        self.sink.push(Reading { position, radius, outcome, normal, line: line.number }, &line)
    }

    /// A nominal point that nothing was measured for.
    fn missed(&mut self) -> Result<(), ProbeError> {
        let Some(Nominal { line, coordinates, normal, .. }) = self.nominal.take() else { return Ok(()) };
        let position = position(coordinates, self.heading.unit(), &line)?;
        self.heading.count();
        let reading = Reading { position, radius: Offset::ZERO, outcome: Outcome::Missed, normal, line: line.number };
        self.sink.push(reading, &line)
    }
}
