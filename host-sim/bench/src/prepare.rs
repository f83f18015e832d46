//! Brings a board into the state in which a run begins: `Off`, known settings, the image active, counters at zero.

use std::time::Duration;

use truepath_core::image::{FORMAT, SEMANTICS};
use truepath_core::link::{Ask, DeviceSettings, Item, LINK_VERSION, Reply};
use truepath_core::rewrite::{Mode, Reason};

use super::board::{Board, Event};
use super::client::foreign;
use super::error::BenchError;

/// What the device says of itself.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize)]
pub struct Identity {
    /// Name of the board.
    pub board: String,
    /// Version of the firmware.
    pub firmware: String,
    /// Most nodes of an image.
    pub most_nodes: u32,
}

/// Asks who is there.
///
/// # Errors
/// No answer, or firmware of another version of the link, of images, or of their meaning.
pub fn identify(board: &mut dyn Board) -> Result<Identity, BenchError> {
    match board.client().ask(Ask::Hello)? {
        Reply::Hello(hello) => {
            for (what, found, wanted) in [
                ("link", u32::from(hello.link_version), u32::from(LINK_VERSION)),
                ("image format", hello.image_format.into(), FORMAT.into()),
                ("semantics", hello.semantics, SEMANTICS),
            ] {
                if found != wanted {
                    let text = format!("{what} {found}, this program has {wanted}");
                    return Err(BenchError::Foreign(text));
                }
            }
            let (board, firmware) = (hello.board.to_owned(), hello.firmware.to_owned());
            Ok(Identity { board, firmware, most_nodes: hello.most_nodes })
        }
        other => Err(foreign(&other)),
    }
}

/// Prepares a board; gives the settings it had before. `progress` is told the bytes of the image that are there.
///
/// # Errors
/// The device refuses the image or the settings, or does not go to `Off`.
pub fn prepare(
    board: &mut dyn Board,
    image: &[u8],
    settings: &DeviceSettings,
    progress: impl FnMut(u64),
) -> Result<DeviceSettings, BenchError> {
    let before = configure(board, settings)?;
    let mut client = board.client();
    let committed = client.upload(Item::Image, image, progress)?;
    client.done(Ask::Activate { slot: committed.slot, crc: committed.crc })?;
    client.done(Ask::ClearCounters)?;
    Ok(before)
}

/// Brings a board to `Off`, without a past, with these settings; gives those it had before.
///
/// # Errors
/// The device refuses the settings, or does not go to `Off`.
pub fn configure(board: &mut dyn Board, settings: &DeviceSettings) -> Result<DeviceSettings, BenchError> {
    let before = board.client().settings()?;
    to_off(board, before.silence_us)?;
    // Why the last correction ended and where the counting stands stay until a reset; the host's model begins without
    // such a past.
    let status = board.client().status()?;
    if status.reason != Reason::None || status.counters.accepted > 0 {
        restart(board)?;
    }
    // Also when they are the same: a device that was never configured shows those it would use, and arms nothing.
    board.client().done(Ask::Configure(*settings))?;
    Ok(before)
}

/// Brings the device to `Off`: by silence where time is ours, by a reset otherwise.
///
/// # Errors
/// It does not go there.
pub fn to_off(board: &mut dyn Board, silence_us: u32) -> Result<(), BenchError> {
    if board.client().status()?.mode == Mode::Off {
        return Ok(());
    }
    if board.is_stepped() {
        let us = silence_us.saturating_add(silence_us / 10).saturating_add(1_000);
        board.exchange(&[Event::Time(us)])?;
    } else {
        restart(board)?;
    }
    match board.client().status()?.mode {
        Mode::Off => Ok(()),
        mode => Err(BenchError::Silent(format!("it stays in {mode}: does something else send setpoints?"))),
    }
}

/// Resets the device and waits until it answers again.
///
/// # Errors
/// It does not.
pub fn restart(board: &mut dyn Board) -> Result<(), BenchError> {
    board.client().done(Ask::Restart { watchdog: false })?;
    // A board answers before it resets, so what follows at once may still meet the old one.
    if !board.is_stepped() {
        std::thread::sleep(RESET);
    }
    board.client().status().map(|_| ())
}

/// Time a board takes to begin its reset.
const RESET: Duration = Duration::from_millis(500);
