//! `truepath device`: a coprocessor over its configuration link.

mod arm;
mod lines;
mod log;
mod timing;
mod update;

use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::time::Duration;

use arm::ArmOptions;
use clap::{Args, Subcommand};
use truepath_bench::{BenchError, Client, Ingredients, Line, compute};
use truepath_core::image::{KeyId, Rights, Role};
use truepath_core::link::{Ask, Counters, DeviceStatus, Slot};
use truepath_ground::diagnostics::{Failure, Source};
use truepath_ground::output::write_file;
use truepath_job::job::JobFile;
use truepath_job::levels;
use truepath_job::pass::Pass;
use truepath_job::signing::{key_id, read_public, role};

use super::hil::Counts;
use super::image;
use crate::coprocessor::{
    Trust, access, activate, info, recording, recording_setpoints, recording_table, trust, upload,
};
use crate::monitor::{Known, Looked, device as view, wanted};
use crate::settings::{NoSuchSetting, changed, named, paced};
use crate::terminal::Terminal;

/// Which device, and what is asked of it.
#[derive(Debug, Args)]
pub struct Options {
    /// Configuration link: a serial port, a Unix socket, or tcp:HOST:PORT.
    #[arg(long, alias = "socket", value_name = "PORT", global = true, required = false)]
    port: Option<String>,
    /// Bits per second of a serial port.
    #[arg(long, value_name = "BAUD", global = true, default_value_t = 921_600)]
    baud: u32,
    /// Log in with this private key (truepath key new) where the device asks for a role; no higher one than it asks for.
    #[arg(long = "key", value_name = "FILE", global = true)]
    access: Option<PathBuf>,
    #[command(subcommand)]
    task: Task,
}

#[derive(Debug, Subcommand)]
enum Task {
    /// What the two image slots hold.
    List,
    /// Who is there, and in which state.
    Info,
    /// Sends an image to the idle slot; goes on where an interrupted upload stopped.
    Upload {
        /// The correction image.
        image: PathBuf,
        /// Make it the active one.
        #[arg(long)]
        activate: bool,
    },
    /// Makes the image of a slot the active one, after resets as well.
    Activate {
        /// 0 or 1.
        #[arg(value_parser = clap::value_parser!(u8).range(0..=1))]
        slot: u8,
    },
    /// No image is active any more: setpoints pass unchanged.
    Deactivate,
    /// Tells a device in Off that the drives are disabled; setpoints have to arrive that say so too.
    Acknowledge,
    /// Arms the active image for one pass of one part. This is the controller's to call, which knows what runs and where.
    Arm(ArmOptions),
    /// Ends an arming; an active correction ramps out.
    Disarm,
    /// State, place and correction, live: a view on a terminal, otherwise lines.
    Monitor {
        /// Print lines on a terminal too.
        #[arg(long)]
        plain: bool,
        /// The image that should be active: its clamp is marked in the view.
        #[arg(long, value_name = "FILE")]
        image: Option<PathBuf>,
        /// Stop after so long; otherwise until interrupted.
        #[arg(long, value_name = "SECONDS")]
        seconds: Option<u64>,
        /// Time between two looks, milliseconds.
        #[arg(long, value_name = "MS", default_value_t = 200, value_parser = clap::value_parser!(u64).range(20..=60_000))]
        every_ms: u64,
    },
    /// Downloads the frames before the last fault as a table.
    Record {
        /// The table.
        #[arg(short, long, value_name = "FILE")]
        output: PathBuf,
        /// Write setpoints for replay instead: t_s,x_mm,y_mm,z_mm,spindle_rpm in machine coordinates.
        #[arg(long)]
        setpoints: bool,
        /// Let the recorder run again.
        #[arg(long)]
        release: bool,
        /// Replace the file if it exists.
        #[arg(long)]
        force: bool,
    },
    /// Shows the settings, or changes some of them (in Off only).
    Settings {
        /// First sets everything that is counted in ticks for a controller that sends a setpoint each so many
        /// microseconds: a LinuxCNC servo period of 1 ms is 1000.
        #[arg(long, value_name = "US", value_parser = clap::value_parser!(u32).range(10..=100_000))]
        period_us: Option<u32>,
        /// For instance rewriter.tick_hz=2000 axes=6.
        #[arg(value_name = "NAME=VALUE")]
        changes: Vec<String>,
    },
    /// Counts since the reset.
    Counters {
        /// Set them to zero afterwards.
        #[arg(long)]
        clear: bool,
    },
    /// How regularly setpoints arrive and how fast they are answered, since the reset: a table and histograms.
    Timing,
    /// The log of changes: who changed what, and when. The device keeps the newest 64 at least.
    Log {
        /// From the entry of this number on.
        #[arg(long, value_name = "N", default_value_t = 0)]
        from: u32,
    },
    /// Whose images the device takes.
    Keys,
    /// Lets the device trust the keys of a file; its button must have been held at its last reset.
    Provision {
        /// A file of public keys.
        file: PathBuf,
        /// The highest role that may be logged in to with them.
        #[arg(long, value_name = "ROLE", value_parser = role, default_value = "engineer")]
        role: Role,
        /// Take no images that they sign.
        #[arg(long)]
        no_images: bool,
        /// Take firmware that they sign.
        #[arg(long)]
        firmware: bool,
    },
    /// Lets the device trust a key no more, for ever; its button must have been held at its last reset.
    Revoke {
        /// Number of the key, 16 hexadecimal digits, as truepath device keys shows it.
        #[arg(value_name = "KEYID", value_parser = key_id)]
        key: KeyId,
    },
    /// Resets the device.
    Restart {
        /// By letting its watchdog run out.
        #[arg(long)]
        watchdog: bool,
    },
    /// Another firmware: sends an update, has it started, and confirms it once it answers. Without FILE: where an update stands.
    Update {
        /// The update (truepath firmware sign). Both image slots are erased for it.
        file: Option<PathBuf>,
        /// Leave it on trial: a reset, or five minutes, bring the firmware before back.
        #[arg(long, requires = "file")]
        trial: bool,
        /// Confirm the one that is on trial.
        #[arg(long, conflicts_with = "file")]
        confirm: bool,
    },
    /// Makes an image on the device, from a job with its program and what the probe measured.
    Compute {
        /// The job.
        job: PathBuf,
        /// What the probe measured on the part cut by the job's program.
        #[arg(long, value_name = "FILE")]
        probe: PathBuf,
        /// Make the image the active one.
        #[arg(long)]
        activate: bool,
        /// Give up after so many minutes.
        #[arg(long, default_value_t = 30)]
        minutes: u64,
    },
}

