//! Pictures of a device in every state, at several sizes, as text.

use std::time::Duration;

use ratatui::Terminal;
use ratatui::backend::TestBackend;
use ratatui::buffer::Buffer;
use ratatui::style::{Color, Modifier};
use truepath_core::image::{Binding, image_bytes};
use truepath_core::link::{ActiveImage, Counters, DeviceStatus, ResetCause, Slot, TraceSample};
use truepath_core::rewrite::{Mode, Place, Reason, Status};

use super::draw::draw;
use super::model::{Known, Message, ViewModel};
use crate::coprocessor::Info;
use crate::monitor::pictures;
use crate::monitor::pictures::text;
use crate::monitor::screen::Key;
use crate::monitor::theme::Theme;

const EVERY: Duration = Duration::from_millis(200);

fn info() -> Info {
    Info {
        board: "nucleo-h743zi2".to_owned(),
        firmware: "0.1.0".to_owned(),
        link_version: 1,
        semantics: 2,
        image_format: 1,
        axes: 3,
        most_nodes: 12_000,
        slot_bytes: 393_152,
        program_bytes: 65_536,
        job_bytes: 1_024,
        probe_bytes: 16_384,
        boots: 3,
        last_reset: ResetCause::PowerOn,
        trust: None,
    }
}

fn status(mode: Mode, reason: Reason, uptime_s: u64, counters: Counters) -> DeviceStatus {
    DeviceStatus {
        mode,
        reason,
        drive_enable: mode != Mode::Off,
        active: Some(ActiveImage { slot: 0, crc: 0x1A2B_3C4D }),
        recording_frozen: reason.is_fault(),
        counters,
        uptime_us: uptime_s * 1_000_000,
    }
}

/// A correction that swells at a corner: µm at a time in s.
fn correction(mode: Mode, t_s: f64) -> [i32; 2] {
    if matches!(mode, Mode::Off | Mode::Bypass | Mode::Armed) {
        return [0; 2];
    }
    let bump = (-(t_s - 12.0).powi(2) / 4.0).exp();
    [(-120_000.0 * bump) as i32 - 20_000, (80_000.0 * bump) as i32 + 5_000]
}

/// 15 s of a pass at 1 kHz, 125 samples a second, looked at five times a second.
fn milled(mode: Mode, reason: Reason, bits: u16, known: bool) -> (ViewModel, Duration) {
    let known = known.then_some(Known { crc: 0x1A2B_3C4D, clamp_nm: 150_000 });
    let mut model = ViewModel::new("/dev/ttyACM0".to_owned(), EVERY, known);
    let binding = Binding { program_crc: 0x89AB_CDEF, feature: 1, pass: 1, tool: 4, tool_offset: 4, setup: 1 };
    let length = image_bytes(4_001) as u32;
    let image = Slot::Image { length, crc: 0x1A2B_3C4D, generation: 3, active: true, binding };
    model.update(Message::Identity { info: Box::new(info()), slots: [image, Slot::Empty] });
    for look in 0..=75u32 {
        let at = EVERY * look;
        let accepted = look * 200;
        let mut counters = Counters { accepted, answered: accepted, messages: 2 * look, ..Counters::default() };
        (counters.lost, counters.damaged) = (look / 20, u32::from(look > 5));
        if reason.is_fault() {
            counters.faults[usize::from(reason.code() - Reason::FIRST_FAULT)] = u32::from(look > 70);
        }
        let sample = |k: u32| TraceSample {
            sequence: accepted - 200 + 8 * k,
            mode,
            reason,
            status: Status(bits),
            place: Place { node: 16 * look + k, fraction: 0 },
            correction_nm: correction(mode, at.as_secs_f64() - 0.2 + 0.008 * f64::from(k)),
            feed_ratio: 64_225,
        };
        let samples = if look == 0 { vec![] } else { (0..25).map(sample).collect() };
        let status = Box::new(status(mode, reason, 700 + u64::from(look / 5), counters));
        let round_trip = Duration::from_micros(2_100);
        let timing = Some(Box::new(pictures::timing()));
        model.update(Message::Look { at, status, dropped: 0, samples, timing, round_trip });
    }
    (model, EVERY * 75 + Duration::from_millis(100))
}

fn picture(model: &ViewModel, now: Duration, [width, height]: [u16; 2], colour: bool) -> Buffer {
    let mut terminal = Terminal::new(TestBackend::new(width, height)).unwrap();
    terminal.draw(|frame| draw(frame, model, now, Theme { colour })).unwrap();
    terminal.backend().buffer().clone()
}

/// What is in the file of a picture; `BLESS=1 cargo test` renews it.
fn is_as_in_its_file(name: &str, text: &str) {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/src/monitor/device/pictures");
    pictures::is_as_in_its_file(folder, name, text);
}

