//! Wrong jobs and the exact text their user sees.
//!
//! Every `job_errors/NAME.toml` has its expected message in `NAME.txt` beside it. `BLESS=1 cargo test` rewrites them.

use std::path::Path;

use truepath_ground::diagnostics::{Failure, Form, Source};
use truepath_job::job::JobFile;

fn cases() -> Vec<std::path::PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/job_errors");
    let mut cases: Vec<_> = std::fs::read_dir(folder)
        .expect("the folder of wrong jobs")
        .map(|entry| entry.expect("an entry").path())
        .filter(|path| path.extension().is_some_and(|e| e == "toml"))
        .collect();
    cases.sort();
    cases
}

fn failure(path: &Path) -> Failure {
    let name = path.file_name().expect("a name").to_string_lossy().into_owned();
    let source = Source::new(name, std::fs::read(path).expect("a readable job"));
    let error = JobFile::parse(source, Path::new("")).expect_err(&format!("{} was accepted", path.display()));
    Failure::from(error)
}

#[test]
fn every_wrong_job_gets_its_exact_message() {
    let cases = cases();
    assert!(cases.len() >= 50, "only {} cases found", cases.len());
    let mut wrong = Vec::new();
    for path in cases {
        let shown = failure(&path).render(Form::Plain);
        let golden = path.with_extension("txt");
        if std::env::var_os("BLESS").is_some() {
            std::fs::write(&golden, &shown).expect("a writable golden file");
        } else if std::fs::read_to_string(&golden).ok().as_deref() != Some(&shown) {
            wrong.push(format!("{}:\n{shown}", path.display()));
        }
    }
    assert!(wrong.is_empty(), "messages differ from their golden files:\n{}", wrong.join("\n"));
}

#[test]
fn every_message_names_place_code_expectation_and_remedy() {
    for path in cases() {
        let failure = failure(&path);
        assert_eq!(failure.exit_code(), 1);
        let json: serde_json::Value = serde_json::from_str(&failure.render(Form::Json)).expect("JSON");
        let error = &json["error"];
        let name = path.file_name().expect("a name").to_string_lossy().into_owned();
        for key in ["code", "message", "found", "expected", "help"] {
            assert!(error[key].as_str().is_some_and(|s| !s.is_empty()), "{name}: {key} is empty");
        }
        assert_eq!(error["file"], name.as_str());
        let place = format!("{name}:{}:{}", error["line"], error["column"]);
        for form in [Form::Plain, Form::Colour] {
            let shown = strip_colour(&failure.render(form));
            assert!(shown.contains(&place), "{place} is missing in:\n{shown}");
        }
        assert!(failure.render(Form::Plain).contains(error["message"].as_str().expect("a text")), "{name}");
    }
}

fn strip_colour(text: &str) -> String {
    let mut plain = String::new();
    let mut rest = text;
    while let Some(start) = rest.find('\x1b') {
        plain.push_str(&rest[..start]);
        let end = rest[start..].find('m').map_or(rest.len(), |m| start + m + 1);
        rest = &rest[end..];
    }
    plain.push_str(rest);
    plain
}
