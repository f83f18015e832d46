//! The fields of a line: between single separators, or between blanks.

use nom::bytes::complete::{take_till, take_till1, take_while};
use nom::{IResult, Parser};

use super::error::{ProbeError, ProbeErrorKind};
use super::format::LengthUnit;
use super::number::{Number, Signs};
use truepath_rs274::Line;
use truepath_units::Position;

/// Fields of a line, with the byte that separates them; `None` for any number of blanks.
#[derive(Clone, Copy, Debug)]
pub(super) struct Row<'a> {
    pub(super) line: Line<'a>,
    pub(super) separator: Option<u8>,
    pub(super) signs: Signs,
}

pub(super) const fn is_blank(byte: u8) -> bool {
    matches!(byte, b' ' | b'\t' | b'\r')
}

/// A position from three numbers of a line.
pub(super) fn position(numbers: [Number; 3], unit: LengthUnit, line: &Line) -> Result<[Position; 3], ProbeError> {
    let mut position = [Position::ZERO; 3];
    for (slot, number) in position.iter_mut().zip(numbers) {
        let nm = number.nm(unit).map_err(|kind| ProbeError::of_line(kind, line))?;
        *slot = Position::from_nm(nm);
    }
    Ok(position)
}

/// Whether a line holds nothing.
pub(super) fn is_empty(line: &Line) -> bool {
    line.text.iter().all(|b| is_blank(*b))
}

fn blank_field(input: &[u8]) -> IResult<&[u8], &[u8]> {
    let (rest, _) = take_while(is_blank).parse(input)?;
    take_till1(is_blank).parse(rest)
}

impl<'a> Row<'a> {
    /// Gives every field, without the blanks around it, and what follows it to `visit`; returns how many there are.
    pub(super) fn fields(
        &self,
        mut visit: impl FnMut(usize, &'a [u8], &'a [u8]) -> Result<(), ProbeError>,
    ) -> Result<usize, ProbeError> {
        let (mut rest, mut count) = (self.line.text, 0usize);
        loop {
            let Some(separator) = self.separator else {
                let Ok((after, field)) = blank_field(rest) else { return Ok(count) };
                visit(count, field, after)?;
                (rest, count) = (after, count.saturating_add(1));
                continue;
            };
            let field: IResult<&[u8], &[u8]> = take_till(|b| b == separator).parse(rest);
            let Ok((after, field)) = field else { return Ok(count) };
            let trimmed = field.trim_ascii();
            let leading = field.len().saturating_sub(field.trim_ascii_start().len());
            let behind = rest.get(leading.saturating_add(trimmed.len())..).unwrap_or_default();
            visit(count, trimmed, behind)?;
            count = count.saturating_add(1);
            match after {
                [_, next @ ..] => rest = next,
                [] => return Ok(count),
            }
        }
    }

    /// The number in a field.
    pub(super) fn number(&self, field: &[u8], rest: &[u8]) -> Result<Number, ProbeError> {
        Number::parse(field, self.signs).map_err(|kind| ProbeError::before(kind, &self.line, field, rest))
    }

    /// The numbers of a line that must have exactly `N`.
    pub(super) fn exactly<const N: usize>(&self) -> Result<[Number; N], ProbeError> {
        let mut numbers = [Number::ZERO; N];
        let found = self.fields(|at, field, rest| {
            if let Some(slot) = numbers.get_mut(at) {
                *slot = self.number(field, rest)?;
            }
            Ok(())
        })?;
        if found == N { Ok(numbers) } else { Err(self.wrong_count(N, found)) }
    }

    pub(super) fn wrong_count(&self, expected: usize, found: usize) -> ProbeError {
        ProbeError::of_line(ProbeErrorKind::WrongCount { expected, found }, &self.line)
    }
}
