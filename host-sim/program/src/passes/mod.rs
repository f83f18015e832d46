//! A program in which contours are cut in several passes: radial steps, levels, spring passes, either way round.
//!
//! The lines along a contour, from the way down to the lead-out, give way to the same moves once for each pass, at its height
//! and feed, forwards or backwards. Between two passes the cutter goes up as it does behind the contour and rapidly to
//! the next start; where that is below it, it stays there. All other lines keep their bytes.
//!
//! The paths are still those of the program: [`rewrite_program`](crate::rewrite_program) moves each pass to where it is to be.
//! What is written is read back and proved (module `proof`): beside these lines both programs do the same step by
//! step, and on them every pass cuts what the program cut, at the height and feed it is to have.
//!
//! | step | where |
//! |---|---|
//! | what is asked for | `request` |
//! | a depth in its program | `section` |
//! | its lines | `text` |
//! | the change to another cutter and back | `change` |
//! | what the control is told before each pass | `announced` |
//! | how long that takes | `times` |
//!
//! Limits: G17, constant height along the contour, feed per minute or per revolution. Where the control compensates by the
//! radius, the passes are paths of the cutter's centre, without G41. Spring passes behind the contour are replaced with it.

mod announced;
mod change;
mod request;
mod section;
mod text;
mod times;

use std::ops::Range;

use truepath_core::gcode::{LineRange, Lines, Modal, Options, Token, Words};
use truepath_core::geometry::Block as Curves;
use truepath_ground::diagnostics::{Failure, InputError, Source};

use super::line::{Block, Manner};
use super::proof::{Changed, Cut, Replaced, same_beside};
use super::survey::{Move, survey};
use crate::codes::{P008, P009};
use change::{Change, Changes, Customs};
use section::{Section, Text};

pub use announced::Announced;
pub use request::{Cutter, Depth, Turn};
pub use times::{PassTimes, Times};

/// A program with its passes written out.
#[derive(Clone, Debug)]
pub struct Repeated {
    /// Its bytes.
    pub text: Vec<u8>,
    /// What became of the depths, in the order in which they were asked for.
    pub depths: Vec<RepeatedDepth>,
}

/// The passes of a depth in the written program.
#[derive(Clone, Debug, PartialEq)]
pub struct RepeatedDepth {
    /// Lines of the original that they replace.
    pub replaced: LineRange,
    /// Their lines.
    pub written: LineRange,
    /// The passes, in the order of cutting.
    pub passes: Vec<RepeatedPass>,
    /// Whether they are the path of the cutter's centre where the original has G41 or G42.
    pub centre_path: bool,
}

/// One pass in the written program. Its blocks are in the order of the original and lead in its direction, on the lines of the
/// written program; a reversed pass cuts them from the last to the first.
#[derive(Clone, Debug, PartialEq)]
pub struct RepeatedPass {
    /// Its lines, from its comment on.
    pub lines: LineRange,
    /// The line on which the way down to it begins: before it the cutter stands above its start. The first line of its path where the
    /// way down of the program is kept.
    pub down: u32,
    /// Lead-in, contour, lead-out.
    pub parts: [Vec<Curves>; 3],
    /// Height, nm.
    pub z_nm: i64,
}

/// How long a depth of a contour takes as passes, reversed ones among them, which are at the programmed feed; an error where they
/// cannot be written.
///
/// # Errors
/// As [`repeat_contours`].
pub fn can_repeat(source: &Source, depth: &Depth, options: Options<'static>) -> Result<Times, Failure> {
    let repeated = repeat_contours(source, std::slice::from_ref(depth), options)?;
    let own = repeated.depths.first().ok_or_else(|| Failure::Internal("a depth that was not written".to_owned()))?;
    let lines = |pass: &RepeatedPass| (pass.lines, pass.parts[1].iter().map(|block| block.line).collect());
    let passes: Vec<(LineRange, Vec<u32>)> = own.passes.iter().map(lines).collect();
    let times = Times::of((source.bytes(), &repeated.text), own.replaced, &passes, options);
    times.map_err(|error| InputError::of_program(source, &error).into())
}

