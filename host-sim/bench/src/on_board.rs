//! The on-board correction as a client sees it: program, job and probe log up, `Compute`, and what came of it.

use std::time::{Duration, Instant};

use truepath_core::link::{Ask, ComputeFailure, Computed, Item, Progress, Reply, Stage};

use super::client::{Client, foreign};
use super::error::BenchError;
use super::wire::Wire;

/// What the device needs to make an image.
#[derive(Clone, Copy, Debug)]
pub struct Ingredients<'a> {
    /// The program.
    pub program: &'a [u8],
    /// The job, in its compact form.
    pub job: &'a [u8],
    /// The probe log.
    pub probe: &'a [u8],
}

/// Sends the ingredients and starts the computation.
///
/// # Errors
/// The device refuses.
pub fn begin<W: Wire>(client: &mut Client<W>, ingredients: &Ingredients<'_>) -> Result<(), BenchError> {
    for (item, bytes) in
        [(Item::Program, ingredients.program), (Item::Job, ingredients.job), (Item::Probe, ingredients.probe)]
    {
        client.upload(item, bytes, |_| ())?;
    }
    client.done(Ask::Compute)
}

/// How far it is; the image once it is made.
///
/// # Errors
/// The computation failed.
pub fn look<W: Wire>(client: &mut Client<W>) -> Result<(Progress, Option<Computed>), BenchError> {
    let reply = client.ask(Ask::Progress)?;
    let Reply::Progress(now) = reply else { return Err(foreign(&reply)) };
    match now.result {
        Some(Ok(computed)) => Ok((now, Some(computed))),
        Some(Err(failure)) => Err(BenchError::Foreign(words(&failure))),
        None => Ok((now, None)),
    }
}

/// Has the device make an image; gives where it lies and the time it took. `progress` is told at each look.
///
/// # Errors
/// The device refuses, fails, or does not come to an end within `patience`.
pub fn compute<W: Wire>(
    client: &mut Client<W>,
    ingredients: &Ingredients<'_>,
    patience: Duration,
    mut progress: impl FnMut(&Progress),
) -> Result<(Computed, Duration), BenchError> {
    begin(client, ingredients)?;
    let start = Instant::now();
    loop {
        let (now, made) = look(client)?;
        progress(&now);
        match made {
            Some(computed) => return Ok((computed, start.elapsed())),
            None if start.elapsed() > patience => return Err(too_long(&now, patience)),
            None => std::thread::sleep(Duration::from_millis(20)),
        }
    }
}

/// It does not come to an end.
pub fn too_long(now: &Progress, patience: Duration) -> BenchError {
    BenchError::Silent(format!("still at {} after {patience:?}", stage(now.stage)))
}

/// A failure as a sentence.
fn words(failure: &ComputeFailure) -> String {
    // The group of the code is the letter of the command line's.
    let letter = b"JGMIW".get(usize::from(failure.code / 1000)).copied().map_or('?', char::from);
    let place = if failure.line > 0 { format!(" at {}:{}", failure.line, failure.column) } else { String::new() };
    format!("the correction failed in {}: {letter}{:03}{place}", stage(failure.stage), failure.code % 1000)
}

/// The name of a stage.
pub fn stage(stage: Stage) -> &'static str {
    match stage {
        Stage::Idle => "nothing",
        Stage::Job => "reading the job",
        Stage::Program => "reading the program",
        Stage::Probe => "reading the probe log",
        Stage::Cut => "engagement and forces",
        Stage::Identify => "identification",
        Stage::Correct => "correction",
        Stage::Write => "writing the image",
        Stage::Ended => "the end",
    }
}
