//! A controller that mills the part of an image again and again, and does now and then what it should not.
//!
//! One part: arm, go over the start, plunge, follow the path with overrides and feed holds, retract. After the end of
//! an arming, by itself or by a disturbance, it goes on for a while as if nothing had happened: that is a spring pass, or a
//! restart in the middle without a new arming, and must go out uncorrected. Then comes the next part.

use truepath_core::image::Image;
use truepath_core::rewrite::{AXES, ArmRequest, AxisMap, Flags, Frame, Mode, Setpoint, TURN_ONE};

use super::cursor::Cursor;
use super::disturbance::{Conditions, Spindle, disturb, operate};
use super::{Command, LEAD, Traffic};
use crate::chance::{Chance, Probability};

/// How the controller behaves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ControllerOptions {
    /// Setpoints in all.
    pub count: u64,
    /// Axes of a setpoint, 3…6.
    pub axes: u8,
    /// Setpoints per second.
    pub tick_hz: u32,
    /// Feed hold or override in a tick.
    pub operate: Probability,
    /// A disturbance in a tick.
    pub disturb: Probability,
    /// Whether each part may be clamped elsewhere: offset, turned by 3-4-5 triangles, mirrored, on other axes.
    pub frames: bool,
}

/// Where in the part it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Phase {
    /// Setpoints with the drives disabled, so many left.
    Waiting(u32),
    /// Over the start, so many ticks down to the pass.
    Plunging(u32),
    /// Along the path.
    Milling,
    /// The arming is over; so many ticks more.
    Afterwards(u32),
}

/// Ticks from above the gate into the pass.
const PLUNGE: u32 = 60;
/// Ticks before the gate over which it comes down.
const CLEAR: u32 = 4;

/// The controller.
#[derive(Clone, Debug)]
pub struct Controller {
    options: ControllerOptions,
    chance: Chance,
    cursor: Cursor,
    request: ArmRequest,
    nominal_millirpm: u32,
    /// Way per tick at the nominal feed, nm.
    feed_nm: i64,
    pass_nm: i64,
    gate_nm: i64,
    phase: Phase,
    conditions: Conditions,
    sequence: u32,
    sent: u64,
    armed: bool,
    /// Ticks since the arming, to give up a part that hangs.
    ticks: u64,
}

impl Controller {
    /// A controller for the part of an image; the same seed gives the same traffic. `serial` numbers the first part.
    pub fn new(image: &Image<'_>, options: ControllerOptions, serial: u32, seed: u64) -> Self {
        let settings = image.settings();
        let window = settings.window;
        let teeth_per_s = u64::from(settings.feed.teeth) * u64::from(settings.feed.spindle_millirpm) / 60_000;
        let per_tooth = settings.feed.per_tooth.offset().nm();
        Self {
            chance: Chance::new(seed, 0),
            cursor: Cursor::new(image),
            request: ArmRequest { binding: settings.binding, part_serial: serial, frame: Frame::identity() },
            nominal_millirpm: settings.feed.spindle_millirpm,
            feed_nm: (per_tooth * teeth_per_s as i64 / i64::from(options.tick_hz.max(1))).max(1),
            pass_nm: (window.z_low.nm() + window.z_high.nm()) / 2,
            gate_nm: window.z_high.nm() + window.gate_height.nm(),
            phase: Phase::Waiting(LEAD),
            conditions: Conditions::calm(),
            sequence: first_sequence(seed),
            sent: 0,
            armed: false,
            ticks: 0,
            options,
        }
    }

    /// The request with which the next part will be armed.
    fn next_part(&mut self) -> ArmRequest {
        self.request.part_serial = self.request.part_serial.wrapping_add(1);
        if self.options.frames {
            self.request.frame = frame(&mut self.chance, self.options.axes);
        }
        self.cursor.rewind();
        self.phase = Phase::Plunging(PLUNGE + CLEAR);
        self.conditions = Conditions::calm();
        self.armed = true;
        self.ticks = 0;
        self.request
    }

    /// One tick on in the phase; gives Z, program coordinates.
    fn move_on(&mut self) -> i64 {
        match &mut self.phase {
            Phase::Waiting(_) => self.gate_nm + 10_000_000,
            Phase::Plunging(left) => {
                *left = left.saturating_sub(1);
                let height = (self.gate_nm - self.pass_nm) * i64::from(*left) / i64::from(PLUNGE);
                if *left == 0 {
                    self.phase = Phase::Milling;
                }
                self.pass_nm + height
            }
            Phase::Milling | Phase::Afterwards(_) => {
                if let Phase::Afterwards(left) = &mut self.phase {
                    *left = left.saturating_sub(1);
                }
                let conditions = &mut self.conditions;
                if conditions.hold > 0 {
                    conditions.hold -= 1;
                } else {
                    let way = self.feed_nm * conditions.feed_256 / 256;
                    self.cursor.advance(if conditions.backwards > 0 { -way } else { way });
                    conditions.backwards = conditions.backwards.saturating_sub(1);
                }
                // At the end it lifts off; an image that ends closed would start again.
                let lift = if self.cursor.at_end() { 3_000_000 } else { conditions.lift_nm };
                self.pass_nm + lift
            }
        }
    }

