//! Statements with a comment, a blank, a tab, a line end or the other case at every place between their bytes.
//!
//! `data/disturbed.txt` holds what `rs274` (LinuxCNC 2.9) made of each: a line `> statement`, its program's stream, and
//! for each kind of disturbance one character a place, from before the first byte to behind the last: `=` the stream of the
//! undisturbed program, `!` refused, `a` … another stream, which is listed.

use crate::interpret::interpret;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use truepath_rs274::{Axes, Canon, Comment, CommentKind, Dialect, GcodeError, HostMemory, Options};
use truepath_units::{Offset, Position};

/// What is put between two bytes.
const INSERTED: [(&str, &str); 8] = [
    ("blank", " "),
    ("tab", "\t"),
    ("comment", "(c)"),
    ("comments", " (c) (d) "),
    ("message", "(debug,m)"),
    ("numbers", "([9] X9)"),
    ("semicolon", ";"),
    ("return", "\r"),
];

/// What is done to the whole statement: case, and its line end.
const WHOLE: [&str; 5] = ["upper", "lower", "mixed", "crlf", "cr"];

/// Programs; the disturbed line begins with `>`.
const PROGRAMS: &[&str] = &[
    ">G1 X10.5 Y-2 F50",
    ">N10 G01X+3.Y.5",
    ">/N3 G1 X4",
    ">G2 X5 Y5 I5 J0 P2",
    ">G3 X1 Y1 R-2",
    ">G1 X[1+2*[3-1]] Y-[2/4]",
    "#1=2\n#2=1\n#<a>=3\n>G1 X#1 Y#<a> Z##2 A-#1",
    ">#1=5 #2=[#1+2] G1 X1\nG1 X#1 Y#2",
    ">#<ab>=1.5\nG1 X#<ab>",
    ">#<_g h>=[5 MOD 3]\nG1 X#<_gh>",
    "#1=4\n>##1=4 #[2+1]=-3\nG1 X#4 Y#3",
    ">G1 X[sin[30]**2] Y[atan[1]/[2]]",
    "#<q>=1\n>G1 X[exists[#<q>]] Y-abs[-2]",
    ">G1 X[1 LT 2] Y[3 GE 4 OR 1] Z[-1-+1]",
    ">G4 P0.5",
    ">M3 S100 G1 X1",
    ">T1 M6",
    ">(debug,a #1 b)",
    ">(msg, Hello x)",
    ">G1 X1 (debug,p #5420 q) Y2",
    ">G1 X1 ; Y2 (debug,x)",
    ">G1 X1 (debug,a) (debug,b)",
    "o1 sub\n(debug,#1 #2 #3 #4)\no1 endsub\n>o1 call [1] [2+1] [3]",
    "o<ab> sub\n(debug,#1 #2 #3 #4)\no<ab> endsub\n>o<a b> call[1] [#<_x>]\n",
    ">o1 sub\nG1 X#1\no1 endsub\no1 call [3]",
    "o1 sub\nG1 X#1\n>o1 endsub [5]\no1 call [3]\nG1 X#<_value>",
    "o1 sub\n>o1 return [4]\nG1 X9\no1 endsub\no1 call [3]\nG1 X#<_value>",
    ">o1 if [#1 GT 0]\nG1 X1\no1 else\nG1 X2\no1 endif\nG1 X3",
    ">o1 if [1]\nG1 X1\no1 else\nG1 X2\no1 endif\nG1 X3",
    "o1 if [0]\nG1 X1\n>o1 elseif [#1 EQ 0]\nG1 X2\no1 else\nG1 X4\no1 endif\nG1 X3",
    "o1 if [0]\nG1 X1\n>o1 else\nG1 X2\no1 endif\nG1 X3",
    "o1 if [1]\nG1 X1\n>o1 else\nG1 X2\no1 endif\nG1 X3",
    "o1 if [0]\nG1 X1\n>o1 endif\nG1 X3",
    "o1 if [1]\nG1 X1\n>o1 endif\nG1 X3",
    ">o1 while [#1 LT 2]\n#1=[#1+1]\nG1 X#1\no1 endwhile\nG1 X9",
    "o1 while [#1 LT 2]\n#1=[#1+1]\nG1 X#1\n>o1 endwhile\nG1 X9",
    ">o1 do\n#1=[#1+1]\nG1 X#1\no1 while [#1 LT 2]\nG1 X9",
    "o1 do\n#1=[#1+1]\nG1 X#1\n>o1 while [#1 LT 2]\nG1 X9",
    ">o1 repeat [2]\nG91 G1 X1\no1 endrepeat\nG1 X9",
    "o1 repeat [2]\nG91 G1 X1\n>o1 endrepeat\nG1 X9",
    "o1 while [#1 LT 2]\n#1=[#1+1]\nG1 X#1\n>o1 break\nG1 Y5\no1 endwhile\nG1 X9",
    "o1 while [#1 LT 2]\n#1=[#1+1]\nG1 X#1\n>o1 continue\nG1 Y5\no1 endwhile\nG1 X9",
    "o2 sub\nG1 X#1\no2 endsub\n#5=1\n>o[#5+1] call [3]",
    "o2 sub\nG1 X#1\no2 endsub\n#5=2\n>o#5 call [3]",
    "F100\n>G81 X1 Y2 Z-1 R1 L2",
    ">G10 L2 P2 X1 R45\nG55 G1 X1",
    "G0 X1\n>G0 @5 ^30",
    ">G92.1\nG92 X1\nG1 X1",
    ">G41.1 D2 G1 X5\nG1 Y5\nG40 G1 X9",
    ">G90 G91.1 G64 P0.01 G1 X2",
    ">G5 I1 J2 P-1 Q-2 X3 Y3",
    ">M98 P3 L2\nM2\no3\nG91 G1 X1\nM99",
    ">M2 (x)\nG1 X5",
];

