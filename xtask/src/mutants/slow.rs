//! What one build does not hold: cargo-mutants judges it itself, with a build for each. Begun anew it goes on where it was, but for what
//! survived, as the tests may have become better. Mutants of fields it runs whatever names it is given.

use super::mutant::{End, Mutant};
use crate::repository::{cargo, lines, make_folder, target};
use crate::step::Failure;

/// Has the mutants judged that have not ended.
///
/// # Errors
/// When cargo-mutants cannot.
pub fn judge(folder: &str, package: &str, mutants: &[Mutant], ends: &mut [Option<End>]) -> Result<(), Failure> {
    let open: Vec<&Mutant> =
        mutants.iter().zip(&*ends).filter(|(_, end)| end.is_none()).map(|(mutant, _)| mutant).collect();
    if open.is_empty() {
        return Ok(());
    }
    let out = target().join("mutants").join(folder.replace('/', "-"));
    make_folder(&out)?;
    let mut command = cargo();
    command
        .args(["mutants", "--iterate", "--package", package, "--file"])
        .arg(format!("{folder}/**"))
        .arg("--output")
        .arg(&out);
    command.args(open.iter().flat_map(|mutant| ["--re".to_owned(), format!("^{}$", exactly(&mutant.name))]));
    // A property that fails is enough: its smallest example is looked for by nobody here, and takes longer than the time-out.
    // Nothing is optimised, and a test's thread has 2 MiB of stack if nobody says otherwise: a computation takes more so.
    command.env("PROPTEST_MAX_SHRINK_ITERS", "0").env("RUST_MIN_STACK", "16777216");
    let status = command.status().map_err(|e| Failure::Missing(format!("cargo mutants: {e}")))?;
    // 2: some survived, 3: some timed out; the files say which.
    if !matches!(status.code(), Some(0 | 2 | 3)) {
        return Err(Failure::found(format!("{status}: cargo mutants; its log is in {}", out.display())));
    }
    for (file, end) in RESULTS {
        for line in lines(&out.join("mutants.out").join(file)).unwrap_or_default() {
            let ended = mutants.iter().position(|mutant| mutant.name == line);
            ended.into_iter().for_each(|index| ends[index] = Some(end));
        }
    }
    Ok(())
}

/// The files in which cargo-mutants lists what it has judged.
const RESULTS: [(&str, End); 5] = [
    ("previously_caught.txt", End::Killed),
    ("caught.txt", End::Killed),
    ("missed.txt", End::Survived),
    ("unviable.txt", End::Unviable),
    ("timeout.txt", End::TimedOut),
];

/// The regular expression of a text alone.
fn exactly(text: &str) -> String {
    let escaped = |c: char| if r"\.+*?()|[]{}^$".contains(c) { format!("\\{c}") } else { c.to_string() };
    text.chars().map(escaped).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_is_an_expression_of_itself_alone() {
        assert_eq!(exactly("a.rs:1: replace + -> [b]"), r"a\.rs:1: replace \+ -> \[b\]");
    }
}
