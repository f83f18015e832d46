//! `truepath hil --bring-up`: the first day of a board, as far as its links can tell, step by step (docs/bringup.md).
//!
//! Nothing may hang on the board but its two links: it arms and moves through parts of an image.

use std::time::{Duration, Instant};

use serde::Serialize;
use truepath_bench::{BenchError, Board, Faults, Probability, identify};
use truepath_core::link::{Ask, Hello, Item, Reply, ResetCause};
use truepath_ground::diagnostics::Failure;

use super::report::Report;
use super::run::{Options, STREAM_HZ, Source, run};

/// A step that was done.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Step {
    /// Its number in the protocol.
    pub number: u32,
    /// What was done.
    pub what: &'static str,
    /// What has to be found.
    pub wanted: String,
    /// What was.
    pub found: String,
    /// Whether it is what has to be.
    pub passed: bool,
}

/// What came of the day: the steps up to the first that failed.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct BringUp {
    /// What the board calls itself.
    pub board: String,
    /// Version of its firmware.
    pub firmware: String,
    /// How it was reached.
    pub link: String,
    /// The steps.
    pub steps: Vec<Step>,
}

impl BringUp {
    /// The step that failed, if one did.
    pub fn failed(&self) -> Option<&Step> {
        self.steps.iter().find(|step| !step.passed)
    }

    /// What a person reads.
    pub fn words(&self) -> String {
        let line = |step: &Step| {
            let mark = if step.passed { "pass" } else { "FAIL" };
            format!("{:>2} {mark}  {}\n         found {}; wanted {}\n", step.number, step.what, step.found, step.wanted)
        };
        let head = format!("{} (firmware {}), {}\n", self.board, self.firmware, self.link);
        head + &self.steps.iter().map(line).collect::<String>()
    }
}

/// How long the clock of a board is compared with that of this computer, and what it may be off by.
const CLOCK: Duration = Duration::from_secs(10);
const CLOCK_SHARE: f64 = 0.002;
/// Until a board answers behind a reset of its watchdog at the latest: it runs out within two seconds, and the start reads both slots.
const BACK: Duration = Duration::from_secs(5);
/// Setpoints at a controller's pace, per second.
const PACE_HZ: u32 = 1_000;
/// Share of the frames that each kind of fault hits.
const HIT: f64 = 0.005;

/// Opens the board, with setpoints that keep to their rate or go out as fast as the answers come.
pub type Open<'o> = dyn Fn(bool) -> Result<Box<dyn Board>, BenchError> + 'o;

/// The steps, one after the other, with `count` setpoints through the board in each that sends any. `progress` is told the step that
/// begins.
///
/// # Errors
/// The board cannot be reached or is of another version. A step that fails is no error: it is the last of the report.
pub fn bring_up(
    open: &Open<'_>,
    image: &[u8],
    count: u64,
    progress: &mut dyn FnMut(&'static str),
) -> Result<BringUp, Failure> {
    let mut board = open(false)?;
    let device = identify(&mut *board)?;
    let link = board.describe();
    let report = BringUp { board: device.board, firmware: device.firmware, link, steps: Vec::new() };
    let mut day = Day { report, progress };
    // The first step that fails ends the day.
    let _ = day.links_alone(&mut *board, image).and_then(|()| day.setpoints(board, open, (image, count)));
    Ok(day.report)
}

/// What a step found, and whether that is what it has to be.
type Found = Result<(String, bool), Failure>;

struct Day<'p> {
    report: BringUp,
    progress: &'p mut dyn FnMut(&'static str),
}