/// Writes the program with the passes of all depths in the places of their contours.
///
/// # Errors
/// `P004` for lines that are executed several times or stand in another file, `P006` for feeds that cannot be written again, `P007` for
/// compensation that goes beyond the leads, `P009` for a contour that cannot be written again, `P010` for a reversed pass that
/// has no safe start, `P008` when the text fails the proof, and the interpreter's own errors.
pub fn repeat_contours(source: &Source, depths: &[Depth], options: Options<'static>) -> Result<Repeated, Failure> {
    let (repeated, replaced) = laid_out(source, depths, options)?;
    same_beside(source.bytes(), &repeated.text, &replaced, options).map_err(|what| {
        let line = replaced.first().map_or(0, |r| r.original.first);
        let span =
            Lines::new(source.bytes()).find(|l| l.number == line).map_or(0..0, |l| l.span().start..l.span().end());
        let found = format!("the program with several passes in place of this contour does more than that: {what}");
        P008.error(found, "a program that differs in the passes alone").at(source, span)
    })?;
    Ok(repeated)
}

/// The program with the passes, not yet proved, and what the proof needs.
fn laid_out(
    source: &Source,
    depths: &[Depth],
    options: Options<'static>,
) -> Result<(Repeated, Vec<Replaced>), Failure> {
    let bytes = source.bytes();
    let moves = survey(bytes, options).map_err(|e| InputError::of_program(source, &e))?;
    let lines: Vec<_> = Lines::new(bytes).collect();
    let text = Text { source, lines: &lines, moves: &moves };
    if options.dialect.is_klartext() {
        let line = depths.first().and_then(|depth| depth.contour.first()).map_or(1, |block| block.line);
        let help = "cut it in one pass with truepath correct, or plan a G-code program of the same part";
        return Err(text.refusal(P009, line, ["a conversational program", "a program in G-code", help]));
    }
    let two_digits =
        lines.iter().map(|&l| Block::new(l, Manner::default())).any(|b| b.motion_word().is_some() && b.two_digits());
    let semicolon = comments_begin_with_semicolon(bytes);
    let mut sections = Vec::new();
    for (at, depth) in depths.iter().enumerate() {
        sections.push((at, text.section(depth)?));
    }
    sections.sort_unstable_by_key(|(_, section)| section.lines);
    if let Some(pair) = sections.windows(2).find(|pair| pair[0].1.lines[1] >= pair[1].1.lines[0]) {
        let found = "two depths of the contour share lines of the program";
        let expected = "lines of their own for every depth";
        return Err(text.refusal(P009, pair[1].1.lines[0], [found, expected, P009.remedy]));
    }
    let mut changes = vec![Changes::default(); sections.len()];
    if depths.iter().any(|depth| depth.cutter.is_some()) {
        let all: Vec<_> = sections.iter().map(|(at, section)| (section, depths[*at].cutter.as_ref())).collect();
        changes = Customs::of(&text, options)?.plan(&text, options, &all)?;
    }
    let mut written = Vec::new();
    for ((at, section), changes) in sections.into_iter().zip(changes) {
        let lines = text::write(text, &depths[at], &section, &changes, (two_digits, semicolon))?;
        written.push(Written { depth: at, section, lines, mounted: changes.mounted });
    }
    Ok(assemble(bytes, &text, depths, &written))
}

/// A section with what is written in its place.
struct Written {
    /// Which of the depths it is.
    depth: usize,
    section: Section,
    lines: text::Lines,
    /// Tool that the original does not have in the spindle there, on its lines and behind them.
    mounted: [Option<u32>; 2],
}

