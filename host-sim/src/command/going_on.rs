//! What to do next, with the command to type, at the end of what a command prints.

use std::path::Path as FilePath;

use truepath_correction::summary::CorrectSummary;

/// What comes after a correction: a part, its touches, the next correction.
pub(super) fn after_correction(s: &CorrectSummary, job: &FilePath, output: &FilePath) -> String {
    let with = match &s.corrected_program {
        Some(name) => shown(&output.join(name)),
        None => format!("the coprocessor and its image in {}", shown(output)),
    };
    format!(
        "next: mill a new part with {with}, touch it, and see what is left:\n  truepath learn {} --probe FILE --from {} -o DIR\n",
        shown(job),
        shown(output)
    )
}

/// What comes after looking at readings: the correction they ask for.
pub(super) fn correct(job: &FilePath, probe: Option<&FilePath>, dimensions: Option<&FilePath>) -> String {
    let mut words = format!("next: truepath correct {}", shown(job));
    for (option, file) in [("--probe", probe), ("--dimensions", dimensions)] {
        if let Some(file) = file {
            words += &format!(" {option} {}", shown(file));
        }
    }
    words + " -o DIR\n"
}

/// What comes after a program that touches a wall.
pub(super) fn after_verification(job: &FilePath, program: &FilePath) -> String {
    format!(
        "next: run {} in single block first, and give its results to\n  truepath correct {} --probe FILE -o DIR\n",
        shown(program),
        shown(job)
    )
}

/// A path as a shell takes it.
pub(super) fn shown(path: &FilePath) -> String {
    let text = path.display().to_string();
    let plain = |c: char| c.is_alphanumeric() || "/._-+,:@%=\\".contains(c);
    if !text.is_empty() && text.chars().all(plain) { text } else { format!("\"{}\"", text.replace('"', "\\\"")) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_with_blanks_is_quoted() {
        assert_eq!(shown(FilePath::new("a b/job.toml")), "\"a b/job.toml\"");
        assert_eq!(shown(FilePath::new("out/job-1.toml")), "out/job-1.toml");
    }

    #[test]
    fn what_was_read_stands_in_the_command() {
        let said = correct(FilePath::new("job.toml"), Some(FilePath::new("p.txt")), Some(FilePath::new("w.toml")));
        assert_eq!(said, "next: truepath correct job.toml --probe p.txt --dimensions w.toml -o DIR\n");
    }
}
