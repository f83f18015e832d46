//! The live view of `truepath device monitor`.
//!
//! One thread asks ([`asker`]), this one draws and listens to the keys. While somebody looks on, a device that stops
//! answering is no end: the view says since when, and tries on. Who leaves it then gets the error.

mod asker;
mod compact;
mod draw;
mod model;
#[cfg(test)]
mod tests;
mod texts;

use std::sync::mpsc::{TryRecvError, channel};
use std::time::{Duration, Instant};

use asker::{Asker, Told};
use model::ViewModel;
use truepath_bench::{BenchError, Client, Wire};
use truepath_ground::diagnostics::Failure;

use super::screen::Screen;
use super::theme::Theme;
use super::wording::time;

pub use model::Known;

/// Time between two pictures.
const FRAME: Duration = Duration::from_millis(100);
/// The device is looked at so often at least, so that a silence is noticed.
const SELDOM: Duration = Duration::from_secs(1);

/// What is looked at.
pub struct Looked<R> {
    /// Name of the port.
    pub port: String,
    /// Makes a new connection.
    pub reopen: R,
    /// Time between two looks.
    pub every: Duration,
    /// How long; otherwise until somebody leaves.
    pub end: Option<Duration>,
    /// The image that should be active.
    pub known: Option<Known>,
}

/// Shows a device until somebody leaves.
///
/// # Errors
/// The device does not answer when the view is left; it is of another version; the terminal fails.
pub fn run<W: Wire + Send + 'static, R>(client: Client<W>, looked: Looked<R>) -> Result<(), Failure>
where
    R: FnMut() -> Result<Client<W>, BenchError> + Send + 'static,
{
    let broken = |e: std::io::Error| Failure::Internal(format!("terminal: {e}"));
    let mut screen = Screen::open().map_err(broken)?;
    let theme = Theme::of_environment();
    let start = Instant::now();
    let every = looked.every.min(SELDOM);
    let mut model = ViewModel::new(looked.port, every, looked.known);
    let (tell, told) = channel();
    let asker = Asker { client: Some(client), reopen: looked.reopen, every, start };
    // It ends when nobody listens; a question that is under way is not waited for.
    std::thread::spawn(move || asker.run(&tell));
    while looked.end.is_none_or(|end| start.elapsed() < end) {
        loop {
            match told.try_recv() {
                Ok(Told::News(message)) => model.update(message),
                Ok(Told::End(error)) => return Err(error.into()),
                Err(TryRecvError::Empty) => break,
                Err(TryRecvError::Disconnected) => return Err(Failure::Internal("the questions ended".to_owned())),
            }
        }
        screen.draw(|frame| draw::draw(frame, &model, start.elapsed(), theme)).map_err(broken)?;
        if let Some(signal) = screen.signal() {
            screen.end_by(signal);
            return Ok(());
        }
        if screen.key(FRAME).map_err(broken)?.is_some_and(|key| model.press(key, start.elapsed())) {
            break;
        }
    }
    drop(screen);
    match model.lost_for(start.elapsed()) {
        Some(since) => {
            let why = model.failure().unwrap_or("no answer");
            Err(BenchError::Silent(format!("for {} when the view was left; {why}", time(since))).into())
        }
        None => Ok(()),
    }
}
