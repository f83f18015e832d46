//! `truepath hil --update`: what a board with a loader does with updates of its own program, tried over its configuration link.
//!
//! The keys are made for this run. The board ends with the program it was given, twice updated and confirmed, and trusts the key
//! of this run.

use truepath_bench::{BenchError, Board, restart};
use truepath_core::image::{KeyId, Rights};
use truepath_core::link::{Ask, Denial, Item, Reply, UpdateStage, UpdateStatus};
use truepath_core::update::{Label, UpdateError};
use truepath_ground::diagnostics::Failure;
use truepath_job::signing::Signer;

use super::trust::{Tried, TrustReport, access};
use crate::command::firmware::update_of;

/// The one whose firmware is taken, and a stranger.
const SEEDS: [[u8; 32]; 2] = [[0x61; 32], [0x62; 32]];
/// Bytes of a program that does nothing: as many vectors as a Cortex-M7 can have, and a loop.
const IDLE_BYTES: usize = 0x404;

/// Tries everything on a board whose button is held, with the program that it runs, as it lies in the flash.
///
/// # Errors
/// The device took something, refused something, or ran another program than it has to; it has a key.
pub fn run(board: &mut dyn Board, program: &[u8]) -> Result<TrustReport, Failure> {
    let [shop, stranger] = SEEDS.map(|seed| Signer::of_seed(&seed));
    let name = match board.client().ask(Ask::Hello)? {
        Reply::Hello(hello) => Label::of(hello.board).unwrap_or_default(),
        other => return Err(BenchError::Foreign(format!("{other:?}")).into()),
    };
    let elsewhere = Label::of("elsewhere").unwrap_or_default();
    let signed =
        |by: &Signer, board, program: &[u8], counter| update_of(program, by, (board, name_of(counter)), counter);
    let mut tried = Tried::of(board);
    let first = stage(&mut tried, "at first", UpdateStage::Settled, None)?;
    let key = shop.public().id();

    let good = signed(&shop, name, program, 100)?;
    tried.update("an update, no key for firmware", &good, refused(UpdateError::UnknownKey { key }))?;
    let rights = Rights { signs: false, ..Rights::default() };
    tried.ask("a key for firmware", Ask::ProvisionFirmware { key: shop.public(), rights }, Ok(()))?;
    tried.board.use_access(Some(access(&shop)));
    let by_stranger = signed(&stranger, name, program, 100)?;
    let unknown = UpdateError::UnknownKey { key: stranger.public().id() };
    tried.update("signed by a stranger", &by_stranger, refused(unknown))?;
    tried.update("in the name of the key", &renamed(by_stranger, key), refused(UpdateError::Forged { key }))?;
    let other = UpdateError::OtherBoard { found: elsewhere, expected: name };
    tried.update("for another board", &signed(&shop, elsewhere, program, 100)?, refused(other))?;
    tried.ask("none is there to be installed", Ask::Install, Err(Denial::Update(UpdateError::Nothing)))?;
    let mut changed = good.clone();
    if let Some(last) = changed.last_mut() {
        *last ^= 1;
    }
    tried.update("another program behind the head", &changed, refused(UpdateError::Digest))?;

    tried.update("an update", &good, Ok(()))?;
    tried.ask("handed to the loader", Ask::Install, Ok(()))?;
    stage(&mut tried, "handed to the loader", UpdateStage::Installed, None)?;
    restart(tried.board)?;
    stage(&mut tried, "started", UpdateStage::Trial, Some(100))?;
    restart(tried.board)?;
    stage(&mut tried, "not confirmed, and reset", UpdateStage::RolledBack, None)?;
    tried.ask("once more", Ask::Install, Ok(()))?;
    restart(tried.board)?;
    stage(&mut tried, "started once more", UpdateStage::Trial, Some(100))?;
    tried.ask("confirmed", Ask::Confirm, Ok(()))?;
    restart(tried.board)?;
    stage(&mut tried, "confirmed, and reset", UpdateStage::Settled, Some(100))?;

    let idle = idle(program).ok_or_else(|| BenchError::Foreign("the program has no vectors".to_owned()))?;
    tried.update("a program that does nothing", &signed(&shop, name, &idle, 200)?, Ok(()))?;
    tried.ask("handed to the loader", Ask::Install, Ok(()))?;
    restart(tried.board)?;
    stage(&mut tried, "which did not start", UpdateStage::RolledBack, Some(100))?;
    let rolled_back = UpdateError::RolledBack { found: 99, least: 100 };
    tried.update("one that was signed before", &signed(&shop, name, program, 99)?, refused(rolled_back))?;
    tried.update("one that was signed later", &signed(&shop, name, program, 300)?, Ok(()))?;
    tried.ask("handed to the loader", Ask::Install, Ok(()))?;
    restart(tried.board)?;
    tried.ask("confirmed", Ask::Confirm, Ok(()))?;
    restart(tried.board)?;
    let last = stage(&mut tried, "at the end", UpdateStage::Settled, Some(300))?;
    if (first.most, last.least) != (last.most, 300) {
        return Err(BenchError::Differs(format!("{first:?}, and at the end {last:?}")).into());
    }
    Ok(tried.report())
}

impl Tried<'_> {
    /// The whole upload.
    fn update(&mut self, given: &'static str, update: &[u8], expected: Result<(), Denial>) -> Result<(), BenchError> {
        let done = self.board.client().upload(Item::Firmware, update, |_| ()).map(|_| ());
        self.keep(given, done, expected)
    }
}

/// Where an update has to stand, with which counter.
fn stage(
    tried: &mut Tried<'_>,
    when: &str,
    expected: UpdateStage,
    counter: Option<u32>,
) -> Result<UpdateStatus, BenchError> {
    let found = match tried.board.client().ask(Ask::Update)? {
        Reply::Update(status) => status,
        other => return Err(BenchError::Foreign(format!("{other:?}"))),
    };
    if (found.stage, found.running.map(|running| running.counter)) == (expected, counter) {
        return Ok(found);
    }
    Err(BenchError::Differs(format!("{when}: {found:?}, it has to be {expected:?} with counter {counter:?}")))
}

const fn refused(error: UpdateError) -> Result<(), Denial> {
    Err(Denial::Update(error))
}

/// A version for each counter.
fn name_of(counter: u32) -> Label {
    Label::of(&format!("0.0.{counter}")).unwrap_or_default()
}

/// An update in the name of another key.
fn renamed(mut update: Vec<u8>, KeyId(key): KeyId) -> Vec<u8> {
    if let Some(place) = update.get_mut(48..56) {
        place.copy_from_slice(&key);
    }
    update
}

/// A program where another lies, that runs and does nothing: it never feeds the watchdog that the loader has started.
fn idle(program: &[u8]) -> Option<Vec<u8>> {
    let (words, _) = program.as_chunks::<4>();
    let [stack, entry] = [words.first()?, words.get(1)?].map(|word| u32::from_le_bytes(*word));
    // The entry lies in the first sector of the program, which begins at a sector.
    let at = (entry & !0x1_FFFF) + 0x400;
    let mut idle: Vec<u8> = [stack].into_iter().chain([at | 1; 0xFF]).flat_map(u32::to_le_bytes).collect();
    // b .
    idle.extend_from_slice(&[0xFE, 0xE7, 0xFE, 0xE7]);
    (idle.len() == IDLE_BYTES).then_some(idle)
}
