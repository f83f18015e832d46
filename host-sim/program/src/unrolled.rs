//! A program with its subprograms and loops written out: every block once for each time it is executed.
//!
//! A corrected program needs a line of its own for every pass of the cutter. Blocks keep their bytes where they compute
//! nothing; parameters and expressions are replaced by their values, statements of control flow and assignments are gone.
//! What is written is read back: it must do the same, step by step, or there is none.

use std::collections::BTreeSet;

use truepath_core::gcode::{Executed, HostMemory, Interpreter, Lines, Number, Options, Token, Words};

use super::proof::same_steps;

/// Blocks written at most.
const LONGEST: usize = 200_000;

/// The program written out; `None` when it cannot be read, calls another file, becomes too long, or would not do the same.
pub fn unrolled(program: &[u8], options: Options<'static>) -> Option<Vec<u8>> {
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
    let read = Interpreter::new(options).run_observed(program, &mut memory.lend(), &mut |_| Ok(()), |block| {
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
