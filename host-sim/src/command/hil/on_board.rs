//! The correction made on the device, compared with the one made here.

use std::path::Path;
use std::time::{Duration, Instant};

use serde::Serialize;
use truepath_bench::{BenchError, Board, Ingredients, Load, RoundTrip, begin, configure, look, stage, too_long};
use truepath_core::image::Image;
use truepath_core::link::{Computed, DeviceSettings};
use truepath_core::rewrite::SettingsError;
use truepath_correction::correct::correct_pass;
use truepath_ground::diagnostics::{Failure, Source};
use truepath_job::job::{JobFile, Route};
use truepath_job::levels;
use truepath_job::measurement::Measurement;
use truepath_job::pass::Pass;

/// An image made twice.
#[derive(Clone, Debug, Serialize)]
pub struct OnBoard {
    /// Checksum of the image the device made.
    pub crc: u32,
    /// Its bytes.
    pub bytes: u32,
    /// Checksum of the image made here.
    pub host_crc: u32,
    /// Its bytes.
    pub host_bytes: u32,
    /// Slot of the device it lies in.
    pub slot: u8,
    /// Time on the device, s.
    pub seconds: f64,
    /// Setpoints that were sent while it computed, and answered as ever. (Over streams only: a batch does one thing
    /// after the other.)
    pub setpoints_meanwhile: usize,
    /// Their round trips.
    pub round_trip: Option<RoundTrip>,
    /// The image.
    #[serde(skip)]
    pub image: Vec<u8>,
}

impl OnBoard {
    /// Whether both are the same image. (A CRC-32 and the length of images that agree in 2³² cases by chance once.)
    pub const fn is_identical(&self) -> bool {
        self.crc == self.host_crc && self.bytes == self.host_bytes
    }
}

/// Computes on the device, with setpoints meanwhile where there is a way for them.
fn compute(
    board: &mut dyn Board,
    settings: &DeviceSettings,
    ingredients: &Ingredients<'_>,
    image: Image<'_>,
    progress: &mut dyn FnMut(&str),
) -> Result<(Computed, Duration, Vec<u64>), BenchError> {
    configure(board, settings)?;
    let unfit =
        |e: SettingsError| BenchError::Option { found: e.to_string(), help: "choose another --rate".to_owned() };
    let mut load = Load::new(*settings, image).map_err(unfit)?;
    begin(&mut board.client(), ingredients)?;
    let start = Instant::now();
    loop {
        let (now, made) = look(&mut board.client())?;
        progress(stage(now.stage));
        match made {
            Some(made) => return Ok((made, start.elapsed(), load.round_trips_ns())),
            None if start.elapsed() > PATIENCE => return Err(too_long(&now, PATIENCE)),
            None => load.beat(board, BEAT)?,
        }
    }
}

/// Setpoints between two looks.
const BEAT: u32 = 100;
/// How long the device may take.
const PATIENCE: Duration = Duration::from_secs(30 * 60);

/// Has the device make the image of a job, and makes it here. `progress` is told each stage.
///
/// # Errors
/// What is wrong with job, program or probe file; the device refuses or fails.
pub fn on_board(
    board: &mut dyn Board,
    settings: &DeviceSettings,
    job: &Path,
    probe: &Path,
    progress: &mut dyn FnMut(&str),
) -> Result<OnBoard, Failure> {
    let probe = Source::read(probe)?;
    let mut pass = Pass::read(JobFile::read(job)?)?.of_file(&probe)?;
    // The device fits machine and material alone.
    pass.job.discrepancy = false;
    let program = pass.program.clone();
    let compact = levels::compact(&pass)?;
    let measurement = Measurement::read(&pass, &probe)?;
    let here = correct_pass(&pass, &measurement, &[], &[Route::Coprocessor], &mut |_| ())?;
    let image = here.image.unwrap_or_default();
    let host_crc = Image::new_checked(&image).map_err(|e| Failure::Internal(e.to_string()))?.crc();
    let ingredients = Ingredients { program: program.bytes(), job: &compact, probe: probe.bytes() };
    let checked = Image::new_checked(&image).map_err(|e| Failure::Internal(e.to_string()))?;
    let (made, time, round_trips_ns) = compute(board, settings, &ingredients, checked, progress)?;
    let found = OnBoard {
        crc: made.crc,
        bytes: made.length,
        host_crc,
        host_bytes: image.len() as u32,
        slot: made.slot,
        seconds: time.as_secs_f64(),
        setpoints_meanwhile: round_trips_ns.len(),
        round_trip: RoundTrip::of(round_trips_ns),
        image,
    };
    if found.is_identical() {
        return Ok(found);
    }
    let text = format!(
        "the device made image {:08x} of {} bytes, the host {:08x} of {}",
        found.crc, found.bytes, found.host_crc, found.host_bytes
    );
    Err(BenchError::Differs(text).into())
}
