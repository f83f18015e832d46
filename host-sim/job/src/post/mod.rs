//! What the text of a program says beside its moves: the control it is written for, its unit, the cutters and the material
//! that its comments name.
//!
//! Posts and machinists write it for people, each in a manner of their own; what is read here is a belief with the line it
//! stands on, which a job or `truepath init` shows and the user confirms. It never reads a move.
//!
//! | of | where |
//! |---|---|
//! | lines, apart into words and comments | `text` |
//! | control | [`Control`] |
//! | cutters | [`ToolNote`] |

mod control;
mod text;
mod tokens;
mod tool;

pub use control::Control;
pub(crate) use text::plain;
pub use tool::{Shape, ToolNote};

use truepath_ground::diagnostics::Source;
use truepath_ground::length::Unit;

use text::TextLine;

/// The unit of the words of a program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ProgramUnit {
    /// Whether it is the inch.
    pub inch: bool,
    /// The line of G20, G21, G70 or G71; `None` where there is none and millimetres are taken.
    pub line: Option<u32>,
}

impl ProgramUnit {
    /// The unit in which people are told.
    pub const fn told(self) -> Unit {
        if self.inch { Unit::Inch } else { Unit::Millimetre }
    }
}

/// A material that a comment names.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MaterialNote {
    /// Its name in the table of materials.
    pub name: &'static str,
    /// The comment.
    pub text: String,
    /// Its line.
    pub line: u32,
}

/// What a program says about itself.
#[derive(Clone, Debug, PartialEq)]
pub struct Post {
    /// The control; `None` without a sign of one.
    pub control: Option<Control>,
    /// The unit.
    pub unit: ProgramUnit,
    /// Cutters in the order of their comments, each number once.
    pub tools: Vec<ToolNote>,
    /// Numbers of the tools it changes to, each once, in their order.
    pub called: Vec<u32>,
    /// The material.
    pub material: Option<MaterialNote>,
    /// Every comment with its line.
    pub remarks: Vec<(u32, String)>,
}

impl Post {
    /// Reads the text of a program.
    pub fn read(program: &Source) -> Self {
        let lines = text::lines(program.bytes());
        let unit = unit(&lines);
        Self {
            control: control::control(&lines, program.name()),
            unit,
            tools: tool::tools(&lines, unit.inch),
            called: tool::called(&lines),
            material: material(&lines),
            remarks: lines.iter().flat_map(|l| l.remarks.iter().map(|text| (l.number, text.clone()))).collect(),
        }
    }

    /// The cutters that mill walls: no drills, taps or chamfering tools.
    pub fn mills(&self) -> Vec<&ToolNote> {
        self.tools.iter().filter(|tool| tool.shape != Shape::Other).collect()
    }

    /// The cutter of a number, or the only one there is.
    pub fn mill(&self, number: Option<u32>) -> Option<&ToolNote> {
        let mut mills = self.mills();
        if number.is_some() && mills.iter().any(|tool| tool.number == number) {
            mills.retain(|tool| tool.number == number);
        } else if number.is_some() {
            mills.retain(|tool| tool.number.is_none());
        }
        if let [only] = mills[..] { Some(only) } else { None }
    }
}

fn unit(lines: &[TextLine]) -> ProgramUnit {
    for line in lines {
        for (inch, codes) in [(true, ["G20", "G70"]), (false, ["G21", "G71"])] {
            // G70 and G71 with P and Q are cycles of a lathe.
            if line.has(codes[0]) || (line.has(codes[1]) && !line.code.contains('P')) {
                return ProgramUnit { inch, line: Some(line.number) };
            }
        }
    }
    ProgramUnit { inch: false, line: None }
}

/// The alloy whose number a comment about material names.
fn material(lines: &[TextLine]) -> Option<MaterialNote> {
    for line in lines {
        for text in &line.remarks {
            let upper = plain(text);
            let speaks = ["MATERIAL", "WERKSTOFF", "ALU", "AL-", "AL "].iter().any(|word| upper.contains(word));
            let named = [("6061", "al-6061-t6"), ("6082", "al-6082-t6"), ("7075", "al-7075-t6")];
            if let Some((_, name)) = named.into_iter().find(|(number, _)| speaks && upper.contains(number)) {
                return Some(MaterialNote { name, text: text.clone(), line: line.number });
            }
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    fn post(text: &str) -> Post {
        Post::read(&Source::new("p.nc", text.as_bytes().to_vec()))
    }

    #[test]
    fn the_first_unit_code_outside_comments_is_the_unit() {
        assert_eq!(post("(G20)\nG90 G021 G17\nG20\n").unit, ProgramUnit { inch: false, line: Some(2) });
        assert_eq!(post("N10 G17 G70\n").unit, ProgramUnit { inch: true, line: Some(1) });
        assert_eq!(post("G71 P100 Q200\nG200\n").unit, ProgramUnit { inch: false, line: None });
    }

    #[test]
    fn an_alloy_is_read_where_a_comment_speaks_of_material() {
        let named = post("(MATERIAL - ALUMINUM MM - 6061)\n").material.expect("an alloy");
        assert_eq!((named.name, named.line), ("al-6061-t6", 1));
        assert_eq!(post("(PART 6061-B)\n").material, None);
    }
}