impl Task {
    /// Whether it asks for what the device may log.
    const fn changes(&self) -> bool {
        !matches!(self, Self::List | Self::Info | Self::Monitor { .. } | Self::Timing | Self::Log { .. } | Self::Keys)
    }
}

/// Asks, and prints the answer.
pub(crate) fn main(options: &Options, terminal: &Terminal) -> Result<(), Failure> {
    let access = options.access.as_deref().map(access).transpose()?;
    let mut client = connect(options.port.as_deref(), options.baud)?;
    if options.task.changes() {
        client.tell_time()?;
    }
    let mut client = client.with_access(access);
    if let Task::Monitor { plain, image, seconds, every_ms } = &options.task {
        let (end, every) = (seconds.map(Duration::from_secs), Duration::from_millis(*every_ms));
        let known = image.as_deref().map(known).transpose()?;
        if !wanted(*plain, terminal) {
            return lines::run(&mut client, end, every, terminal);
        }
        let (port, baud) = (options.port.clone().unwrap_or_default(), options.baud);
        let name = port.clone();
        let looked = Looked { port, reopen: move || connect(Some(&name), baud), every, end, known };
        return view(client, looked);
    }
    let done = carry_out(&options.task, &mut client, terminal);
    client.log_out();
    done
}

fn carry_out(task: &Task, client: &mut Client<Line>, terminal: &Terminal) -> Result<(), Failure> {
    match task {
        Task::List => {
            let slots = client.slots()?;
            terminal.tell(&slots, || slots_words(&slots))
        }
        Task::Info => {
            let info = info(client)?;
            let status = client.status()?;
            let both = serde_json::json!({ "device": info, "status": status });
            terminal.tell(&both, || {
                format!(
                    "{} with firmware {}, {} axes, images up to {} nodes\n\
                     link {}, image format {}, semantics {}; {} boots, the last by {:?}\n{}{}",
                    info.board,
                    info.firmware,
                    info.axes,
                    info.most_nodes,
                    info.link_version,
                    info.image_format,
                    info.semantics,
                    info.boots,
                    info.last_reset,
                    status_words(&status),
                    info.trust.as_ref().map(Trust::words).unwrap_or_default()
                )
            })
        }
        Task::Upload { image: path, activate } => {
            let bytes = image::read(path)?;
            image::check(&bytes, path)?;
            let mut bar = terminal.progress("uploading", bytes.len() as u64);
            let done = upload(client, &bytes, *activate, |there| bar.reached(there))?;
            drop(bar);
            let both = serde_json::json!({ "slot": done.slot, "crc": format!("{:08x}", done.crc), "active": activate });
            let word = if *activate { "active" } else { "not active yet: truepath device activate" };
            terminal.tell(&both, || format!("image {:08x} in slot {}, {word}\n", done.crc, done.slot))
        }
        Task::Activate { slot } => {
            let crc = activate(client, *slot)?;
            let both = serde_json::json!({ "slot": slot, "crc": format!("{crc:08x}") });
            terminal.tell(&both, || format!("image {crc:08x} of slot {slot} is active\n"))
        }
        Task::Deactivate => done(client, Ask::Deactivate, terminal, "no image is active"),
        Task::Acknowledge => {
            done(client, Ask::AcknowledgeDrivesDisabled, terminal, "drives acknowledged as disabled: bypass")
        }
        Task::Arm(arm) => {
            let request = arm.request(client)?;
            let (ask, word) =
                if arm.check { (Ask::Check(request), "could be armed") } else { (Ask::Arm(request), "armed") };
            client.done(ask)?;
            let (part, frame) = (request.part_serial, request.frame.crc);
            let both = serde_json::json!({
                "armed": !arm.check, "part": part, "frame_crc": frame, "binding": request.binding });
            terminal.tell(&both, || format!("{word}: part {part}, frame {frame:08x}\n"))
        }
        Task::Disarm => done(client, Ask::Disarm, terminal, "disarmed"),
        // It keeps the client, see `main`.
        Task::Monitor { .. } => Ok(()),
        Task::Record { output, setpoints, release, force } => {
            let axes = client.settings()?.axes;
            let mut bar = terminal.progress("downloading", 1000);
            let frames = recording(client, axes, |n, all| bar.reached(1000 * n / all.max(1)))?;
            drop(bar);
            let text = if *setpoints {
                recording_setpoints(&frames, client.settings()?.rewriter.tick_hz)
            } else {
                recording_table(&frames, axes)
            };
            write_file(output, *force, text.as_bytes())?;
            if *release {
                client.done(Ask::ReleaseRecording)?;
            }
            let both = serde_json::json!({ "frames": frames.len(), "file": output });
            terminal.tell(&both, || format!("{} frames in {}\n", frames.len(), output.display()))
        }
        Task::Settings { period_us, changes } => {
            let mut settings = client.settings()?;
            if let Some(period_us) = *period_us {
                settings = paced(&settings, period_us);
            }
            if !changes.is_empty() || period_us.is_some() {
                let unfit = |e: NoSuchSetting| BenchError::Option { found: e.found, help: e.help };
                settings = changed(&settings, changes).map_err(unfit)?;
                client.done(Ask::Configure(settings))?;
            }
            terminal.tell(&settings, || {
                named(&settings).iter().map(|(name, value)| format!("{name} = {value}\n")).collect()
            })
        }
        Task::Counters { clear } => {
            let status = client.status()?;
            if *clear {
                client.done(Ask::ClearCounters)?;
            }
            terminal.tell(&status.counters, || counters_words(&status.counters))
        }
        Task::Timing => {
            let timing = client.timing()?.ok_or_else(|| BenchError::Option {
                found: "the firmware of the device does not time its setpoints".to_owned(),
                help: "load the firmware of this version".to_owned(),
            })?;
            terminal.tell(&timing, || timing::words(&timing))
        }
        Task::Log { from } => {
            let (entries, next) = client.log(*from)?;
            let shown = log::Log::of(&entries, *from, next);
            terminal.tell(&shown, || shown.words())
        }
        Task::Keys => {
            let trust = trust(client)?;
            terminal.tell(&trust, || trust.words())
        }
        Task::Provision { file, role, no_images, firmware } => {
            let rights = Rights { role: *role, signs: !no_images, firmware: *firmware };
            let whole = rights == Rights::default();
            for key in read_public(file)? {
                client.done(match (firmware, whole) {
                    (true, _) => Ask::ProvisionFirmware { key, rights },
                    // What an older firmware knows as well.
                    (false, true) => Ask::Provision(key),
                    (false, false) => Ask::ProvisionAs { key, rights },
                })?;
            }
            let trust = trust(client)?;
            terminal.tell(&trust, || trust.words())
        }
        Task::Revoke { key } => {
            client.done(Ask::Revoke(*key))?;
            let trust = trust(client)?;
            terminal.tell(&trust, || trust.words())
        }
        Task::Update { file: Some(file), trial, .. } => update::run(client, file, *trial, terminal),
        Task::Update { confirm, .. } => {
            if *confirm {
                client.done(Ask::Confirm)?;
            }
            let status = update::status(client)?;
            terminal.tell(&status, || update::words(&status))
        }
        Task::Restart { watchdog } => done(client, Ask::Restart { watchdog: *watchdog }, terminal, "restarted"),
        Task::Compute { job, probe, activate: after, minutes } => {
            let probe = Source::read(probe)?;
            let pass = Pass::read(JobFile::read(job)?)?.of_file(&probe)?;
            let compact = levels::compact(&pass)?;
            let ingredients = Ingredients { program: pass.program.bytes(), job: &compact, probe: probe.bytes() };
            let mut bar = terminal.progress("computing on the device", truepath_core::link::Stage::Ended as u64 * 1000);
            let patience = Duration::from_secs(60 * minutes);
            let (made, time) = compute(client, &ingredients, patience, |now| {
                bar.reached(now.stage as u64 * 1000 + u64::from(now.permille));
            })?;
            drop(bar);
            if *after {
                activate(client, made.slot)?;
            }
            let seconds = time.as_secs_f64();
            let both = serde_json::json!({
                "slot": made.slot, "crc": format!("{:08x}", made.crc), "length": made.length, "seconds": seconds });
            terminal.tell(&both, || {
                format!("image {:08x} of {} bytes in slot {}, {seconds:.1} s\n", made.crc, made.length, made.slot)
            })
        }
    }
}

