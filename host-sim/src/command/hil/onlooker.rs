//! Who looks on while a run is under way: the live view on a terminal, otherwise a bar.

use std::sync::Arc;

use truepath_bench::{RunStatus, Watch};

use crate::monitor::{HilView, Step, wanted};
use crate::streams;
use crate::terminal::Terminal;

/// One of them.
pub(super) enum Onlooker {
    /// The view.
    View(HilView),
    /// A bar, and the setpoints that make it full.
    Bar(streams::Bar, u64),
}

/// Steps of the bar.
const STEPS: u64 = 1_000;

impl Onlooker {
    /// For a run of `count` setpoints on a board.
    pub fn new(plain: bool, terminal: &Terminal, board: String, count: u64) -> Self {
        if wanted(plain, terminal) {
            match HilView::open(board, count) {
                Ok(view) => return Self::View(view),
                // A run needs no view.
                Err(error) => terminal.note(&format!("no live view: {error}")),
            }
        }
        Self::Bar(terminal.progress("setpoints", STEPS), count.max(1))
    }
    /// Between the board and the one who looks on.
    pub fn watch(&self) -> Arc<Watch> {
        match self {
            Self::View(view) => Arc::clone(view.watch()),
            Self::Bar(..) => Arc::default(),
        }
    }
    /// The device computes.
    pub fn stage(&self, stage: &str) {
        if let Self::View(view) = self {
            view.tell(&Step::Stage(&format!("the device makes the image: {stage}")));
        }
    }
    /// A batch was compared.
    pub fn batch(&mut self, status: &RunStatus<'_>) {
        match self {
            Self::View(view) => view.tell(&Step::Batch(status)),
            Self::Bar(bar, count) => {
                let share = status.injected.frames as f64 / *count as f64;
                bar.reached((share * STEPS as f64) as u64);
            }
        }
    }
}
