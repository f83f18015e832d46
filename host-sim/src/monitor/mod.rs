//! Live views on a terminal: `device monitor` and `hil`.
//!
//! | piece | what it does |
//! |---|---|
//! | [`device`], [`hil`] | what is shown (a model that messages change), how it is drawn, the thread that asks or runs |
//! | [`screen`] | the terminal: raw mode, the other screen, keys, signals; given back on every way out |
//! | [`state`], [`advice`] | the state of a device in words, and what the operator should do |
//! | [`history`], [`trend`] | samples of the last seconds, and their picture |
//! | [`timing`] | how regularly setpoints arrive: a line, and histograms |
//! | [`growth`], [`counts`] | counters with what they grow by, and their table |
//! | [`theme`], [`wording`] | colours that differ for colour-blind eyes too; numbers and times in words |
//!
//! Models and drawing know neither clock nor terminal: time is an argument, the frame is ratatui's, so that the tests look
//! at the same pictures. Nothing is told by colour alone.

mod advice;
mod counts;
mod device;
mod growth;
mod hil;
mod history;
#[cfg(test)]
mod pictures;
mod screen;
mod state;
mod theme;
mod timing;
mod trend;
mod wording;

use std::io::IsTerminal;

pub(crate) use device::{Known, Looked, run as device};
pub(crate) use hil::{Step, View as HilView};

use crate::terminal::Terminal;

/// Whether there is somebody to look on: both ends are a terminal that can place text, and no lines are asked for.
/// (Without a keyboard nobody could leave the view.)
pub(crate) fn wanted(plain: bool, terminal: &Terminal) -> bool {
    let able = std::env::var_os("TERM").is_none_or(|name| name != "dumb");
    !plain && !terminal.json() && able && std::io::stdout().is_terminal() && std::io::stdin().is_terminal()
}