/// Puts the lines of the sections into the program.
fn assemble(bytes: &[u8], text: &Text<'_>, depths: &[Depth], sections: &[Written]) -> (Repeated, Vec<Replaced>) {
    let starts: Vec<usize> = text.lines.iter().map(|l| l.start).chain([bytes.len()]).collect();
    let start = |line: u32| starts[(line as usize - 1).min(starts.len() - 1)];
    let ends = text.lines.iter().zip(starts.iter().skip(1)).map(|(l, &next)| &bytes[l.span().end()..next]);
    let usual = ends.into_iter().find(|end| !end.is_empty()).unwrap_or(b"\n");
    let mut out = Vec::new();
    let (mut from, mut count) = (1u32, 0u32);
    let mut found = vec![None; depths.len()];
    let mut replaced = Vec::new();
    for Written { depth: at, section, lines, mounted } in sections {
        let [first, last] = section.lines;
        out.extend_from_slice(&bytes[start(from)..start(first)]);
        count += first - from;
        let begin = count + 1;
        for line in &lines.text {
            out.extend_from_slice(line);
            out.extend_from_slice(usual);
        }
        count += lines.text.len() as u32;
        from = last + 1;
        let depth = &depths[*at];
        let written = LineRange { first: begin, last: count };
        let passes = passes(text.moves, depth, section, lines, begin);
        replaced.push(Replaced {
            original: LineRange { first, last },
            written,
            cuts: passes
                .iter()
                .zip(&depth.turns)
                .flat_map(|(pass, turn)| cuts(text.moves, section, pass, turn))
                .map(|cut| Cut { modal: Modal { tool: mounted[0].or(cut.modal.tool), ..cut.modal }, ..cut })
                .collect(),
            changes: lines.changes.iter().map(|(lines, change)| changed(begin, lines, change)).collect(),
            mounted: mounted[1],
            clearance: section.clearance,
            lifted: lines.lifted,
            centre_path: section.centre_path,
        });
        found[*at] = Some(RepeatedDepth {
            replaced: LineRange { first, last },
            written,
            passes,
            centre_path: section.centre_path,
        });
    }
    out.extend_from_slice(&bytes[start(from)..]);
    (Repeated { text: out, depths: found.into_iter().flatten().collect() }, replaced)
}

/// The passes of a section whose first line is `begin`.
fn passes(moves: &[Move], depth: &Depth, section: &Section, lines: &text::Lines, begin: u32) -> Vec<RepeatedPass> {
    let until = |k: usize| lines.passes.get(k + 1).map_or(lines.text.len(), |next| next.first) as u32;
    let pass = |(k, own): (usize, &text::PassLines)| {
        let mut line = own.cuts.iter().map(|&line| begin + line as u32);
        let parts = section.parts.each_ref().map(|part| {
            let blocks = part.iter().filter_map(|&i| Some((moves[i].curve()?, line.next()?)));
            let mut s = truepath_core::units::Offset::ZERO;
            let blocks = blocks.map(|(curve, line)| {
                let block = Curves { curve, line, s, ..Curves::BLANK };
                s += curve.length();
                block
            });
            blocks.collect::<Vec<_>>()
        });
        let lines = LineRange { first: begin + own.first as u32, last: begin + until(k) - 1 };
        RepeatedPass { lines, down: begin + own.down as u32, parts, z_nm: section.height_of(depth.turns[k].raise).nm() }
    };
    lines.passes.iter().enumerate().map(pass).collect()
}

/// A change of the cutter in a section whose first line is `begin`.
fn changed(begin: u32, lines: &Range<usize>, change: &Change) -> Changed {
    let lines = LineRange { first: begin + lines.start as u32, last: begin + lines.end as u32 - 1 };
    Changed { lines, tool: change.tool, length: change.length }
}

/// What a pass has to cut, in the order of cutting.
fn cuts(moves: &[Move], section: &Section, pass: &RepeatedPass, turn: &Turn) -> Vec<Cut> {
    let programmed = section.parts.iter().flatten();
    let cut = |(block, &i): (&Curves, &usize)| Cut {
        curve: block.curve,
        reversed: turn.reversed,
        z_nm: pass.z_nm,
        factor: turn.feed,
        modal: moves[i].modal,
    };
    let mut cuts: Vec<Cut> = pass.parts.iter().flatten().zip(programmed).map(cut).collect();
    if turn.reversed {
        cuts.reverse();
    }
    cuts
}

/// Whether the comments of a program begin with `;`.
fn comments_begin_with_semicolon(program: &[u8]) -> bool {
    let comments = Lines::new(program).flat_map(|line| Words::new(line).map_while(Result::ok).collect::<Vec<_>>());
    let first = comments.into_iter().find_map(|token| match token {
        Token::Comment { span, body } if body.len > 0 => program.get(span.start),
        _ => None,
    });
    first == Some(&b';')
}

#[cfg(test)]
mod tests {
    use std::ops::RangeInclusive;
    use std::process::{Command, Stdio};

