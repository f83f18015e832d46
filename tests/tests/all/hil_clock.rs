//! The clock of a run: it goes on by at least one tick before every frame, so that a device which watches the rate of its
//! setpoints sees the rate it was told.

use crate::hil_support::{everything, host_board, image, options};
use truepath::command::hil::{Options, Source, run};
use truepath_bench::{BenchError, Board, BulkBoard, Client, Clients, Event, Exchange, InProcess, Wire};

/// A board that looks at the time before every frame.
struct Watched {
    board: BulkBoard<InProcess>,
    tick_us: u32,
    since_frame_us: u32,
    frames: u64,
}

impl Board for Watched {
    fn describe(&self) -> String {
        self.board.describe()
    }
    fn is_stepped(&self) -> bool {
        true
    }
    fn client(&mut self) -> Client<&mut dyn Wire> {
        self.board.client()
    }
    fn clients(&mut self) -> &mut Clients {
        self.board.clients()
    }
    fn exchange(&mut self, events: &[Event]) -> Result<Exchange, BenchError> {
        for event in events {
            match event {
                Event::Time(us) => self.since_frame_us += us,
                Event::Setpoint { .. } => {
                    assert!(
                        self.since_frame_us >= self.tick_us,
                        "{} us after frame {}",
                        self.since_frame_us,
                        self.frames
                    );
                    self.since_frame_us = 0;
                    self.frames += 1;
                }
                Event::Request(_) => {}
            }
        }
        self.board.exchange(events)
    }
}

#[test]
fn a_tick_passes_before_every_frame_at_any_rate_and_under_faults() {
    // 3 kHz is 333⅓ us: rounded down, frames would come faster than they may.
    for (rate_hz, tick_us) in [(1_000, 1_000), (3_000, 334), (20_000, 50)] {
        let mut board = Watched { board: host_board(), tick_us, since_frame_us: 0, frames: 0 };
        let options = Options { rate_hz, ..options(Source::Random, 4_000, everything(), 5) };
        let report = run(&mut board, &image(0), &options, &mut |_| ()).unwrap();
        assert!(report.identical && board.frames > 3_500, "{:?}", report.difference);
        assert!(report.armed > 0, "{report:?}");
    }
}
