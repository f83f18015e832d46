//! Scheduled feeds, in the program and on the virtual machine.

use std::path::Path;
use std::process::{Command, Stdio};

use truepath_core::gcode::Options;
use truepath_core::gcode::Units;
use truepath_correction::correct::{CorrectedPass, correct_pass};
use truepath_ground::diagnostics::{Failure, Form, Source};
use truepath_job::job::{JobFile, Route};
use truepath_job::measurement::Measurement;
use truepath_job::pass::{Pass, read_blocks};
use truepath_plant::Machine;
use truepath_trial::virtual_mill;

const JOB: &str = include_str!("../../../demo/corner-helix/job.toml");
const PLANT: &str = include_str!("../../../demo/corner-helix/plant.toml");
const PROGRAM: &str = "%\nG21 G90 G17 G40\nT1 M6\nS1500 M3\nG0 X34 Y90 Z50\nG0 Z-15\nG1 X34 Y80 F600\nG1 Y35 F400 (first wall)\nG3 X39 Y30 I5\nG1 X90 F300\nM9\nG1 X95 Y35\nG0 Z50\nM30\n%\n";
/// Straight walls alone: the corner is outside the window.
const STRAIGHT: [f64; 4] = [30.0, 37.0, 75.0, 85.0];

fn pass(program: &str, feed: &str) -> Result<Pass, Failure> {
    let job = JOB.lines().filter(|l| !l.starts_with("feed_mm_per_min")).collect::<Vec<_>>().join("\n");
    let text = format!("{job}\n{feed}\n[[feature]]\nid = \"wall\"\nlines = [8, 10]\nrole = \"finish\"\n");
    let job = JobFile::parse(Source::new("job.toml", text.into_bytes()), Path::new(""))?;
    Pass::new(job, Source::new("part.nc", program.as_bytes().to_vec()))
}

fn shown<T>(result: Result<T, Failure>) -> T {
    result.unwrap_or_else(|e| panic!("{}", e.render(Form::Plain)))
}

fn corrected(pass: &Pass, routes: &[Route]) -> Result<CorrectedPass, Failure> {
    let machine: Machine = toml::from_str(PLANT).unwrap();
    let milled = virtual_mill::mill(pass, &machine, None)?;
    let mut probe = virtual_mill::probe(pass, &milled, &STRAIGHT, &[0.1, 0.5, 0.9], 6.0)?;
    if pass.core.contour.units == Units::Inches {
        let inch = |n: &str| format!("{:.7}", n.parse::<f64>().unwrap() / 25.4);
        let row = |l: &str| l.split(' ').map(inch).collect::<Vec<_>>().join(" ");
        probe = probe.lines().map(row).collect::<Vec<_>>().join("\n");
    }
    let measurement = Measurement::read(pass, &Source::new("probe.txt", probe.into_bytes()))?;
    correct_pass(pass, &measurement, &[], routes, &mut |_| ())
}

fn program(corrected: &CorrectedPass) -> String {
    String::from_utf8(corrected.program.clone().unwrap()).unwrap()
}

#[test]
fn a_corner_whose_force_leaves_the_window_comes_out_better_with_scheduled_feeds() {
    let machine: Machine = toml::from_str(PLANT).unwrap();
    let [plain, fed] = ["", "[feed]\nmin_percent = 30\n"].map(|feed| {
        let pass = shown(pass(PROGRAM, feed));
        let done = shown(corrected(&pass, &[Route::Program]));
        let score = shown(virtual_mill::mill_program(&pass, &machine, done.program.as_deref().unwrap())).score();
        (done, score)
    });
    assert!(plain.0.summary.feed.is_none());
    let feed = fed.0.summary.feed.unwrap();
    assert!(feed.max_force_before_n > 1.8 * feed.limit_n, "{feed:?}");
    assert!(feed.max_force_after_n < 0.6 * feed.max_force_before_n && feed.time_after_s < 1.4 * feed.time_before_s);
    // What no displacement in X and Y reaches: the error over the height.
    assert!(fed.1.worst_height_mm < 0.65 * plain.1.worst_height_mm, "{:?} {:?}", fed.1, plain.1);
    assert!(fed.1.axial_form_mm < 0.65 * plain.1.axial_form_mm, "{:?} {:?}", fed.1, plain.1);
    assert!(fed.0.summary.axial_form_error_mm < 0.65 * feed.unscheduled.unwrap().axial_form_error_mm);
}

