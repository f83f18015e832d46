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
//! | what the control is told before each pass | `announced` |
//!
//! Limits: G17, constant height along the contour, feed per minute or per revolution. Where the control compensates by the
//! radius, the passes are paths of the cutter's centre, without G41. Spring passes behind the contour are replaced with it.

mod announced;
mod request;
mod section;
mod text;

use truepath_core::gcode::{LineRange, Lines, Options, Token, Words};
use truepath_core::geometry::Block as Curves;
use truepath_ground::diagnostics::{Failure, InputError, Source};

use super::line::{Block, Manner};
use super::proof::{Cut, Replaced, same_beside};
use super::survey::{Move, survey};
use crate::codes::{P008, P009};
use section::{Section, Text};

pub use announced::Announced;
pub use request::{Depth, Turn};

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

/// Whether a depth of a contour can be written as passes, reversed ones among them.
///
/// # Errors
/// As [`repeat_contours`].
pub fn can_repeat(source: &Source, depth: &Depth, options: Options<'static>) -> Result<(), Failure> {
    repeat_contours(source, std::slice::from_ref(depth), options).map(|_| ())
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
    let mut written = Vec::new();
    for (at, depth) in depths.iter().enumerate() {
        let section = text.section(depth)?;
        let lines = text::write(text, depth, &section, two_digits, semicolon)?;
        written.push((at, section, lines));
    }
    written.sort_by_key(|(_, section, _)| section.lines);
    if let Some(pair) = written.windows(2).find(|pair| pair[0].1.lines[1] >= pair[1].1.lines[0]) {
        let found = "two depths of the contour share lines of the program";
        let expected = "lines of their own for every depth";
        return Err(text.refusal(P009, pair[1].1.lines[0], [found, expected, P009.remedy]));
    }
    Ok(assemble(bytes, &text, depths, &written))
}

/// Puts the lines of the sections into the program.
fn assemble(
    bytes: &[u8],
    text: &Text<'_>,
    depths: &[Depth],
    sections: &[(usize, Section, text::Lines)],
) -> (Repeated, Vec<Replaced>) {
    let starts: Vec<usize> = text.lines.iter().map(|l| l.start).chain([bytes.len()]).collect();
    let start = |line: u32| starts[(line as usize - 1).min(starts.len() - 1)];
    let ends = text.lines.iter().zip(starts.iter().skip(1)).map(|(l, &next)| &bytes[l.span().end()..next]);
    let usual = ends.into_iter().find(|end| !end.is_empty()).unwrap_or(b"\n");
    let mut out = Vec::new();
    let (mut from, mut count) = (1u32, 0u32);
    let mut found = vec![None; depths.len()];
    let mut replaced = Vec::new();
    for (at, section, lines) in sections {
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
                .collect(),
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
    use truepath_core::units::Offset;

    use super::*;

    const ORIGINAL: &str = "%\nG21 G90\nM3 S1500\nG0 X0 Y-8 Z10\nG1 Z-5 F300\nN10 G1 X0 Y0 (in)\nN20 G1 X20 F250\nG3 X25 Y5 I0 J5\nN30 G1 Y30\nG0 Z10\nG0 X50 Y50\nM30\n%\n";

    fn depth(turns: &[(f64, bool, f64)]) -> Depth {
        let source = Source::new("p.nc", ORIGINAL.as_bytes().to_vec());
        let moves = survey(source.bytes(), Options::default()).expect("readable");
        let contour = moves.iter().filter(|m| (7..=9).contains(&m.line));
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
}