impl Day<'_> {
    /// Does a step; `None` where it failed. What the board denies, or does not answer, is what was found.
    fn step(&mut self, what: &'static str, wanted: &str, done: impl FnOnce() -> Found) -> Option<()> {
        (self.progress)(what);
        let (found, passed) = done().unwrap_or_else(|failure| (failure.to_string(), false));
        let number = self.report.steps.len() as u32 + 1;
        self.report.steps.push(Step { number, what, wanted: wanted.to_owned(), found, passed });
        passed.then_some(())
    }

    /// What needs the configuration link and the flash only.
    fn links_alone(&mut self, board: &mut dyn Board, image: &[u8]) -> Option<()> {
        let has_own_clock = !board.is_stepped();
        self.step("it says what it is, and is open", "no key, enough room for the image", || {
            let keys = board.client().keys()?;
            let (room, boots, why) = hello(board, |hello| (hello.slot_bytes as usize, hello.boots, hello.last_reset))?;
            let is_open = keys.keys.is_open();
            let key = if is_open { "no key" } else { "it has keys" };
            let found = format!("{key}, {room} bytes for an image, start {boots}, the last for {why:?}");
            Ok((found, is_open && room >= image.len()))
        })?;
        for (watchdog, cause) in [(false, ResetCause::Software), (true, ResetCause::Watchdog)] {
            let what = if watchdog { "its watchdog runs out" } else { "it is reset by request" };
            let wanted = format!("{cause:?}, one start more, an answer within {} s", BACK.as_secs());
            self.step(what, &wanted, || {
                let before = hello(board, |hello| hello.boots)?;
                let began = Instant::now();
                board.client().done(Ask::Restart { watchdog })?;
                let (boots, found) = behind(board, before, began)?;
                let took = began.elapsed();
                let text =
                    format!("{found:?}, start {before} and then {boots}, an answer after {:.1} s", took.as_secs_f64());
                Ok((text, found == cause && boots == before.wrapping_add(1) && took <= BACK))
            })?;
        }
        if has_own_clock {
            let wanted = format!("the clock of this computer within {:.1} %", 100.0 * CLOCK_SHARE);
            self.step("its clock goes on for ten seconds", &wanted, || {
                let mut uptime_us = || Ok::<_, BenchError>((board.client().status()?.uptime_us, Instant::now()));
                let (from_us, from) = uptime_us()?;
                std::thread::sleep(CLOCK);
                let (to_us, to) = uptime_us()?;
                let passed_us = to.duration_since(from).as_secs_f64() * 1e6;
                let share = to_us.saturating_sub(from_us) as f64 / passed_us - 1.0;
                Ok((format!("{:+.3} %", 100.0 * share), share.abs() <= CLOCK_SHARE))
            })?;
        }
        let crc = image.last_chunk().map_or(0, |crc| u32::from_le_bytes(*crc));
        self.step("an image goes into its flash and into use", "the image in use", || {
            let began = Instant::now();
            let there = board.client().upload(Item::Image, image, |_| ())?;
            let per_s = image.len() as f64 / began.elapsed().as_secs_f64();
            board.client().done(Ask::Activate { slot: there.slot, crc: there.crc })?;
            in_use(board, crc).map(|(found, is_it)| (format!("{found}, {per_s:.0} bytes/s"), is_it))
        })?;
        self.step("it is reset with that image", "the image in use", || {
            let before = hello(board, |hello| hello.boots)?;
            board.client().done(Ask::Restart { watchdog: false })?;
            behind(board, before, Instant::now())?;
            in_use(board, crc)
        })
    }

    /// What needs both links: the whole setpoint path of the device against that of the host.
    fn setpoints(&mut self, board: Box<dyn Board>, open: &Open<'_>, (image, count): (&[u8], u64)) -> Option<()> {
        let rate_hz = if board.is_stepped() { PACE_HZ } else { STREAM_HZ };
        let base = seed();
        let options = |source, faults, number| Options { source, count, axes: 3, rate_hz, faults, seed: base + number };
        let hit = Probability::new(HIT).unwrap_or_default();
        let bad = Faults { drop: hit, corrupt: hit, reorder: hit, repeat: hit, ..Faults::default() };
        let [path, random, cable, slow] = [
            options(Source::Path, Faults::default(), 0),
            options(Source::Random, Faults::default(), 1),
            options(Source::Path, bad, 2),
            options(Source::Path, Faults::default(), 3),
        ];
        let paced = Options { rate_hz: PACE_HZ, ..slow };
        let mut board = board;
        let mut fast = |day: &mut Self, what, options: &Options| {
            day.step(what, EQUAL, || equal(&run(&mut *board, image, options, &mut |_| ())?))
        };
        fast(self, "parts are milled as fast as it answers", &path)?;
        fast(self, "parts are milled with everything that a controller does wrong", &random)?;
        fast(self, "parts are milled over a bad cable", &cable)?;
        // Ports are closed before they are opened again.
        drop(board);
        self.step("parts are milled at a thousand setpoints per second", EQUAL, || {
            equal(&run(&mut *open(true)?, image, &paced, &mut |_| ())?)
        })
    }
}

