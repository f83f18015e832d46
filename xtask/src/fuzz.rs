//! Fuzzing: random bytes, guided by coverage, into everything that reads a file.
//!
//! The targets are a workspace of their own (`fuzz/`), built with the counters of LLVM's sancov and linked to libFuzzer;
//! that takes a stable compiler and a C++ compiler, no nightly. A corpus begins with the programs, probe files, jobs and
//! images of the tests and examples and grows under the target directory. What once failed lies in `fuzz/regressions/TARGET` and is
//! run first.

use std::path::{Path, PathBuf};

use crate::repository::{cargo, program, read, root, run, succeeds, target};
use crate::step::{Failure, Outcome, Passed};
use crate::table::thousands;
use crate::toolchain::need;

/// A target and the files its corpus begins with: folders below the root, endings of names.
struct Target {
    name: &'static str,
    seeds: &'static [(&'static str, &'static [&'static str])],
    /// What an input begins with that its files do not have: the byte by which the target chooses a format.
    choices: u8,
    /// The dictionary of the words that its text is made of: a name in `fuzz/words`.
    words: Option<&'static str>,
    /// Longest input, bytes.
    longest: u32,
}

const TARGETS: [Target; 7] = [
    Target {
        name: "program",
        seeds: &[
            ("core/rs274/tests/data", &["nc", "ngc"]),
            ("host-sim/demo", &["nc"]),
            ("host-sim/tests", &["nc", "ngc"]),
            ("host-sim/program/tests", &["nc", "ngc"]),
            ("tests/data", &["nc", "ngc"]),
        ],
        choices: 2,
        words: Some("program"),
        longest: 2_000,
    },
    Target {
        name: "probe",
        seeds: &[("core/tests/data", &["txt", "csv", "log"]), ("host-sim/job/tests/data", &["txt", "csv", "log"])],
        choices: 6,
        words: Some("probe"),
        longest: 2_000,
    },
    Target {
        name: "job",
        seeds: &[("host-sim/demo", &["toml"]), ("host-sim/job/tests", &["toml"])],
        choices: 0,
        words: Some("job"),
        longest: 3_000,
    },
    Target {
        name: "five_axis",
        seeds: &[("examples/multiaxis", &["nc", "toml"]), ("fuzz/seeds/five_axis", &["nc"])],
        choices: 0,
        words: Some("program"),
        longest: 2_000,
    },
    Target { name: "image", seeds: &[("fuzz/seeds/image", &["tpi"])], choices: 0, words: None, longest: 1_000 },
    Target { name: "servo", seeds: &[("fuzz/seeds/servo", &["bin"])], choices: 0, words: None, longest: 16_000 },
    Target { name: "device", seeds: &[("fuzz/seeds/device", &["bin"])], choices: 0, words: None, longest: 2_000 },
];

/// Counters for every edge and comparison.
const COVERAGE: &str = "-Cpasses=sancov-module -Cllvm-args=-sanitizer-coverage-level=4 \
    -Cllvm-args=-sanitizer-coverage-inline-8bit-counters -Cllvm-args=-sanitizer-coverage-pc-table \
    -Cllvm-args=-sanitizer-coverage-trace-compares --cfg fuzzing -Ccodegen-units=1";

/// Seconds after which one input counts as a hang.
const HANG: u32 = 10;

/// How long to fuzz.
#[derive(Clone, Copy, Debug)]
pub enum Length {
    /// So many inputs for each target.
    Runs(u64),
    /// So long for each target.
    Seconds(u64),
}

/// Fuzzes one target, or all of them one after the other; inputs of up to `longest` bytes, or what a target has for itself.
pub fn check(only: Option<&str>, length: Length, longest: Option<u32>) -> Outcome {
    let chosen: Vec<&Target> = TARGETS.iter().filter(|t| only.is_none_or(|name| name == t.name)).collect();
    if chosen.is_empty() {
        let names: Vec<&str> = TARGETS.iter().map(|t| t.name).collect();
        return Err(Failure::found(format!("no such target; there are {}", names.join(", "))));
    }
    let binaries = build()?;
    for target in chosen {
        fuzz(target, &binaries, length, longest)?;
    }
    Ok(Passed::Done)
}

