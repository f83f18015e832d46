//! The control a program is written for, by what only its programs have.
//!
//! In this order: the words of its language, what a comment of the post says, the head of the file, the name of the file.

use truepath_core::gcode::Dialect;

use super::text::{BEGIN_PGM, TextLine, plain};
use super::tokens::tokens;

/// The control, and what shows it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Control {
    /// How its programs are read.
    pub dialect: Dialect,
    /// `--dialect` of `truepath probe` for the same control; `None` where no verification program is written for it.
    pub probe: Option<&'static str>,
    /// The sign.
    pub why: String,
    /// Its line; 0 for the name of the file.
    pub line: u32,
}

const LINUXCNC: (Dialect, Option<&str>) = (Dialect::Linuxcnc, Some("linuxcnc"));
const GRBL: (Dialect, Option<&str>) = (Dialect::Linuxcnc, Some("grbl"));
const HAAS: (Dialect, Option<&str>) = (Dialect::Haas, Some("haas"));
const FANUC: (Dialect, Option<&str>) = (Dialect::Fanuc, Some("fanuc"));
const SIEMENS: (Dialect, Option<&str>) = (Dialect::Siemens, None);
const HEIDENHAIN: (Dialect, Option<&str>) = (Dialect::Heidenhain, None);
const MACH: (Dialect, Option<&str>) = (Dialect::Mach, None);

/// Words in comments; the first that stands in one counts.
const NAMES: [(&str, (Dialect, Option<&str>)); 12] = [
    ("LINUXCNC", LINUXCNC),
    ("EMC", LINUXCNC),
    ("GRBL", GRBL),
    ("GRBLHAL", GRBL),
    ("MACH", MACH),
    ("HAAS", HAAS),
    ("SINUMERIK", SIEMENS),
    ("SIEMENS", SIEMENS),
    ("FANUC", FANUC),
    ("OKUMA", FANUC),
    ("MITSUBISHI", FANUC),
    ("ESTLCAM", GRBL),
];
/// Lines at the start of a program in which a comment names its post.
const HEAD: usize = 60;