    use crate::codes::P011;
    use truepath_core::gcode::Dialect;
    use truepath_core::units::Offset;

    use super::*;

    const ORIGINAL: &str = "%\nG21 G90\nM3 S1500\nG0 X0 Y-8 Z10\nG1 Z-5 F300\nN10 G1 X0 Y0 (in)\nN20 G1 X20 F250\nG3 X25 Y5 I0 J5\nN30 G1 Y30\nG0 Z10\nG0 X50 Y50\nM30\n%\n";

    fn depth(turns: &[(f64, bool, f64)]) -> Depth {
        depth_of((ORIGINAL, Options::default()), 7..=9, turns)
    }

    fn depth_of(
        (text, options): (&str, Options<'static>),
        lines: RangeInclusive<u32>,
        turns: &[(f64, bool, f64)],
    ) -> Depth {
        let moves = survey(text.as_bytes(), options).expect("readable");
        let contour = moves.iter().filter(|m| lines.contains(&m.line));
        let block = |m: &Move| Some(Curves { curve: m.curve()?, line: m.line, ..Curves::BLANK });
        let turn = |&(raise, reversed, feed): &(f64, bool, f64)| Turn {
            raise: Offset::from_nm((raise * 1e6) as i64),
            reversed,
            feed,
        };
        Depth {
            contour: contour.filter_map(block).collect(),
            springs: Vec::new(),
            allowance: Offset::from_um(500),
            turns: turns.iter().map(turn).collect(),
            announced: false,
            cutter: None,
        }
    }

    fn laid() -> (String, Vec<Replaced>) {
        let source = Source::new("p.nc", ORIGINAL.as_bytes().to_vec());
        let depth = depth(&[(2.0, false, 1.0), (0.0, false, 0.8), (0.0, true, 0.5)]);
        let Ok((repeated, replaced)) = laid_out(&source, &[depth], Options::default()) else { panic!("refused") };
        (String::from_utf8(repeated.text).expect("ASCII"), replaced)
    }

    #[test]
    fn every_pass_is_written_out_and_proved() {
        let (text, replaced) = laid();
        let expected = "%\nG21 G90\nM3 S1500\nG0 X0 Y-8 Z10\n(TRUEPATH PASS 1 OF 3, Z-3.)\nG1 Z-3. F300.\n(in)\nN10 G1 X0. Y0. F300.\n\
            N20 G1 X20. Y0. F250.\nG3 X25. Y5. I0. J5.\nN30 G1 X25. Y30.\n(TRUEPATH PASS 2 OF 3, Z-5., FEED 80 PERCENT)\nG0 Z10.\n\
            G0 X0. Y-8.\nG1 Z-5. F300.\nG1 X0. Y0. F240.\nG1 X20. Y0. F200.\nG3 X25. Y5. I0. J5.\nG1 X25. Y30.\n\
            (TRUEPATH PASS 3 OF 3, Z-5., FEED 50 PERCENT, REVERSED)\nG0 Z10.\nG1 Z-5. F300.\nG1 X25. Y5. F125.\nG2 X20. Y0. I-5. J0.\n\
            G1 X0. Y0.\nG1 X0. Y-8. F150.\nG0 Z10.\nG0 X25. Y30.\nF250.\nG0 Z10\nG0 X50 Y50\nM30\n%\n";
        assert_eq!(text, expected);
        assert_eq!(same_beside(ORIGINAL.as_bytes(), text.as_bytes(), &replaced, Options::default()), Ok(()));
    }

    #[test]
    fn every_change_of_a_pass_or_beside_it_is_found() {
        let (text, replaced) = laid();
        for (what, with) in [
            ("S1500", "S1501"),
            ("X0 Y-8 Z10", "X0 Y-8.1 Z10"),
            ("G1 Z-3. F300.\n", "G1 Z-3. F300.\nM8\n"),
            ("G1 Z-3.", "G1 Z-3.1"),
            ("G1 Z-3.", "G1 Z-5.5"),
            ("N20 G1 X20. Y0. F250.", "N20 G1 X20. Y0. F251."),
            ("N20 G1 X20. Y0.", "N20 G1 X20. Y0.001"),
            ("G3 X25. Y5. I0. J5.", "G2 X25. Y5. I5. J0."),
            ("G3 X25. Y5. I0. J5.\nG1 X25. Y30.\n(TRUEPATH PASS 3", "G1 X25. Y5.\nG1 X25. Y30.\n(TRUEPATH PASS 3"),
            ("G0 X0. Y-8.\n", "G0 Z9.\nG0 X0. Y-8.\n"),
            ("G0 X0. Y-8.\n", "G1 X0. Y-8.\n"),
            ("F240.", "F250."),
            ("G1 X0. Y0.\nG1 X0. Y-8.", "G1 X0. Y-8."),
            ("F250.\nG0 Z10\n", "F260.\nG0 Z10\n"),
            ("G0 X25. Y30.\n", ""),
            ("G0 X50 Y50", "G0 X50 Y51"),
            ("(TRUEPATH PASS 2", "G64\n(TRUEPATH PASS 2"),
        ] {
            let tampered = text.replacen(what, with, 1);
            assert_ne!(tampered, text, "{what}");
            let lines = |text: &str| text.lines().count() as u32;
            let mut replaced = replaced.clone();
            replaced[0].written.last = replaced[0].written.last + lines(&tampered) - lines(&text);
            let verdict = same_beside(ORIGINAL.as_bytes(), tampered.as_bytes(), &replaced, Options::default());
            assert!(verdict.is_err(), "{what} -> {with} was not noticed");
        }
    }

    const CONTOUR: &str = "G1 X0 Y0\nG1 X20 F250\nG3 X25 Y5 I0 J5\nG1 Y30\nG0 Z10\n";

    /// A program with its contour from a line on, cut in one pass by T5.
    fn with_t5(text: &str, dialect: Dialect, from: u32) -> Result<(String, Vec<Replaced>, Options<'static>), Failure> {
        let options = Options { dialect, ..Options::default() };
        let cutter = Cutter { number: 5, own: None, words: "HELIX 45 DEGREES".to_owned() };
        let depth = Depth { cutter: Some(cutter), ..depth_of((text, options), from..=from + 2, &[(0.0, false, 1.0)]) };
        let source = Source::new("p.nc", text.as_bytes().to_vec());
        let (repeated, replaced) = laid_out(&source, &[depth], options)?;
        let written = String::from_utf8(repeated.text).expect("ASCII");
        assert_eq!(same_beside(text.as_bytes(), written.as_bytes(), &replaced, options), Ok(()), "{written}");
        Ok((written, replaced, options))
    }

    fn linuxcnc() -> String {
        format!(
            "%\nG21 G90 G40 G49\nT4 M6\nS1500 M3\nG0 X0 Y-8\nG43 H4 Z10 M8\nG1 Z-5 F300\n{CONTOUR}G0 X50 Y50\nG1 Z-3\nG1 X60\nG0 Z10\nM9\nM30\n%\n"
        )
    }

    /// Whether LinuxCNC's interpreter reads a program without a message; nothing is asked where it is not installed.
    fn linuxcnc_accepts(text: &str) {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("p.ngc"), text).unwrap();
        std::fs::write(folder.path().join("tool.tbl"), "T4 P4 Z50 D10\nT5 P5 Z60 D10\n").unwrap();
        let mut command = Command::new("rs274");
        command.env("HOME", folder.path()).args(["-t", "tool.tbl", "-g", "p.ngc"]).current_dir(folder.path());
        match command.stdin(Stdio::null()).output() {
            Ok(output) => assert_eq!(String::from_utf8_lossy(&output.stderr).trim(), "executing", "{text}"),
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => eprintln!("skipped: no rs274"),
            Err(error) => panic!("{error}"),
        }
    }