/// Builds the targets; returns the folder of the programs.
///
/// # Errors
/// What does not build, or a missing C++ compiler.
pub fn build() -> Result<PathBuf, Failure> {
    cpp_compiler()?;
    let said = read(program("rustc").arg("-vV"))?;
    let host = said.lines().find_map(|line| line.strip_prefix("host: ")).unwrap_or("x86_64-unknown-linux-gnu");
    let folder = target().join("fuzz");
    let mut command = cargo();
    command.args(["build", "--quiet", "--release", "--manifest-path", "fuzz/Cargo.toml", "--target", host]);
    run(command.env("RUSTFLAGS", COVERAGE).env("CARGO_TARGET_DIR", &folder))?;
    Ok(folder.join(host).join("release"))
}

/// libFuzzer is C++.
fn cpp_compiler() -> Result<(), Failure> {
    need(|| succeeds(program("c++").arg("--version")), "g++", "fuzzing needs a C++ compiler")
}

fn fuzz(target: &Target, binaries: &Path, length: Length, longest: Option<u32>) -> Result<(), Failure> {
    let place = binaries.ancestors().nth(2).unwrap_or(binaries);
    let (corpus, artifacts) = (place.join("corpus").join(target.name), place.join("artifacts").join(target.name));
    for folder in [&corpus, &artifacts] {
        std::fs::create_dir_all(folder).map_err(|e| Failure::found(format!("{}: {e}", folder.display())))?;
    }
    let seeds = seeds(target);
    if seeds.is_empty() {
        return Err(Failure::found(format!("no seeds for {}: the folders have moved", target.name)));
    }
    for (k, seed) in seeds.iter().enumerate() {
        let sown = std::fs::read(seed).and_then(|bytes| {
            let mut inputs = inputs(&bytes, target.choices).into_iter().enumerate();
            inputs.try_for_each(|(n, input)| std::fs::write(corpus.join(format!("seed-{k}-{n}")), input))
        });
        sown.map_err(|e| Failure::found(format!("{}: {e}", seed.display())))?;
    }
    let mut command = program(binaries.join(target.name));
    command.arg(format!("-max_len={}", longest.unwrap_or(target.longest))).arg(format!("-timeout={HANG}"));
    command.arg(format!("-artifact_prefix={}/", artifacts.display())).arg("-print_final_stats=1");
    if let Some(words) = target.words {
        command.arg(format!("-dict={}", dictionary(words).display()));
    }
    command.arg(match length {
        Length::Runs(runs) => format!("-runs={runs}"),
        Length::Seconds(seconds) => format!("-max_total_time={seconds}"),
    });
    let regressions = root().join("fuzz/regressions").join(target.name);
    command.arg(&corpus);
    if regressions.is_dir() {
        command.arg(&regressions);
    }
    let log = place.join(format!("{}.log", target.name));
    let problem = |e: std::io::Error| Failure::found(format!("{}: {e}", log.display()));
    let status = command.stderr(std::fs::File::create(&log).map_err(problem)?).status();
    let said = std::fs::read(&log).map_err(problem)?;
    let said = String::from_utf8_lossy(&said);
    match status {
        Ok(status) if status.success() => println!("{:<10} {}", target.name, reached(&said)),
        _ => return Err(Failure::found(format!("{}: {}\n{}", target.name, log.display(), end(&said)))),
    }
    Ok(())
}

/// What a file is as inputs: itself, or itself behind each choice.
fn inputs(bytes: &[u8], choices: u8) -> Vec<Vec<u8>> {
    match choices {
        0 => vec![bytes.to_vec()],
        choices => (0..choices).map(|choice| [&[choice], bytes].concat()).collect(),
    }
}

/// The file of a dictionary.
fn dictionary(name: &str) -> PathBuf {
    root().join("fuzz/words").join(name).with_extension("dict")
}

