//! A program with its subprograms and loops written out: every block once for each time it is executed.
//!
//! A corrected program needs a line of its own for every pass of the cutter. Blocks keep their bytes where they compute
//! nothing; parameters and expressions are replaced by their values, statements of control flow and assignments are gone.
//! What is written is read back: it must do the same, step by step, or there is none.

use std::collections::BTreeSet;

use truepath_core::gcode::{
    Executed, HostMemory, Interpreter, KlartextBlock, KlartextValue, Line, Lines, Number, Options, Statement, Token,
    Words, klartext_letter as letter,
};

use super::klartext::{continues, first_number, numbered, without_number};
use super::proof::same_steps;

/// Blocks written at most.
const LONGEST: usize = 200_000;

/// The program written out; `None` when it cannot be read, calls another file, becomes too long, or would not do the same.
pub fn unrolled(program: &[u8], options: Options<'static>) -> Option<Vec<u8>> {
    if options.dialect.is_klartext() {
        return conversational(program, options);
    }
    let end: &[u8] = if program.windows(2).any(|pair| pair == b"\r\n") { b"\r\n" } else { b"\n" };
    let percent = |line: &&&[u8]| line.first() == Some(&b'%');
    let lines: Vec<&[u8]> = Lines::new(program).map(|line| line.text).collect();
    let mut text = Vec::new();
    let mut put = |line: &[u8]| {
        text.extend_from_slice(line);
        text.extend_from_slice(end);
    };
    lines.first().filter(percent).into_iter().for_each(|line| put(line));
    let (mut count, mut foreign) = (0usize, false);
    let mut written = BTreeSet::new();
    let mut memory = Box::new(HostMemory::new());
    let read =
        Interpreter::new(options).run_observed(program.into(), &mut memory.lend(), &mut |_| Ok(()), &mut |block| {
            count += 1;
            foreign |= block.source.file != 0;
            // The number of a subprogram is none of the program it is written into.
            let names = block.source.depth > 0 && block.words.iter().any(|word| word.letter == b'O');
            if !block.steers && !names && count <= LONGEST {
                put(&line_of(block, written.insert(block.source.line)));
            }
        });
    read.ok()?;
    lines.last().filter(|_| lines.len() > 1).filter(percent).into_iter().for_each(|line| put(line));
    (!foreign && count <= LONGEST && same_steps(program, &text, options)).then_some(text)
}

/// The same for a conversational program: labels, calls, repetitions and jumps are gone, Q parameters are values. The
/// values of a cycle stay with it, and END PGM at the end; blocks are numbered as they were.
fn conversational(program: &[u8], options: Options<'static>) -> Option<Vec<u8>> {
    let end: &[u8] = if program.windows(2).any(|pair| pair == b"\r\n") { b"\r\n" } else { b"\n" };
    let lines: Vec<Line<'_>> = Lines::new(program).collect();
    let mut text = Vec::new();
    let mut count = 0usize;
    let put = |text: &mut Vec<u8>, line: &[u8]| {
        text.extend_from_slice(line);
        text.extend_from_slice(end);
    };
    let mut memory = Box::new(HostMemory::new());
    let read =
        Interpreter::new(options).run_observed(program.into(), &mut memory.lend(), &mut |_| Ok(()), &mut |block| {
            count += 1;
            if count > LONGEST || block.steers {
                return;
            }
            put(&mut text, &conversational_line(block));
            // What belongs to CYCL DEF: values in lines of their own.
            if KlartextBlock::of(block.line).is_ok_and(|b| matches!(b.statement, Statement::Cycle(..))) {
                let behind = lines.iter().skip(block.source.line as usize);
                let values = |line: &&Line<'_>| {
                    KlartextBlock::of(**line).is_ok_and(|b| b.statement == Statement::Assignment && b.number.is_none())
                };
                behind.take_while(values).for_each(|line| put(&mut text, line.text));
            }
        });
    read.ok()?;
    let ends = |line: &&Line<'_>| KlartextBlock::of(**line).is_ok_and(|b| b.statement == Statement::End);
    let last = lines.iter().find(ends)?;
    let closing = without_number(last.text).trim_ascii();
    if !text.trim_ascii_end().ends_with(closing) {
        put(&mut text, closing);
    }
    if let Some(first) = first_number(program) {
        text = numbered(&text, first, continues);
    }
    (count <= LONGEST && same_steps(program, &text, options)).then_some(text)
}