    #[test]
    fn another_cutter_is_changed_to_as_the_program_changes_and_back_where_its_own_goes_on() {
        let (text, replaced, options) = with_t5(&linuxcnc(), Dialect::Linuxcnc, 9).expect("written");
        let change =
            |tool: &str, place: &str| format!("M9\nM5\nT{tool} M6\nS1500 M3\nG0 {place}\nG0 G43 Z10. H{tool}\nM8\n");
        let there = format!("(TRUEPATH CUTTER T5, HELIX 45 DEGREES)\n{}(TRUEPATH PASS 1", change("5", "X0. Y-8."));
        let back = format!("(TRUEPATH CUTTER T4, THE CUTTER OF THE PROGRAM)\n{}G0 Z10\n", change("4", "X25. Y30."));
        assert!(text.contains(&there) && text.contains(&back), "{text}");
        linuxcnc_accepts(&text);
        for (what, with) in [
            ("T5 M6", "T6 M6"),
            ("H5", "H6"),
            ("H5\nM8\n", "H5\n"),
            ("T5 M6\nS1500 M3", "T5 M6\nS1400 M3"),
            ("T5 M6", "T5 M6 G4 P1"),
            ("G0 X0. Y-8.\nG0 G43 Z10.", "G0 X0. Y-8.\nG0 G43 Z-4."),
            ("G0 G43 Z10. H5\n", "G0 Z10. \n"),
            ("T4 M6\nS1500 M3\nG0 X25. Y30.", "T5 M6\nS1500 M3\nG0 X25. Y30."),
        ] {
            let tampered = text.replacen(what, with, 1);
            assert_ne!(tampered, text, "{what}");
            let verdict = same_beside(linuxcnc().as_bytes(), tampered.as_bytes(), &replaced, options);
            assert!(verdict.is_err(), "{what} -> {with} was not noticed");
        }
    }

