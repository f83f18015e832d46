//! The device of the firmware, in this process, answers as the host's own code does, byte for byte, and keeps the rules
//! that know nothing of that code.

use crate::hil_support::{host_board, image, on, on_host, options, part};
use truepath::command::hil::{Options, Source, run};
use truepath_bench::Faults;
use truepath_core::link::DeviceSettings;
use truepath_core::rewrite::Mode;

#[test]
fn whole_parts_are_milled_with_the_same_bits_on_both_sides() {
    for (index, count) in [(0, 40_000), (1, 40_000), (2, 60_000)] {
        let report = on_host(index, &options(Source::Path, count, Faults::default(), 1));
        assert!(report.identical, "{:?}", report.difference);
        assert_eq!((report.setpoints, report.answers), (count, count));
        assert_eq!(report.digest, report.host_digest);
        // Nothing but feed holds and overrides happens, so the correction is on almost all the time.
        assert!(report.answers_in(Mode::Active) > count * 9 / 10 && report.answers_in(Mode::Fault) == 0);
        assert!(report.armed >= 2 && report.max_correction_mm > 0.1, "{report:?}");
        // Enough setpoints before the arming for the device to know their rate, each of them answered.
        assert!(report.answers_in(Mode::Off) >= 40, "{report:?}");
    }
}

#[test]
fn disturbances_in_any_frame_on_any_axes_at_any_rate_give_the_same_bits() {
    let mut seen = [0; 6];
    for (axes, rate_hz, seed) in [(3, 1_000, 1), (4, 500, 2), (6, 1_000, 3), (5, 10_000, 4), (6, 20_000, 5)] {
        let options = Options { source: Source::Random, count: 60_000, axes, rate_hz, faults: Faults::default(), seed };
        let report = on_host(seed as usize % 3, &options);
        assert!(report.identical, "{axes} axes at {rate_hz} Hz: {:?}", report.difference);
        seen.iter_mut().zip(report.modes).for_each(|(all, one)| *all += one);
    }
    assert!(seen.iter().all(|&answers| answers > 0) && seen[3] > 100_000 && seen[5] > 500, "{seen:?}");
}

#[test]
fn the_same_seed_gives_the_same_digest_and_another_seed_another() {
    let digest = |seed| on_host(0, &options(Source::Random, 20_000, Faults::default(), seed)).digest;
    assert_eq!(digest(7), digest(7));
    assert_ne!(digest(7), digest(8));
}

#[test]
fn one_board_takes_one_image_after_another() {
    let mut board = host_board();
    for (round, index) in [(1, 0), (2, 2), (3, 0), (4, 1)] {
        let report = on(&mut board, index, &options(Source::Path, 3_000, Faults::default(), round));
        assert!(report.identical && report.armed > 0, "{:?}", report.difference);
    }
}

#[test]
fn a_recorded_file_gives_what_replay_gives() {
    // Down through the gate and 40 mm along the corner's first wall.
    let bytes = image(0);
    let image = truepath_core::image::Image::new_checked(&bytes).unwrap();
    let (origin, window) = (image.header().origin, image.settings().window);
    let mut text = String::from("# frame = program\nt_s,x_mm,y_mm,z_mm\n");
    let mm = |nm: i64| nm as f64 / 1e6;
    for tick in 0..6_000i64 {
        let height = (60 - tick).max(0) * 30_000;
        let nodes = ((tick - 60).max(0) as usize / 15).min(image.len() - 2);
        let (a, b) = (image.node(nodes), image.node(nodes + 1));
        let part = if tick > 60 { (tick - 60) % 15 } else { 0 };
        let at = |from: i32, to: i32| i64::from(from) + (i64::from(to) - i64::from(from)) * part / 15;
        let (x, y) = (origin.x.nm() + at(a.x, b.x), origin.y.nm() + at(a.y, b.y));
        let z = window.z_low.nm() + height;
        text += &format!("{}.{:03},{:.6},{:.6},{:.6}\n", tick / 1000, tick % 1000, mm(x), mm(y), mm(z));
    }
    let source = truepath_ground::diagnostics::Source::new("in.csv", text.into_bytes());
    let setpoints = truepath_trial::setpoints::Setpoints::parse(&source).unwrap();
    let settings = truepath_trial::replay::settings(setpoints.period_ns);
    let run_file = truepath_trial::replay::Run { placement: Default::default(), part_serial: 1, settings };
    let mut largest = 0;
    let replayed = truepath_trial::replay::replay(image, &setpoints, &run_file, |_, output| {
        largest = largest.max(output.correction_nm.iter().map(|nm| nm.abs()).max().unwrap_or(0));
        Ok(())
    })
    .unwrap();
    let count = setpoints.rows.len() as u64;
    let options = options(Source::Recorded(setpoints), count, Faults::default(), 1);
    let report = run(&mut host_board(), &bytes, &options, &mut |_| ()).unwrap();
    assert!(report.identical, "{:?}", report.difference);
    assert_eq!(replayed.state, "Active");
    assert!(replayed.corrected_ticks > 5_000);
    assert_eq!((report.max_correction_mm * 1e6).round() as i32, largest);
}

#[test]
fn an_image_made_on_the_device_is_the_hosts_byte_for_byte() {
    for index in [0, 2] {
        let made = truepath::command::hil::on_board(
            &mut host_board(),
            &DeviceSettings::at_1_khz(),
            &part(index).join("job.toml"),
            &part(index).join("probe.txt"),
            &mut |_| (),
        )
        .unwrap();
        assert_eq!((made.crc, made.bytes), (made.host_crc, made.host_bytes), "{made:?}");
    }
}