/// What shows the control; `None` without a sign.
pub(super) fn control(lines: &[TextLine], name: &str) -> Option<Control> {
    let made =
        |(dialect, probe): (Dialect, Option<&'static str>), why: String, line| Control { dialect, probe, why, line };
    let found = by_words(lines)
        .or_else(|| by_comments(lines))
        .or_else(|| by_head(lines))
        .map(|(control, why, line)| made(control, why, line));
    let found = found.or_else(|| {
        let ending = name.rsplit_once('.').map(|(_, e)| e.to_ascii_lowercase()).unwrap_or_default();
        let control = match ending.as_str() {
            "ngc" => LINUXCNC,
            "mpf" | "spf" => SIEMENS,
            "h" => HEIDENHAIN,
            "gcode" => GRBL,
            _ => return None,
        };
        Some(made(control, format!("its name ends in .{ending}"), 0))
    });
    let found = found.or_else(|| units(lines));
    // LinuxCNC stops at a comment inside a comment: a program that has them runs on something else.
    let nested = lines.iter().find(|line| line.nested);
    match (found, nested) {
        (Some(control), Some(line)) if control.dialect == Dialect::Linuxcnc => {
            let why = format!("{}, and a comment stands inside another, which linuxcnc does not take", control.why);
            Some(Control { dialect: Dialect::Mach, why, line: line.number, ..control })
        }
        (None, Some(line)) => {
            let why = "a comment stands inside another, which linuxcnc does not take".to_owned();
            Some(Control { dialect: Dialect::Mach, probe: None, why, line: line.number })
        }
        (found, _) => found,
    }
}

type Sign = ((Dialect, Option<&'static str>), String, u32);

/// Words that one language has and the others do not.
fn by_words(lines: &[TextLine]) -> Option<Sign> {
    lines.iter().find_map(|line| {
        let code = line.code.as_str();
        let without_n = code.trim_start_matches('N').trim_start_matches(|c: char| c.is_ascii_digit());
        let says = |control, what: &str| Some((control, format!("{what} is of its language"), line.number));
        if code.starts_with(BEGIN_PGM) {
            return says(HEIDENHAIN, "BEGIN PGM");
        }
        let siemens = ["CR=", "SUPA", "MSG(", "CYCLE", "T=\"", "TRANS", "MCALL", "_MPF", "_SPF"];
        if let Some(word) = siemens.into_iter().find(|word| code.contains(word)) {
            return says(SIEMENS, word);
        }
        if line.remarks.iter().any(|text| text.to_ascii_uppercase().starts_with("$PATH=")) {
            return says(SIEMENS, ";$PATH=");
        }
        if code.starts_with("G15H") {
            return says(FANUC, "G15 H (an Okuma, nearest to fanuc)");
        }
        let o_word = without_n.strip_prefix('O').is_some_and(|rest| {
            let rest = rest.trim_start_matches(|c: char| c.is_ascii_digit());
            let flow = ["SUB", "CALL", "ENDSUB", "IF[", "WHILE[", "REPEAT[", "DO", "ENDIF"];
            rest.starts_with('<') || flow.iter().any(|word| rest.starts_with(word))
        });
        if o_word {
            return says(LINUXCNC, "an O word with a name or a keyword");
        }
        if code.contains("#<") {
            return says(LINUXCNC, "a named parameter");
        }
        let commands = ["PROBEOPEN", "LOGOPEN", "LOG,", "DEBUG,", "PRINT,"];
        if line.remarks.iter().any(|text| commands.iter().any(|c| text.to_ascii_uppercase().starts_with(c))) {
            return says(LINUXCNC, "a comment that the control carries out");
        }
        if line.has("G64") && code.contains('P') {
            return says(LINUXCNC, "G64 P");
        }
        let (macros, goto) = (code.contains("WHILE[") || code.contains("IF["), code.contains("GOTO"));
        if (macros && goto) || (code.contains("WHILE[") && code.contains("DO")) {
            return says(FANUC, "a macro of the custom macro B");
        }
        if line.has("M97") || line.has("G154") || line.has("G187") {
            return says(HAAS, "M97, G154 or G187");
        }
        if code.starts_with("$H") || code.starts_with("$J=") {
            return says(GRBL, "a command of its console");
        }
        None
    })
}

/// What a comment at the start says of post or control.
fn by_comments(lines: &[TextLine]) -> Option<Sign> {
    lines.iter().take(HEAD).find_map(|line| {
        line.remarks.iter().find_map(|text| {
            let words = tokens(&plain(text));
            let (_, control) = NAMES.iter().find(|(name, _)| words.iter().any(|word| word.is(&[name])))?;
            Some((*control, format!("the comment \"{text}\""), line.number))
        })
    })
}

/// The head of the file: an O number.
fn by_head(lines: &[TextLine]) -> Option<Sign> {
    let line = lines.iter().filter(|line| !line.code.is_empty() && line.code != "%").take(1).next()?;
    let digits: String =
        line.code.trim_start_matches('%').strip_prefix('O')?.chars().take_while(char::is_ascii_digit).collect();
    let five = digits.len() == 5 && digits.starts_with('0');
    let home = lines.iter().any(|line| line.has("G53"));
    match digits.len() {
        0 => None,
        _ if five || home => Some((HAAS, format!("O{digits} at its head, as a Haas has it"), line.number)),
        _ => Some((FANUC, format!("O{digits} at its head"), line.number)),
    }
}

/// G70 and G71 alone are units, which only some controls have.
fn units(lines: &[TextLine]) -> Option<Control> {
    let line = lines.iter().find(|line| (line.has("G70") || line.has("G71")) && !line.code.contains('P'))?;
    let (dialect, probe) = SIEMENS;
    Some(Control { dialect, probe, why: "G70 or G71 is its unit".to_owned(), line: line.number })
}

#[cfg(test)]
mod tests {
    use super::super::text::lines;
    use super::*;

    fn of(text: &str, name: &str) -> Option<(Dialect, Option<&'static str>, u32)> {
        control(&lines(text.as_bytes()), name).map(|c| (c.dialect, c.probe, c.line))
    }

    #[test]
    fn every_control_has_its_signs() {
        use Dialect::{Fanuc, Haas, Heidenhain, Linuxcnc, Mach, Siemens};
        for (text, name, expected) in [
            ("(Post Processor: linuxcnc_post)\nG21\n", "a.nc", Some((Linuxcnc, Some("linuxcnc"), 1))),
            ("(Post Processor: grbl_post)\n", "a.nc", Some((Linuxcnc, Some("grbl"), 1))),
            ("( for Mach2/3 from Vectric )\nN110G71G91.1\n", "a.txt", Some((Mach, None, 1))),
            ("%\nO01001 (BLOCK)\nG53 G0 Z0.\n", "a.nc", Some((Haas, Some("haas"), 2))),
            ("%\nO1200\nG28 G91 Z0.\n", "a.nc", Some((Fanuc, Some("fanuc"), 2))),
            ("O0042\nG0 X1\nM97 P100\n", "a.nc", Some((Haas, Some("haas"), 3))),
            ("%_N_PLATTE_MPF\nN20 G2 X8 CR=8\n", "a.mpf", Some((Siemens, None, 1))),
            ("o<wall> sub\n", "a.nc", Some((Linuxcnc, Some("linuxcnc"), 1))),
            ("N10 G1 X1\n#1=3\nIF[#1GT2]GOTO10\n", "a.nc", Some((Fanuc, Some("fanuc"), 3))),
            ("G21\nG1 X1\n", "a.ngc", Some((Linuxcnc, Some("linuxcnc"), 0))),
            ("(Fraeser 6mm (2 Schneiden))\n(Created by Estlcam)\n", "a.nc", Some((Mach, Some("grbl"), 1))),
            ("%\nN0010 G40 G17 G90 G70\n", "a.ptp", Some((Siemens, None, 2))),
            ("%O1200(HEBEL)\nG15H1\n", "a.nc", Some((Fanuc, Some("fanuc"), 2))),
            ("0 BEGIN PGM 17 MM\n1 ; FANUC\n", "a.h", Some((Heidenhain, None, 1))),
            ("L X+10 R0 FMAX\n", "a.h", Some((Heidenhain, None, 0))),
            ("G21\nG1 X1 F100\n", "a.nc", None),
            ("(PART FOR HAASE LTD)\n", "a.nc", None),
        ] {
            assert_eq!(of(text, name), expected, "{text}");
        }
    }
}