fn scheduled(program: &str, feed: &str) -> (Pass, CorrectedPass) {
    let pass = shown(pass(program, feed));
    let done = shown(corrected(&pass, &[Route::Program]));
    (pass, done)
}

/// Lines that are executed, in order, without comments.
fn lines(text: &str) -> Vec<&str> {
    text.lines().filter(|l| !l.starts_with('(')).collect()
}

#[test]
fn without_the_table_or_with_a_limit_that_is_kept_not_a_byte_changes() {
    let plain = program(&scheduled(PROGRAM, "").1);
    let kept = scheduled(PROGRAM, "[feed]\nmin_percent = 50\nmax_force_n = 9000\n").1;
    assert_eq!(lines(&program(&kept)), lines(&plain));
    assert!(kept.summary.warnings.iter().any(|w| w.contains("[feed] changes nothing")));
    assert!(!kept.summary.difference("part.nc").contains("wanted percentages"));
}

#[test]
fn behind_the_contour_the_feed_of_the_program_is_in_force_again() {
    let (pass, done) = scheduled(PROGRAM, "[feed]\nmin_percent = 50\n");
    let text = program(&done);
    let blocks = shown(read_blocks(&Source::new("corrected.nc", text.clone().into_bytes()), Options::default())).0;
    let feeds: Vec<f64> = blocks.iter().map(|b| b.feed.bits() as f64 / 4_294_967_296.0).collect();
    assert!(feeds.iter().all(|f| (149.9..=600.0).contains(f)), "{feeds:?}");
    assert!(feeds.iter().filter(|f| **f < 300.0).count() > 3 && feeds.last() == Some(&300.0));
    // The lead-in keeps its feed, and every other line its bytes.
    assert!(text.contains(" F600\n") && text.contains("\nM9\n") && text.contains("\nG0 Z-15\n"), "{text}");
    assert_eq!(pass.blocks.len(), 3);
    // A contour that ends slowly: the line behind it relies on its feed.
    let ends = PROGRAM.replace("G1 X90 F300", "G1 X90").replace("M9\nG1 X95 Y35\n", "M9\n");
    let text = program(&scheduled(&ends, "[feed]\nmin_percent = 50\nmax_force_n = 120\n").1);
    let alone = lines(&text).iter().position(|l| *l == "F400.").expect("a line with the feed alone");
    assert_eq!(lines(&text)[alone + 1], "M9", "{text}");
}

#[test]
fn inches_and_feeds_per_revolution_are_scheduled_in_their_own_numbers() {
    let per_revolution = PROGRAM.replace("F400", "G95 F0.2666667").replace("F300", "F0.2");
    let text = program(&scheduled(&per_revolution, "[feed]\nmin_percent = 50\nmax_force_n = 200\n").1);
    let numbers = |text: &str| -> Vec<f64> {
        let word = |l: &str| l.split(['F', ' ']).next_back().and_then(|n| n.parse().ok());
        lines(text).iter().filter(|l| l.contains(" F")).filter_map(|l| word(l)).collect()
    };
    assert!(numbers(&text).iter().any(|f| (0.13..0.2).contains(f)), "{text}");
    let inch = |word: &str| match word.split_at_checked(1) {
        Some((l @ ("X" | "Y" | "Z" | "I" | "F"), n)) => format!("{l}{:.6}", n.parse::<f64>().unwrap() / 25.4),
        _ => word.replace("G21", "G20"),
    };
    let words = |line: &str| line.split(' ').map(inch).collect::<Vec<_>>().join(" ");
    let inches: Vec<String> = PROGRAM.replace(" (first wall)", "").lines().map(words).collect();
    let text = program(&scheduled(&inches.join("\n"), "[feed]\nmin_percent = 50\nmax_force_n = 200\n").1);
    assert!(numbers(&text).iter().any(|f| (7.8..11.0).contains(f)), "{text}");
}

