//! Recorded setpoints through the device's own code.
//!
//! The ticks of a file go through [`Rewriter::tick`], which is what the coprocessor calls, in the same order and with
//! the same settings scaled to the file's tick rate: what comes out is what the device would have sent to the drives,
//! bit for bit. The image is armed with its own identity, once, before the first tick.
//!
//! What the controller said besides the positions comes from the optional columns of the file (flags, frame, disarmed by
//! command); settings other than the usual ones come from the caller. With both, a recorded run is reproduced to the
//! last bit from its arming on.
//!
//! Limits: X, Y, Z on the first three axes, no mirror; the spindle speed is fresh throughout, no tick is missing.

use truepath_core::image::Image;
use truepath_core::rewrite::{
    AXES, ArmRequest, Digest, Frame, Mode, Output, Reason, Rewriter, Setpoint, Settings, State, Status, TURN_BITS,
    TURN_ONE,
};
use truepath_core::units::{Real, shift_rounded_i64, sin_cos};
use truepath_ground::diagnostics::Failure;

use crate::codes::{R001, R002};
use crate::setpoints::Setpoints;

/// Where the program stands in the machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Placement {
    /// Machine coordinates of the program's origin, nm.
    pub origin_nm: [i64; 3],
    /// Cosine of the turn of the program in the XY plane, counter-clockwise, units of 2⁻³⁰.
    pub cosine: i32,
    /// Sine of that turn.
    pub sine: i32,
}

impl Default for Placement {
    /// Program coordinates are machine coordinates.
    fn default() -> Self {
        Self { origin_nm: [0; 3], cosine: TURN_ONE, sine: 0 }
    }
}

impl Placement {
    /// The origin, nm, and a turn in degrees.
    pub fn turned(origin_nm: [i64; 3], rotation_deg: Real) -> Self {
        let (sine, cosine) = sin_cos(rotation_deg * Real::PI / Real::from_int(180));
        let turn = |v: Real| shift_rounded_i64(v.bits(), Real::FRACTION_BITS - TURN_BITS) as i32;
        Self { origin_nm, cosine: turn(cosine), sine: turn(sine) }
    }

    /// As the controller sends it with the arming: X, Y, Z on the first three axes.
    pub fn frame(&self) -> Frame {
        let Self { origin_nm, cosine, sine } = *self;
        Frame { offset_nm: origin_nm, cosine, sine, ..Frame::identity() }.sealed()
    }
}

/// What is replayed besides the file.
#[derive(Clone, Debug)]
pub struct Run {
    /// Where the program stands.
    pub placement: Placement,
    /// Serial number of the part.
    pub part_serial: u32,
    /// Settings of the rewriter; see [`settings`] for the usual ones.
    pub settings: Settings,
}

/// What came of a replay.
#[derive(Clone, Debug, serde::Serialize)]
pub struct Summary {
    /// Ticks replayed.
    pub ticks: usize,
    /// Ticks with a correction on (Active, Hold, and ramping out in Fault).
    pub corrected_ticks: usize,
    /// Largest correction of an axis, mm.
    pub max_correction_mm: f64,
    /// Ticks above the warn level.
    pub warned_ticks: usize,
    /// Ticks in which the clamp cut the correction.
    pub saturated_ticks: usize,
    /// Ticks with a faded correction.
    pub faded_ticks: usize,
    /// State after the last tick.
    pub state: String,
    /// Number of the reason for which the correction ended; 0 for none.
    pub reason: u16,
    /// The same in words.
    pub reason_text: String,
    /// Whether it was a fault.
    pub fault: bool,
    /// Fingerprint of all outputs; the device gives the same for the same ticks.
    pub digest: String,
}

/// Replays setpoints; `each` gets every tick's output in order.
///
/// # Errors
/// `R001` for a tick rate outside 10 Hz … 100 kHz or a setting out of range, `R002` when the image refuses to be armed,
/// and whatever `each` answers.
pub fn replay(
    image: Image<'_>,
    setpoints: &Setpoints,
    run: &Run,
    mut each: impl FnMut(usize, &Output) -> Result<(), Failure>,
) -> Result<Summary, Failure> {
    let nominal_millirpm = image.settings().feed.spindle_millirpm;
    let request =
        ArmRequest { binding: image.settings().binding, part_serial: run.part_serial, frame: run.placement.frame() };
    let rewriter = Rewriter::new(run.settings, Some(image)).map_err(|e| R001.error(e.to_string(), ""))?;
    let mut state = State::default();
    let refused = |e: truepath_core::rewrite::Refusal| R002.error(e.to_string(), "");
    rewriter.acknowledge_drives_disabled(&mut state).map_err(refused)?;
    rewriter.arm(&mut state, &request).map_err(refused)?;
    let mut tally = Tally::default();
    for (index, row) in setpoints.rows.iter().enumerate() {
        let mut axes = [0; AXES];
        for (axis, nm) in axes.iter_mut().zip(row.position_nm) {
            *axis = nm;
        }
        let setpoint = Setpoint {
            axes,
            spindle_millirpm: row.spindle_rpm.map_or(nominal_millirpm, millirpm),
            spindle_age_ticks: 0,
            sequence: index as u32 + 1,
            frame_crc: row.frame_crc.unwrap_or(request.frame.crc),
            flags: row.flags,
        };
        if row.disarm {
            // Where nothing is armed any more the controller's command was refused as well.
            let _ = rewriter.disarm(&mut state);
        }
        let output = rewriter.tick(&mut state, &setpoint);
        tally.add(&output);
        each(index, &output)?;
    }
    Ok(tally.summary(state.mode(), state.reason()))
}

/// The settings of a device at 1 kHz, scaled to another rate; the rewriter checks that there is such a rate.
pub fn settings(period_ns: i64) -> Settings {
    let hz = (1_000_000_000 + period_ns / 2) / period_ns.max(1);
    let tick_hz = u32::try_from(hz).unwrap_or(u32::MAX);
    Settings::at_rate(tick_hz)
}

fn millirpm(rpm: Real) -> u32 {
    u32::try_from((rpm * Real::from_int(1000)).round_to_int()).unwrap_or(0)
}

/// Counts over all ticks.
#[derive(Default)]
struct Tally {
    ticks: usize,
    corrected: usize,
    warned: usize,
    saturated: usize,
    faded: usize,
    largest_nm: u32,
    digest: Digest,
}

impl Tally {
    fn add(&mut self, output: &Output) {
        self.ticks += 1;
        self.corrected += usize::from(matches!(output.mode, Mode::Active | Mode::Hold | Mode::Fault));
        self.warned += usize::from(output.status.has(Status::WARN));
        self.saturated += usize::from(output.status.has(Status::SATURATED));
        self.faded += usize::from(output.status.has(Status::FADED));
        let largest = output.correction_nm.iter().map(|nm| nm.unsigned_abs()).max().unwrap_or(0);
        self.largest_nm = self.largest_nm.max(largest);
        self.digest.add(output);
    }

    fn summary(self, mode: Mode, reason: Reason) -> Summary {
        Summary {
            ticks: self.ticks,
            corrected_ticks: self.corrected,
            max_correction_mm: f64::from(self.largest_nm) / 1e6,
            warned_ticks: self.warned,
            saturated_ticks: self.saturated,
            faded_ticks: self.faded,
            state: mode.to_string(),
            reason: reason.code(),
            reason_text: reason.to_string(),
            fault: reason.is_fault(),
            digest: format!("{:016x}", self.digest.value()),
        }
    }
}