#[test]
fn every_state_is_drawn_as_in_its_file() {
    let sizes = [[80, 24], [40, 10]];
    let states = [
        ("off", Mode::Off, Reason::Silence, 0),
        ("pass", Mode::Bypass, Reason::Completed, 0),
        ("armed", Mode::Armed, Reason::None, 0),
        ("active", Mode::Active, Reason::None, 1),
        ("ramp", Mode::Active, Reason::ProgramEnd, 4),
        ("hold", Mode::Hold, Reason::None, 0),
        ("fault", Mode::Fault, Reason::OffPath, 3),
    ];
    for (name, mode, reason, bits) in states {
        let (model, now) = milled(mode, reason, bits, true);
        for size in sizes {
            let name = format!("{name}-{}x{}", size[0], size[1]);
            is_as_in_its_file(&name, &text(&picture(&model, now, size, false)));
        }
    }
    let (model, now) = milled(Mode::Active, Reason::None, 1, true);
    is_as_in_its_file("active-120x40", &text(&picture(&model, now, [120, 40], false)));
    for size in sizes {
        let name = format!("lost-{}x{}", size[0], size[1]);
        is_as_in_its_file(&name, &text(&picture(&model, now + Duration::from_secs(15), size, false)));
    }
    let (mut model, now) = (model, now);
    model.press(Key::Help, now);
    is_as_in_its_file("help-80x24", &text(&picture(&model, now, [80, 24], false)));
}

#[test]
fn the_documents_show_the_view_as_it_is() {
    let (model, now) = milled(Mode::Active, Reason::None, 1, true);
    pictures::is_as_in_the_documents("device monitor", &text(&picture(&model, now, [80, 24], false)));
}

#[test]
#[ignore = "slow: more than nine seconds of processor time"]
fn no_size_of_a_terminal_and_no_state_is_too_much() {
    let all = [Mode::Off, Mode::Bypass, Mode::Armed, Mode::Active, Mode::Hold, Mode::Fault];
    for mode in all {
        let (mut model, now) = milled(mode, Reason::Backwards, 31, true);
        for help in [false, true] {
            model.help = help;
            for width in [1, 2, 5, 19, 20, 39, 40, 59, 60, 80, 300] {
                for height in [1, 2, 3, 9, 10, 19, 20, 23, 24, 25, 100] {
                    picture(&model, now, [width, height], true);
                    picture(&model, now + Duration::from_secs(100_000), [width, height], true);
                }
            }
        }
    }
    let blank = ViewModel::new("x".repeat(500), EVERY, None);
    for size in [[1, 1], [40, 10], [80, 24]] {
        picture(&blank, Duration::ZERO, size, true);
        picture(&blank, Duration::MAX, size, true);
    }
}

#[test]
fn without_colours_the_text_is_the_same_and_nothing_is_coloured() {
    for (mode, reason) in [(Mode::Active, Reason::None), (Mode::Fault, Reason::Jump), (Mode::Armed, Reason::None)] {
        let (model, now) = milled(mode, reason, 1, true);
        for size in [[80, 24], [40, 10]] {
            let [plain, coloured] = [false, true].map(|colour| picture(&model, now, size, colour));
            assert_eq!(text(&plain), text(&coloured));
            assert!(plain.content.iter().all(|cell| cell.fg == Color::Reset && cell.bg == Color::Reset));
            assert!(coloured.content.iter().any(|cell| cell.bg != Color::Reset));
            // The state stands out all the same.
            assert!(plain.content.iter().any(|cell| cell.modifier.contains(Modifier::REVERSED)));
        }
    }
}

#[test]
fn what_the_operator_should_do_is_legible_in_full_on_80_columns() {
    for reason in Reason::ALL {
        for mode in [Mode::Off, Mode::Bypass, Mode::Active, Mode::Fault] {
            let (model, now) = milled(mode, reason, 0, false);
            let words = model.words(now).unwrap();
            let shown = text(&picture(&model, now, [80, 24], true));
            let right: Vec<&str> = shown.lines().skip(2).take(5).filter_map(|line| line.get(22..)).collect();
            let said = right.join(" ");
            for wanted in [words.goes_out, words.advice, words.why.as_deref().unwrap_or_default()] {
                assert!(said.contains(wanted), "{mode} {reason}: \"{wanted}\" is cut:\n{shown}");
            }
        }
    }
}

