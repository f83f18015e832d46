//! `truepath key`: the keys that sign images.

use std::io::Write;
use std::path::{Path, PathBuf};

use clap::{Args, Subcommand};
use truepath_ground::codes::F003;
use truepath_ground::diagnostics::{Failure, InputError};
use truepath_ground::output::write_file;
use truepath_job::signing::{Signer, public_text, read_public};

use crate::terminal::Terminal;

/// What is done with keys.
#[derive(Debug, Args)]
pub struct Options {
    #[command(subcommand)]
    task: Task,
}

#[derive(Debug, Subcommand)]
enum Task {
    /// Makes a pair: the private key in FILE, for its owner alone, the public one in FILE.pub.
    New {
        /// The private key; it is never replaced.
        file: PathBuf,
    },
    /// The public key of a private one, or those of a file of public keys.
    Show {
        /// A private key, or a file of public ones.
        file: PathBuf,
    },
}

/// Makes or shows keys.
pub(crate) fn main(options: &Options, terminal: &Terminal) -> Result<(), Failure> {
    match &options.task {
        Task::New { file } => {
            let mut seed = [0; 32];
            getrandom::fill(&mut seed).map_err(|e| Failure::Internal(format!("no random numbers: {e}")))?;
            let signer = Signer::of_seed(&seed);
            let key = signer.public();
            let public = with_suffix(file);
            write_private(file, &signer.text())?;
            write_file(&public, false, public_text(&key).as_bytes())?;
            let id = key.id().to_string();
            terminal.tell(&serde_json::json!({ "key": id, "private": file, "public": public }), || {
                format!(
                    "key {id}\nprivate, for truepath correct --sign: {}\npublic, for devices: {}\n",
                    file.display(),
                    public.display()
                )
            })
        }
        Task::Show { file } => {
            let keys = match read_public(file) {
                // A private key: its public half.
                Err(error) if error.code() == "K021" => vec![Signer::read(file, &[])?.public()],
                other => other?,
            };
            let ids: Vec<_> = keys.iter().map(|key| key.id().to_string()).collect();
            terminal.tell(&serde_json::json!({ "keys": ids }), || keys.iter().map(public_text).collect())
        }
    }
}

fn with_suffix(file: &Path) -> PathBuf {
    let mut name = file.as_os_str().to_owned();
    name.push(".pub");
    PathBuf::from(name)
}

/// A new file that nobody else could ever read, not even while it was written.
fn write_private(path: &Path, text: &str) -> Result<(), InputError> {
    let mut open = std::fs::OpenOptions::new();
    open.write(true).create_new(true);
    #[cfg(unix)]
    std::os::unix::fs::OpenOptionsExt::mode(&mut open, 0o600);
    let written = open.open(path).and_then(|mut file| file.write_all(text.as_bytes()).and_then(|()| file.sync_all()));
    written.map_err(|error| match error.kind() {
        std::io::ErrorKind::AlreadyExists => {
            let help = "name another file: a private key is never replaced, images signed with it would be lost";
            InputError::new(F003, format!("{} exists", path.display()), "the name of a new file", help).in_file(path)
        }
        _ => InputError::unwritable(path, &error),
    })
}
