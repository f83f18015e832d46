//! `truepath completions` and `truepath man`: what shells and `man` need, made from the command line itself.

use std::path::PathBuf;

use clap::{Args, Command};
use clap_complete::Shell;
use truepath_ground::diagnostics::Failure;
use truepath_ground::output::OutputFolder;

use crate::streams::write_out;

/// For which shell.
#[derive(Debug, Args)]
pub struct CompletionsOptions {
    /// The shell.
    shell: Shell,
}

/// Where the pages go.
#[derive(Debug, Args)]
pub struct ManOptions {
    /// Folder for the pages.
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    /// Replace the files of an earlier run.
    #[arg(long)]
    force: bool,
}

/// Prints the completions.
pub(crate) fn completions(options: &CompletionsOptions, mut command: Command) -> Result<(), Failure> {
    let mut text = Vec::new();
    clap_complete::generate(options.shell, &mut command, "truepath", &mut text);
    write_out(&text)
}

/// Writes the pages: `truepath.1`, and `truepath-COMMAND.1` of each command.
pub(crate) fn pages(options: &ManOptions, mut command: Command) -> Result<(), Failure> {
    command.build();
    let folder = OutputFolder::create(&options.output, options.force, &["*truepath*"])?;
    write_page(&folder, &command)?;
    for sub in command.get_subcommands().filter(|sub| sub.get_name() != "help") {
        write_page(&folder, sub)?;
    }
    Ok(folder.commit()?)
}

fn write_page(folder: &OutputFolder, command: &Command) -> Result<(), Failure> {
    // Of a command it is `truepath-COMMAND`.
    let name = format!("{}.1", command.get_display_name().unwrap_or(command.get_name()));
    let mut page = Vec::new();
    let written = clap_mangen::Man::new(command.clone()).render(&mut page);
    written.map_err(|e| Failure::Internal(format!("{name}: {e}")))?;
    Ok(folder.write(&name, &page)?)
}
