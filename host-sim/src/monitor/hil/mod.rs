//! The live view of `truepath hil`.
//!
//! The run goes on where it was begun and tells of every batch; a thread of its own draws what it was told, ten times a
//! second, from a copy, so that the run never waits for a picture.

mod draw;
mod model;
#[cfg(test)]
mod tests;

use std::io;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use draw::{Ending, draw};
use model::{Model, RoundTrips};
use truepath_bench::{RunStatus, Watch};

use super::screen::{Key, Screen};
use super::theme::Theme;

/// Time between two pictures.
const FRAME: Duration = Duration::from_millis(100);

/// What the run tells.
pub enum Step<'a, 'b> {
    /// Another stage, in words.
    Stage(&'a str),
    /// After a batch.
    Batch(&'a RunStatus<'b>),
}

/// What both threads hold.
struct Shared {
    model: Mutex<Model>,
    over: AtomicBool,
    watch: Arc<Watch>,
}

impl Shared {
    fn model(&self) -> MutexGuard<'_, Model> {
        self.model.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// The view while it is open; given up it gives the terminal back.
pub struct View {
    shared: Arc<Shared>,
    drawer: Option<JoinHandle<io::Result<()>>>,
}

impl View {
    /// Opens the view of a run of `count` setpoints.
    ///
    /// # Errors
    /// The terminal cannot be taken.
    pub fn open(board: String, count: u64) -> io::Result<Self> {
        let screen = Screen::open()?;
        let model = Mutex::new(Model::new(board, count));
        let shared = Arc::new(Shared { model, over: AtomicBool::new(false), watch: Arc::default() });
        let theirs = Arc::clone(&shared);
        let drawer = Some(std::thread::spawn(move || keep_drawing(screen, &theirs)));
        Ok(Self { shared, drawer })
    }
    /// Between the board and those who look on.
    pub fn watch(&self) -> &Arc<Watch> {
        &self.shared.watch
    }
    /// Takes what the run tells.
    pub fn tell(&self, step: &Step<'_, '_>) {
        let mut model = self.shared.model();
        match step {
            Step::Stage(stage) => model.stage = (*stage).to_owned(),
            Step::Batch(status) => model.see(status, self.shared.watch.answered()),
        }
    }
}

impl Drop for View {
    fn drop(&mut self) {
        self.shared.over.store(true, Ordering::Relaxed);
        if let Some(drawer) = self.drawer.take() {
            // Drawing that failed is no reason to fail a run; a panic there has told of itself.
            let _ = drawer.join();
        }
    }
}

/// Draws until the run is over, at least once. When it cannot draw it stops, and the run goes on.
fn keep_drawing(mut screen: Screen, shared: &Shared) -> io::Result<()> {
    let theme = Theme::of_environment();
    let start = Instant::now();
    let mut trips = RoundTrips::new();
    loop {
        let now = start.elapsed();
        let model = {
            let mut model = shared.model();
            model.tick(now, shared.watch.answered());
            model.clone()
        };
        let times = shared.watch.round_trips_ns();
        if let Some(trips) = &mut trips {
            trips.take(&times);
        }
        let ending = if shared.watch.is_stopping() { Ending::Stopping } else { Ending::Regular };
        screen.draw(|frame| draw(frame, &model, trips.as_ref(), ending, now, theme))?;
        if let Some(signal) = screen.signal() {
            screen.end_by(signal);
            return Ok(());
        }
        if shared.over.load(Ordering::Relaxed) {
            return Ok(());
        }
        match screen.key(FRAME)? {
            Some(Key::Leave | Key::Back) if shared.watch.is_stopping() => shared.watch.leave(),
            Some(Key::Leave | Key::Back) => shared.watch.stop(),
            _ => {}
        }
    }
}