/// The line of an executed conversational block, without its number and with the values of its Q parameters.
fn conversational_line(block: &Executed<'_>) -> Vec<u8> {
    let base = block.line.span().start;
    let mut text = block.line.text.to_vec();
    let Ok(parsed) = KlartextBlock::of(block.line) else { return text };
    let words: Vec<_> = parsed.words().map_while(Result::ok).collect();
    for word in words.iter().rev().filter(|w| matches!(w.value, KlartextValue::Parameter { .. })) {
        let value = block.words.iter().find(|given| given.span == word.span).map(|given| given.value);
        if let Some(Number::Computed(value)) = value {
            let range = word.value_span.start - base..word.value_span.end() - base;
            let number = decimal(value);
            let number = number.trim_end_matches('.');
            let sign = if number.starts_with('-') { "" } else { "+" };
            let unsigned = matches!(word.letter, letter::FEED | letter::SPEED | letter::FUNCTION | letter::TOOL);
            let number = if unsigned { number.to_owned() } else { format!("{sign}{number}") };
            text.splice(range, number.into_bytes());
        }
    }
    if let Some(number) = parsed.number {
        let (from, to) = (number.start - base, number.end() - base);
        let behind = text[to..].trim_ascii_start().to_vec();
        text.truncate(from);
        text.extend(behind);
    }
    text
}

/// The line of an executed block; its block number only the first time.
fn line_of(block: &Executed<'_>, first: bool) -> Vec<u8> {
    let computes = block.words.iter().any(|word| matches!(word.value, Number::Computed(_)));
    let tokens: Vec<Token> = Words::new(block.line).map_while(Result::ok).collect();
    let assigns = tokens.iter().any(|token| matches!(token, Token::Assignment(_)));
    let number = tokens.iter().find_map(|token| match token {
        Token::Word(word) if word.letter == b'N' => Some(word.span),
        _ => None,
    });
    let base = block.line.span().start;
    let of = |span: truepath_core::gcode::Span| {
        block.line.text.get(span.start - base..span.start + span.len - base).unwrap_or_default()
    };
    if !computes && !assigns {
        return match number.filter(|_| !first) {
            Some(span) => {
                let (from, to) = (span.start - base, span.start + span.len - base);
                let behind = block.line.text[to..].trim_ascii_start();
                [&block.line.text[..from], behind].concat()
            }
            None => block.line.text.to_vec(),
        };
    }
    let mut parts: Vec<Vec<u8>> = Vec::new();
    if block.source.block_delete {
        parts.push(b"/".to_vec());
    }
    parts.extend(number.filter(|_| first).map(|span| of(span).to_vec()));
    for word in block.words {
        let name = match word.letter {
            letter @ (b'r' | b'c') => vec![b',', letter.to_ascii_uppercase()],
            letter => vec![letter],
        };
        let value = match word.value {
            Number::Exact(_) => of(word.span)[1..].to_vec(),
            Number::Computed(value) => decimal(value).into_bytes(),
        };
        let value = if matches!(word.value, Number::Exact(_)) && name.len() > 1 {
            value.into_iter().skip_while(|byte| byte.is_ascii_alphabetic() || *byte == b' ').collect()
        } else {
            value
        };
        parts.push([name, value].concat());
    }
    for token in &tokens {
        if let Token::Comment { span, .. } = token {
            parts.push(of(*span).to_vec());
        }
    }
    parts.join(&b' ')
}

