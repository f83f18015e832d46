//! The command line of `truepath device`.

use std::path::PathBuf;

use clap::{Args, Subcommand};

use super::arm::ArmArguments;

#[derive(Debug, Args)]
pub(in crate::cli) struct Arguments {
    /// Configuration link: a serial port, a Unix socket, or tcp:HOST:PORT.
    #[arg(long, alias = "socket", value_name = "PORT", global = true, required = false)]
    pub port: Option<String>,
    /// Bits per second of a serial port.
    #[arg(long, value_name = "BAUD", global = true, default_value_t = 921_600)]
    pub baud: u32,
    #[command(subcommand)]
    pub task: Task,
}

#[derive(Debug, Subcommand)]
pub(in crate::cli) enum Task {
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
    Arm(ArmArguments),
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
    /// Resets the device.
    Restart {
        /// By letting its watchdog run out.
        #[arg(long)]
        watchdog: bool,
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
