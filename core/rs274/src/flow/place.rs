//! A place in a program or in a file it calls, and the search for another one.

use super::super::lexical::{is_blank, is_word, number, spelled, trimmed};
use super::super::{Line, Lines};

/// A place: the next line to be read.
#[derive(Clone, Debug)]
pub(super) struct Place<'p> {
    /// The file.
    pub(super) text: &'p [u8],
    /// Its number.
    pub(super) file: u16,
    /// Where the program in it begins: a file may hold several.
    pub(super) start: Lines<'p>,
    /// The lines to be read.
    pub(super) lines: Lines<'p>,
}

impl<'p> Place<'p> {
    /// At the start of a file.
    pub(super) fn start_of(text: &'p [u8], file: u16) -> Self {
        Self { text, file, start: Lines::new(text), lines: Lines::new(text) }
    }

    /// Behind the line with a block number: further on in this program, or else from its start.
    pub(super) fn block(&self, wanted: u32) -> Option<Lines<'p>> {
        let here = self.lines.clone();
        let found = |mut lines: Lines<'p>| {
            let mut first = true;
            loop {
                let before = lines.clone();
                let line = lines.next()?;
                if block_number(line.text) == Some(wanted) {
                    return Some(before);
                }
                if !first && program_number(line.text).is_some() {
                    return None;
                }
                first = false;
            }
        };
        found(here).or_else(|| found(self.start.clone()))
    }

    /// The program with a number in this file: from its O line.
    pub(super) fn program(&self, wanted: u32) -> Option<Lines<'p>> {
        let mut lines = Lines::new(self.text);
        loop {
            let before = lines.clone();
            let line = lines.next()?;
            if program_number(line.text) == Some(wanted) {
                return Some(before);
            }
        }
    }
}

/// A line without the `/` and the N word in front.
pub(super) fn statement<'t>(line: &Line<'t>) -> &'t [u8] {
    behind_number(behind_switch(line.text))
}

fn behind_switch(text: &[u8]) -> &[u8] {
    let rest = trimmed(text);
    match rest.split_first() {
        Some((b'/', behind)) => {
            let digits = behind.iter().take_while(|b| b.is_ascii_digit()).count();
            trimmed(behind.get(digits..).unwrap_or(&[]))
        }
        _ => rest,
    }
}

fn behind_number(text: &[u8]) -> &[u8] {
    match text.split_first() {
        Some((b'N' | b'n', behind)) => trimmed(number(behind).0),
        _ => text,
    }
}

fn block_number(text: &[u8]) -> Option<u32> {
    let (b'N' | b'n', behind) = behind_switch(text).split_first()? else { return None };
    u32::try_from(number(behind).1.ok()?.exactly_times(1)?).ok()
}

fn program_number(text: &[u8]) -> Option<u32> {
    let (first, behind) = text.iter().position(|b| !is_blank(*b)).and_then(|n| text.get(n..)?.split_first())?;
    if !matches!(first, b'O' | b'o' | b':') {
        return None;
    }
    let (rest, value) = number(behind);
    // `O100 if` is no program; `O100 sub` is one that M98 may call too.
    let rest = trimmed(rest);
    if is_word(rest) && spelled(rest, b"SUB").is_none() {
        None
    } else {
        u32::try_from(value.ok()?.exactly_times(1)?).ok()
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn a_block_is_sought_further_on_first_and_in_its_own_program_only() {
        let text = b"O1\nN10 G0\nN20 G1\nN10 G2\nO2\nN30\nN10 G3";
        let mut place = Place::start_of(text, 0);
        let line = |lines: Option<Lines<'_>>| lines.and_then(|mut l| l.next()).map(|l| l.number);
        assert_eq!(line(place.block(10)), Some(2));
        place.lines.nth(2);
        assert_eq!((line(place.block(10)), line(place.block(20)), line(place.block(30))), (Some(4), Some(3), None));
        assert_eq!((line(place.program(2)), line(place.program(3))), (Some(5), None));
    }

    #[test]
    fn an_o_word_that_steers_is_no_program() {
        assert_eq!(program_number(b" o100 sub"), Some(100));
        assert_eq!(program_number(b":7 (NAME)"), Some(7));
        assert_eq!(program_number(b"o100 if [1]"), None);
    }
}
