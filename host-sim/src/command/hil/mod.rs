//! `truepath hil`: a board under setpoints and faults, compared with the host answer by answer.

mod attack;
mod bring_up;
mod on_board;
mod onlooker;
mod place;
mod report;
mod run;
mod trust;
mod update;

use std::fmt::Write;
use std::path::{Path as FilePath, PathBuf};
use std::time::Duration;

use clap::{Args, ValueEnum};
use onlooker::Onlooker;
use truepath_bench::{BenchError, Faults, RoundTrip};
use truepath_ground::diagnostics::{Failure, InputError};
use truepath_ground::length::Unit;

pub use attack::{AttackReport, Length};
pub use on_board::{OnBoard, on_board};
pub use place::{Kind, attended, open, updatable};
pub use report::{Counts, Report};
pub use run::{Options, SILENCE_US, STREAM_HZ, Source, recorded, run, run_watched, settings};

use super::image;
use crate::coprocessor::access;
use crate::terminal::Terminal;

/// What is run, as it is asked for.
#[derive(Debug, Args)]
pub struct Arguments {
    /// The correction image.
    #[arg(required_unless_present_any = ["job", "attack", "update"])]
    image: Option<PathBuf>,
    /// Have the device make the image of this job first, and compare it with the one made here.
    #[arg(long, value_name = "FILE", requires = "probe", conflicts_with = "image")]
    job: Option<PathBuf>,
    /// What the probe measured, for --job.
    #[arg(long, value_name = "FILE", requires = "job")]
    probe: Option<PathBuf>,
    /// What is tested: the device in this process, the emulated one, or one on serial ports.
    #[arg(long, value_enum, default_value_t = BoardArgument::Host)]
    board: BoardArgument,
    /// Recorded setpoints in program coordinates; otherwise a part is milled along the path of the image.
    #[arg(long, value_name = "FILE", conflicts_with = "random")]
    setpoints: Option<PathBuf>,
    /// So many setpoints along the path with everything that can go wrong, in changing frames.
    #[arg(long, value_name = "N", conflicts_with = "count")]
    random: Option<u64>,
    /// Attack the host's own servo: random images, settings, controllers and cables, judged by the safety contract alone.
    #[arg(long, conflicts_with_all = ["image", "job", "setpoints", "random", "count", "link", "rate"])]
    attack: bool,
    /// Try on the configuration link what a device with a key has to refuse. The device is to be open, with its button held at
    /// its last reset; afterwards it takes no image any more.
    #[arg(long, requires = "image", conflicts_with_all = ["attack", "job", "setpoints", "random", "count", "rate"])]
    trust: bool,
    /// Try updates of the board's own program: PROGRAM is the one it runs, as it lies in the flash. The device is to be open, with
    /// its button held at its last reset; of the virtual board --elf is then the loader.
    #[arg(long, value_name = "PROGRAM", conflicts_with_all = ["image", "attack", "trust", "job", "setpoints", "random", "count", "rate"])]
    update: Option<PathBuf>,
    /// The first day of a board, step by step, as docs/bringup.md has it: nothing but its two links may hang on it.
    #[arg(long, requires = "image", conflicts_with_all = ["attack", "trust", "job", "setpoints", "random", "rate", "link"])]
    bring_up: bool,
    /// Setpoints of the attack. [default: 1000000]
    #[arg(long, value_name = "N", requires = "attack", conflicts_with = "seconds")]
    ticks: Option<u64>,
    /// Time of the attack, instead of setpoints.
    #[arg(long, value_name = "S", requires = "attack")]
    seconds: Option<u64>,
    /// Setpoints in all. [default: 20000, or the file once]
    #[arg(long, value_name = "N")]
    count: Option<u64>,
    /// How a board is reached: frame by frame, or in batches through shared memory. [default: bulk; uart for serial]
    #[arg(long, value_enum)]
    link: Option<LinkArgument>,
    /// Setpoints per second of the controller. Over uart they also go out at this rate, when it or a file is given.
    /// [default: that of the file, or 1000; over uart 20000, which no uart reaches]
    #[arg(long, value_name = "HZ")]
    rate: Option<u32>,
    /// Answers that may be outstanding over uart.
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=64))]
    window: u32,
    /// Axes of a setpoint.
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = clap::value_parser!(u8).range(3..=6))]
    axes: u8,
    /// Seed of controller and faults: the same seed gives the same run.
    #[arg(long, value_name = "S", default_value_t = 1)]
    seed: u64,
    /// Say lengths in inches in what is told at the end.
    #[arg(long, conflicts_with_all = ["attack", "trust", "update", "bring_up"])]
    inch: bool,
    /// No live view on a terminal.
    #[arg(long)]
    plain: bool,
    #[command(flatten)]
    faults: Faults,
    #[command(flatten)]
    place: PlaceArguments,
}