    fn setpoint(&mut self) -> Setpoint {
        let z = self.move_on();
        let [x, y] = self.cursor.xy();
        let mut axes = [0i64; AXES];
        for (spare, axis) in axes.iter_mut().enumerate() {
            *axis = 1_000_000 * spare as i64;
        }
        let frame = &self.request.frame;
        for (map, nm) in frame.axes.iter().zip(frame.machine_nm(x, y, z)) {
            axes[usize::from(map.axis) % AXES] = nm;
        }
        let mut flags = Flags::SPINDLE_LOADED;
        if !matches!(self.phase, Phase::Waiting(_)) {
            flags = flags.with(Flags::DRIVES_ENABLED);
        }
        if self.conditions.hold > 0 {
            flags = flags.with(Flags::FEED_HOLD);
        }
        let (spindle_millirpm, spindle_age_ticks) = match self.conditions.spindle {
            Spindle::Nominal => (self.nominal_millirpm, 0),
            Spindle::Stopped => (0, 0),
            Spindle::Stale => (self.nominal_millirpm, 60_000),
            Spindle::Other(share) => ((u64::from(self.nominal_millirpm) * u64::from(share) / 256) as u32, 1),
        };
        self.sequence = self.sequence.wrapping_add(1);
        Setpoint { axes, spindle_millirpm, spindle_age_ticks, sequence: self.sequence, frame_crc: frame.crc, flags }
    }
}

impl Traffic for Controller {
    fn next(&mut self, mode: Mode) -> Option<Command> {
        if self.sent >= self.options.count {
            return None;
        }
        match (mode, self.phase) {
            (Mode::Off, Phase::Waiting(0)) => {
                self.phase = Phase::Waiting(LEAD);
                return Some(Command::Acknowledge);
            }
            (Mode::Off, Phase::Waiting(left)) => self.phase = Phase::Waiting(left - 1),
            (Mode::Off, _) => {
                self.phase = Phase::Waiting(LEAD);
                self.armed = false;
            }
            (Mode::Bypass, Phase::Waiting(_) | Phase::Afterwards(0)) => return Some(Command::Arm(self.next_part())),
            (Mode::Bypass, Phase::Plunging(_) | Phase::Milling) if self.armed => {
                // On as before, or from the start once more, or from the middle: nothing of it is armed.
                match self.chance.below(3) {
                    0 => self.cursor.rewind(),
                    1 => self.cursor.place_at(self.chance.below(self.cursor.len() as u64) as usize),
                    _ => {}
                }
                self.phase = Phase::Afterwards(self.chance.below(80) as u32);
                self.conditions = Conditions::calm();
                self.armed = false;
            }
            (Mode::Armed | Mode::Hold | Mode::Active, _) if self.ticks > self.patience() => {
                self.ticks = 0;
                return Some(Command::Disarm);
            }
            _ => {}
        }
        self.ticks += 1;
        let moving = matches!(self.phase, Phase::Milling | Phase::Afterwards(_));
        if moving && self.chance.happens(self.options.operate) {
            operate(&mut self.chance, &mut self.conditions);
        }
        let disturbed = self.chance.happens(self.options.disturb);
        if disturbed && self.chance.one_in(20) {
            return Some(Command::Disarm);
        }
        self.sent += 1;
        let mut setpoint = self.setpoint();
        if disturbed {
            disturb(&mut self.chance, &mut self.conditions, &mut setpoint);
        }
        self.sequence = setpoint.sequence;
        Some(Command::Setpoint(setpoint))
    }
}

impl Controller {
    /// Ticks after which a part is given up: four times the path at half the feed.
    fn patience(&self) -> u64 {
        1_000 + 8 * self.cursor.way().unsigned_abs() / self.feed_nm.unsigned_abs()
    }
}

/// Where the counting starts: near the end of the range for odd seeds, so that it wraps.
fn first_sequence(seed: u64) -> u32 {
    if seed % 2 == 1 { u32::MAX - 500 } else { 0 }
}

/// A clamping of the part: offset, turn with 3-4-5 triangles or quarters, mirrored or not, on any axes.
fn frame(chance: &mut Chance, axes: u8) -> Frame {
    // 0.6 and 0.8 in 2⁻³⁰, rounded.
    const SIX_TENTHS: i32 = 644_245_094;
    const EIGHT_TENTHS: i32 = 858_993_459;
    let turns = [(TURN_ONE, 0), (0, TURN_ONE), (-TURN_ONE, 0), (EIGHT_TENTHS, SIX_TENTHS), (-SIX_TENTHS, EIGHT_TENTHS)];
    let (cosine, sine) = turns[chance.below(turns.len() as u64) as usize];
    let first = chance.below(axes.into()) as u8;
    let map = |k: u8, reversed| AxisMap { axis: (first + k) % axes, reversed };
    let axes = [map(0, chance.one_in(2)), map(1, chance.one_in(2)), map(2, false)];
    let offset_nm = [(); 3].map(|()| chance.around(500_000_000));
    Frame { offset_nm, cosine, sine, axes, crc: 0 }.sealed()
}
