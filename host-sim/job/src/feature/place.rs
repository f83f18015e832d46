//! Where a feature of the job lies in the program: its first and last line.
//!
//! `blocks` are N words when the program has any, and line numbers when it has none; `lines` are always line numbers.
//! An N word that the program uses more than once names no place.

use truepath_core::gcode::{KlartextBlock, LineRange, Lines, Token, Words};
use truepath_ground::codes::Row;
use truepath_ground::diagnostics::{InputError, Source};

use super::marker::Marked;
use crate::codes::{N007, N008};
use crate::job::{FeaturePlace, FeatureTable, JobFile};

/// The lines of every feature of a job that names its own; `None` for those that markers show.
///
/// # Errors
/// `N008` when a feature names blocks or lines that the program does not have.
pub fn lines_named(job: &JobFile, program: &Source) -> Result<Vec<Option<LineRange>>, InputError> {
    let named = |feature: &FeatureTable| match feature.place {
        FeaturePlace::Markers => Ok(None),
        FeaturePlace::Lines(_) | FeaturePlace::Blocks(_) => lines(job, feature, program, &[]).map(Some),
    };
    job.features.iter().map(named).collect()
}

/// The lines of a feature.
pub(super) fn lines(
    job: &JobFile,
    feature: &FeatureTable,
    program: &Source,
    marked: &[Marked],
) -> Result<LineRange, InputError> {
    let wrong = |row: Row, found: String, expected: String, help: &str| {
        InputError::new(row, found, expected, help).at(job.source(), feature.place_span.clone())
    };
    match feature.place {
        FeaturePlace::Markers => marked.iter().find(|m| m.id == feature.id).map(|m| m.lines).ok_or_else(|| {
            let found = format!("the feature \"{}\" has no place: no blocks, no lines, no markers", feature.id);
            let expected = format!("blocks, or (TRUEPATH BEGIN {}) in {}", feature.id, program.name());
            wrong(N007, found, expected, "add blocks = [first, last], or put the two comments around the cut")
        }),
        FeaturePlace::Lines([first, last]) => by_lines(first, last, program)
            .map_err(|(found, expected)| wrong(N008, found, expected, "count the lines of the program from 1")),
        FeaturePlace::Blocks([first, last]) => {
            let numbers = numbers(program);
            if numbers.is_empty() {
                return by_lines(first, last, program).map_err(|(found, expected)| {
                    wrong(N008, found, expected, "the program has no N words, so that blocks are line numbers")
                });
            }
            let line = |number: u32| match numbers.iter().filter(|(n, _)| *n == number).collect::<Vec<_>>()[..] {
                [(_, line)] => Ok(*line),
                [] => Err(wrong(
                    N008,
                    format!("{} has no block N{number}", program.name()),
                    "the N word of a block".to_owned(),
                    "the program has N words, so that blocks are those; for line numbers write lines = [first, last]",
                )),
                [(_, a), (_, b), ..] => Err(wrong(
                    N008,
                    format!("{} has N{number} more than once, on lines {a} and {b}", program.name()),
                    "an N word that names one block".to_owned(),
                    N008.remedy,
                )),
            };
            let (first, last) = (line(first)?, line(last)?);
            Ok(LineRange { first: first.min(last), last: first.max(last) })
        }
    }
}

fn by_lines(first: u32, last: u32, program: &Source) -> Result<LineRange, (String, String)> {
    let count = Lines::new(program.bytes()).count();
    if first >= 1 && last as usize <= count {
        return Ok(LineRange { first, last });
    }
    Err((
        format!("{} has no line {}", program.name(), if first == 0 { 0 } else { last }),
        format!("lines 1 to {count}"),
    ))
}

/// The whole N words of a program with their lines, or its conversational block numbers.
fn numbers(program: &Source) -> Vec<(u32, u32)> {
    let mut list = Vec::new();
    for line in Lines::new(program.bytes()) {
        let conversational = Words::new(line).next().is_none_or(|token| token.is_err());
        if conversational && let Some(span) = KlartextBlock::of(line).ok().and_then(|block| block.number) {
            let digits = std::str::from_utf8(span.of(program.bytes())).ok();
            list.extend(digits.and_then(|d| d.parse().ok()).map(|n| (n, line.number)));
            continue;
        }
        for token in Words::new(line).map_while(Result::ok) {
            let Token::Word(word) = token else { continue };
            if word.letter == b'N' {
                list.extend(
                    word.value
                        .and_then(|v| v.exactly_times(1))
                        .and_then(|n| u32::try_from(n).ok())
                        .map(|n| (n, line.number)),
                );
                break;
            }
        }
    }
    list
}
