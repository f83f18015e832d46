//! Cutters as comments name them.
//!
//! | manner | example |
//! |---|---|
//! | Fusion | `(T1 D=10. CR=0. - ZMIN=-8. - flat end mill)` |
//! | Mastercam | `( 1/2 FLAT ENDMILL \| TOOL - 2 \| DIA. OFF. - 2 \| LEN. - 2 \| TOOL DIA. - .5 )` |
//! | FreeCAD | `(TC: 8mm Endmill)` |
//! | Estlcam | `(Fraeser 6mm (2 Schneiden))` |
//! | VCarve | `(1 = End Mill {6 mm})` |
//! | SolidCAM | `(TOOL -3- MILL DIA 12.0 R0. MM )` |
//! | CamBam | `( T3 : 0.375 )` |
//! | by hand | `(T3 12MM HARTMETALL 4 SCHN)`, `T1 = ENDMILL 10`, `(SCHAFTFRAESER D10 Z4)`, `T="FRAESER_D10"` |
//!
//! A comment speaks of a cutter when it has a word for one, or a tool number beside a diameter. What is no length of a cutter
//! (0.1 to 100 mm) is not read; a bare number has the unit of the program.

use super::text::{TextLine, plain};
use super::tokens::{Token, tokens};

/// What a cutter is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
    /// Its side mills a wall down to its tip, or to its corner radius.
    Flat,
    /// A ball end: down to its radius only.
    Ball,
    /// A drill, a tap, a chamfering or engraving tool, a probe.
    Other,
}

/// A cutter that a comment names.
#[derive(Clone, Debug, PartialEq)]
pub struct ToolNote {
    /// Its number, from the comment or from the tool change beside it.
    pub number: Option<u32>,
    /// Its diameter, 0.1…100 mm.
    pub diameter_mm: f64,
    /// Its corner radius, mm.
    pub corner_mm: Option<f64>,
    /// Its teeth, 1…12.
    pub teeth: Option<u32>,
    /// What it is.
    pub shape: Shape,
    /// The comment.
    pub text: String,
    /// Its line.
    pub line: u32,
}

/// Words for a cutter; also parts of longer ones, `SCHAFTFRAESER`.
const MILLS: [&str; 9] = ["MILL", "FRAES", "FRAS", "FRÄS", "CUTTER", "BULL", "FRAISE", "FRESA", "TORUS"];
/// Words for a cutter that stand alone.
const MILL_WORDS: [&str; 7] = ["EM", "VHM", "HARTMETALL", "HSS", "CARBIDE", "HSSCO", "TC"];
/// Words for tools that mill no wall.
const OTHERS: [&str; 23] = [
    "DRILL",
    "BOHR",
    "TAP",
    "GEWINDE",
    "REAM",
    "REIB",
    "SPOT",
    "CENTER",
    "ZENTRIER",
    "CHAMFER",
    "FASE",
    "FASEN",
    "ENGRAV",
    "GRAVIER",
    "PROBE",
    "TASTER",
    "VBIT",
    "SENKER",
    "COUNTERSINK",
    "COUNTERSINKING",
    "THREAD",
    "DOVETAIL",
    "FACE",
];
/// Words behind the number of teeth.
const TEETH: [&str; 14] = [
    "FL",
    "FLT",
    "FLUTE",
    "FLUTES",
    "FLTS",
    "TEETH",
    "TOOTH",
    "SCHN",
    "SCHNEIDE",
    "SCHNEIDEN",
    "SCHNEIDER",
    "ZAEHNE",
    "ZAHN",
    "SCHNEIDIG",
];
/// How many lines a comment stands before or behind the tool change it speaks of, at most.
const NEAR: usize = 8;

