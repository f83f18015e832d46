//! What is answered when a written text fails its proof.
//!
//! The program does more than the writer knows: under cutter compensation, where it computes with the place at which it
//! stands, which is displaced, or in a way nobody has thought of. It is an answer about the program, not a crash.

use truepath_core::gcode::Lines;
use truepath_ground::diagnostics::{Failure, InputError, Source};

use super::edit::BlockEdit;
use crate::codes::{P003, P007, P008};

/// How a program reads where it stands: LinuxCNC's parameters of the present position.
const POSITIONS: [&str; 6] = ["#542", "#<_x>", "#<_y>", "#<_abs_x>", "#<_abs_y>", "#[542"];

/// The failure, for what the proof has found.
pub(super) fn failure(source: &Source, edits: &[BlockEdit], centre_path: bool, what: &str) -> Failure {
    let at = |error: InputError, line: u32| {
        let span = Lines::new(source.bytes()).find(|l| l.number == line).map(|l| l.span());
        error.at(source, span.map_or(0..0, |s| s.start..s.end())).into()
    };
    if let Some(line) = reads_its_position(source.bytes()) {
        let found = format!("the program computes with the place where it stands, which is displaced ({what})");
        let help = "keep places in parameters of the program, or use --route coprocessor";
        return at(InputError::new(P003, found, "moves that do not depend on the present position", help), line);
    }
    let line = edits.first().map_or(0, |e| e.line);
    if centre_path {
        let found = format!("the path that G41 or G42 leads along cannot be written without them ({what})");
        return at(P007.error(found, "the path of the cutter's centre"), line);
    }
    let found = format!("the program written for this contour does more than correct it: {what}");
    at(P008.error(found, "a program that differs in the contour alone"), line)
}

/// The first line that names the present position.
fn reads_its_position(program: &[u8]) -> Option<u32> {
    let names = |text: &[u8]| {
        let text: String = text.iter().filter(|b| !b.is_ascii_whitespace()).map(|&b| char::from(b)).collect();
        POSITIONS.iter().any(|name| text.to_ascii_lowercase().contains(name))
    };
    Lines::new(program).find(|l| names(l.text)).map(|l| l.number)
}