#[test]
fn a_device_that_falls_silent_has_no_value_of_now() {
    let (mut model, now) = milled(Mode::Active, Reason::None, 1, true);
    assert!(model.lost_for(now).is_none());
    model.update(Message::Silent { why: "no answer to Status in 1 attempts".to_owned() });
    let later = now + Duration::from_millis(1_300);
    for size in [[80, 24], [40, 10]] {
        let shown = text(&picture(&model, later, size, true));
        let spaced = shown.contains("L O S T") || shown.contains("LOST for 1.4 s");
        assert!(spaced && shown.contains("no answer to Status"), "{shown}");
        for value in ["-32.8", "node", "/s", "WARN", "▲"] {
            assert!(!shown.contains(value), "{value}:\n{shown}");
        }
    }
    // It comes back.
    let status = status(Mode::Bypass, Reason::None, 2, Counters::default());
    let (status, round_trip) = (Box::new(status), Duration::ZERO);
    model.update(Message::Look { at: later, status, dropped: 0, samples: vec![], timing: None, round_trip });
    let shown = text(&picture(&model, later, [80, 24], true));
    assert!(shown.contains("P A S S") && shown.contains("RESTARTED"), "{shown}");
}

#[test]
fn a_pause_holds_the_curves_and_nothing_else() {
    let (mut model, now) = milled(Mode::Active, Reason::None, 0, true);
    let curves = |model: &ViewModel, now| {
        let shown = text(&picture(model, now, [80, 24], true));
        shown.lines().skip(10).take(5).map(str::to_owned).collect::<Vec<_>>()
    };
    assert!(!model.press(Key::Pause, now));
    let before = curves(&model, now);
    let later = now + Duration::from_secs(1);
    let samples = vec![TraceSample { correction_nm: [-150_000, 0], mode: Mode::Fault, ..TraceSample::default() }; 20];
    let status = Box::new(status(Mode::Fault, Reason::EmergencyStop, 720, Counters::default()));
    model.update(Message::Look { at: later, status, dropped: 0, samples, timing: None, round_trip: Duration::ZERO });
    assert_eq!(curves(&model, later), before);
    let shown = text(&picture(&model, later, [80, 24], true));
    assert!(shown.contains("PAUSED") && shown.contains("F A U L T") && shown.contains("-150.0"), "{shown}");
    model.press(Key::Pause, later);
    assert_ne!(curves(&model, later), before);
}

#[test]
fn keys_leave_clear_and_help() {
    let (mut model, now) = milled(Mode::Active, Reason::None, 0, true);
    assert!(model.shown(now).0.points().count() > 1_000);
    model.press(Key::Clear, now);
    assert_eq!(model.shown(now).0.points().count(), 0);
    assert!(model.counters(now).iter().all(|row| !row.stands_out()));
    assert!(!model.press(Key::Help, now) && model.help);
    assert!(!model.press(Key::Back, now) && !model.help);
    assert!(model.clone().press(Key::Back, now) && model.press(Key::Leave, now));
}

#[test]
fn a_counter_of_trouble_that_grows_is_marked_and_one_that_should_grow_is_not() {
    let (model, now) = milled(Mode::Active, Reason::None, 0, true);
    let rows = model.counters(now);
    let marked: Vec<&str> = rows.iter().filter(|row| row.stands_out()).map(|row| row.name).collect();
    assert_eq!(marked, ["lost"]);
    let accepted = rows[0].count;
    assert!((accepted.per_s - 1_000.0).abs() < 1.0 && accepted.value == 15_000, "{accepted:?}");
}

#[test]
fn place_and_clamp_are_those_of_the_active_image() {
    let (mut model, now) = milled(Mode::Active, Reason::None, 0, true);
    assert_eq!((model.nodes(), model.clamp_nm()), (Some(4_001), Some(150_000)));
    let mut other = status(Mode::Active, Reason::None, 720, Counters::default());
    other.active = Some(ActiveImage { slot: 0, crc: 7 });
    model.update(Message::Look {
        at: now,
        status: Box::new(other),
        dropped: 0,
        samples: vec![],
        timing: None,
        round_trip: Duration::ZERO,
    });
    assert_eq!((model.nodes(), model.clamp_nm()), (None, None));
}

#[test]
fn a_flag_of_a_single_sample_is_shown_for_as_long_as_it_is_of_now() {
    let (mut model, now) = milled(Mode::Active, Reason::None, 0, true);
    let mut look = |at, bits: &[u16]| {
        let samples = bits.iter().map(|bits| TraceSample { status: Status(*bits), ..TraceSample::default() }).collect();
        let status = Box::new(status(Mode::Active, Reason::None, 720, Counters::default()));
        model.update(Message::Look { at, status, dropped: 0, samples, timing: None, round_trip: Duration::ZERO });
        text(&picture(&model, at, [80, 24], true))
    };
    assert!(look(now, &[0, Status::SATURATED.0, 0]).contains("SATURATED"));
    assert!(look(now + Duration::from_millis(400), &[0]).contains("SATURATED"));
    let after = look(now + Duration::from_secs(2), &[0]);
    assert!(after.contains("Flags: none") && after.contains("Nothing to do."), "{after}");
}
