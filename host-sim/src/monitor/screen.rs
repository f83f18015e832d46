//! The terminal of a view: raw mode, the other screen, keys, signals.
//!
//! It is given back on every way out: at the end, on an error, in a panic before its text is printed, and by the signals
//! that end a process (SIGTERM, SIGHUP, SIGINT, SIGQUIT), after which the process ends by that signal as ever. Ctrl-C
//! arrives as a key. A terminal that is gone shows itself as an error of drawing.

use std::io::{self, Stdout, stdout};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, Once};
use std::time::Duration;

use ratatui::crossterm::cursor::{Hide, Show};
use ratatui::crossterm::event::{self, Event, KeyCode, KeyEvent, KeyEventKind, KeyModifiers};
use ratatui::crossterm::execute;
use ratatui::crossterm::terminal::{
    Clear, ClearType, EnterAlternateScreen, LeaveAlternateScreen, disable_raw_mode, enable_raw_mode,
};
use ratatui::prelude::CrosstermBackend;
use ratatui::{Frame, Terminal};
use truepath_ground::interruption::{self, Watch};

/// What a key asks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Key {
    /// q, Ctrl-C.
    Leave,
    /// Esc: closes what lies over the view, then leaves it.
    Back,
    /// p, space.
    Pause,
    /// c.
    Clear,
    /// ?, h, F1.
    Help,
}

/// Whether the terminal is ours.
static OURS: AtomicBool = AtomicBool::new(false);
/// Held while something is written, so that nothing is drawn into a terminal that was given back.
static WRITING: Mutex<()> = Mutex::new(());

/// The terminal while a view has it.
pub struct Screen {
    terminal: Terminal<CrosstermBackend<Stdout>>,
    signals: Watch,
}

impl Screen {
    /// Takes the terminal.
    ///
    /// # Errors
    /// It has no raw mode, or is gone.
    pub fn open() -> io::Result<Self> {
        give_back_in_a_panic();
        let signals = Watch::begin()?;
        let terminal = Terminal::new(CrosstermBackend::new(stdout()))?;
        OURS.store(true, Ordering::SeqCst);
        let screen = Self { terminal, signals };
        enable_raw_mode()?;
        execute!(stdout(), EnterAlternateScreen, Clear(ClearType::All), Hide)?;
        Ok(screen)
    }
    /// Draws; nothing once the terminal was given back.
    ///
    /// # Errors
    /// The terminal is gone.
    pub fn draw(&mut self, picture: impl FnOnce(&mut Frame<'_>)) -> io::Result<()> {
        let _writing = WRITING.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        if OURS.load(Ordering::SeqCst) {
            self.terminal.draw(picture)?;
        }
        Ok(())
    }
    /// The next key within a time; a change of size ends the wait.
    ///
    /// # Errors
    /// The terminal is gone.
    pub fn key(&mut self, within: Duration) -> io::Result<Option<Key>> {
        if !event::poll(within)? {
            return Ok(None);
        }
        Ok(match event::read()? {
            Event::Key(key) => meaning(&key),
            _ => None,
        })
    }
    /// The signal that wants the process to end, if one came.
    pub fn signal(&self) -> Option<i32> {
        self.signals.came()
    }
    /// Gives the terminal back and ends the process by a signal.
    pub fn end_by(self, signal: i32) {
        drop(self);
        interruption::end_by(signal);
    }
}

impl Drop for Screen {
    fn drop(&mut self) {
        let _writing = WRITING.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        give_back();
    }
}

/// What a key means; Windows reports releases as well.
fn meaning(key: &KeyEvent) -> Option<Key> {
    if key.kind == KeyEventKind::Release {
        return None;
    }
    match key.code {
        KeyCode::Char('c') if key.modifiers.contains(KeyModifiers::CONTROL) => Some(Key::Leave),
        KeyCode::Char('q' | 'Q') => Some(Key::Leave),
        KeyCode::Esc => Some(Key::Back),
        KeyCode::Char('p' | 'P' | ' ') => Some(Key::Pause),
        KeyCode::Char('c' | 'C') => Some(Key::Clear),
        KeyCode::Char('?' | 'h' | 'H') | KeyCode::F(1) => Some(Key::Help),
        _ => None,
    }
}

/// Everything as it was; once. There is nobody left to tell of an error.
fn give_back() {
    if OURS.swap(false, Ordering::SeqCst) {
        let _ = execute!(stdout(), LeaveAlternateScreen, Show);
        let _ = disable_raw_mode();
    }
}

/// Before a panic prints its text. The one that panics may be the one that draws, so a drawing that does not end is not
/// waited for.
fn give_back_in_a_panic() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        let before = std::panic::take_hook();
        std::panic::set_hook(Box::new(move |panic| {
            for _ in 0..20 {
                if !OURS.load(Ordering::SeqCst) || WRITING.try_lock().is_ok() {
                    break;
                }
                std::thread::sleep(Duration::from_millis(2));
            }
            give_back();
            before(panic);
        }));
    });
}

#[cfg(all(test, unix))]
mod tests;
