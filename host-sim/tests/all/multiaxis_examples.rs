//! The examples of `examples/multiaxis`, and what `docs/multiaxis.md` prints of them.
//!
//! `BLESS=1 cargo test` writes the programs, the pictures and the printed results anew.

use std::path::{Path, PathBuf};

use crate::multiaxis_support::{Machine as Independent, feeds, matched};
use crate::workplace::truepath;
use truepath_ground::diagnostics::Source;
use truepath_multiaxis::Machine;

const CASES: [(&str, &str, &str, bool); 2] = [
    ("sine-trunnion", "trunnion", "SINE SURFACE, A C TRUNNION", false),
    ("sine-fork-head", "fork-head", "SINE SURFACE, A B FORK HEAD, INVERSE TIME", true),
];

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap().to_owned()
}

fn blesses() -> bool {
    std::env::var_os("BLESS").is_some()
}

#[test]
fn the_example_programs_are_what_the_generator_writes() {
    let folder = root().join("examples/multiaxis");
    for (name, machine, title, inverse_time) in CASES {
        let source = Source::read(&folder.join(format!("{machine}.toml"))).unwrap();
        let text = crate::multiaxis_example::program(&Machine::from_toml(&source).unwrap(), title, inverse_time);
        let path = folder.join(format!("{name}.nc"));
        if blesses() {
            std::fs::write(&path, &text).unwrap();
        }
        assert_eq!(std::fs::read_to_string(&path).unwrap(), text, "{name}: BLESS=1 renews it");
    }
}

#[test]
fn the_page_prints_what_the_command_prints() {
    let page = root().join("docs/multiaxis.md");
    let out = tempfile::tempdir().unwrap();
    for (name, machine, ..) in CASES {
        let arguments = [
            "multiaxis".to_owned(),
            format!("examples/multiaxis/{name}.nc"),
            "--machine".to_owned(),
            format!("examples/multiaxis/{machine}.toml"),
            "--tolerance".to_owned(),
            "0.005".to_owned(),
            "-o".to_owned(),
            out.path().join(format!("{name}.nc")).display().to_string(),
            "--report".to_owned(),
            out.path().join(name).display().to_string(),
        ];
        let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
        let output = truepath(&root(), &arguments);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let printed = String::from_utf8(output.stdout).unwrap();
        let text = std::fs::read_to_string(&page).unwrap();
        let begin = format!("<!-- {name} -->\n```text\n");
        let from = text.find(&begin).expect("the place of the result") + begin.len();
        let to = from + text[from..].find("```").expect("its end");
        let picture = root().join("docs/multiaxis.svg");
        let drawn = std::fs::read(out.path().join(name).join("errors.svg")).unwrap();
        if blesses() {
            std::fs::write(&page, format!("{}{printed}{}", &text[..from], &text[to..])).unwrap();
            if name == "sine-trunnion" {
                std::fs::write(&picture, &drawn).unwrap();
            }
            continue;
        }
        assert_eq!(&text[from..to], printed, "{name}: BLESS=1 renews it");
        if name == "sine-trunnion" {
            assert_eq!(std::fs::read(&picture).unwrap(), drawn, "the picture of the page");
        }
    }
}

#[test]
fn the_rewritten_examples_keep_to_the_chords_of_the_examples() {
    let trunnion = Independent { axes: [(3, false, [0.0, 0.0, -40.0], 1.0), (5, false, [0.0; 3], 1.0)], length: 0.0 };
    let fork = Independent { axes: [(3, true, [0.0, 0.0, 60.0], 1.0), (4, true, [0.0, 0.0, 60.0], 1.0)], length: 90.0 };
    let out = tempfile::tempdir().unwrap();
    for ((name, file, ..), machine) in CASES.into_iter().zip([trunnion, fork]) {
        let original = std::fs::read_to_string(root().join(format!("examples/multiaxis/{name}.nc"))).unwrap();
        let toml = root().join(format!("examples/multiaxis/{file}.toml")).display().to_string();
        std::fs::write(out.path().join("in.nc"), &original).unwrap();
        let run = truepath(
            out.path(),
            &["multiaxis", "in.nc", "--machine", &toml, "--tolerance", "0.005", "-o", "out.nc", "--force"],
        );
        assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
        let rewritten = std::fs::read_to_string(out.path().join("out.nc")).unwrap();
        let (original, written) = (feeds(&original), feeds(&rewritten));
        let mut before = 0.0f64;
        for (wanted, pieces) in original.iter().zip(matched(&original, &written)) {
            let chord = (machine.end(&wanted.from, false), machine.end(&wanted.to, false));
            before = before.max(machine.error(wanted, chord, false));
            for piece in pieces {
                assert!(machine.error(piece, chord, false) <= 0.005 + 2e-6, "{name} line {}", piece.line);
            }
        }
        assert!(before > 0.01, "{name}: {before} mm before");
    }
}
