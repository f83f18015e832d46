//! `truepath store`: the parts of a shop in one place.

pub(super) mod believe;
mod chosen;
pub(super) mod keep;
mod words;

use std::path::{Path as FilePath, PathBuf};

use clap::{Args, Subcommand};
use truepath_correction::learning::Facts;
use truepath_ground::diagnostics::{Failure, InputError};
use truepath_ground::output::OutputFolder;
use truepath_job::job::{JobFile, StoreNames};
use truepath_job::pass::Pass;
use truepath_store::codes::{O005, O006};
use truepath_store::{Added, Choice, Migrated, PartFolder, Place, Setup, Store};

use self::chosen::place;
pub use self::keep::kept;
use self::words::{Exported, Imported};
use super::correction_files::{CONTOURS, HISTORY, contour_place};
use crate::terminal::Terminal;

/// What is done with a store.
#[derive(Clone, Debug, Args)]
pub struct Options {
    /// The store: a file, or postgres://user@host/database; otherwise TRUEPATH_STORE, then the one that the job names.
    #[arg(long, global = true, value_name = "PATH|URL")]
    store: Option<String>,
    #[command(subcommand)]
    task: Task,
}

#[derive(Clone, Debug, Subcommand)]
enum Task {
    /// Makes a store; one that is there stays as it is.
    Init {
        /// Also make the roles of a server: truepath_reader, truepath_operator, truepath_engineer.
        #[arg(long)]
        roles: bool,
    },
    /// What is in it: machines, cutters, jobs, parts, readings, and the last parts.
    Status {
        /// How many of the last parts are listed.
        #[arg(long, value_name = "N", default_value_t = 10, value_parser = clap::value_parser!(u32).range(0..=10_000))]
        last: u32,
        /// Read all of it: pages, counters, every history against its checksum.
        #[arg(long)]
        check: bool,
    },
    /// Puts parts in that truepath correct and truepath learn have written; a part that is in it stays as it is.
    Import {
        /// Folders with history.json, or folders above them.
        #[arg(required = true, value_name = "FOLDER")]
        folders: Vec<PathBuf>,
        /// What they were cut on, with and from.
        #[command(flatten)]
        names: StoreNames,
    },
    /// Writes history.json of a job as it was, byte for byte.
    Export {
        /// The job, for the newest history of it, or the number of a history as status lists them.
        #[arg(value_name = "JOB|NUMBER")]
        what: String,
        /// Folder for history.json; of several contours one for each in it.
        #[arg(short, long, value_name = "DIR")]
        output: PathBuf,
        /// Replace the files of an earlier run.
        #[arg(long)]
        force: bool,
    },
    /// Brings a store up to the schema of this program; make a backup before.
    Migrate,
}

/// Does it and prints what came of it.
pub(crate) fn main(options: &Options, terminal: &Terminal) -> Result<(), Failure> {
    let given = options.store.as_deref();
    match &options.task {
        Task::Init { roles } => {
            let place = place(given, None)?;
            made(&place, Store::init(&place, *roles)?, terminal)
        }
        Task::Migrate => {
            let place = place(given, None)?;
            made(&place, Store::migrate(&place)?, terminal)
        }
        Task::Status { last, check } => {
            let mut store = Store::open(&place(given, None)?)?;
            if *check {
                let histories = terminal.watch("checking", |_| store.check())?;
                terminal.note(&format!("{histories} histories are as they were stored"));
            }
            let status = store.status(*last)?;
            terminal.tell(&status, || words::status(&status))
        }
        Task::Import { folders, names } => {
            let imported = terminal
                .watch("importing", |progress| import(&place(given, None)?, folders, names, (terminal, progress)))?;
            terminal.tell(&imported, || words::imported(&imported))
        }
        Task::Export { what, output, force } => {
            let written = export(given, what, output, *force)?;
            terminal.tell(&written, || words::exported(&written))
        }
    }
}