/// A value with as many digits as lengths are kept with, without needless zeros; a point is always written, because some
/// controls take a number without one in other units.
fn decimal(value: f64) -> String {
    let text = format!("{value:.7}");
    let text = text.trim_end_matches('0');
    if text == "-0." { "0.".to_owned() } else { text.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn written_out(program: &str) -> String {
        String::from_utf8(unrolled(program.as_bytes(), Options::default()).expect("a program that can be written out"))
            .unwrap()
    }

    #[test]
    fn calls_and_loops_become_lines() {
        let program = "%\nG21 G90\no1 sub\nN10 G1 Z#1 F[50 * 2] (down)\nG1 X10\no1 endsub\nG0 X0 Y0 Z2\n\
                       o1 call [-4]\n#5 = 2\no2 while [#5 GT 0]\nG1 Y[#5]\n#5 = [#5 - 1]\no2 endwhile\nM2\n%\n";
        assert_eq!(
            written_out(program),
            "%\nG21 G90\nG0 X0 Y0 Z2\nN10 G1 Z-4. F100. (down)\nG1 X10\nG1 Y2.\nG1 Y1.\nM2\n%\n"
        );
    }

    #[test]
    fn subprograms_of_fanuc_lose_their_number() {
        let options = Options { dialect: truepath_core::gcode::Dialect::Fanuc, ..Options::default() };
        let program = "%\nO1\nG21 G90\nG0 X0 Y0 Z2\nM98 P7 L2\nM30\nO7\nN1 G91 G1 Z-2. F99\nG90\nM99\n%\n";
        let text = unrolled(program.as_bytes(), options).expect("a program that can be written out");
        let expected = "%\nO1\nG21 G90\nG0 X0 Y0 Z2\nN1 G91 G1 Z-2. F99\nG90\nG91 G1 Z-2. F99\nG90\nM30\n%\n";
        assert_eq!(String::from_utf8(text).unwrap(), expected);
    }

    #[test]
    fn labels_of_conversational_programs_become_lines() {
        let options = Options { dialect: truepath_core::gcode::Dialect::Heidenhain, ..Options::default() };
        let program = "0 BEGIN PGM A MM\n1 BLK FORM 0.1 Z X+0 Y+0 Z-9\n2 Q1 = -2\n3 L X+0 Y+0 Z+2 R0 FMAX M3\n4 LBL 1\n\
            5 L Z+Q1 FQ9 F200 ; down\n6 L X+10\n7 Q1 = Q1 - 2\n8 L X+0\n9 CALL LBL 1 REP 1\n10 CALL LBL \"up\"\n11 L M30\n\
            12 LBL \"up\"\n13 L Z+50 FMAX\n14 LBL 0\n15 END PGM A MM\n";
        let text =
            unrolled(program.replace("FQ9 ", "").as_bytes(), options).expect("a program that can be written out");
        let expected = "0 BEGIN PGM A MM\n1 BLK FORM 0.1 Z X+0 Y+0 Z-9\n2 L X+0 Y+0 Z+2 R0 FMAX M3\n3 L Z-2 F200 ; down\n\
            4 L X+10\n5 L X+0\n6 L Z-4 F200 ; down\n7 L X+10\n8 L X+0\n9 L Z+50 FMAX\n10 L M30\n11 END PGM A MM\n";
        assert_eq!(String::from_utf8(text).unwrap(), expected);
    }

    #[test]
    fn a_program_without_control_flow_keeps_its_bytes() {
        let program = "G21 G90\r\n(comment) N5 G0 X0 Y0 Z2\r\nG1 X10. F100\r\nM30\r\n";
        let program = program.replace("(comment) N5", "N5");
        assert_eq!(written_out(&program), program);
    }

    #[test]
    fn what_cannot_be_read_is_not_written_out() {
        assert_eq!(unrolled(b"G1 X[1/\nM2\n", Options::default()), None);
    }
}
