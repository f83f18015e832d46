//! Setpoints and faults for a board, every answer compared with the host's own code.

use std::path::Path;
use std::sync::Arc;

use truepath_bench::codes::H007;
use truepath_bench::traffic::{Command, Controller, ControllerOptions, Recorded};
use truepath_bench::{
    Board, Campaign, Faults, Plan, Probability, RunStatus, Traffic, Watch, identify, prepare, to_off,
};
use truepath_core::image::Image;
use truepath_core::link::{Ask, DeviceSettings};
use truepath_core::rewrite::{ArmRequest, Mode};
use truepath_ground::diagnostics::{Failure, InputError};
use truepath_trial::replay;
use truepath_trial::setpoints::{Frame, Setpoints};

use super::report::{Report, report};

/// What the controller sends.
#[derive(Clone, Debug)]
pub enum Source {
    /// The image's own path, well behaved but for feed holds and overrides.
    Path,
    /// The same with disturbances, in changing frames.
    Random,
    /// A file.
    Recorded(Setpoints),
}

/// A run.
#[derive(Clone, Debug)]
pub struct Options {
    /// What is sent.
    pub source: Source,
    /// Setpoints in all; for a file rounded up to whole rounds.
    pub count: u64,
    /// Axes of a setpoint, 3…6.
    pub axes: u8,
    /// Setpoints per second.
    pub rate_hz: u32,
    /// Faults of the cable.
    pub faults: Faults,
    /// Seed of controller and cable.
    pub seed: u64,
}

/// Runs setpoints through a board. `progress` is told after every batch.
///
/// # Errors
/// The board cannot be reached, is of another version, or refuses; the options do not go together. A difference is no
/// error here: it is in the report.
pub fn run(
    board: &mut dyn Board,
    bytes: &[u8],
    options: &Options,
    progress: &mut dyn FnMut(&RunStatus<'_>),
) -> Result<Report, Failure> {
    run_watched(board, bytes, options, &Arc::default(), progress)
}

/// The same with somebody who looks on and may end it: a run that was stopped has the report of what was done.
///
/// # Errors
/// As [`run`]; `H008` when it was left within a batch.
pub fn run_watched(
    board: &mut dyn Board,
    bytes: &[u8],
    options: &Options,
    watch: &Arc<Watch>,
    progress: &mut dyn FnMut(&RunStatus<'_>),
) -> Result<Report, Failure> {
    let image = Image::new_checked(bytes).map_err(|e| Failure::Internal(format!("an image that was checked: {e}")))?;
    let device = identify(board)?;
    let settings = settings(options, board.is_stepped())?;
    let before = prepare(board, bytes, &settings, |_| ())?;
    let plan = Plan { settings, faults: options.faults, seed: options.seed };
    let campaign = Campaign::new(plan, image, board.is_stepped())?;
    let mut traffic = Stoppable { traffic: traffic(image, options), watch };
    board.watched_by(Arc::clone(watch));
    let outcome = campaign.run(&mut traffic, board, progress)?;
    let counters = board.client().status()?.counters;
    let report = report(board, device, &outcome, &counters);
    if !board.is_stepped() {
        // What the device was before; an emulator or a device in process is gone with the run.
        to_off(board, settings.silence_us)?;
        board.client().done(Ask::Configure(before))?;
    }
    Ok(report)
}

/// Traffic that ends when it is asked to.
struct Stoppable<'a> {
    traffic: Box<dyn Traffic>,
    watch: &'a Watch,
}

impl Traffic for Stoppable<'_> {
    fn next(&mut self, mode: Mode) -> Option<Command> {
        if self.watch.is_stopping() { None } else { self.traffic.next(mode) }
    }
}

/// Settings for a run. Over streams the clock of the device is not ours: deadline and silence are then as long as they
/// may be, so that no answer depends on how busy this machine is.
///
/// # Errors
/// `H007` for a rate or a number of axes that there is not.
pub fn settings(options: &Options, stepped: bool) -> Result<DeviceSettings, InputError> {
    let period_ns = 1_000_000_000 / i64::from(options.rate_hz.max(1));
    let rewriter = replay::settings(period_ns);
    let (deadline_us, silence_us) = if stepped { (500, SILENCE_US) } else { (1_000_000, 10_000_000) };
    let settings = DeviceSettings { rewriter, axes: options.axes, deadline_us, silence_us };
    settings.check().map_err(|e| InputError::new(H007, e.to_string(), "", "choose other --rate or --axes"))?;
    Ok(settings)
}

/// Setpoint rate of a device over streams when setpoints go out as fast as the answers come, Hz. No stream reaches it, so
/// that no burst is faster than the device permits.
pub const STREAM_HZ: u32 = 20_000;
/// Silence of a board whose clock is ours, µs.
pub const SILENCE_US: u32 = 20_000;

fn traffic(image: Image<'_>, options: &Options) -> Box<dyn Traffic> {
    let probability = |share| Probability::new(share).unwrap_or_default();
    let behaviour = ControllerOptions {
        count: options.count,
        axes: options.axes,
        tick_hz: options.rate_hz,
        operate: probability(0.001),
        disturb: probability(0.0),
        frames: false,
    };
    // Parts of a run are numbered from its seed on, so that a device remembers none of them from the run before.
    let serial = 1_000u32.wrapping_mul(options.seed as u32);
    match &options.source {
        Source::Path => Box::new(Controller::new(&image, behaviour, serial, options.seed)),
        Source::Random => {
            let disturbed = ControllerOptions { disturb: probability(0.0005), frames: true, ..behaviour };
            Box::new(Controller::new(&image, disturbed, serial, options.seed))
        }
        Source::Recorded(setpoints) => {
            let request = ArmRequest {
                binding: image.settings().binding,
                part_serial: serial,
                frame: truepath_core::rewrite::Frame::identity(),
            };
            let rounds = options.count.div_ceil(setpoints.rows.len().max(1) as u64).max(1);
            let nominal = image.settings().feed.spindle_millirpm;
            Box::new(Recorded::new(setpoints.clone(), request, nominal, rounds.try_into().unwrap_or(u32::MAX)))
        }
    }
}

/// Recorded setpoints for a run: program coordinates, from a file.
///
/// # Errors
/// As [`Setpoints::parse`]; `H007` for a file in machine coordinates.
pub fn recorded(path: &Path) -> Result<Setpoints, InputError> {
    let source = truepath_ground::diagnostics::Source::read(path)?;
    let setpoints = Setpoints::parse(&source)?;
    if setpoints.frame == Frame::Machine {
        let found = "the setpoints are in machine coordinates";
        let help = "record them in program coordinates (# frame = program): the bench arms with the identity frame";
        return Err(InputError::new(H007, found, "program coordinates", help).at(&source, 0..1));
    }
    Ok(setpoints)
}
