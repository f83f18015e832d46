//! The commands of Truepath for Python: what the package `truepath` (in `python/` beside this) calls.
//!
//! Every function takes the words of a command line and calls what the command itself calls, so files and numbers are those of
//! the command, byte for byte; there is no second implementation of anything here. Arrays, objects and warnings are made from
//! the files by the Python part.
//!
//! While a command works other threads of Python run, and Ctrl-C is heard. What goes wrong is a `TruepathError`, a panic too.

mod error;
mod words;
mod work;

/// The extension module.
#[pyo3::pymodule]
mod _truepath {
    use std::ffi::OsString;
    use std::path::PathBuf;

    use pyo3::prelude::*;
    use truepath::command;
    use truepath_ground::diagnostics::Failure;
    use truepath_ground::output::OutputFolder;
    use truepath_job::job::JobFile;

    #[pymodule_export]
    use crate::error::TruepathError;
    use crate::error::raised;
    use crate::words::options;
    use crate::work::{Given, done};

    #[pymodule_export]
    #[allow(non_upper_case_globals, reason = "the name that Python has for it")]
    const __version__: &str = env!("CARGO_PKG_VERSION");

    /// What a job names as its program; None where it does not.
    #[pyfunction]
    fn program_name(toml: &str) -> Option<String> {
        toml.parse::<toml::Table>().ok()?.get("program")?.as_str().map(str::to_owned)
    }

    /// Reads a job and its program; the program's path.
    #[pyfunction]
    fn read(py: Python<'_>, job: PathBuf, hidden: Vec<PathBuf>) -> PyResult<PathBuf> {
        let read = || -> Result<PathBuf, Failure> {
            let job = JobFile::read(&job)?;
            job.read_program()?;
            Ok(job.program)
        };
        read().map_err(|failure| raised(py, failure, &hidden))
    }

    /// Plans, and writes what `truepath plan` writes.
    #[pyfunction]
    fn plan(py: Python<'_>, words: Vec<OsString>, given: Given<'_>) -> PyResult<()> {
        let mut options: command::plan::Options =
            options(words).map_err(|failure| raised(py, failure, &given.hidden))?;
        options.probe_flags.millimetres = given.millimetres;
        done(py, given, move |progress| command::plan::run(&options, progress).map(drop))
    }

    /// Puts the part of a folder into a store, as the command `by` does; a sentence for each history.
    #[pyfunction]
    fn keep(py: Python<'_>, job: PathBuf, store: String, folder: PathBuf, by: &str) -> PyResult<Vec<String>> {
        let by = if by == "learn" { "learn" } else { "correct" };
        let kept = py.detach(|| command::store::kept((&job, Some(&store)), &folder, by));
        kept.map_err(|failure| raised(py, failure, &[]))
    }

    /// Corrects, and writes what `truepath correct` writes.
    #[pyfunction]
    fn correct(py: Python<'_>, words: Vec<OsString>, given: Given<'_>) -> PyResult<()> {
        let mut options: command::correct::Options =
            options(words).map_err(|failure| raised(py, failure, &given.hidden))?;
        options.said.probe.millimetres = given.millimetres;
        done(py, given, move |progress| command::correct::run(&options, progress).map(drop))
    }

    /// Learns, and writes what `truepath learn` writes.
    #[pyfunction]
    fn learn(py: Python<'_>, words: Vec<OsString>, given: Given<'_>) -> PyResult<()> {
        let mut options: command::learn::Options =
            options(words).map_err(|failure| raised(py, failure, &given.hidden))?;
        options.said.probe.millimetres = given.millimetres;
        done(py, given, move |progress| match command::learn::of_planned(&options) {
            true => command::learn::run_planned(&options, progress).map(drop),
            false => command::learn::run(&options, progress).map(drop),
        })
    }

    /// Simulates, and writes what `truepath simulate` writes.
    #[pyfunction]
    fn simulate(py: Python<'_>, words: Vec<OsString>, given: Given<'_>) -> PyResult<()> {
        let options: command::simulate::Options =
            options(words).map_err(|failure| raised(py, failure, &given.hidden))?;
        done(py, given, move |_| command::simulate::run(&options).map(drop))
    }

    /// What `truepath inspect --json` prints.
    #[pyfunction]
    fn inspect(py: Python<'_>, words: Vec<OsString>, given: Given<'_>) -> PyResult<String> {
        let mut options: command::inspect::Options =
            options(words).map_err(|failure| raised(py, failure, &given.hidden))?;
        options.said.probe.millimetres = given.millimetres;
        done(py, given, move |_| text(&command::inspect::run(&options)?))
    }

    /// Machine and material as JSON, from the words of `correct`; nothing is written.
    #[pyfunction]
    fn identify(py: Python<'_>, words: Vec<OsString>, given: Given<'_>) -> PyResult<String> {
        let mut options: command::correct::Options =
            options(words).map_err(|failure| raised(py, failure, &given.hidden))?;
        options.said.probe.millimetres = given.millimetres;
        done(py, given, move |progress| text(&command::correct::identify(&options, progress)?))
    }

    /// Writes what `truepath demo` writes.
    #[pyfunction]
    fn demo(py: Python<'_>, words: Vec<OsString>, given: Given<'_>) -> PyResult<()> {
        let options: command::demo::Options = options(words).map_err(|failure| raised(py, failure, &given.hidden))?;
        done(py, given, move |progress| command::demo::run(&options, progress).map(drop))
    }

    /// Writes the files of a correction or of a plan into a folder, whole or not at all.
    #[pyfunction]
    fn save(py: Python<'_>, folder: PathBuf, files: Vec<(String, Vec<u8>)>, force: bool) -> PyResult<()> {
        let write = || -> Result<(), Failure> {
            let is_plan = files.iter().any(|(name, _)| name == command::plan::PROGRAM);
            let names = if is_plan { command::plan::FILES } else { command::correct::FILES };
            let folder = OutputFolder::create(&folder, force, names)?;
            files.iter().try_for_each(|(name, bytes)| folder.write(name, bytes))?;
            Ok(folder.commit()?)
        };
        write().map_err(|failure| raised(py, failure, &[]))
    }

    fn text(value: &impl serde::Serialize) -> Result<String, Failure> {
        serde_json::to_string(value).map_err(|e| Failure::Internal(format!("JSON: {e}")))
    }
}
