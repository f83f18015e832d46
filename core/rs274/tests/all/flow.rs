//! Parameters, expressions, subprograms and loops against what LinuxCNC's `rs274` (2.9) says of the same programs, and
//! their limits.

use crate::interpret::interpret;
use proptest::prelude::*;
use truepath_rs274::{
    Axes, Canon, Comment, CommentKind, Dialect, GcodeError, HostMemory, Library, LibraryFile, Options, Program,
};

/// What a program says: its messages, and `x y z` in millimetres for every move.
fn said_with(program: &Program<'_>, options: Options<'_>) -> (Vec<String>, Option<GcodeError>) {
    let mut memory = Box::new(HostMemory::new());
    let mut said = Vec::new();
    let run = interpret(options, *program, &mut memory.lend(), &mut |event| {
        match *event.canon {
            Canon::Comment(body) => {
                let comment = Comment::of(body.of(event.text));
                if comment.kind != CommentKind::Plain {
                    let mut text = String::new();
                    comment.write(event.parameters, &mut text).expect("a string");
                    said.push(text);
                }
            }
            Canon::Traverse { to, .. } | Canon::Feed { to, .. } => {
                let mm = |p: Option<truepath_units::Position>| p.map_or(f64::NAN, |p| p.nm() as f64 / 1e6);
                said.push(format!("{:.4} {:.4} {:.4}", mm(to.x), mm(to.y), mm(to.z)));
            }
            _ => {}
        }
        Ok(())
    });
    (said, run.err())
}

fn options(dialect: Dialect) -> Options<'static> {
    Options { start: Axes::ORIGIN, dialect, ..Options::default() }
}

fn said(program: &str, dialect: Dialect) -> (Vec<String>, Option<GcodeError>) {
    said_with(&Program::new(program.as_bytes()), options(dialect))
}

/// Program, what `rs274` says; `!` and a line for an error.
const REFERENCE: &str = include_str!("../data/flow.txt");

#[test]
fn programs_say_what_the_reference_says() {
    let mut checked = 0;
    for line in REFERENCE.lines().filter(|l| !l.starts_with(';')) {
        let (program, expected) = line.split_once(" => ").unwrap_or_else(|| panic!("{line}"));
        let (mut said, error) = said(&program.replace("\\n", "\n"), Dialect::Linuxcnc);
        if let Some(error) = error {
            said.push(format!("!{}", error.line));
        }
        assert_eq!(said.join("|"), expected, "{program}");
        checked += 1;
    }
    assert!(checked > 90, "{checked}");
}

#[test]
fn macro_b_jumps_loops_and_knows_vacant_parameters() {
    for (program, expected) in [
        ("#100=1\nN10 #100=#100+1\nIF [#100 LT 4] GOTO 10\n(DEBUG,%d#100)\nM30", "4"),
        ("#100=0\nWHILE [#100 LT 3] DO1\n#100=#100+1\n(DEBUG,%d#100)\nEND1\nM30", "1|2|3"),
        ("GOTO 20\n(DEBUG,a)\nN20 (DEBUG,b)\nM30", "b"),
        ("IF [#1 EQ #0] THEN #100=5\nIF [#100 EQ #0] THEN #100=6\n(DEBUG,%d#100)\nM30", "5"),
        ("#1=0\nIF [#1 EQ #0] GOTO 9\n(DEBUG,zero is not vacant)\nN9 M30", "zero is not vacant"),
        ("G90 G0 X5\nG0 X#7 Y2\nM30", "5.0000 0.0000 0.0000|5.0000 2.0000 0.0000"),
        ("#1=2*3+4/2\n(DEBUG,%d#1)\nDPRNT[X#1[44]]\nM30", "8"),
    ] {
        let (said, error) = said(program, Dialect::Fanuc);
        assert_eq!((said.join("|").as_str(), error), (expected, None), "{program}");
    }
}

#[test]
fn a_loop_without_end_is_stopped_at_the_block_limit() {
    for (program, dialect) in [
        ("o1 while [1]\no1 endwhile\nM2", Dialect::Linuxcnc),
        ("o1 do\no1 while [1]\nM2", Dialect::Linuxcnc),
        ("o1 repeat [4000000000]\no1 endrepeat\nM2", Dialect::Linuxcnc),
        ("N1 GOTO 1", Dialect::Fanuc),
        ("DO1\nEND1", Dialect::Fanuc),
    ] {
        let limited = Options { block_limit: 5_000, ..options(dialect) };
        let (_, error) = said_with(&Program::new(program.as_bytes()), limited);
        assert_eq!(error.map(|e| e.kind.code()), Some("G153"), "{program}");
    }
}

