//! Console logs of grbl and grblHAL: `[PRB:x,y,z:1]`, ball centre in machine coordinates.
//!
//! Work coordinates are machine coordinates less the work offset, G92 and the tool length offset, all three from the
//! answer to `$#` in the same log; the active system is that of `[GC:…]`, else G54. grbl reports inches when `$13 = 1`,
//! whatever G20 or G21 says, and then writes four decimals instead of three. Source: grbl 1.1 `report.c` as documented
//! in its wiki ("Grbl v1.1 Interface").
//!
//! The answer to `$#` repeats the last touch behind `[TLO:…]`; that line is not a reading. Two touches in succession at
//! one place are an approach and a measurement: the last one counts. A sender may show `;VERIFY PROGRAM HEX` and
//! `;VERIFY CORRECTION HEX` of the verification program (see [`Heading`]). Everything else in the log is talk.

use super::error::{ProbeError, ProbeErrorKind};
use super::format::{Given, LengthUnit};
use super::heading::Heading;
use super::number::{Number, Signs};
use super::reading::{Outcome, Reading, Sink};
use super::row::position;
use truepath_rs274::{Line, Lines};
use truepath_units::{Offset, Position};

/// Two touches nearer than this in X and Y, at one height, are of one place.
const ONE_PLACE: Offset = Offset::from_um(500);
/// Heights nearer than this are one.
const ONE_HEIGHT: Offset = Offset::from_um(50);
/// Numbers of a line, at most: the axes a controller may have.
const AXES: usize = 9;
const PRB: &str = "[PRB:x,y,z:1] or [PRB:x,y,z:0]";
const SYSTEMS: [&str; 9] = ["G54", "G55", "G56", "G57", "G58", "G59", "G59.1", "G59.2", "G59.3"];

pub(super) fn read(file: &[u8], given: &Given, sink: &mut Sink) -> Result<(), ProbeError> {
    let unit = Reports::of(file)?;
    let mut origin = None;
    let mut behind_tool_length = false;
    let mut heading = Heading::new(given);
    for line in Lines::new(file) {
        if let Some(text) = verified(line.text) {
            heading.note(text, &line)?;
        }
        let Some((text, touch)) = touch(&line) else {
            if !line.text.trim_ascii().is_empty() {
                behind_tool_length = report(line.text, "TLO").is_some();
            }
            continue;
        };
        let (numbers, touched) =
            touch.ok_or_else(|| ProbeError::before(ProbeErrorKind::Malformed { expected: PRB }, &line, text, b""))?;
        if core::mem::take(&mut behind_tool_length) {
            continue;
        }
        let machine = unit.position(numbers, &line)?;
        let [ox, oy, oz] = match origin {
            Some(origin) => origin,
            None => *origin.insert(work_offset(file, given, &unit, &line)?),
        };
        let [x, y, z] = machine;
        let position = [x - ox, y - oy, z - oz];
        if let Some(before) = sink.last().filter(|before| is_same_place(before.position, position)) {
            before.outcome = Outcome::Superseded;
        }
        let outcome = if touched { Outcome::Touched } else { Outcome::Missed };
        let reading = Reading { position, radius: given.ball_radius(), outcome, normal: None, line: line.number };
        sink.push(reading, &line)?;
    }
    Ok(())
}

/// What a verification program says of the part in a comment that a sender shows.
fn verified(text: &[u8]) -> Option<&[u8]> {
    const MARK: &[u8] = b";VERIFY ";
    let at = text.windows(MARK.len()).position(|w| w.eq_ignore_ascii_case(MARK))?;
    let text = text.get(at.saturating_add(MARK.len())..)?.trim_ascii();
    let named = |name: &[u8]| text.get(..name.len()).is_some_and(|key| key.eq_ignore_ascii_case(name));
    (named(b"PROGRAM ") || named(b"CORRECTION ")).then_some(text)
}

fn is_same_place(a: [Position; 3], b: [Position; 3]) -> bool {
    let ([ax, ay, az], [bx, by, bz]) = (a, b);
    (ax - bx).abs() < ONE_PLACE && (ay - by).abs() < ONE_PLACE && (az - bz).abs() < ONE_HEIGHT
}

/// The text and the content of a report of a touch; content `None` when it is not as it should be.
type Touch<'a> = (&'a [u8], Option<([Number; 3], bool)>);

fn touch<'a>(line: &Line<'a>) -> Option<Touch<'a>> {
    // Commands that a sender shows may speak of PRB too.
    let echo = matches!(line.text.trim_ascii_start().first(), Some(b'>' | b';' | b'('));
    let start = line.text.windows(4).position(|w| w == b"PRB:").filter(|_| !echo)?;
    let start = start.checked_sub(1).filter(|&s| line.text.get(s) == Some(&b'[')).unwrap_or(start);
    let text = line.text.get(start..).unwrap_or_default();
    let content = || {
        let inner = text.strip_prefix(b"[PRB:")?.trim_ascii_end().strip_suffix(b"]")?;
        let (numbers, touched) = match inner {
            [numbers @ .., b':', b'1'] => (numbers, true),
            [numbers @ .., b':', b'0'] => (numbers, false),
            _ => return None,
        };
        let (numbers, count) = axes(numbers)?;
        let [x, y, z, ..] = numbers;
        (count >= 3).then_some(([x, y, z], touched))
    };
    Some((text, content()))
}