/// What of a target's code its inputs have reached, from what libFuzzer says.
fn reached(said: &str) -> String {
    let number = |behind: &str| {
        let (_, rest) = said.rsplit_once(behind)?;
        rest.trim_start().split(|c: char| !c.is_ascii_digit()).next()?.parse::<u64>().ok()
    };
    let inputs = number("stat::number_of_executed_units:").unwrap_or(0);
    let (edges, all) = (number(" cov: ").unwrap_or(0), number("INFO: Loaded 1 modules   (").unwrap_or(0));
    let percent = (edges * 100).checked_div(all).unwrap_or(0);
    format!("{:>12} inputs, {} of {} edges ({percent} %)", thousands(inputs), thousands(edges), thousands(all))
}

/// The last lines of what was said.
fn end(said: &str) -> String {
    let lines: Vec<&str> = said.lines().collect();
    lines[lines.len().saturating_sub(60)..].join("\n")
}

/// The files a corpus begins with.
fn seeds(target: &Target) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for (folder, endings) in target.seeds {
        gather(&root().join(folder), endings, &mut found);
    }
    found.sort();
    found
}

fn gather(folder: &Path, endings: &[&str], found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        let path = entry.path();
        if path.is_dir() {
            gather(&path, endings, found);
        } else if path.extension().is_some_and(|e| endings.iter().any(|ending| e == *ending)) {
            found.push(path);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_target_has_seeds_and_a_source() {
        for target in &TARGETS {
            assert!(!seeds(target).is_empty(), "{}", target.name);
            assert!(root().join(format!("fuzz/targets/{}.rs", target.name)).is_file(), "{}", target.name);
            let words = target.words.map(|name| std::fs::read_to_string(dictionary(name)).unwrap()).unwrap_or_default();
            // As libFuzzer reads them: other bytes are escaped.
            let is_word =
                |line: &str| line.len() > 2 && line.starts_with('"') && line.ends_with('"') && line.is_ascii();
            for line in words.lines().filter(|line| !line.starts_with('#')) {
                assert!(is_word(line), "{}: {line}", target.name);
            }
        }
    }

    #[test]
    fn the_words_of_a_job_are_all_keys_of_its_schema() {
        let text = |path: &Path| std::fs::read_to_string(path).unwrap();
        let schema: serde_json::Value = serde_json::from_str(&text(&root().join("docs/job.schema.json"))).unwrap();
        let words = text(&dictionary("job"));
        let (mut open, mut keys) = (vec![&schema], 0);
        while let Some(part) = open.pop() {
            match part {
                serde_json::Value::Object(object) => open.extend(object.values()),
                serde_json::Value::Array(array) => open.extend(array),
                _ => (),
            }
            for key in part["properties"].as_object().into_iter().flat_map(serde_json::Map::keys) {
                assert!(words.lines().any(|line| line == format!("\"{key}\"")), "{key}");
                keys += 1;
            }
        }
        assert!(keys > 100, "{keys}");
    }

    #[test]
    fn a_file_is_an_input_for_every_choice() {
        assert_eq!(inputs(b"G0", 0), [b"G0"]);
        assert_eq!(inputs(b"G0", 2), [b"\x00G0", b"\x01G0"]);
    }

    #[test]
    fn what_a_target_reached_is_read_from_its_last_lines() {
        let said = "INFO: Loaded 1 modules   (41234 inline 8-bit counters): 41234 [0x1, 0x2),\n#2 INITED cov: 12 ft: 13 corp: 1/1b\n\
                    #900\tDONE   cov: 20617 ft: 9 corp: 1/1b\nstat::number_of_executed_units: 900\n";
        assert_eq!(reached(said), "         900 inputs, 20,617 of 41,234 edges (50 %)");
        assert_eq!(reached("nothing"), "           0 inputs, 0 of 0 edges (0 %)");
        assert_eq!(end("a\nb"), "a\nb");
    }
}