/// Before and behind each program.
const HEAD: &str = "G21 G90 G17 G40 G49 G80 G94 F100\nG0 X0 Y0 Z0\n";
const TAIL: &str = "\nM2\n";

/// The disturbed programs of a base, with their place and kind; the first is undisturbed.
fn variants(base: &str) -> Vec<(String, Vec<Vec<u8>>)> {
    let whole = format!("{HEAD}{base}{TAIL}");
    let mark = whole.find("\n>").expect("a marked line") + 1;
    let (before, rest) = (&whole[..mark], &whole[mark + 1..]);
    let (line, after) = rest.split_once('\n').expect("a line behind it");
    let joined = |line: &str, end: &str| format!("{before}{line}{end}{after}").into_bytes();
    let mut all = vec![("none".to_owned(), vec![joined(line, "\n")])];
    for (name, text) in INSERTED {
        let put = |at| joined(&format!("{}{text}{}", &line[..at], &line[at..]), "\n");
        all.push((name.to_owned(), (0..=line.len()).map(put).collect()));
    }
    let mixed: String = line
        .chars()
        .enumerate()
        .map(|(n, c)| if n % 2 == 0 { c.to_ascii_uppercase() } else { c.to_ascii_lowercase() })
        .collect();
    for name in WHOLE {
        let one = match name {
            "upper" => joined(&line.to_ascii_uppercase(), "\n"),
            "lower" => joined(&line.to_ascii_lowercase(), "\n"),
            "mixed" => joined(&mixed, "\n"),
            _ => whole.replace("\n>", "\n").replace('\n', if name == "crlf" { "\r\n" } else { "\r" }).into_bytes(),
        };
        all.push((name.to_owned(), vec![one]));
    }
    all
}