/// The first of ten seeds, others for every day: the device may still know the parts of the one before.
fn seed() -> u64 {
    let since = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH);
    since.map_or(1, |since| 10 * since.as_secs())
}

const EQUAL: &str = "every answer and every counter the host's own, byte for byte";

/// Whether a run was the host's own.
fn equal(report: &Report) -> Found {
    let round_trip = report.round_trip.as_ref().map_or_else(String::new, |t| {
        format!(", round trip {:.0} us, 99 % within {:.0}, at most {:.0}", t.median_us, t.p99_us, t.max_us)
    });
    let injected = &report.injected;
    let hit = injected.dropped + injected.corrupted + injected.reordered + injected.repeated;
    let hit = if hit > 0 { format!(", {hit} frames hit") } else { String::new() };
    let differs = report.difference.as_ref().map_or_else(String::new, |difference| {
        // What follows the first line are both states, whole.
        format!("; {}", difference.lines().next().unwrap_or_default())
    });
    let found = format!(
        "{} answers, {} parts, corrections up to {:.3} mm, {:.0} setpoints/s{hit}{round_trip}{differs}",
        report.answers, report.armed, report.max_correction_mm, report.setpoints_per_s
    );
    // A run that arms nothing shows nothing.
    Ok((found, report.identical && report.armed > 0 && report.max_correction_mm > 0.0))
}

/// Something of what the device says of itself.
fn hello<T>(board: &mut dyn Board, of: impl FnOnce(&Hello<'_>) -> T) -> Result<T, BenchError> {
    match board.client().ask(Ask::Hello)? {
        Reply::Hello(hello) => Ok(of(&hello)),
        other => Err(BenchError::Foreign(format!("{other:?}"))),
    }
}

/// Starts so far and the cause of the last, once the board is behind the start with number `before`.
fn behind(board: &mut dyn Board, before: u32, began: Instant) -> Result<(u32, ResetCause), BenchError> {
    loop {
        let found = hello(board, |hello| (hello.boots, hello.last_reset));
        match found {
            // It answers before it resets, and is silent while it does.
            Ok((boots, _)) if boots == before && began.elapsed() < BACK => {}
            Err(BenchError::Silent(_)) if began.elapsed() < BACK => {}
            found => return found,
        }
        std::thread::sleep(Duration::from_millis(20));
    }
}

/// Which image is in use, and whether it is this one.
fn in_use(board: &mut dyn Board, crc: u32) -> Found {
    let found = board.client().status()?.active.map(|active| active.crc);
    Ok((found.map_or_else(|| "no image".to_owned(), |found| format!("image {found:08x}")), found == Some(crc)))
}

#[cfg(test)]
mod tests {
    use truepath_bench::{BulkBoard, InProcess};

    use super::*;

    const IMAGE: &[u8] = include_bytes!("../../../../fuzz/seeds/image/twelve-nodes.tpi");

    fn device(_: bool) -> Result<Box<dyn Board>, BenchError> {
        Ok(Box::new(BulkBoard::new(InProcess::start()?)))
    }

    #[test]
    fn the_device_in_this_process_passes_every_step_that_it_has() {
        let mut told = Vec::new();
        let day = bring_up(&device, IMAGE, 2_000, &mut |step| told.push(step)).unwrap();
        assert_eq!(day.failed(), None, "{}", day.words());
        assert_eq!((day.steps.len(), told.len()), (9, 9), "{}", day.words());
    }

    #[test]
    fn a_board_that_is_not_open_ends_the_day_at_its_first_step() {
        let locked = |_: bool| {
            let mut board = BulkBoard::new(InProcess::attended()?);
            let key = truepath_job::signing::Signer::of_seed(&[7; 32]).public();
            board.client().done(Ask::Provision(key))?;
            Ok(Box::new(board) as Box<dyn Board>)
        };
        let day = bring_up(&locked, IMAGE, 100, &mut |_| ()).unwrap();
        let failed = day.failed().expect("a step that fails");
        assert!(day.steps.len() == 1 && failed.found.starts_with("it has keys"), "{}", day.words());
    }
}