/// Numbers between commas, and how many; `None` when one is not a number or there are too many.
fn axes(text: &[u8]) -> Option<([Number; AXES], usize)> {
    let mut numbers = [Number::ZERO; AXES];
    let mut count = 0usize;
    for field in text.split(|b| *b == b',') {
        *numbers.get_mut(count)? = Number::parse(field.trim_ascii(), Signs::POINT).ok()?;
        count = count.saturating_add(1);
    }
    Some((numbers, count))
}

/// What stands between `[NAME:` and `]`.
fn report<'a>(line: &'a [u8], name: &str) -> Option<&'a [u8]> {
    let start = line.iter().position(|b| *b == b'[')?;
    let behind = line.get(start.saturating_add(1)..)?.strip_prefix(name.as_bytes())?.strip_prefix(b":")?;
    behind.split(|b| *b == b']').next().filter(|inner| inner.len() < behind.len())
}

/// The unit of the reports.
struct Reports {
    unit: LengthUnit,
    /// Decimals that every number must have when they alone tell the unit.
    decimals: Option<u8>,
}

impl Reports {
    fn of(file: &[u8]) -> Result<Self, ProbeError> {
        let mut stated = None;
        for line in Lines::new(file) {
            let Some(at) = line.text.windows(4).position(|w| w == b"$13=") else { continue };
            let unit = match line.text.get(at.saturating_add(4)) {
                Some(b'0') => LengthUnit::Millimetre,
                Some(b'1') => LengthUnit::Inch,
                _ => continue,
            };
            if stated.is_some_and(|before| before != unit) {
                return Err(ProbeError::of_line(ProbeErrorKind::UnitUnclear, &line));
            }
            stated = Some(unit);
        }
        if let Some(unit) = stated {
            return Ok(Self { unit, decimals: None });
        }
        let first = Lines::new(file).find_map(|line| Some((line, touch(&line)?.1?.0)));
        match first.map(|(line, [x, ..])| (line, x.decimals())) {
            Some((_, 4)) => Ok(Self { unit: LengthUnit::Inch, decimals: Some(4) }),
            Some((line, decimals)) if decimals != 3 => Err(ProbeError::of_line(ProbeErrorKind::UnitUnclear, &line)),
            _ => Ok(Self { unit: LengthUnit::Millimetre, decimals: Some(3) }),
        }
    }

    fn position(&self, numbers: [Number; 3], line: &Line) -> Result<[Position; 3], ProbeError> {
        if self.decimals.is_some_and(|decimals| numbers.iter().any(|n| n.decimals() != decimals)) {
            return Err(ProbeError::of_line(ProbeErrorKind::UnitUnclear, line));
        }
        position(numbers, self.unit, line)
    }

    /// The numbers of a report, each time the same ones; `None` when the log has none.
    fn once(&self, file: &[u8], name: &'static str) -> Result<Option<[Offset; 3]>, ProbeError> {
        let mut found = None;
        for line in Lines::new(file) {
            let Some(text) = report(line.text, name) else { continue };
            let malformed = ProbeErrorKind::Malformed { expected: "[NAME:x,y,z]" };
            let Some((numbers, count)) = axes(text) else { return Err(ProbeError::of_line(malformed, &line)) };
            let numbers = match (numbers, count) {
                // The tool length of grbl is a single number along Z.
                ([z, ..], 1) if name == "TLO" => [z.zeroed(), z.zeroed(), z],
                ([x, y, z, ..], 3..) => [x, y, z],
                _ => return Err(ProbeError::of_line(malformed, &line)),
            };
            let value = self.position(numbers, &line)?.map(|p| p - Position::ZERO);
            if found.is_some_and(|before| before != value) {
                return Err(ProbeError::of_line(ProbeErrorKind::OffsetChanged { what: name }, &line));
            }
            found = Some(value);
        }
        Ok(found)
    }
}

/// Origin of the work coordinates: system, G92 and tool length together.
fn work_offset(file: &[u8], given: &Given, unit: &Reports, at: &Line) -> Result<[Offset; 3], ProbeError> {
    let system = active_system(file)?;
    let Some(mut sum) = unit.once(file, system)? else {
        // What the job says holds tool length and all.
        let missing = ProbeError::of_line(ProbeErrorKind::NoWorkOffset { system }, at);
        return given.work_offset.ok_or(missing);
    };
    for name in ["G92", "TLO"] {
        for (sum, part) in sum.iter_mut().zip(unit.once(file, name)?.unwrap_or_default()) {
            *sum += part;
        }
    }
    Ok(sum)
}

/// The system that `$G` reports, else G54.
fn active_system(file: &[u8]) -> Result<&'static str, ProbeError> {
    let mut active = None;
    for line in Lines::new(file) {
        let Some(modes) = report(line.text, "GC") else { continue };
        let named = SYSTEMS.into_iter().find(|s| modes.split(|b| *b == b' ').any(|word| word == s.as_bytes()));
        if active.is_some() && named.is_some() && active != named {
            return Err(ProbeError::of_line(ProbeErrorKind::OffsetChanged { what: "GC" }, &line));
        }
        active = active.or(named);
    }
    Ok(active.unwrap_or("G54"))
}