#[test]
fn the_feed_rises_only_where_the_job_says_so_and_a_closed_contour_has_no_jump_at_its_seam() {
    let job = include_str!("../../../demo/pocket/job.toml").replace("feed_mm_per_min", "# feed_mm_per_min");
    let program = include_str!("../../../demo/pocket/program.nc");
    let machine: Machine = toml::from_str(include_str!("../../../demo/pocket/plant.toml")).unwrap();
    let used = |highest: u16, limit: &str| {
        let text = format!("{job}\n[feed]\nmin_percent = 50\nmax_percent = {highest}\n{limit}\n");
        let job =
            shown(JobFile::parse(Source::new("job.toml", text.into_bytes()), Path::new("")).map_err(Failure::from));
        let pass = shown(Pass::new(job, Source::new("part.nc", program.as_bytes().to_vec())));
        let milled = shown(virtual_mill::mill(&pass, &machine, None));
        let probe = shown(virtual_mill::probe(&pass, &milled, &[45.0, 92.0, 145.0], &[0.3, 0.8], 4.0));
        let measurement = shown(Measurement::read(&pass, &Source::new("probe.txt", probe.into_bytes())));
        let done = shown(correct_pass(&pass, &measurement, &[], &[Route::Program], &mut |_| ()));
        let blocks = shown(read_blocks(&Source::new("corrected.nc", done.program.unwrap()), Options::default())).0;
        let feeds = [blocks.first(), blocks.last()].map(|b| b.map_or(0, |b| b.feed.round_to_int()));
        (done.summary.feed.unwrap(), feeds)
    };
    let (kept, _) = used(100, "");
    assert_eq!(kept.used_percent[1], 100);
    let limit_n = 1.2 * kept.limit_n;
    let (raised, [first, last]) = used(130, &format!("max_force_n = {limit_n:.3}"));
    assert!(raised.used_percent[1] > 110 && raised.max_force_after_n < 1.01 * limit_n.max(kept.max_force_after_n));
    assert!(raised.time_after_s < kept.time_after_s && last * 5 < first * 6 && first * 5 < last * 6, "{first} {last}");
}

#[test]
fn a_correction_beyond_the_clamp_comes_within_it_at_a_lower_feed() {
    let clamped = |feed: &str| {
        let mut pass = shown(pass(PROGRAM, feed));
        pass.job.numbers.correct.clamp = truepath_core::units::Offset::from_um(550);
        pass.core.job.correct.clamp = pass.job.numbers.correct.clamp;
        corrected(&pass, &[Route::Program])
    };
    assert!(clamped("").is_err());
    let done = shown(clamped("[feed]\nmin_percent = 50\n"));
    assert!(done.summary.max_correction_mm < 0.55 && done.summary.feed.unwrap().unscheduled.is_none());
}

#[test]
fn feeds_that_nobody_would_follow_are_refused() {
    let pass = shown(pass(PROGRAM, "[feed]\nmin_percent = 50\n"));
    let refused = corrected(&pass, &[Route::Coprocessor]).expect_err("the coprocessor follows the live feed");
    assert!(refused.render(Form::Plain).contains("J008") && refused.render(Form::Plain).contains("live feed"));
    let mut other = pass.job.clone();
    other.numbers.cut.feed_mm_per_min = Some(truepath_core::units::Real::from_int(350));
    let other = shown(Pass::new(other, pass.program.clone()));
    let refused = corrected(&other, &[Route::Program]).expect_err("F words that are not those of the cut");
    assert!(refused.render(Form::Plain).contains("says F400"), "{}", refused.render(Form::Plain));
}

#[test]
fn linuxcnc_reads_the_scheduled_feeds_and_the_one_behind_them() {
    let text = program(&scheduled(PROGRAM, "[feed]\nmin_percent = 50\n").1);
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("part.ngc"), &text).unwrap();
    std::fs::write(folder.path().join("tool.tbl"), "T1 P1 D20\n").unwrap();
    let mut command = Command::new("rs274");
    // The interpreter keeps its tool table in a file in the home folder, which others may be using.
    command.env("HOME", folder.path()).args(["-t", "tool.tbl", "-g", "part.ngc"]).current_dir(folder.path());
    let said = match command.stdin(Stdio::null()).output() {
        Ok(output) => String::from_utf8(output.stdout).unwrap(),
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => {
            eprintln!("skipped: rs274 of LinuxCNC is not installed");
            return;
        }
        Err(error) => panic!("{error}"),
    };
    let rates: Vec<f64> = said
        .lines()
        .filter_map(|l| l.split_once("SET_FEED_RATE(")?.1.trim_end_matches(')').trim().parse().ok())
        .collect();
    let written: Vec<f64> =
        lines(&text).iter().filter_map(|l| l.split(' ').find_map(|w| w.strip_prefix('F'))?.parse().ok()).collect();
    assert!(written.len() > 8 && said.contains("PROGRAM_END"), "{said}");
    assert_eq!(rates.iter().copied().filter(|r| *r > 0.0).collect::<Vec<_>>(), written, "{said}");
}
