//! Files written whole or not at all, one run at a time, and gone when a signal ends the run.

#[cfg(unix)]
mod interrupted;
mod output_files;
