//! `pack` and `unpack`: the story of a part as one file, and as a folder again.

pub(super) mod again;
mod anonymous;
mod gathered;

use std::path::{Path as FilePath, PathBuf};

use clap::Args;
use truepath_ground::diagnostics::{Failure, InputError, Source};
use truepath_ground::output::{OutputFolder, write_file};
use truepath_story::container::{packed, unpacked};
use truepath_story::contents::Story;

use crate::terminal::Terminal;
use again::{Again, again};
use gathered::gathered;

/// What is packed.
#[derive(Clone, Debug, Args)]
pub struct Options {
    /// The folder of the part, or its files and folders: job, program, probe files, and what truepath correct and truepath learn
    /// wrote.
    #[arg(required = true)]
    pub inputs: Vec<PathBuf>,
    /// The pack.
    #[arg(short, long, value_name = "STORY.tpk")]
    pub output: PathBuf,
    /// The probe file of the part that was cut with the last correction, where nothing was learned from it yet.
    #[arg(long, value_name = "FILE")]
    pub cut_again: Option<PathBuf>,
    /// Take names and comments out of program, job and probe files, and make the corrections anew from them.
    #[arg(long)]
    pub anonymous: bool,
    /// Replace an existing file.
    #[arg(long)]
    pub force: bool,
}

/// A pack to be opened.
#[derive(Clone, Debug, Args)]
pub struct UnpackOptions {
    /// What truepath pack wrote.
    pub pack: PathBuf,
    /// A new folder for its files.
    #[arg(short, long, value_name = "DIR")]
    pub output: PathBuf,
}

/// What was packed.
#[derive(Clone, Debug, serde::Serialize)]
pub struct PackSummary {
    /// The file.
    pub pack: PathBuf,
    /// Its size.
    pub bytes: usize,
    /// The files in it.
    pub files: Vec<String>,
    /// Whether names and comments were taken out.
    pub anonymous: bool,
    /// Folders that are in it and cannot be made again.
    pub kept: Vec<String>,
    /// What making the corrections again gave.
    pub again: Again,
}

/// Packs and prints what is in it.
pub(crate) fn main(options: &Options, terminal: &Terminal) -> Result<(), Failure> {
    let summary = terminal.watch("packing", |progress| run(options, progress))?;
    terminal.tell(&summary, || words(&summary))
}

fn words(s: &PackSummary) -> String {
    let mut text = format!("{}: {} files, {} bytes\n", s.pack.display(), s.files.len(), s.bytes);
    s.files.iter().for_each(|name| text += &format!("  {name}\n"));
    s.kept.iter().for_each(|kept| text += &format!("kept, and not made again: {kept}\n"));
    if !s.anonymous {
        text += "names and comments of program, job and probe files are in it; --anonymous takes them out\n";
    }
    text + &s.again.words()
}

/// Packs, and makes every correction again from what was packed: a file that is missing is found now, not by whoever opens it.
///
/// # Errors
/// No story, a file that is missing, what making it again refuses, and a pack that cannot be written.
pub fn run(options: &Options, progress: &mut dyn FnMut(f64)) -> Result<PackSummary, Failure> {
    let mut story = gathered(&options.inputs, options.cut_again.as_deref())?;
    if options.anonymous {
        story = anonymous::anonymous(&story, &mut |share| progress(0.5 * share))?;
    }
    let again = again(&story, &mut |share| progress(0.5 + 0.5 * share))?;
    let bytes = packed(&story)?;
    write_file(&options.output, options.force, &bytes)?;
    Ok(PackSummary {
        pack: options.output.clone(),
        bytes: bytes.len(),
        files: story.files.into_keys().collect(),
        anonymous: story.told.anonymous,
        kept: story.told.kept.into_iter().map(|(folder, why)| format!("{folder}: {why}")).collect(),
        again,
    })
}

/// Reads a pack.
///
/// # Errors
/// A file that cannot be read, and one that is no sound pack.
pub(super) fn read(pack: &FilePath) -> Result<Story, InputError> {
    unpacked(Source::read(pack)?.bytes()).map_err(|error| error.in_file(pack))
}

/// What was unpacked.
#[derive(Clone, Debug, serde::Serialize)]
pub struct UnpackSummary {
    /// The folder.
    pub folder: PathBuf,
    /// Its files.
    pub files: Vec<String>,
    /// The program that packed them, with its version.
    pub by: String,
}

/// Unpacks and prints what came out.
pub(crate) fn unpack(options: &UnpackOptions, terminal: &Terminal) -> Result<(), Failure> {
    let summary = run_unpack(options)?;
    terminal.tell(&summary, || {
        let files: String = summary.files.iter().map(|name| format!("  {name}\n")).collect();
        format!("{}: {} files, packed by {}\n{files}", summary.folder.display(), summary.files.len(), summary.by)
    })
}

/// Unpacks into a new folder, whole or not at all.
///
/// # Errors
/// As when it is read, a folder that is there already, and files that cannot be written.
pub fn run_unpack(options: &UnpackOptions) -> Result<UnpackSummary, Failure> {
    let story = read(&options.pack)?;
    let place = options.output.clone();
    let into = OutputFolder::new(&place)?;
    story.files.iter().try_for_each(|(name, bytes)| into.write(name, bytes))?;
    into.commit()?;
    Ok(UnpackSummary { folder: place, files: story.files.into_keys().collect(), by: story.told.by })
}