fn made(place: &Place, done: Migrated, terminal: &Terminal) -> Result<(), Failure> {
    let told = serde_json::json!({ "store": place.to_string(), "before": done.before, "schema_version": done.version });
    terminal.tell(&told, || words::made(place, done))
}

/// Puts every part of some folders in, each in a transaction of its own. A folder that cannot be read is told, and the others go
/// in all the same.
fn import(
    place: &Place,
    folders: &[PathBuf],
    names: &StoreNames,
    (terminal, progress): (&Terminal, &mut dyn FnMut(f64)),
) -> Result<Imported, Failure> {
    let folders = PartFolder::every(folders)?;
    let setup = Setup { names: names.clone(), by: "store import", ..Setup::default() };
    let mut store = Store::open(place)?;
    let mut all: Vec<Added> = Vec::new();
    let mut wrong = Vec::new();
    for (k, folder) in folders.iter().enumerate() {
        match PartFolder::read(folder) {
            Ok(Some(part)) => all.extend(store.add(&part, &setup)?),
            Ok(None) => (),
            Err(error) => {
                terminal.warn(&format!("left out: {error}"));
                wrong.push(folder);
            }
        }
        progress((k + 1) as f64 / folders.len() as f64);
    }
    if let (Some(first), true) = (wrong.first(), wrong.len() == folders.len()) {
        let found = format!("none of {} folders can be read, {} the first", folders.len(), first.display());
        return Err(O005.error(found, "a history that can be read").into());
    }
    Ok(Imported {
        store: place.to_string(),
        folders: folders.len() - wrong.len(),
        histories: all.len(),
        known: all.iter().filter(|one| one.known).count(),
        new_parts: all.iter().map(|one| one.new_parts).sum(),
        new_readings: all.iter().map(|one| one.new_readings).sum(),
    })
}

/// Writes the history of a number, or the newest of every contour of a job.
fn export(given: Option<&str>, what: &str, output: &FilePath, force: bool) -> Result<Vec<Exported>, Failure> {
    let (numbers, mut store) = match what.parse::<i64>() {
        Ok(number) => (vec![(number, String::new())], Store::open(&place(given, None)?)?),
        Err(_) => {
            let job = JobFile::read(FilePath::new(what))?;
            let mut store = Store::open(&place(given, Some(&job))?)?;
            (newest(&mut store, job, what)?, store)
        }
    };
    let folder = OutputFolder::create(output, force, &[HISTORY, CONTOURS])?;
    let mut written = Vec::new();
    for (history, place) in numbers {
        let name = format!("{place}{HISTORY}");
        folder.write(&name, &store.history(history)?)?;
        written.push(Exported { history, file: output.join(name) });
    }
    folder.commit()?;
    Ok(written)
}

/// The newest history of every contour of a job that has one, with its place below the folder.
fn newest(store: &mut Store, job: JobFile, what: &str) -> Result<Vec<(i64, String)>, Failure> {
    let walls = Pass::every(job)?;
    let several = walls.len() > 1;
    let mut numbers = Vec::new();
    for pass in &walls {
        let choices = store.newest(&Facts::of(pass))?;
        match &choices[..] {
            [] => (),
            [only] => numbers.push((only.history, contour_place(pass, several))),
            many => {
                let of = |one: &Choice| format!("{} (part {}, stored {})", one.history, one.last_part, one.stored);
                let list: Vec<String> = many.iter().map(of).collect();
                let found = format!("{what} has several histories: {}", list.join(", "));
                return Err(O006.error(found, "one of these numbers").in_file(FilePath::new(what)).into());
            }
        }
    }
    if numbers.is_empty() {
        let found = format!("no part of {what} is in the store");
        let help = "import its folder with truepath store import; a changed program, tool or cut is another job";
        return Err(InputError::new(O006, found, "a job with parts", help).in_file(FilePath::new(what)).into());
    }
    Ok(numbers)
}
