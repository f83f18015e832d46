//! LinuxCNC's own interpreter reads what was written and cuts what our reader says.
//!
//! Skipped where `rs274` is not installed.

use std::process::{Command, Stdio};

use truepath_core::gcode::{Dialect, Units};
use truepath_ground::diagnostics::Source;
use truepath_program::canon::{CanonOptions, ToolTable, write_canon};

use super::parts::*;
use super::planned::{Plan, levels, radial};

const TOOLS: &str = "T1 P1 D20\nT2 P2 D8\nT3 P3 D0\n";

/// What the interpreter says; `None` when it is not installed.
fn interpreted(program: &str) -> Option<String> {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("part.ngc"), program).expect("written");
    std::fs::write(folder.path().join("tool.tbl"), TOOLS).expect("written");
    let mut command = Command::new("rs274");
    command.env("HOME", folder.path()).args(["-t", "tool.tbl", "-g", "part.ngc"]);
    match command.current_dir(folder.path()).stdin(Stdio::null()).output() {
        Ok(output) => {
            let message = String::from_utf8(output.stderr).expect("UTF-8");
            assert_eq!(message.trim().trim_start_matches("executing"), "", "{program}");
            Some(String::from_utf8(output.stdout).expect("UTF-8"))
        }
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => {
            eprintln!("skipped: rs274 of LinuxCNC is not installed");
            None
        }
        Err(error) => panic!("{error}"),
    }
}

/// The moves of a canonical text: what they are, and their numbers.
fn moves(text: &str) -> Vec<(String, Vec<f64>)> {
    let call = |line: &str| {
        let at = ["STRAIGHT_", "ARC_FEED", "SET_FEED_RATE"].iter().find_map(|name| line.find(name))?;
        let (name, inside) = line[at..].split_once('(')?;
        let numbers = inside.trim_end_matches(')').split(',').filter_map(|n| n.trim().parse().ok()).collect();
        Some((name.to_owned(), numbers))
    };
    text.lines().filter_map(call).collect()
}

/// Lines that LinuxCNC does not read, beside the contour: names of tools, a bare G53, SUPA; and codes of another dialect.
fn for_linuxcnc(text: &str) -> String {
    let line = |line: &str| match line {
        "G53" => String::new(),
        _ if line.contains("SUPA") => String::new(),
        _ if line.contains("T=") => "T1".to_owned(),
        _ => line.replace(" G71 ", " G21 "),
    };
    text.lines().map(|text| line(text) + "\n").collect()
}

#[test]
fn linuxcnc_moves_as_our_reader_says_and_sends_no_message() {
    for part in [CORNER, POCKET, HAAS, WEAR, INCH, G64, SIEMENS, SPRING] {
        for plan in [radial as Plan, levels] {
            let text = for_linuxcnc(shown(part.written(plan)).text());
            let Some(said) = interpreted(&text) else { return };
            assert!(said.contains("PROGRAM_END"), "{}: {said}", part.name);
            let table = Source::new("tool.tbl", TOOLS.as_bytes().to_vec());
            let tools = ToolTable::parse(&table, Units::Millimetres).expect("a tool table");
            let options = CanonOptions { tools, dialect: Dialect::Linuxcnc, ..CanonOptions::default() };
            let mut ours = Vec::new();
            let source = Source::new("part.ngc", text.clone().into_bytes());
            write_canon(&source, &options, &mut ours).expect("understood").expect("written");
            let (ours, theirs) = (moves(&String::from_utf8(ours).expect("UTF-8")), moves(&said));
            assert_eq!(ours.len(), theirs.len(), "{}", part.name);
            for (a, b) in ours.iter().zip(&theirs) {
                let near = a.1.iter().zip(&b.1).all(|(a, b)| (a - b).abs() < 1.5e-4);
                assert!(a.0 == b.0 && a.1.len() == b.1.len() && near, "{}: {a:?} {b:?}\n{text}", part.name);
            }
        }
    }
}
