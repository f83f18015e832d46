//! `truepath firmware`: updates of a device's own program.

use std::path::{Path, PathBuf};

use clap::{Args, Subcommand};
use sha2::{Digest, Sha512};
use truepath_core::image::{KeyRing, Rights};
use truepath_core::update::{Label, UPDATE_HEAD_BYTES, UpdateError, UpdateHead};
use truepath_fw::program::PROGRAM_BYTES;
use truepath_ground::diagnostics::{Failure, InputError};
use truepath_ground::output::write_file;
use truepath_job::signing::{Signer, now, read_public};

use super::image::read;
use crate::terminal::Terminal;

/// What is done with updates.
#[derive(Debug, Args)]
pub struct Options {
    #[command(subcommand)]
    task: Task,
}

#[derive(Debug, Subcommand)]
enum Task {
    /// Makes an update of a program, as cargo xtask firmware writes it (.bin).
    Sign {
        /// The program, as it lies in the flash.
        program: PathBuf,
        /// The board it is for, as truepath device info names it.
        #[arg(long, value_name = "BOARD", value_parser = label)]
        board: Label,
        /// Its version.
        #[arg(long, value_name = "VERSION", value_parser = label, default_value = env!("CARGO_PKG_VERSION"))]
        release: Label,
        /// The private key (truepath key new), provisioned with --firmware on the devices that are to take it.
        #[arg(long, value_name = "KEY")]
        key: PathBuf,
        /// Counter of the signature: no device takes one below that of an update it has confirmed. [default: the time in
        /// seconds since 1970]
        #[arg(long, value_name = "N")]
        counter: Option<u32>,
        /// The update.
        #[arg(short, long, value_name = "FILE")]
        output: PathBuf,
        /// Replace the output file if it exists.
        #[arg(long)]
        force: bool,
    },
    /// What an update is for, and whether it is whole: exit code 0, else 1.
    Show {
        /// The update.
        file: PathBuf,
        /// A file of public keys: one of them has to have signed it.
        #[arg(long, value_name = "PUB")]
        key: Option<PathBuf>,
    },
}

/// A board or a version.
fn label(text: &str) -> Result<Label, String> {
    Label::of(text).ok_or_else(|| "1 to 16 printable characters without spaces".to_owned())
}

/// Makes or shows updates.
pub(crate) fn main(options: &Options, terminal: &Terminal) -> Result<(), Failure> {
    match &options.task {
        Task::Sign { program, board, release, key, counter, output, force } => {
            let bytes = read(program)?;
            let signer = Signer::read(key, &[])?;
            let length = u32::try_from(bytes.len()).unwrap_or(u32::MAX);
            if !(1..=PROGRAM_BYTES).contains(&length) {
                return Err(refused(UpdateError::Length { length, most: PROGRAM_BYTES }, program).into());
            }
            let update = update_of(&bytes, &signer, (*board, *release), counter.map_or_else(now, Ok)?)?;
            write_file(output, *force, &update)?;
            let head = Update::of(update, output)?.head;
            terminal.tell(&json(&head, output), || format!("{}: {}\n", words(&head), output.display()))
        }
        Task::Show { file, key } => {
            let update = Update::read(file)?;
            if let Some(path) = key {
                let mut ring = KeyRing::default();
                for key in read_public(path)? {
                    // There is room for the keys of a person; of more, those behind do not count.
                    let _ = ring.add_with(key, Rights { firmware: true, ..Rights::default() });
                }
                let verified = UpdateHead::verified(&update.bytes, &ring, update.head.board, PROGRAM_BYTES);
                verified.map_err(|error| refused(error, file))?;
            }
            terminal.tell(&json(&update.head, file), || words(&update.head) + "\n")
        }
    }
}

/// The update of a program, for a board and with a version.
///
/// # Errors
/// A program of more than 4 GiB.
pub(super) fn update_of(
    program: &[u8],
    signer: &Signer,
    (board, version): (Label, Label),
    counter: u32,
) -> Result<Vec<u8>, Failure> {
    let length = u32::try_from(program.len()).map_err(|e| Failure::Internal(e.to_string()))?;
    let (key, digest) = (signer.public().id(), Sha512::digest(program).into());
    let head = UpdateHead { length, counter, board, version, key, digest };
    Ok([&head.signed(|message| signer.sign(message))[..], program].concat())
}

/// An update of a file, whole.
pub(super) struct Update {
    pub head: UpdateHead,
    bytes: [u8; UPDATE_HEAD_BYTES],
    /// Head and program.
    pub whole: Vec<u8>,
}

impl Update {
    /// Reads one; who signed it is not looked at.
    pub fn read(path: &Path) -> Result<Self, InputError> {
        Self::of(read(path)?, path)
    }
    fn of(whole: Vec<u8>, path: &Path) -> Result<Self, InputError> {
        let bytes = *whole.first_chunk().ok_or_else(|| refused(UpdateError::Format, path))?;
        let head = UpdateHead::read(&bytes).ok_or_else(|| refused(UpdateError::Format, path))?;
        let program = &whole[UPDATE_HEAD_BYTES..];
        if program.len() != head.length as usize || head.digest != <[u8; 64]>::from(Sha512::digest(program)) {
            return Err(refused(UpdateError::Digest, path));
        }
        Ok(Self { head, bytes, whole })
    }
}

fn refused(error: UpdateError, path: &Path) -> InputError {
    let expected = "an update as truepath firmware sign writes it";
    InputError::of_core(error.code(), error.to_string(), expected, error.help()).in_file(path)
}

fn words(head: &UpdateHead) -> String {
    let UpdateHead { length, counter, board, version, key, .. } = head;
    format!(
        "firmware {:08x}, version {version} for {board}, {length} bytes, signed with key {key}, counter {counter}",
        head.name()
    )
}

fn json(head: &UpdateHead, file: &Path) -> serde_json::Value {
    serde_json::json!({ "name": format!("{:08x}", head.name()), "version": head.version.text(),
        "board": head.board.text(), "length": head.length, "key": head.key.to_string(), "counter": head.counter, "file": file })
}
