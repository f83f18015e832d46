//! Our own small programs against what LinuxCNC's interpreter made of them, recorded by `cargo xtask conformance --write`.

use std::fs;
use std::path::{Path, PathBuf};

use truepath_core::gcode::Units;
use truepath_ground::diagnostics::Source;
use truepath_program::canon::{CanonOptions, ParameterFile, ToolTable, write_canon};

/// Programs whose motion is another on purpose, and why.
const OTHERWISE: [(&str, &str); 2] = [
    ("odd-comp-units-change.ngc", "a move that waits for its corner is told in the unit it was written in"),
    ("tool-m61.ngc", "the reference without a machine does not find the tool that M61 names"),
];

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("data/conformance")
}

/// What the reference made of a program.
struct Expected<'a> {
    file: &'a str,
    end: &'a str,
    motion: Vec<&'a str>,
}

fn expected(recorded: &str) -> Vec<Expected<'_>> {
    let mut all: Vec<Expected<'_>> = Vec::new();
    for line in recorded.lines() {
        match (line.strip_prefix("== "), all.last_mut()) {
            (Some(head), _) => {
                let (file, end) = head.split_once(' ').expect("a file and its end");
                all.push(Expected { file, end, motion: Vec::new() });
            }
            (None, Some(last)) => last.motion.push(line),
            (None, None) => panic!("{line} belongs to no program"),
        }
    }
    all
}

fn options() -> CanonOptions {
    let read = |name: &str| Source::read(&folder().join(name)).expect("a file");
    CanonOptions {
        tools: ToolTable::parse(&read("tools.tbl"), Units::Inches).expect("a tool table"),
        parameters: ParameterFile::parse(&read("machine.var")).expect("parameters"),
        machine_units: Units::Inches,
        ..CanonOptions::default()
    }
}

/// The recorded calls that ours do not make, in order, and what stands there instead.
fn difference(theirs: &[&str], ours: &[&str], prefix: bool) -> Option<String> {
    let agreeing = theirs.iter().zip(ours).take_while(|(a, b)| agree(a, b)).count();
    let ended = agreeing == theirs.len() && (prefix || agreeing == ours.len());
    let at = |calls: &[&str]| calls.get(agreeing).map_or("the end".to_owned(), |c| (*c).to_owned());
    (!ended).then(|| format!("after {agreeing} calls {} became {}", at(theirs), at(ours)))
}

/// The same call, numbers equal but for one unit of the fourth decimal.
fn agree(a: &str, b: &str) -> bool {
    let parts = |text: &'static [char], call: &str| -> Vec<String> {
        call.split(text).filter(|p| !p.is_empty()).map(str::to_owned).collect()
    };
    let (a, b) = (parts(&['(', ')', ',', ' '], a), parts(&['(', ')', ',', ' '], b));
    let equal = |a: &str, b: &str| {
        a == b || matches!((a.parse::<f64>(), b.parse::<f64>()), (Ok(a), Ok(b)) if (a - b).abs() <= 1.0001e-4)
    };
    a.len() == b.len() && a.iter().zip(&b).all(|(a, b)| equal(a, b))
}

/// What is wrong with one program.
fn judge(expected: &Expected<'_>, options: &CanonOptions, names: &[&str]) -> Option<String> {
    let source = Source::read(&folder().join(expected.file)).expect("a program");
    let mut text = Vec::new();
    let read = write_canon(&source, options, &mut text);
    let text = String::from_utf8_lossy(&text).into_owned();
    let calls =
        text.lines().filter_map(|l| l.get(6..)?.trim_start().split_once(' ').map(|(_, call)| call.trim_start()));
    let ours: Vec<&str> = calls.filter(|c| names.contains(&c.split('(').next().unwrap_or_default())).collect();
    let wrong = match (expected.end.split_once(' '), read) {
        (None, Err(error)) => Some(format!("refused: {error}")),
        (None, Ok(written)) => {
            let warnings = written.expect("memory").warnings.as_slice().len();
            let stopped = expected.end == "stopped";
            let silent = (stopped && warnings == 0).then(|| "accepted without a warning".to_owned());
            silent.or_else(|| difference(&expected.motion, &ours, stopped))
        }
        (Some((_, line)), Ok(_)) => Some(format!("accepted, but line {line} is wrong")),
        (Some((_, line)), Err(error)) => {
            let found = error.line_column().map_or(0, |(line, _)| line);
            (found.to_string() != line).then(|| format!("refused at line {found} instead of {line}: {error}"))
        }
    };
    wrong.map(|why| format!("{}: {why}", expected.file))
}

#[test]
fn every_small_program_moves_or_is_refused_as_by_the_reference() {
    let recorded = fs::read_to_string(folder().join("expected.txt")).expect("recorded expectations");
    let expected = expected(&recorded);
    let mut names: Vec<&str> =
        expected.iter().flat_map(|e| &e.motion).map(|call| call.split('(').next().unwrap_or_default()).collect();
    names.sort_unstable();
    names.dedup();
    let options = options();
    let mut wrong: Vec<String> = expected.iter().filter_map(|e| judge(e, &options, &names)).collect();
    for (file, why) in OTHERWISE {
        let count = wrong.len();
        wrong.retain(|text| !text.starts_with(&format!("{file}: ")));
        assert_eq!(wrong.len() + 1, count, "{file} is the same now, although {why}");
    }
    assert!(wrong.is_empty(), "{} of {}:\n{}", wrong.len(), expected.len(), wrong.join("\n"));
}

#[test]
fn every_small_program_is_recorded() {
    let recorded = fs::read_to_string(folder().join("expected.txt")).expect("recorded expectations");
    let files = fs::read_dir(folder()).expect("a folder").map(|e| e.expect("an entry").file_name());
    let files = files.map(|f| f.to_string_lossy().into_owned());
    let programs: Vec<String> = files.filter(|f| f.ends_with(".ngc") && !f.starts_with("sub-")).collect();
    assert!(programs.len() >= 150, "{}", programs.len());
    for program in programs {
        assert!(recorded.contains(&format!("== {program} ")), "{program} is not recorded");
    }
}
