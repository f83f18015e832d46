//! Lines of a program: numbers in the program's unit, comments that every control accepts, the common header.

use std::fmt::Write;

use truepath_core::gcode::Units;
use truepath_ground::diagnostics::InputError;

use super::plan::{Place, Plan};
use crate::codes::V005;

/// How a control writes numbers.
#[derive(Clone, Copy, Debug)]
pub(super) struct Notation {
    inch: bool,
    /// Decimals of a coordinate in millimetres; inches have one more.
    decimals: usize,
}

impl Notation {
    /// For the unit of a plan.
    pub(super) fn of(plan: &Plan, decimals: usize) -> Self {
        Self { inch: plan.program.units == Units::Inches, decimals }
    }
    /// G20 or G21.
    pub(super) const fn unit_code(self) -> &'static str {
        if self.inch { "G20" } else { "G21" }
    }
    /// The name of the unit.
    pub(super) const fn unit_name(self) -> &'static str {
        if self.inch { "inch" } else { "mm" }
    }
    /// A length or a feed, given in millimetres, in the program's unit.
    pub(super) fn number(self, mm: f64) -> String {
        if self.inch { fixed(mm / 25.4, self.decimals + 1) } else { fixed(mm, self.decimals) }
    }
    /// A feed.
    pub(super) fn feed(self, mm_per_min: f64) -> String {
        if self.inch { fixed(mm_per_min / 25.4, 2) } else { fixed(mm_per_min, 1) }
    }
    /// X and Y words.
    pub(super) fn xy(self, p: [f64; 2]) -> String {
        format!("X{} Y{}", self.number(p[0]), self.number(p[1]))
    }
    /// Whether the unit is the inch.
    pub(super) const fn is_inch(self) -> bool {
        self.inch
    }
}

/// A number with fixed decimals; a zero carries no sign.
pub(super) fn fixed(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    let is_zero = text.bytes().all(|b| matches!(b, b'-' | b'0' | b'.'));
    if is_zero { text.trim_start_matches('-').to_owned() } else { text }
}

/// A program in the making.
#[derive(Debug, Default)]
pub(super) struct Page(String);

impl Page {
    /// A line.
    pub(super) fn line(&mut self, text: impl AsRef<str>) {
        self.0.push_str(text.as_ref());
        self.0.push('\n');
    }
    /// A comment, in capitals and with nothing in it that a control could take for something else.
    pub(super) fn comment(&mut self, text: &str) {
        // Writing to a string cannot fail.
        let _ = writeln!(self.0, "({})", plain(text));
    }
    /// The program.
    pub(super) fn finish(self) -> String {
        self.0
    }
    /// What every program says of itself before it moves.
    pub(super) fn header(&mut self, plan: &Plan, control: &str, results: &str) {
        let program = &plan.program;
        let touches = plan.count();
        let unit = Notation::of(plan, 3);
        self.comment(&format!("truepath verification program, {control}"));
        self.comment(&format!("part program {}, CRC32 {:08X}", program.name, program.crc));
        if let Some(correction) = plan.correction {
            self.comment(&format!("for the part cut with the correction of CRC32 {correction:08X}"));
        }
        if plan.before_the_pass {
            self.comment("touches the stock, before the finishing pass: after it no result is of use");
        }
        self.comment(&format!(
            "points {touches}, places {}, heights {}, ball {} {}",
            plan.places.len(),
            plan.most_heights(),
            unit.number(plan.ball_mm),
            unit.unit_name()
        ));
        self.comment(if plan.z_is_tip {
            "Z is that of the lowest point of the ball"
        } else {
            "Z is that of the centre of the ball"
        });
        self.comment(results);
        self.comment("changes no offset. spindle stopped. same work offset as the part program");
        self.comment(&format!("moves between places at Z{}: it must clear every clamp", unit.number(plan.safe_z_mm)));
        if plan.settings.probe_tool.is_none() {
            self.comment(
                "before starting: probe in the spindle, its length offset in force, probe switched on and tried",
            );
        }
    }
    /// What a place is and why it is touched, before its touches.
    pub(super) fn place(&mut self, place: &Place, first: usize, last: usize) {
        let points = if first == last { format!("point {first}") } else { format!("points {first} to {last}") };
        let of = place.contour.as_ref().map_or_else(String::new, |contour| format!(" {contour},"));
        self.comment(&format!("{points}:{of} {}, line {}", place.what, place.line));
        self.comment(&format!("why: {}", place.why));
    }
}

/// What every control accepts inside a comment.
fn plain(text: &str) -> String {
    let text = text.replace("->", "to").replace('%', "pct").to_uppercase();
    let allowed = |c: char| c.is_ascii_alphanumeric() || " .,:+-=/".contains(c);
    text.chars().map(|c| if allowed(c) { c } else { ' ' }).collect()
}

/// What a control calls work offsets beyond G59.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum MoreOffsets {
    /// None.
    Nothing,
    /// G59.1 … G59.3.
    Points,
    /// A code with P, `G154` or `G54.1`.
    Code(&'static str),
}

/// The code of the work offset in which the part was cut.
///
/// # Errors
/// `V005` for one that the control does not have.
pub(super) fn work_offset(plan: &Plan, more: MoreOffsets) -> Result<String, InputError> {
    match (plan.program.work_offset, more) {
        (n @ 1..=6, _) => Ok(format!("G{}", 53 + n)),
        (n @ 7..=9, MoreOffsets::Points) => Ok(format!("G59.{}", n - 6)),
        (n @ 10.., MoreOffsets::Code(code)) => Ok(format!("{code} P{}", n - 9)),
        (n, _) => Err(V005.error(
            format!(
                "the part's program cuts in {}",
                match n {
                    7..=9 => format!("G59.{}", n - 6),
                    _ => format!("additional work offset P{}", n.saturating_sub(9)),
                }
            ),
            "a work offset that this control has",
        )),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_zero_has_no_sign_and_a_comment_no_parenthesis() {
        assert_eq!(fixed(-0.0001, 3), "0.000");
        assert_eq!(fixed(-0.0006, 3), "-0.001");
        assert_eq!(plain("a (b) ü 10 -> 5 %"), "A  B    10 TO 5 PCT");
    }
}