/// All of them; of a number that several comments name, the one that says most.
pub(super) fn tools(lines: &[TextLine], inch: bool) -> Vec<ToolNote> {
    let mut found: Vec<ToolNote> = Vec::new();
    // Numbers that stand in the comments themselves.
    let mut names: Vec<u32> = Vec::new();
    let only = only_tool(lines);
    for (at, line) in lines.iter().enumerate() {
        for text in &line.remarks {
            let Some(mut note) = note(text, inch) else { continue };
            note.line = line.number;
            let named = note.number.is_some();
            note.number = note.number.or_else(|| beside(lines, at)).or(only);
            let numbered = names.iter().copied().find(|number| Some(*number) == note.number);
            if named {
                names.extend(note.number);
            }
            match found.iter_mut().find(|f| f.number == note.number) {
                None => found.push(note),
                Some(before) => {
                    let same = (before.diameter_mm - note.diameter_mm).abs() < 1e-6;
                    if !same && !named && numbered.is_none_or(|number| Some(number) != note.number) {
                        // Of comments without a number the nearest to the tool change speaks of it.
                        *before = note;
                    } else if same {
                        before.teeth = before.teeth.or(note.teeth);
                        before.corner_mm = before.corner_mm.or(note.corner_mm);
                    }
                }
            }
        }
    }
    found
}

/// Numbers of the tools that the program changes to.
pub(super) fn called(lines: &[TextLine]) -> Vec<u32> {
    let mut numbers: Vec<u32> = Vec::new();
    for number in lines.iter().filter_map(changed) {
        if !numbers.contains(&number) {
            numbers.push(number);
        }
    }
    numbers
}

/// The number of the only tool that the program changes to.
fn only_tool(lines: &[TextLine]) -> Option<u32> {
    if let [only] = called(lines)[..] { Some(only) } else { None }
}

/// The tool that a line calls; not the `T1` inside of a name or an expression.
fn changed(line: &TextLine) -> Option<u32> {
    let at = line.code.find('T')?;
    let before = line.code[..at].chars().next_back();
    (before.is_none_or(|c| c.is_ascii_digit() || c == '.')).then(|| line.word('T')).flatten().filter(|n| *n > 0)
}

/// The tool change beside a comment: on its line, soon behind it, or shortly before it.
fn beside(lines: &[TextLine], at: usize) -> Option<u32> {
    let behind = lines.iter().skip(at).take(NEAR).find_map(changed);
    behind.or_else(|| lines[..at].iter().rev().take(NEAR).find_map(changed))
}

/// What a comment says of a cutter.
fn note(text: &str, inch: bool) -> Option<ToolNote> {
    let upper = plain(text).replace('_', " ");
    let tokens = tokens(&upper);
    let number = tool_number(&tokens);
    let is_mill = |token: &Token| match token {
        // What is done is no cutter: `5: KONTURFRAESEN`, `POCKET MILLING`.
        Token::Word(word) if ["FRAESEN", "FRÄSEN", "MILLING"].iter().any(|done| word.ends_with(done)) => false,
        Token::Word(word) => MILLS.iter().any(|mill| word.contains(mill)) || MILL_WORDS.contains(&word.as_str()),
        _ => false,
    };
    let word = tokens.iter().any(is_mill);
    let other = tokens.iter().any(|t| match t {
        Token::Word(word) => OTHERS.iter().any(|other| word.starts_with(other) || word.ends_with(other)),
        _ => false,
    }) || upper.contains("V-BIT");
    let unit = if inch { 25.4 } else { 1.0 };
    let (value, scale) = diameter(&tokens, &is_mill, number.is_some())?;
    let diameter_mm = value * scale.unwrap_or(unit);
    if !(0.1..=100.0).contains(&diameter_mm) || !(word || other || number.is_some()) {
        return None;
    }
    let ball = tokens.iter().any(|t| t.is(&["BALL", "BALLNOSE", "KUGEL", "KUGELFRAESER", "RADIUSFRAESER"]));
    let shape = match (other, ball) {
        (true, _) => Shape::Other,
        (_, true) => Shape::Ball,
        _ => Shape::Flat,
    };
    let stated = behind(&tokens, &["CR", "R"]).map(|r| r * scale.unwrap_or(unit));
    let corner_mm = if ball { Some(diameter_mm / 2.0) } else { stated.filter(|r| *r <= diameter_mm / 2.0) };
    let (text, teeth) = (text.to_owned(), teeth(&tokens));
    Some(ToolNote { number, diameter_mm, corner_mm, teeth, shape, text, line: 0 })
}