#[derive(Debug, Args)]
#[command(next_help_heading = "Where the board is")]
struct PlaceArguments {
    /// Firmware of the virtual board. [default: target/firmware/truepath-virtual]
    #[arg(long, value_name = "FILE")]
    elf: Option<PathBuf>,
    /// Setpoint link: a serial port, a Unix socket, or tcp:HOST:PORT.
    #[arg(long, value_name = "PORT", required_if_eq("board", "serial"))]
    port: Option<String>,
    /// Configuration link, as --port.
    #[arg(long, value_name = "PORT", required_if_eq("board", "serial"))]
    config_port: Option<String>,
    /// Bits per second of --port, where it is a serial one; 3000000 of a NUCLEO.
    #[arg(long, value_name = "BAUD", default_value_t = 921_600)]
    baud: u32,
    /// Bits per second of --config-port, where it is a serial one.
    #[arg(long, value_name = "BAUD", default_value_t = 921_600)]
    config_baud: u32,
    /// Log in with this private key where the device asks for a role.
    #[arg(long, value_name = "FILE", conflicts_with_all = ["attack", "trust", "bring_up"])]
    key: Option<PathBuf>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum BoardArgument {
    /// The device in this process.
    Host,
    /// The firmware in QEMU.
    Virtual,
    /// A real one.
    Serial,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum LinkArgument {
    Uart,
    Bulk,
}

/// Runs and prints what came of it; a difference is an error.
pub(crate) fn main(arguments: &Arguments, terminal: &Terminal) -> Result<(), Failure> {
    if arguments.attack {
        return attacked(arguments, terminal);
    }
    if let (true, Some(path)) = (arguments.trust, &arguments.image) {
        let bytes = image::read(path)?;
        image::check(&bytes, path)?;
        let report = trust::run(&mut *attended(&kind(arguments)?)?, &bytes)?;
        return terminal.tell(&report, || report.words());
    }
    if let Some(path) = &arguments.update {
        let program = image::read(path)?;
        let report = update::run(&mut *updatable(&kind(arguments)?, path)?, &program)?;
        return terminal.tell(&report, || report.words());
    }
    if let (true, Some(path)) = (arguments.bring_up, &arguments.image) {
        return brought_up(arguments, path, terminal);
    }
    let options = options(arguments)?;
    let given = arguments.image.as_deref().map(|path| {
        let bytes = image::read(path)?;
        image::check(&bytes, path).map(|_| ())?;
        Ok::<_, InputError>(bytes)
    });
    let given = given.transpose()?;
    // Setpoints at a rate of their own keep to it; the others go out as fast as the answers come.
    let paced = arguments.rate.is_some() || arguments.setpoints.is_some();
    let mut board = open(&kind(arguments)?, arguments.window, paced)?;
    board.use_access(arguments.place.key.as_deref().map(access).transpose()?);
    let mut onlooker = Onlooker::new(arguments.plain, terminal, board.describe(), options.count);
    let made = match (&arguments.job, &arguments.probe) {
        (Some(job), Some(probe)) => {
            let settings = settings(&options, board.is_stepped())?;
            Some(on_board(&mut *board, &settings, job, probe, &mut |stage| onlooker.stage(stage))?)
        }
        _ => None,
    };
    let bytes = given.or_else(|| made.as_ref().map(|m| m.image.clone())).unwrap_or_default();
    let watch = onlooker.watch();
    let mut report = run_watched(&mut *board, &bytes, &options, &watch, &mut |status| onlooker.batch(status))?;
    // What is printed stays on the screen.
    drop(onlooker);
    report.on_board = made;
    terminal.tell(&report, || words(&report, unit(arguments)))?;
    match report.difference {
        Some(difference) => Err(BenchError::Differs(difference).into()),
        None if watch.is_stopping() => {
            let text = format!("after {} of {} setpoints", report.setpoints, options.count);
            Err(BenchError::Stopped(text).into())
        }
        None => Ok(()),
    }
}

/// The attack; a broken rule is an error.
fn attacked(arguments: &Arguments, terminal: &Terminal) -> Result<(), Failure> {
    if arguments.board != BoardArgument::Host {
        let help = "leave --board out: every board is compared with the host byte by byte, by --random";
        let found = "the attack is on the host's own servo".to_owned();
        return Err(BenchError::Option { found, help: help.to_owned() }.into());
    }
    let length = match arguments.seconds {
        Some(seconds) => Length::Time(Duration::from_secs(seconds)),
        None => Length::Setpoints(arguments.ticks.unwrap_or(1_000_000)),
    };
    let mut bar = terminal.progress("attack", attack::STEPS);
    let report = attack::run(arguments.seed, length, &mut bar);
    drop(bar);
    terminal.tell(&report, || report.words())?;
    report.alarm.map_or(Ok(()), |alarm| Err(BenchError::Alarm(alarm).into()))
}

/// The first day of a board; a step that fails is an error.
fn brought_up(arguments: &Arguments, image: &FilePath, terminal: &Terminal) -> Result<(), Failure> {
    let bytes = image::read(image)?;
    image::check(&bytes, image)?;
    // Frame by frame, as it is to be used.
    let kind = match kind(arguments)? {
        Kind::VirtualBulk { elf } => Kind::VirtualUart { elf },
        kind => kind,
    };
    let opened = |paced| open(&kind, arguments.window, paced);
    let day = bring_up::bring_up(&opened, &bytes, arguments.count.unwrap_or(20_000), &mut |step| terminal.note(step))?;
    terminal.tell(&day, || day.words())?;
    day.failed().map_or(Ok(()), |step| {
        Err(BenchError::Differs(format!("step {}, {}: {}, wanted {}", step.number, step.what, step.found, step.wanted))
            .into())
    })
}

/// The unit in which lengths are told.
const fn unit(arguments: &Arguments) -> Unit {
    if arguments.inch { Unit::Inch } else { Unit::Millimetre }
}

fn options(arguments: &Arguments) -> Result<Options, Failure> {
    let (source, count, file_hz) = match (&arguments.setpoints, arguments.random) {
        (Some(path), _) => {
            let setpoints = recorded(path)?;
            let hz = u32::try_from(1_000_000_000 / setpoints.period_ns.max(1)).unwrap_or(u32::MAX);
            let rows = setpoints.rows.len() as u64;
            (Source::Recorded(setpoints), arguments.count.unwrap_or(rows), Some(hz))
        }
        (None, Some(count)) => (Source::Random, count, None),
        (None, None) => (Source::Path, arguments.count.unwrap_or(20_000), None),
    };
    let nominal_hz = if kind(arguments)?.is_stepped() { 1_000 } else { STREAM_HZ };
    let rate_hz = arguments.rate.or(file_hz).unwrap_or(nominal_hz);
    Ok(Options { source, count, axes: arguments.axes, rate_hz, faults: arguments.faults, seed: arguments.seed })
}

fn kind(arguments: &Arguments) -> Result<Kind, BenchError> {
    let place = &arguments.place;
    let elf = place.elf.clone();
    Ok(match (arguments.board, arguments.link) {
        (BoardArgument::Host, Some(LinkArgument::Uart)) | (BoardArgument::Serial, Some(LinkArgument::Bulk)) => {
            return Err(BenchError::Option {
                found: "this board has no such link".to_owned(),
                help: "the host board has bulk only, a serial one uart only".to_owned(),
            });
        }
        (BoardArgument::Host, _) => Kind::Host,
        (BoardArgument::Virtual, Some(LinkArgument::Uart)) => Kind::VirtualUart { elf },
        (BoardArgument::Virtual, _) => Kind::VirtualBulk { elf },
        (BoardArgument::Serial, _) => {
            let names = [&place.port, &place.config_port].map(|name| name.clone().unwrap_or_default());
            Kind::Ports { names, bauds: [place.baud, place.config_baud] }
        }
    })
}

fn words(report: &Report, unit: Unit) -> String {
    let mut text = String::new();
    // Writing to a String cannot fail.
    let _ = write_words(report, unit, &mut text);
    text
}

fn write_words(r: &Report, unit: Unit, out: &mut String) -> std::fmt::Result {
    writeln!(out, "{} (firmware {}), {}", r.device.board, r.device.firmware, r.board)?;
    if let Some(m) = &r.on_board {
        writeln!(out, "image made on the device in {:.1} s: {:08x}, {} bytes, as here", m.seconds, m.crc, m.bytes)?;
        if let Some(t) = &m.round_trip {
            let count = m.setpoints_meanwhile;
            writeln!(out, "meanwhile {count} setpoints were answered, round trip {}", round_trip(t))?;
        }
    }
    writeln!(out, "{} setpoints, {} answers compared, {} parts armed", r.setpoints, r.answers, r.armed)?;
    let [off, bypass, armed, active, hold, fault] = r.modes;
    writeln!(out, "answers: Off {off}, Bypass {bypass}, Armed {armed}, Active {active}, Hold {hold}, Fault {fault}")?;
    writeln!(out, "largest correction {:.6} {}", unit.of(r.max_correction_mm), unit.name())?;
    let i = &r.injected;
    let faults = [i.dropped, i.corrupted, i.reordered, i.repeated, i.pauses];
    if faults.iter().any(|&count| count > 0) {
        let [dropped, corrupted, reordered, repeated, pauses] = faults;
        writeln!(
            out,
            "injected: {dropped} lost, {corrupted} damaged, {reordered} overtaken, {repeated} repeated, {pauses} pauses"
        )?;
    }
    let c = &r.counters;
    writeln!(
        out,
        "device: {} accepted, {} answered, {} damaged, {} repeated, {} out of order, {} lost, {} jumps, {} late, {} silences",
        c.accepted, c.answered, c.damaged, c.repeated, c.out_of_order, c.lost, c.jumps, c.late, c.silences
    )?;
    for (reason, count) in &r.faults {
        writeln!(out, "{count:>10} x {reason}")?;
    }
    writeln!(out, "{:.0} setpoints/s", r.setpoints_per_s)?;
    if let Some(t) = &r.round_trip {
        writeln!(out, "round trip {}", round_trip(t))?;
    }
    writeln!(out, "digest {} host {}", r.digest, r.host_digest)?;
    writeln!(out, "{}", if r.identical { "identical" } else { "DIFFERENT" })
}

fn round_trip(t: &RoundTrip) -> String {
    format!(
        "min {:.0}, median {:.0}, 99 % {:.0}, max {:.0} us, with the noise of this machine",
        t.min_us, t.median_us, t.p99_us, t.max_us
    )
}