    #[test]
    fn a_fanuc_program_goes_to_its_reference_point_calls_t_before_m06_and_keeps_the_cutter_to_its_end() {
        let text = "%\nO0001\nN10 G21 G90 G17 G40 G80\nN20 T04\nN30 M06\nN40 S2500 M03\nN50 G00 X0. Y-8.\nN60 G43 H04 Z10.\n\
            N70 G01 Z-5. F300.\nN80 G01 X0. Y0.\nN90 G01 X20. F250.\nN100 G03 X25. Y5. I0. J5.\nN110 G01 Y30.\nN120 G00 Z10.\n\
            N130 M05\nN140 G91 G28 Z0.\nN150 M30\n%\n";
        let (written, ..) = with_t5(text, Dialect::Fanuc, 11).expect("written");
        let there = "M05\nG91 G28 Z0.\nG90\nT05\nM06\nS2500 M03\nG00 X0. Y-8.\nG00 G43 Z10. H05\n(TRUEPATH PASS 1";
        assert!(written.contains(there) && !written.contains("CUTTER OF THE PROGRAM"), "{written}");
    }

    #[test]
    fn where_the_program_changes_no_tool_it_stops_and_says_what_to_mount() {
        let text = format!("G21 G90\nM3 S12000\nG0 X0 Y-8 Z10\nG1 Z-5 F300\n{CONTOUR}G0 X50 Y50\nM5\nM30\n");
        let (written, replaced, options) = with_t5(&text, Dialect::Linuxcnc, 6).expect("written");
        let there = "(TRUEPATH CUTTER T5, HELIX 45 DEGREES)\nM5\n(MOUNT T5 WITH ITS TIP WHERE THAT OF THE LAST ONE WAS)\nM0\n\
            S12000 M3\nG0 X0. Y-8.\nG0 Z10.\n(TRUEPATH PASS 1";
        assert!(written.contains(there), "{written}");
        linuxcnc_accepts(&written);
        let unstopped = written.replacen("M0\n", "(M0)\n", 1);
        assert!(same_beside(text.as_bytes(), unstopped.as_bytes(), &replaced, options).is_err());
    }

    #[test]
    fn a_change_that_has_no_model_in_the_program_is_refused_by_name() {
        for (what, with, said) in [
            ("G43 H4", "G43 H14", "H14"),
            ("G43 H4", "G43.1 Z-50\nG0", "G43.1"),
            ("G1 X0 Y0\n", "G41 D4 G1 X0 Y0\n", "G41"),
        ] {
            let line = if with.contains('\n') && !with.ends_with('\n') { 10 } else { 9 };
            let refused = with_t5(&linuxcnc().replacen(what, with, 1), Dialect::Linuxcnc, line).err();
            let Some(Failure::Input(error)) = refused else { panic!("{with} was written") };
            assert!(error.code() == P011.code && error.found().contains(said), "{}", error.found());
        }
    }
}
