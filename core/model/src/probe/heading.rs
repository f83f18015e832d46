//! What a verification program writes before and after its points: which program, correction, unit, ball, how many
//! points.
//!
//! `program HEX`, `correction HEX` (of a part cut with that file), `unit mm|inch`, `ball D`, `points N`, `end N`, in any case; other words are remarks. The ball is in the
//! unit stated before it.

use super::error::{ProbeError, ProbeErrorKind};
use super::format::{CutWith, Given, LengthUnit};
use super::number::{Number, Signs};
use truepath_rs274::Line;
use truepath_units::Offset;

/// The heading as far as it was read.
pub(super) struct Heading<'g> {
    given: &'g Given,
    unit: LengthUnit,
    announced: Option<u32>,
    counted: u32,
}

impl<'g> Heading<'g> {
    pub(super) const fn new(given: &'g Given) -> Self {
        Self { given, unit: given.program_unit, announced: None, counted: 0 }
    }

    /// The unit of the numbers.
    pub(super) const fn unit(&self) -> LengthUnit {
        self.unit
    }

    /// Counts a point.
    pub(super) fn count(&mut self) {
        self.counted = self.counted.saturating_add(1);
    }

    /// Takes note of a line; `true` when it is the last of its file.
    pub(super) fn note(&mut self, text: &[u8], line: &Line) -> Result<bool, ProbeError> {
        let mut words = text.split(|b| b.is_ascii_whitespace()).filter(|w| !w.is_empty());
        let key = words.next().unwrap_or_default();
        let value = words.next();
        let is = |name: &str| key.eq_ignore_ascii_case(name.as_bytes());
        let fails = |kind| ProbeError::of_line(kind, line);
        let malformed = |expected| fails(ProbeErrorKind::Malformed { expected });
        let number =
            |expected| value.and_then(|v| Number::parse(v, Signs::POINT).ok()).ok_or_else(|| malformed(expected));
        if is("program") {
            // A remark such as "program finished" is not a check sum.
            let file = value.and_then(check_sum).ok_or_else(|| malformed("`program` with 8 hexadecimal digits"))?;
            if file != self.given.program_crc {
                return Err(fails(ProbeErrorKind::ProgramDiffers { file, job: self.given.program_crc }));
            }
        } else if is("correction") {
            let file = value.and_then(check_sum).ok_or_else(|| malformed("`correction` with 8 hexadecimal digits"))?;
            match self.given.cut_with {
                CutWith::Nothing => return Err(fails(ProbeErrorKind::CutCorrected { file })),
                CutWith::Correction(known) if !known.contains(&Some(file)) => {
                    return Err(fails(ProbeErrorKind::CorrectionDiffers { file }));
                }
                CutWith::Anything | CutWith::Correction(_) => {}
            }
        } else if is("unit") {
            let value = value.unwrap_or_default();
            let named = |names: &[&str]| names.iter().any(|name| value.eq_ignore_ascii_case(name.as_bytes()));
            self.unit = if named(&["mm"]) {
                LengthUnit::Millimetre
            } else if named(&["inch", "in"]) {
                LengthUnit::Inch
            } else {
                return Err(malformed("`unit mm` or `unit inch`"));
            };
        } else if is("ball") {
            let file = Offset::from_nm(number("`ball` with a diameter")?.nm(self.unit).map_err(fails)?);
            if self.given.is_other_ball(file) {
                return Err(fails(ProbeErrorKind::BallDiffers { file, job: self.given.ball_diameter }));
            }
        } else if is("points") {
            let count = number("`points` with their number")?.whole();
            self.announced = Some(count.ok_or_else(|| malformed("`points` with their number"))?);
        } else if is("end") {
            let found = core::mem::take(&mut self.counted);
            let said = match value {
                None => None,
                Some(_) => Some(number("`end` with the number of points")?)
                    .map(|n| n.whole().ok_or_else(|| malformed("`end` with the number of points")))
                    .transpose()?,
            };
            for said in [said, self.announced.take()].into_iter().flatten() {
                if said != found {
                    return Err(fails(ProbeErrorKind::PointsLost { said, found }));
                }
            }
            return Ok(true);
        }
        Ok(false)
    }
}

/// Eight hexadecimal digits.
fn check_sum(text: &[u8]) -> Option<u32> {
    let digits = core::str::from_utf8(text).ok().filter(|digits| digits.len() == 8)?;
    u32::from_str_radix(digits, 16).ok()
}
