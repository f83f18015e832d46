//! Every line that was not to be changed has kept its bytes.

use std::collections::BTreeMap;

use truepath_core::gcode::Lines;

use super::super::klartext::without_number;

/// Compares the bytes of both programs: `touched` gives how many lines a line has become, `head` the lines added
/// after line `head_after`.
pub(super) fn compare(
    original: &[u8],
    written: &[u8],
    touched: &BTreeMap<u32, usize>,
    (head_after, head): (u32, &[u8]),
    klartext: bool,
) -> Result<(), String> {
    // A conversational program gets the block numbers that its control would count.
    let lines = |text| {
        let mut lines = lines(text);
        if klartext {
            lines.iter_mut().for_each(|line| *line = without_number(line).trim_ascii_start());
        }
        lines
    };
    let (old, new) = (lines(original), lines(written));
    let head_lines = lines(head);
    let mut at = 0;
    let mut take = |count: usize| {
        let part = new.get(at..at + count);
        at += count;
        part
    };
    let expect_head = |take: &mut dyn FnMut(usize) -> Option<_>| match take(head_lines.len()) {
        Some(part) if part == &head_lines[..] => Ok(()),
        _ => Err("the mark is not where it should be".to_owned()),
    };
    if head_after == 0 {
        expect_head(&mut take)?;
    }
    for (number, line) in (1u32..).zip(&old) {
        match touched.get(&number) {
            Some(&count) => {
                take(count);
            }
            None => match take(1) {
                Some(part) if part == [*line] => {}
                _ => return Err(format!("line {number} was to be left alone and is another one now")),
            },
        }
        if number == head_after {
            expect_head(&mut take)?;
        }
    }
    if at == new.len() { Ok(()) } else { Err(format!("{} lines were expected, {} written", at, new.len())) }
}

/// The lines with their ends.
fn lines(text: &[u8]) -> Vec<&[u8]> {
    let starts: Vec<usize> = Lines::new(text).map(|l| l.start).collect();
    let ends = starts.iter().skip(1).copied().chain([text.len()]);
    starts.iter().zip(ends).map(|(&start, end)| &text[start..end]).collect()
}