/// `T1`, `TOOL - 1`, `TOOL 1`, `1 = …`.
fn tool_number(tokens: &[Token]) -> Option<u32> {
    let at = tokens.iter().position(|t| t.is(&["T", "TOOL", "WZ", "WERKZEUG"]));
    let named = at.and_then(|at| {
        let rest = tokens.get(at + 1..)?;
        let signs = rest.iter().take_while(|t| t.is_sign("-#:=.")).count();
        rest.get(signs)?.whole()
    });
    let listed = match tokens {
        [number, Token::Sign('='), ..] => number.whole(),
        _ => None,
    };
    named.or(listed).filter(|number| (1..=99_999).contains(number))
}

/// The number behind one of some words and signs such as `=`; no word in between.
fn behind(tokens: &[Token], words: &[&str]) -> Option<f64> {
    tokens.iter().enumerate().filter(|(_, t)| t.is(words)).find_map(|(at, _)| {
        let rest = tokens.get(at + 1..)?;
        let signs = rest.iter().take_while(|t| t.is_sign("=:.-")).count();
        rest.get(signs)?.number()
    })
}

/// A unit behind a number: its length in mm.
fn unit_behind(tokens: &[Token], at: usize) -> Option<f64> {
    let next = tokens.get(at + 1)?;
    if next.is(&["MM"]) {
        Some(1.0)
    } else if next.is(&["IN", "INCH", "ZOLL", "INCHES"]) || next.is_sign("\"”″") {
        Some(25.4)
    } else {
        None
    }
}

/// The diameter, and its unit in mm where it is said.
fn diameter(tokens: &[Token], is_mill: &dyn Fn(&Token) -> bool, numbered: bool) -> Option<(f64, Option<f64>)> {
    let with_unit = |value: f64| {
        let at = tokens.iter().position(|t| t.number() == Some(value));
        let own = at.and_then(|at| unit_behind(tokens, at));
        // `MILL DIA 12.0 R0. MM`: one unit for all lengths of the comment.
        own.or_else(|| tokens.iter().any(|t| t.is(&["MM"])).then_some(1.0))
    };
    let said = tokens.iter().enumerate().find_map(|(at, t)| {
        let rest = tokens.get(at + 1..)?;
        let signs = rest.iter().take_while(|t| t.is_sign("=:.-")).count();
        let value = rest.get(signs)?.number()?;
        let plain_d = t.is(&["D"]) && rest.first().is_some_and(|t| t.is_sign("=:"));
        let named = t.is(&["DIA", "DIAM", "DIAMETER", "DURCHMESSER", "DM", "DMR"]) || t.is_sign("ØØ⌀") || t.is(&["Ø"]);
        (plain_d || named).then_some(value)
    });
    if let Some(value) = said {
        return Some((value, with_unit(value)));
    }
    let measured = tokens.iter().enumerate().find_map(|(at, t)| Some((t.number()?, unit_behind(tokens, at)?)));
    if let Some((value, unit)) = measured {
        return Some((value, Some(unit)));
    }
    // `10. FLAT ENDMILL`, `ENDMILL 10`: the number nearest to the word, no number of the tool and no count of teeth.
    let mill = tokens.iter().position(is_mill);
    let near = mill.and_then(|mill| {
        let free = |at: usize| {
            let t = tokens.get(at)?;
            let labelled = at.checked_sub(1).and_then(|b| tokens.get(b)).is_some_and(|b| {
                b.is(&["T", "H", "D", "L", "TOOL", "Z", "R", "CR", "NO", "NR", "OP", "REV"]) || b.is_sign("-#=")
            });
            // `T4 - 3/8 EM`: behind a number the dash is one between words.
            let parted = at.checked_sub(2).and_then(|b| tokens.get(b)).is_some_and(|b| b.number().is_some());
            let labelled = labelled && !(parted && tokens.get(at - 1).is_some_and(|b| b.is_sign("-")));
            let counted = tokens.get(at + 1).is_some_and(|next| next.is(&TEETH) || next.is_sign("="));
            t.number().filter(|_| !labelled && !counted)
        };
        let behind = (mill + 1..(mill + 3).min(tokens.len())).find_map(free);
        (mill.saturating_sub(3)..mill).rev().find_map(free).or(behind)
    });
    if let Some(value) = near {
        return Some((value, None));
    }
    // `FRAESER D10`, and `T3 : 0.375`.
    let bare = behind(tokens, &["D"]).filter(|_| mill.is_some());
    let listed = match tokens {
        [t, number, Token::Sign(':'), value] if numbered && t.is(&["T"]) && number.whole().is_some() => value.number(),
        _ => None,
    };
    bare.or(listed).map(|value| (value, None))
}

