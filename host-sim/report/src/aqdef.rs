//! An inspection in the transfer format of quality departments, Q-DAS ASCII (AQDEF): every reading a characteristic with the wall error
//! as its value, nominal 0 and the limits of the part, for a shop's statistics.
//!
//! No clock is read: a value carries no date.

use std::fmt::Write;

use truepath_ground::units::{float, mm};
use truepath_job::measurement::Measurement;
use truepath_job::pass::Pass;

/// Between the values of a line.
const NEXT: char = '\u{f}';
/// Between a value and its attribute, 0 for a valid one.
const ATTRIBUTE: char = '\u{14}';

/// The readings of the walls of a part; several walls with their names.
pub fn aqdef(walls: &[(Option<&str>, &Pass, &Measurement)]) -> String {
    let Some((_, first, _)) = walls.first() else { return String::new() };
    let names = &first.job.part.names;
    let part = names.name.as_deref().unwrap_or_else(|| first.program.name());
    let readings: usize = walls.iter().map(|(_, _, measurement)| measurement.contacts.len()).sum();
    let mut text = format!(
        "K0100 {readings}\r\nK1001 {}\r\nK1002 {}\r\n",
        plain(names.drawing.as_deref().unwrap_or(part)),
        plain(part)
    );
    let mut values = String::new();
    let mut number = 0;
    for (wall, pass, measurement) in walls {
        let depth = mm(pass.job.numbers.cut.axial_depth);
        // A dimension between two contours is one characteristic.
        for contact in measurement.contacts.iter().filter(|c| !measurement.is_second_half(c.line)) {
            number += 1;
            let wall = wall.map_or_else(String::new, |wall| format!("{wall}: "));
            let what = measurement.dimension(contact.line).map_or_else(
                || format!("wall at s {:.2}, {:.2} above the tip", mm(contact.s), float(contact.height) * depth),
                |placed| match placed.across {
                    Some(_) => format!("{}, mean error of both walls", placed.dimension.name),
                    None => format!("{}, wall error", placed.dimension.name),
                },
            );
            // Writing to a string cannot fail.
            let _ = write!(
                text,
                "K2001/{number} {number}\r\nK2002/{number} {}\r\nK2022/{number} 4\r\nK2101/{number} 0\r\n",
                plain(&format!("{wall}{what}"))
            );
            if let Some(tolerance) = pass.job.part.tolerance {
                let (lower, upper) = (mm(tolerance.lower), mm(tolerance.upper));
                let _ = write!(text, "K2110/{number} {lower}\r\nK2111/{number} {upper}\r\n");
            }
            let _ = write!(text, "K2142/{number} mm\r\n");
            if number > 1 {
                values.push(NEXT);
            }
            let _ = write!(values, "{}{ATTRIBUTE}0", mm(contact.error));
        }
    }
    text + &values + "\r\n"
}

/// A text as a key field holds it: on one line, in the letters that every reader of the format knows.
fn plain(text: &str) -> String {
    let plain = |c: char| if c.is_ascii_graphic() || c == ' ' { c } else { '?' };
    text.chars().map(plain).take(80).collect()
}
