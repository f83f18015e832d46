//! `truepath device update`: another program for the device, tried and confirmed.

use std::path::Path;
use std::time::{Duration, Instant};

use truepath_bench::{BenchError, Client, Wire};
use truepath_core::link::{Ask, Item, Reply, TRIAL_US, UpdateStage, UpdateStatus};
use truepath_ground::diagnostics::Failure;

use crate::command::firmware::Update;
use crate::terminal::Terminal;

/// How long a loader may take: eleven sectors erased and programmed.
const SWAP: Duration = Duration::from_secs(180);
/// Between two questions to a device that does not answer.
const PAUSE: Duration = Duration::from_millis(200);

/// Where an update stands.
pub fn status<W: Wire>(client: &mut Client<W>) -> Result<UpdateStatus, BenchError> {
    match client.ask(Ask::Update)? {
        Reply::Update(status) => Ok(status),
        other => Err(BenchError::Foreign(format!("{other:?}"))),
    }
}

/// The same in words, on lines of its own.
pub fn words(status: &UpdateStatus) -> String {
    let running = status.running.map_or_else(
        || "a program that came through the debug port".to_owned(),
        |r| format!("firmware {:08x}, version {}, counter {}, signed with key {}", r.name, r.version, r.counter, r.key),
    );
    let minutes = TRIAL_US / 60_000_000;
    let stage = match status.stage {
        UpdateStage::NoLoader => "no loader: no updates over the link".to_owned(),
        UpdateStage::Settled => "no update is under way".to_owned(),
        UpdateStage::Installed => "an update starts with the next reset".to_owned(),
        UpdateStage::Trial => format!(
            "ON TRIAL: without truepath device update --confirm within {minutes} minutes, or with a reset, the program before comes back"
        ),
        UpdateStage::RolledBack => "the last update was not confirmed: this is the program before it".to_owned(),
    };
    format!("{running}\n{stage}\n")
}

/// Sends an update, has it started, and confirms it if it answers as it should; with `trial` it is left unconfirmed.
pub fn run<W: Wire>(client: &mut Client<W>, file: &Path, trial: bool, terminal: &Terminal) -> Result<(), Failure> {
    let update = Update::read(file)?;
    terminal.note("both image slots are erased: upload the images again afterwards");
    let mut bar = terminal.progress("uploading", update.whole.len() as u64);
    client.upload(Item::Firmware, &update.whole, |there| bar.reached(there))?;
    drop(bar);
    client.done(Ask::Install)?;
    client.done(Ask::Restart { watchdog: false })?;
    let after = started(client)?;
    let right = after.stage == UpdateStage::Trial && after.running.is_some_and(|r| r.name == update.head.name());
    if !right {
        let found = format!("the update did not start: {}", words(&after).replace('\n', "; "));
        return Err(BenchError::Differs(found).into());
    }
    // The program answers to what every client asks of it.
    client.ask(Ask::Hello)?;
    client.settings()?;
    client.slots()?;
    if !trial {
        client.done(Ask::Confirm)?;
    }
    let last = status(client)?;
    terminal.tell(&last, || words(&last))
}

/// Waits until the device answers behind the restart.
fn started<W: Wire>(client: &mut Client<W>) -> Result<UpdateStatus, BenchError> {
    let until = Instant::now() + SWAP;
    loop {
        std::thread::sleep(PAUSE);
        match status(client) {
            // It has not begun to restart yet.
            Ok(found) if found.stage == UpdateStage::Installed && Instant::now() < until => {}
            Ok(found) => return Ok(found),
            Err(BenchError::Silent(_)) if Instant::now() < until => {}
            Err(error) => return Err(error),
        }
    }
}
