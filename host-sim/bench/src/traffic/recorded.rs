//! Recorded setpoints as traffic: acknowledged, armed once, then row by row.

use truepath_core::rewrite::{ArmRequest, Flags, Mode, Setpoint};
use truepath_core::units::Real;
use truepath_trial::setpoints::Setpoints;

use super::{Command, LEAD, Traffic};

/// A file of setpoints being played.
#[derive(Clone, Debug)]
pub struct Recorded {
    setpoints: Setpoints,
    nominal_millirpm: u32,
    request: ArmRequest,
    row: usize,
    sequence: u32,
    /// Setpoints sent with the drives disabled since the mode became `Off`.
    waited: u32,
    /// Whether this round was armed, and whether its end was commanded.
    armed: bool,
    disarmed: bool,
    /// How often the file is still to be played.
    rounds: u32,
}

impl Recorded {
    /// Plays a file `rounds` times, each time as another part. Without a column of its own the spindle runs at the
    /// nominal speed of the image.
    pub fn new(setpoints: Setpoints, request: ArmRequest, nominal_millirpm: u32, rounds: u32) -> Self {
        Self {
            setpoints,
            nominal_millirpm,
            request,
            row: 0,
            sequence: 0,
            waited: 0,
            armed: false,
            disarmed: false,
            rounds,
        }
    }

    /// The present row, or the last one behind the end: the machine stands there until the correction is out.
    fn setpoint(&mut self, flags: Flags) -> Option<Command> {
        let rows = &self.setpoints.rows;
        let row = rows.get(self.row).or(rows.last())?;
        let [x, y, z] = row.position_nm;
        self.sequence = self.sequence.wrapping_add(1);
        Some(Command::Setpoint(Setpoint {
            axes: [x, y, z, 0, 0, 0],
            spindle_millirpm: row.spindle_rpm.map_or(self.nominal_millirpm, millirpm),
            spindle_age_ticks: 0,
            sequence: self.sequence,
            frame_crc: self.request.frame.crc,
            flags,
        }))
    }
}

impl Traffic for Recorded {
    fn next(&mut self, mode: Mode) -> Option<Command> {
        if mode == Mode::Off && self.rounds > 0 {
            if self.waited == LEAD {
                self.waited = 0;
                return Some(Command::Acknowledge);
            }
            self.waited += 1;
            return self.setpoint(Flags::default());
        }
        let behind = self.row >= self.setpoints.rows.len();
        if behind && mode == Mode::Bypass {
            self.rounds = self.rounds.saturating_sub(1);
            self.row = 0;
            (self.armed, self.disarmed) = (false, false);
            self.request.part_serial = self.request.part_serial.wrapping_add(1);
        } else if behind && matches!(mode, Mode::Armed | Mode::Active | Mode::Hold) && !self.disarmed {
            self.disarmed = true;
            return Some(Command::Disarm);
        }
        if self.rounds == 0 {
            return None;
        }
        if mode == Mode::Bypass && !self.armed {
            self.armed = true;
            return Some(Command::Arm(self.request));
        }
        let usual = Flags::DRIVES_ENABLED.with(Flags::SPINDLE_LOADED);
        let command = self.setpoint(self.setpoints.rows.get(self.row).map_or(usual, |row| row.flags));
        self.row = self.row.saturating_add(1);
        command
    }
}

fn millirpm(rpm: Real) -> u32 {
    u32::try_from((rpm * Real::from_int(1000)).round_to_int()).unwrap_or(0)
}