/// `4FL`, `2 Schneiden`, `FLUTES: 4`, `Z4`.
fn teeth(tokens: &[Token]) -> Option<u32> {
    let count = |t: &Token| t.whole().filter(|n| (1..=12).contains(n));
    let before = tokens.windows(2).find_map(|pair| {
        let teeth =
            matches!(&pair[1], Token::Word(word) if TEETH.iter().any(|t| word == t) || word.starts_with("SCHNEID"));
        count(&pair[0]).filter(|_| teeth)
    });
    let named = tokens.iter().enumerate().find_map(|(at, t)| {
        let rest = tokens.get(at + 1..)?;
        let words = ["FLUTES", "TEETH", "FLUTE", "SCHNEIDEN", "ZAEHNE", "ZAEHNEZAHL"];
        if t.is(&words) {
            let signs = rest.iter().take_while(|t| t.is_sign("=:-")).count();
            return rest.get(signs).filter(|_| signs > 0).and_then(count);
        }
        // A height has a sign or decimals: `Z-8.`, `Z=0.5`.
        if t.is(&["Z"]) { rest.first().and_then(count) } else { None }
    });
    before.or(named)
}

#[cfg(test)]
mod tests {
    use super::super::text::lines;
    use super::*;

    fn of(text: &str) -> Option<(Option<u32>, f64, Option<u32>, Shape)> {
        let inch = text.contains("G20");
        let all = tools(&lines(text.as_bytes()), inch);
        all.first().map(|t| (t.number, (t.diameter_mm * 1e4).round() / 1e4, t.teeth, t.shape))
    }

