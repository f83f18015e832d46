//! What to do next, with the command to type: at the end of what a command prints, and on its page.

use std::fmt;
use std::path::Path as FilePath;

use serde::Serialize;
use truepath_correction::summary::CorrectSummary;

/// The next step.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Next {
    /// In words, up to the command; may be empty.
    pub what: String,
    /// What to type. Words in capitals are the user's to fill in.
    pub command: String,
}

impl fmt::Display for Next {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.what.is_empty() {
            return writeln!(f, "next: {}", self.command);
        }
        writeln!(f, "next: {}\n  {}", self.what, self.command)
    }
}

/// What comes after a correction: a part, its touches, the next correction. Without a folder, as a page has none, THIS_FOLDER stands for it.
pub fn after_correction(s: &CorrectSummary, job: &FilePath, output: Option<&FilePath>) -> Next {
    let folder = output.map_or_else(|| "THIS_FOLDER".to_owned(), shown);
    let with = match (&s.corrected_program, output) {
        (Some(name), Some(output)) => shown(&output.join(name)),
        (Some(name), None) => shown(FilePath::new(name)),
        (None, Some(_)) => format!("the coprocessor and its image in {folder}"),
        (None, None) => "the coprocessor and its image".to_owned(),
    };
    Next {
        what: format!("mill a new part with {with}, touch it, and see what is left:"),
        command: format!("truepath learn {} --probe FILE --from {folder} -o DIR", shown(job)),
    }
}

/// What comes after looking at readings: the correction they ask for.
pub fn correct(job: &FilePath, probe: Option<&FilePath>, dimensions: Option<&FilePath>) -> Next {
    let mut command = format!("truepath correct {}", shown(job));
    for (option, file) in [("--probe", probe), ("--dimensions", dimensions)] {
        if let Some(file) = file {
            command += &format!(" {option} {}", shown(file));
        }
    }
    Next { what: String::new(), command: command + " -o DIR" }
}

/// What comes after a program that touches a wall.
pub fn after_verification(job: &FilePath, program: &FilePath) -> Next {
    Next {
        what: format!("run {} in single block first, and give its results to", shown(program)),
        command: format!("truepath correct {} --probe FILE -o DIR", shown(job)),
    }
}

/// What comes after a pass that was only computed: a part, and a program that touches it.
pub fn after_simulation(job: &FilePath) -> Next {
    Next {
        what: "mill the part as it is, and touch it where that tells most:".to_owned(),
        command: format!("truepath probe {} --dialect DIALECT -o verify.nc", shown(job)),
    }
}

/// What comes after a demonstration.
pub fn after_demonstration() -> Next {
    Next { what: "try it with a program of your own:".to_owned(), command: "truepath init PROGRAM".to_owned() }
}

/// A path as a shell takes it.
pub fn shown(path: &FilePath) -> String {
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
        assert_eq!(said.to_string(), "next: truepath correct job.toml --probe p.txt --dimensions w.toml -o DIR\n");
    }

    #[test]
    fn a_step_in_words_has_its_command_on_a_line_of_its_own() {
        let said = after_verification(FilePath::new("job.toml"), FilePath::new("v.nc")).to_string();
        assert_eq!(
            said,
            "next: run v.nc in single block first, and give its results to\n  truepath correct job.toml --probe FILE -o DIR\n"
        );
    }
}
