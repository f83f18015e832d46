//! Bytes at the start of a conversational text: names, numbers, Q parameters.

use super::super::Decimal;
use super::super::lexical::NumberError;

/// The first place of QL and of QR in the memory; Q0 is 1.
const LOCAL: u16 = 3_001;
const RETAINED: u16 = 4_001;
/// What stands behind a name, if the text begins with it, in any case.
pub(super) fn named<'t>(text: &'t [u8], name: &[u8]) -> Option<&'t [u8]> {
    let (start, rest) = text.split_at_checked(name.len())?;
    if start.eq_ignore_ascii_case(name) { Some(rest) } else { None }
}

/// All but the first byte.
pub(in super::super) fn behind(text: &[u8]) -> &[u8] {
    text.get(1..).unwrap_or(&[])
}

/// A number, with a point or a comma.
pub(in super::super) fn number(text: &[u8]) -> (&[u8], Result<Decimal, NumberError>) {
    Decimal::read(text, |byte| matches!(byte, b'.' | b','), |_| false)
}

/// A Q parameter at the start of a text: its place in the memory, and what follows it.
pub(in super::super) fn parameter(text: &[u8]) -> Option<(u16, &[u8])> {
    let rest = named(text, b"Q")?;
    let (first, most, rest) = match (named(rest, b"L"), named(rest, b"R")) {
        (Some(rest), _) => (LOCAL, 499, rest),
        (None, Some(rest)) => (RETAINED, 499, rest),
        (None, None) => (1, 1_999, rest),
    };
    let digits = rest.iter().take_while(|b| b.is_ascii_digit()).count();
    let (number, rest) = rest.split_at_checked(digits)?;
    let number = core::str::from_utf8(number).ok()?.parse::<u16>().ok().filter(|n| *n <= most)?;
    Some((number.saturating_add(first), rest))
}