/// What the view marks of an image.
fn known(path: &Path) -> Result<Known, Failure> {
    let bytes = image::read(path)?;
    Ok(Known::of(&image::check(&bytes, path)?))
}

fn connect(port: Option<&str>, baud: u32) -> Result<Client<Line>, BenchError> {
    let Some(name) = port else {
        return Err(BenchError::Option {
            found: "no port is named".to_owned(),
            help: "add --port with a serial port, a Unix socket or tcp:HOST:PORT".to_owned(),
        });
    };
    let line = Line::open(name, baud).map_err(|e| BenchError::open(name, &e))?;
    // Not the id of the request before this one, which the device remembers.
    let now = std::time::UNIX_EPOCH.elapsed().unwrap_or_default();
    Ok(Client::new(line, now.as_millis() as u16))
}

/// A request without an answer of its own.
fn done(client: &mut Client<Line>, ask: Ask<'_>, terminal: &Terminal, words: &str) -> Result<(), Failure> {
    client.done(ask)?;
    terminal.tell(&serde_json::json!({ "done": words }), || format!("{words}\n"))
}

fn slots_words(slots: &[Slot; 2]) -> String {
    let one = |(index, slot): (usize, &Slot)| match slot {
        Slot::Empty => format!("slot {index}: empty\n"),
        Slot::Damaged => format!("slot {index}: damaged; the next upload erases it\n"),
        Slot::Partial { length, crc, written } => {
            format!("slot {index}: upload of {crc:08x} interrupted at {written} of {length} bytes\n")
        }
        Slot::Image { length, crc, generation, active, binding } => {
            let word = if *active { ", ACTIVE" } else { "" };
            format!(
                "slot {index}: image {crc:08x}, {length} bytes, upload {generation}{word}\n        \
                 program {:08x}, feature {}, pass {}, tool {}, offset {}, setup {}\n",
                binding.program_crc, binding.feature, binding.pass, binding.tool, binding.tool_offset, binding.setup
            )
        }
    };
    slots.iter().enumerate().map(one).collect()
}