/// What the interpreter makes of a program: moves, dwells, rates, messages.
fn ours(program: &[u8], dialect: Dialect) -> (String, Option<GcodeError>) {
    const TOOLS: [truepath_rs274::Tool; 1] = [truepath_rs274::Tool { number: 1, ..truepath_rs274::Tool::NONE }];
    let mut buffers = Box::new(HostMemory::new());
    let machine = truepath_rs274::Machine { units: truepath_rs274::Units::Inches, probe_before_end: Offset::ZERO };
    let machine = (dialect == Dialect::Linuxcnc).then_some(machine);
    let options = Options {
        start: Axes::ORIGIN,
        dialect,
        as_linuxcnc: true,
        tools: &TOOLS,
        machine,
        whole_splines: true,
        ..Options::default()
    };
    let mut said = String::new();
    let mm = |p: Option<Position>| p.map_or(f64::NAN, |p| p.nm() as f64 / 1e6);
    let run = interpret(options, program, &mut buffers.lend(), &mut |event| {
        let written = match *event.canon {
            Canon::Traverse { to, .. } => write!(said, "T{:.3},{:.3},{:.3}|", mm(to.x), mm(to.y), mm(to.z)),
            Canon::Feed { to, .. } => write!(said, "F{:.3},{:.3},{:.3}|", mm(to.x), mm(to.y), mm(to.z)),
            Canon::Arc { to, centre, counter_clockwise, turns, .. } => {
                let turns = (f64::from(turns) + 1.0) * if counter_clockwise { 1.0 } else { -1.0 };
                let centre = [centre.x, centre.y].map(|p| mm(Some(p)));
                write!(
                    said,
                    "A{:.3},{:.3},{:.3},{:.3},{turns},{:.3}|",
                    mm(to.x),
                    mm(to.y),
                    centre[0],
                    centre[1],
                    mm(to.z)
                )
            }
            Canon::Dwell(time) => write!(said, "D{:.3}|", time.value()),
            Canon::FeedRate(feed) => write!(said, "R{:.2}|", feed.bits() as f64 / 4_294_967_296.0),
            Canon::SpindleSpeed(speed) => write!(said, "S{:.2}|", speed.bits() as f64 / 4_294_967_296.0),
            Canon::ChangeTool(Some(tool)) => write!(said, "C{tool}|"),
            Canon::Spline { .. } => write!(said, "N|"),
            Canon::Comment(body) => {
                let comment = Comment::of(body.of(event.text));
                if !matches!(comment.kind, CommentKind::Debug | CommentKind::Message) {
                    return Ok(());
                }
                said.push('M');
                comment.write(event.parameters, &mut said).and_then(|()| write!(said, "|"))
            }
            _ => Ok(()),
        };
        written.expect("a string");
        Ok(())
    });
    (said.replace("-0.000", "0.000").replace('\r', ""), run.err())
}

#[derive(Default)]
struct Recorded {
    statement: String,
    stream: String,
    others: Vec<String>,
    kinds: Vec<(String, String)>,
}

fn recorded() -> Vec<Recorded> {
    let mut all: Vec<Recorded> = Vec::new();
    for line in include_str!("../data/disturbed.txt").lines() {
        let (key, rest) = line.split_once(' ').unwrap_or((line, ""));
        let last = all.last_mut();
        match (key, last) {
            (">", _) => all.push(Recorded { statement: rest.replace("\\n", "\n"), ..Recorded::default() }),
            ("stream", Some(last)) => rest.clone_into(&mut last.stream),
            ("other", Some(last)) => last.others.push(rest.to_owned()),
            (kind, Some(last)) => last.kinds.push((kind.to_owned(), rest.to_owned())),
            _ => {}
        }
    }
    all
}

#[test]
fn a_disturbed_statement_is_read_as_the_reference_reads_it_or_refused() {
    let recorded = recorded();
    assert_eq!(recorded.iter().map(|r| r.statement.as_str()).collect::<Vec<_>>(), PROGRAMS);
    let (mut wrong, mut stricter, mut checked) = (Vec::new(), 0, 0);
    for base in &recorded {
        for (kind, programs) in variants(&base.statement) {
            let marks = base.kinds.iter().find(|(k, _)| *k == kind).map_or("", |(_, marks)| marks);
            assert_eq!(marks.chars().count(), programs.len(), "{kind} of {}", base.statement);
            for (mark, program) in marks.chars().zip(&programs) {
                checked += 1;
                let (mut stream, error) = ours(program, Dialect::Linuxcnc);
                if base.statement.starts_with(">M98") {
                    // The reference does not execute the comment of a block that calls.
                    stream = stream.replace("Mm|", "");
                }
                let theirs = match mark {
                    // The reference takes a file without any LF for one line.
                    _ if kind == "cr" => Some(&base.stream),
                    '=' => Some(&base.stream),
                    '!' => None,
                    other => base.others.get(other as usize - 'a' as usize),
                };
                let right = match (&error, theirs) {
                    (Some(_), None) => true,
                    // Refused by the reference: the disturbance may mean nothing here, never something else.
                    (None, None) => stream.replace("Mm|", "") == base.stream,
                    (None, Some(theirs)) => stream == *theirs,
                    // What makes another program of it may be refused here.
                    (Some(_), Some(theirs)) => {
                        stricter += 1;
                        *theirs != base.stream
                    }
                };
                if !right {
                    let program = String::from_utf8_lossy(&program[HEAD.len()..]).into_owned();
                    let said = error.map_or(stream, |e| e.to_string());
                    wrong.push(format!("{kind} {program:?}:\n   ours {said}\n theirs {theirs:?}"));
                }
            }
        }
    }
    assert!(checked > 5_000, "{checked}");
    assert!(wrong.is_empty(), "{} of {checked} ({stricter} only refused):\n{}", wrong.len(), wrong.join("\n"));
}