#[test]
fn every_limit_is_an_error_with_its_number() {
    let deep = format!("#1={}1{}", "[".repeat(60), "]".repeat(60));
    let nested = (0..40).map(|n| format!("o{n} if [1]\n")).collect::<String>();
    let words = format!("G0{}", " X1".repeat(80));
    let assignments = "#1=1 ".repeat(40);
    let parameters = "#100=0\no1 repeat [5500]\n#[#100+40]=1\n#100=[#100+1]\no1 endrepeat\n#<a>=1";
    for (program, code) in [
        (deep.as_str(), "G168"),
        (&nested, "G150"),
        (&words, "G047"),
        (&assignments, "G152"),
        (
            "o1 sub\no1 endsub\no1 call [1][1][1][1][1][1][1][1][1][1][1][1][1][1][1][1][1][1][1][1][1][1][1][1][1][1][1][1][1][1][1]",
            "G151",
        ),
    ] {
        assert_eq!(said(program, Dialect::Linuxcnc).1.map(|e| e.kind.code()), Some(code), "{program}");
    }
    assert_eq!(said(parameters, Dialect::Linuxcnc).1, None);
}

struct Shelf;

impl Library for Shelf {
    fn find(&self, name: &[u8]) -> Option<LibraryFile<'_>> {
        match name {
            b"pocket" => {
                Some(LibraryFile { number: 1, text: b"(beside)\no<pocket> sub\nG0 X#1\no<pocket> endsub\nM2" })
            }
            b"wrong" => Some(LibraryFile { number: 2, text: b"o<wrong> sub\nG0 X1\n  G0 X[1/0]\no<wrong> endsub" }),
            _ => None,
        }
    }
}

#[test]
fn a_file_beside_the_program_is_called_and_its_errors_name_it() {
    let program = |text| Program { text, library: Some(&Shelf) };
    let (said, error) = said_with(&program(b"o<pocket> call [7]\nG0 Y1\nM2"), options(Dialect::Linuxcnc));
    assert_eq!((said.join("|").as_str(), error), ("7.0000 0.0000 0.0000|7.0000 1.0000 0.0000", None));
    let (_, error) = said_with(&program(b"o<wrong> call\nM2"), options(Dialect::Linuxcnc));
    let error = error.expect("a division by zero");
    assert_eq!((error.file, error.line, error.column), (2, 3, 9));
}

proptest! {
    #[test]
    fn steered_programs_never_panic_and_always_end(
        lines in proptest::collection::vec(prop_oneof![
            "o[1-3] (if|elseif|while|repeat) \\[#[1-3]( (LT|GT|EQ) [0-9])?\\]",
            "o[1-3] (else|endif|endwhile|do|endrepeat|break|continue|sub|endsub|return|call \\[1\\])",
            "#[1-4]=\\[?#[1-4][-+*/][0-9.]{1,3}\\]?",
            "(IF \\[#1 LT [0-9]\\] GOTO |GOTO |WHILE \\[#2 GT #3\\] DO|DO|END)[1-3]",
            "N[1-3] G1 X#[1-4] Y-#<_v> Z\\[[0-9.+*/# ]{0,9}\\]?",
            "(M98 P[1-3] L[0-3]|M99|M99 P[1-3]|O[1-3]|G65 P1 A1\\. B2|M2)",
            "[#\\[\\]<>=*/+A-Za-z0-9 .-]{0,16}",
        ], 0..24),
        fanuc: bool,
    ) {
        let text = lines.join("\n");
        let dialect = if fanuc { Dialect::Fanuc } else { Dialect::Linuxcnc };
        let limited = Options { block_limit: 2_000, ..options(dialect) };
        let (_, error) = said_with(&Program::new(text.as_bytes()), limited);
        if let Some(error) = error {
            prop_assert!(error.start <= text.len() && error.line as usize <= lines.len().max(1), "{error}\n{text}");
        }
    }
}