fn status_words(s: &DeviceStatus) -> String {
    let image = s.active.map_or_else(|| "no image".to_owned(), |a| format!("image {:08x} of slot {}", a.crc, a.slot));
    let drives = if s.drive_enable { "passed on" } else { "dropped" };
    let recorder = if s.recording_frozen { "stands since the last fault" } else { "runs" };
    format!(
        "{} ({}), drive enable {drives}, {image}, recorder {recorder}, up for {:.1} s\n",
        s.mode,
        s.reason,
        s.uptime_us as f64 / 1e6
    )
}

fn counters_words(counters: &Counters) -> String {
    let c = Counts::from(counters);
    let mut text = format!(
        "accepted {}\nanswered {}\ndamaged {}\nrepeated {}\nout of order {}\nlost {}\njumps {}\nlate {}\nsilences {}\n",
        c.accepted, c.answered, c.damaged, c.repeated, c.out_of_order, c.lost, c.jumps, c.late, c.silences
    );
    for (reason, count) in counters.by_fault().filter(|&(_, count)| count > 0) {
        // Writing to a String cannot fail.
        let _ = writeln!(text, "fault: {reason} {count}");
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use truepath_core::rewrite::Reason;

    #[test]
    fn every_fault_that_is_counted_is_shown_with_its_count() {
        let mut counters = Counters::default();
        for (count, counter) in (1..).zip(&mut counters.faults) {
            *counter = 100 + count;
        }
        let text = counters_words(&counters);
        let faults: Vec<Reason> = Reason::ALL.into_iter().filter(|reason| reason.is_fault()).collect();
        assert_eq!(faults.len(), counters.faults.len());
        for (count, reason) in (1..).zip(faults) {
            let line = format!("fault: {reason} {}", 100 + count);
            assert!(text.lines().any(|l| l == line), "{line} is missing in\n{text}");
        }
    }
}