/// Calls of the reference in the form of [`ours`].
fn theirs(folder: &Path, program: &[u8]) -> Option<String> {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/data/conformance");
    // The reference keeps its tools in a file of the home folder.
    let _ = std::fs::remove_dir_all(folder);
    std::fs::create_dir_all(folder).expect("a folder");
    std::fs::write(folder.join("p.ngc"), program).expect("written");
    for file in ["machine.var", "tools.tbl"] {
        std::fs::copy(data.join(file), folder.join(file)).expect("copied");
    }
    let arguments = ["5", "rs274", "-t", "tools.tbl", "-v", "machine.var", "-g", "p.ngc"];
    let mut command = Command::new("timeout");
    command.args(arguments).current_dir(folder).env("HOME", folder).env("LC_ALL", "C").stdin(Stdio::null());
    let ran = command.output().expect("rs274 runs");
    if ran.status.code() != Some(0) {
        return None;
    }
    let mut said = String::new();
    for line in String::from_utf8_lossy(&ran.stdout).lines() {
        let Some(call) = line.get(6..).and_then(|l| l.trim_start().split_once(' ')).map(|(_, call)| call.trim_start())
        else {
            continue;
        };
        let Some((name, arguments)) = call.split_once('(') else { continue };
        let arguments = arguments.strip_suffix(')').unwrap_or(arguments);
        let n: Vec<f64> = arguments.split([',', ' ']).filter_map(|a| a.trim().parse().ok()).collect();
        let text = match name {
            "STRAIGHT_TRAVERSE" => format!("T{:.3},{:.3},{:.3}|", n[0], n[1], n[2]),
            "STRAIGHT_FEED" => format!("F{:.3},{:.3},{:.3}|", n[0], n[1], n[2]),
            "ARC_FEED" => format!("A{:.3},{:.3},{:.3},{:.3},{},{:.3}|", n[0], n[1], n[2], n[3], n[4], n[5]),
            "DWELL" => format!("D{:.3}|", n[0]),
            "SET_FEED_RATE" if n[0] != 0.0 => format!("R{:.2}|", n[0]),
            "SET_SPINDLE_SPEED" => format!("S{:.2}|", n[n.len() - 1]),
            "CHANGE_TOOL" => "C1|".to_owned(),
            "NURBS_FEED" => "N|".to_owned(),
            "MESSAGE" => format!("M{}|", arguments.trim_matches('"')),
            _ => continue,
        };
        said += &text;
    }
    Some(said.replace("-0.000", "0.000").replace('\r', ""))
}

/// Records what is not recorded yet, for a machine with `rs274`; empty the file to record everything.
#[test]
#[ignore = "records with LinuxCNC's rs274: RECORD=1"]
fn record_what_the_reference_makes_of_disturbed_statements() {
    // Also `cargo xtask test --all` comes by here.
    if std::env::var_os("RECORD").is_none() {
        return;
    }
    let folder: PathBuf = std::env::temp_dir().join(format!("disturbed-{}", std::process::id()));
    let mut out = String::new();
    let known = include_str!("../data/disturbed.txt");
    for base in PROGRAMS {
        let head = format!("> {}\n", base.replace('\n', "\\n"));
        if let Some((_, behind)) = known.split_once(&head) {
            let end = behind.find("\n> ").map_or(behind.len(), |n| n + 1);
            out += &head;
            out += &behind[..end];
            continue;
        }
        let mut others: Vec<String> = Vec::new();
        let mut lines = String::new();
        let mut stream = String::new();
        for (kind, programs) in variants(base) {
            let mut marks = String::new();
            for program in &programs {
                let said = theirs(&folder, program);
                if kind == "none" {
                    stream = said.clone().expect("the undisturbed program is accepted");
                }
                marks.push(match said {
                    None => '!',
                    Some(said) if said == stream => '=',
                    Some(said) => {
                        let at = others.iter().position(|o| *o == said).unwrap_or_else(|| {
                            others.push(said);
                            others.len() - 1
                        });
                        char::from_u32('a' as u32 + at as u32).expect("few streams")
                    }
                });
            }
            let _ = writeln!(lines, "{kind} {marks}");
        }
        let _ = writeln!(out, "{head}stream {stream}");
        for other in others {
            let _ = writeln!(out, "other {other}");
        }
        out += &lines;
        eprintln!("{base:?} done");
    }
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/disturbed.txt");
    std::fs::write(file, out).expect("written");
    std::fs::remove_dir_all(folder).expect("removed");
}
