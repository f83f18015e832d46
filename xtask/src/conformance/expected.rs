//! What the reference made of our own programs, recorded for tests that run where it is not installed.
//!
//! A section begins with `== FILE accepted`, `== FILE refused LINE` or `== FILE stopped` (by a lack that ours only
//! warns of) and holds the calls that are motion.

use super::corpus::{Origin, Program};
use super::outcome::End;
use super::stream::calls;
use super::verdict::{Verdict, bare};
use crate::step::Failure;

/// Where it lies, from the root.
pub const FILE: &str = "tests/data/conformance/expected.txt";

/// The text of the file.
///
/// # Errors
/// When the reference crashed, or the line it refuses is not the only one that reads so.
pub fn record(programs: &[Program], verdicts: &[Verdict]) -> Result<String, Failure> {
    let mut out = String::new();
    for (program, verdict) in programs.iter().zip(verdicts) {
        let end = match (program.origin, &verdict.theirs.end) {
            (Origin::Shipped | Origin::Caller, _) => continue,
            (Origin::Warn, End::Refused { .. }) => "stopped".to_owned(),
            (_, End::Accepted) => "accepted".to_owned(),
            (_, End::Refused { line, .. }) => format!("refused {}", number_of(program, line)?),
            (_, End::Crashed(how)) => return Err(Failure::found(format!("{}: the reference: {how}", program.name))),
        };
        out += &format!("== {} {end}\n", program.name);
        for call in calls(&verdict.theirs.text, true) {
            out += &format!("{}({})\n", call.name, call.arguments);
        }
    }
    Ok(out)
}

fn number_of(program: &Program, line: &str) -> Result<usize, Failure> {
    let text = String::from_utf8_lossy(&program.text).into_owned();
    let mut found = text.split('\n').enumerate().filter(|(_, l)| bare(l) == bare(line)).map(|(index, _)| index + 1);
    match (found.next(), found.next()) {
        (Some(number), None) => Ok(number),
        _ => Err(Failure::found(format!(
            "{}: which line is {line:?}? Lines of these programs must differ",
            program.name
        ))),
    }
}
