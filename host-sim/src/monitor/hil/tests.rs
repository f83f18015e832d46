//! Pictures of a run at several sizes, as text.

use std::time::Duration;

use ratatui::Terminal;
use ratatui::backend::TestBackend;
use truepath_bench::{Injected, RoundTrip, RunStatus};
use truepath_core::link::Counters;
use truepath_core::rewrite::{AXES, Mode, Output, Place, Reason, Status};

use super::draw::{Ending, draw};
use super::model::{Model, RoundTrips};
use crate::monitor::pictures;
use crate::monitor::pictures::text;
use crate::monitor::theme::Theme;

fn output(sequence: u32) -> Output {
    let size = (f64::from(sequence) / 2_000.0).sin().abs() * 180_000.0;
    Output {
        axes: [0; AXES],
        correction_nm: [size as i32, -(size as i32) / 2, 0, 0, 0, 0],
        forward: true,
        mode: Mode::Active,
        reason: Reason::None,
        status: Status(0),
        place: Place { node: sequence / 16, fraction: 0 },
        sequence,
    }
}

/// A run of 20,000 at 1,000/s of which 8,192 were compared, and 500 more arrived.
fn under_way() -> (Model, RoundTrips, Duration) {
    let mut model = Model::new("/dev/ttyACM0, /dev/ttyACM1".to_owned(), 20_000);
    let mut trips = RoundTrips::new().unwrap();
    let injected = Injected { frames: 8_192, dropped: 81, corrupted: 79, reordered: 0, repeated: 12, pauses: 3 };
    let mut counters = Counters { lost: 160, damaged: 80, repeated: 12, silences: 3, ..Counters::default() };
    counters.faults[usize::from(Reason::SequenceBroken.code() - Reason::FIRST_FAULT)] = 2;
    let trail: Vec<Output> = (0..1_004).map(|k| output(8 * k)).collect();
    let status = RunStatus {
        injected: &injected,
        counters: &counters,
        answers: 8_032,
        modes: &[0, 400, 600, 7_000, 30, 2],
        armed: 3,
        largest_nm: 180_123,
        elapsed: Duration::from_millis(8_200),
        timing: Some(&pictures::timing()),
        trail: &trail,
    };
    for k in 0..=80u64 {
        model.tick(Duration::from_millis(100 * k), 100 * k);
    }
    model.see(&status, 8_032);
    model.tick(Duration::from_millis(8_532), 8_532);
    trips.take(&(0..8_532).map(|k| 900_000 + 100 * k).collect::<Vec<u64>>());
    (model, trips, Duration::from_millis(8_532))
}

fn picture(model: &Model, trips: Option<&RoundTrips>, ending: Ending, now: Duration, size: [u16; 2]) -> String {
    let mut terminal = Terminal::new(TestBackend::new(size[0], size[1])).unwrap();
    terminal.draw(|frame| draw(frame, model, trips, ending, now, Theme { colour: false })).unwrap();
    text(terminal.backend().buffer())
}

fn is_as_in_its_file(name: &str, text: &str) {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/src/monitor/hil/pictures");
    pictures::is_as_in_its_file(folder, name, text);
}

#[test]
fn a_run_is_drawn_as_in_its_file() {
    let (model, trips, now) = under_way();
    for size in [[80, 24], [120, 40], [40, 10]] {
        let name = format!("stopping-{}x{}", size[0], size[1]);
        is_as_in_its_file(&name, &picture(&model, Some(&trips), Ending::Stopping, now, size));
    }
    let model = Model::new("the device in this process".to_owned(), 1_000_000);
    is_as_in_its_file("begin-80x24", &picture(&model, None, Ending::Regular, Duration::ZERO, [80, 24]));
}

#[test]
fn the_documents_show_the_view_as_it_is() {
    let (model, trips, now) = under_way();
    pictures::is_as_in_the_documents("hil", &picture(&model, Some(&trips), Ending::Regular, now, [80, 24]));
}

#[test]
fn no_size_of_a_terminal_is_too_small_or_too_large() {
    let (model, trips, now) = under_way();
    for width in [1, 2, 20, 40, 80, 300] {
        for height in [1, 2, 3, 4, 10, 19, 20, 24, 100] {
            picture(&model, Some(&trips), Ending::Regular, now, [width, height]);
        }
    }
}

#[test]
fn round_trips_are_those_of_the_report_to_one_percent() {
    let times: Vec<u64> = (0..5_000u64).map(|k| 50_000 + k * k % 7_919 * 131).collect();
    let mut trips = RoundTrips::new().unwrap();
    trips.take(&times[..10]);
    trips.take(&times[10..]);
    let [min, median, p99, max] = trips.four().unwrap();
    let report = RoundTrip::of(times).unwrap();
    for (found, exact) in [(min, report.min_us), (median, report.median_us), (p99, report.p99_us), (max, report.max_us)]
    {
        assert!((found - exact).abs() <= 0.01 * exact, "{found} {exact}");
    }
}

#[test]
fn setpoints_done_are_those_of_batches_and_those_answered_since() {
    let (mut model, _, _) = under_way();
    assert_eq!((model.done(), model.since), (8_192 + 500, 500));
    assert!(model.trail_nm.len() <= 2_048);
    model.tick(Duration::from_secs(9), 8_032);
    assert_eq!(model.done(), 8_192);
}