    #[test]
    fn cutters_are_read_in_the_manner_of_every_post() {
        let flat = |number, diameter, teeth| Some((number, diameter, teeth, Shape::Flat));
        for (text, expected) in [
            ("(T1 D=10. CR=0. - ZMIN=-8. - flat end mill)", flat(Some(1), 10.0, None)),
            ("( 10. FLAT ENDMILL TOOL - 1 DIA. OFF. - 1 LEN. - 1 DIA. - 10. )", flat(Some(1), 10.0, None)),
            (
                "G20\n( 1/2 FLAT ENDMILL | TOOL - 2 | DIA. OFF. - 2 | LEN. - 2 | TOOL DIA. - .5 )",
                flat(Some(2), 12.7, None),
            ),
            ("( T6 |  16. FLAT ENDMILL |   H6   |   D6   | TOOL DIA. - 16. )", flat(Some(6), 16.0, None)),
            ("( T6 |  16. FLAT ENDMILL |   H6   |   D6   | XY STOCK TO LEAVE - 0. )", flat(Some(6), 16.0, None)),
            ("(TC: 8mm Endmill)\nM6 T3", flat(Some(3), 8.0, None)),
            ("N13 MSG(\"5: KONTURFRAESEN (SCHLICHTEN)\")", None),
            ("(2: POCKET MILLING)\nM6 T3", None),
            ("(Required tools:)\n(Fraeser 6mm (2 Schneiden))\nG90", flat(None, 6.0, Some(2))),
            ("(8mm Schaftfräser)", flat(None, 8.0, None)),
            ("(1 = End Mill {6 mm})", flat(Some(1), 6.0, None)),
            ("[T1: x]\n(T2: End Mill {0.25 inch})", flat(Some(2), 6.35, None)),
            ("(TOOL -3- MILL DIA 12.0 R0. MM )", flat(Some(3), 12.0, None)),
            ("G20\n( T3 : 0.375 )", flat(Some(3), 9.525, None)),
            ("(T3 12MM HARTMETALL 4 SCHN)", flat(Some(3), 12.0, Some(4))),
            ("(T1 = ENDMILL 10)", flat(Some(1), 10.0, None)),
            ("(SCHAFTFRAESER D10 Z4)", flat(None, 10.0, Some(4))),
            ("(VHM FRÄSER Ø8 Z=3)\nT4 M6", flat(Some(4), 8.0, None)),
            ("N20 T=\"FRAESER_D10\" D1", flat(None, 10.0, None)),
            ("M6 T1 (8mm Fraeser)", flat(Some(1), 8.0, None)),
            ("G20\n(1/2\" 4FL EM)", flat(None, 12.7, Some(4))),
            ("G20\n(T4 - 3/8 EM 4 FLUTE CARBIDE)", flat(Some(4), 9.525, Some(4))),
            ("(3/8 ENDMILL, 3 FLUTE)\nG20", flat(None, 9.525, Some(3))),
            ("(T4 D=6. CR=3. - ZMIN=-2. - ball end mill)", Some((Some(4), 6.0, None, Shape::Ball))),
            ("(T6 D=5. CR=0. TAPER=118deg - ZMIN=-14. - drill)", Some((Some(6), 5.0, None, Shape::Other))),
            ("(BOHRER 5.0)\nT2 M6", None),
        ] {
            assert_eq!(of(text), expected, "{text}");
        }
    }

    #[test]
    fn of_comments_without_a_number_the_last_before_the_tool_change_counts() {
        let text = "(TOOL/MILL,0.25,0.0,10,0)\nG21\n(TOOL/MILL,6,0,20,0)\nM6T201\n";
        let all = tools(&lines(text.as_bytes()), false);
        assert_eq!(all.len(), 1);
        assert_eq!((all[0].number, all[0].diameter_mm, all[0].line), (Some(201), 6.0, 3));
    }

    #[test]
    fn other_comments_name_no_cutter() {
        for text in [
            "(BLOCK 80X50)",
            "(2D CONTOUR1)",
            "(DATE=DD-MM-YY - 14-05-24 TIME=HH:MM - 09:12)",
            "(Output Time:2024-03-17 14:22:51.207431)",
            "( X= 120.000, Y= 80.000, Z= 12.000)",
            "(No. 1: Aussenkontur (Teil 1))",
            "(Created by Estlcam version 11.244 build 11.244)",
            "(MATERIAL - ALUMINUM MM - 6061)",
            "(NUT 18 BREIT)",
            "(machine units: mm/min)",
            "(TOOL CHANGE)",
        ] {
            assert_eq!(of(text), None, "{text}");
        }
    }

    #[test]
    fn several_comments_about_one_tool_are_one() {
        let text = "(T3 D=16. CR=0.5 - flat end mill)\n(T3 16MM 4 FL)\n(T4 D=4. - drill)\n";
        let all = tools(&lines(text.as_bytes()), false);
        assert_eq!(all.len(), 2);
        assert_eq!((all[0].teeth, all[0].corner_mm, all[0].line), (Some(4), Some(0.5), 1));
    }
}
