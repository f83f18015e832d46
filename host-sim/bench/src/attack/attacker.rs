//! The controller that attacks: it mills the part of a set-up again and again, and does what it must not, at the edges of
//! what is permitted above all.

use truepath_core::image::{Binding, Image};
use truepath_core::rewrite::{AXES, ArmRequest, AxisMap, Flags, Frame, Mode, Setpoint, TURN_ONE};

use super::setup::Setup;
use crate::chance::Chance;
use crate::traffic::{Command, Cursor};

/// What it does next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Act {
    /// A setpoint, so long after the one before; the servo is ready to answer after a delay.
    Send {
        /// The setpoint.
        setpoint: Setpoint,
        /// Time since the one before, µs.
        gap_us: u32,
        /// From its arrival to the answer, µs.
        delay_us: u32,
        /// What else is on the line with it.
        stray: Stray,
    },
    /// A command.
    Command(Command),
    /// The servo is reset.
    Reset,
    /// Another image is put in use, the first again, or none.
    Image(Option<bool>),
}

/// Bytes beside a frame, which is whole all the same.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stray {
    /// None.
    Nothing,
    /// A delimiter before it.
    Before,
    /// A delimiter behind it.
    Behind,
    /// Noise with a delimiter before it.
    Noise(u64),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Phase {
    /// Drives disabled, so many ticks more.
    Waiting(u64),
    /// Down to the pass over the start, so many ticks more.
    Plunging(i64),
    Milling,
    /// The arming is over, so many ticks more as before.
    Afterwards(u64),
}

/// What is wrong for so many ticks.
#[derive(Clone, Copy, Debug, Default)]
struct Lasting {
    hold: u64,
    /// Ticks before the end of the hold in which the setpoint begins to move.
    moves_at: u64,
    still: u64,
    backwards: u64,
    fast: u64,
    late: u64,
    dead_spindle: u64,
    stale_spindle: u64,
}

/// The controller.
#[derive(Clone, Debug)]
pub struct Attacker {
    bindings: [Binding; 2],
    cursor: Cursor,
    tick_us: u32,
    deadline_us: u32,
    silence_us: u32,
    max_lost: u64,
    max_step_nm: i64,
    tolerance_nm: i64,
    feed_nm: i64,
    axes: u8,
    still_frames: bool,
    nominal_millirpm: u32,
    stale_ticks: u32,
    /// Program Z of the lower and the upper end of the pass, and of the top of the gate, nm.
    heights: [i64; 3],
    /// One tick in so many has an event; 0: none.
    heat: u64,
    phase: Phase,
    lasting: Lasting,
    /// Where it is aside of the path, and where it goes, nm.
    aside: [i64; 2],
    aside_goal: [i64; 2],
    /// The drives stay enabled in `Off`.
    stubborn: bool,
    lift_nm: i64,
    sequence: u32,
    frame: Frame,
    serial: u32,
    armed_before: Vec<u32>,
    image: Option<bool>,
    plunge_ticks: i64,
    patience: u64,
}

impl Attacker {
    /// For a set-up.
    pub fn new(setup: &Setup, chance: &mut Chance) -> Self {
        let [image, other]: [Image<'_>; 2] = setup.images();
        let window = image.settings().window;
        let settings = setup.settings();
        let gate_nm = window.z_high.nm() + window.gate_height.nm().max(window.tolerance.nm());
        Self {
            bindings: [image.settings().binding, other.settings().binding],
            cursor: Cursor::new(&image),
            tick_us: 1_000_000u32.div_ceil(settings.rewriter.tick_hz),
            deadline_us: settings.deadline_us,
            silence_us: settings.silence_us,
            max_lost: settings.rewriter.max_lost_frames.into(),
            max_step_nm: settings.rewriter.max_step.nm(),
            tolerance_nm: window.tolerance.nm(),
            feed_nm: setup.feed_nm(),
            axes: settings.axes,
            still_frames: setup.has_joint_limits(),
            nominal_millirpm: image.settings().feed.spindle_millirpm,
            stale_ticks: settings.rewriter.spindle_stale_ticks,
            heights: [window.z_low.nm(), window.z_high.nm(), gate_nm],
            heat: [0, 30, 80, 200, 1_000][chance.below(5) as usize],
            phase: Phase::Waiting(40),
            lasting: Lasting::default(),
            aside: [0; 2],
            aside_goal: [0; 2],
            stubborn: false,
            lift_nm: 0,
            sequence: if chance.one_in(3) {
                u32::MAX - chance.below(2_000) as u32
            } else {
                chance.below(1 << 32) as u32
            },
            frame: Frame::identity(),
            serial: chance.below(1 << 20) as u32,
            armed_before: vec![],
            image: Some(false),
            plunge_ticks: 2 + chance.below(30) as i64,
            patience: 0,
        }
    }

    /// What it does, given the mode the servo is in.
    pub fn next(&mut self, chance: &mut Chance, mode: Mode) -> Act {
        self.patience += 1;
        if let Some(act) = self.on_mode(chance, mode) {
            return act;
        }
        // A way back and a hold need some time for themselves.
        let busy = self.lasting.backwards > 0 || self.lasting.hold > 0;
        let hot = self.heat > 0 && chance.one_in(self.heat) && (!busy || chance.one_in(6));
        if hot && let Some(act) = self.command(chance) {
            return act;
        }
        let mut setpoint = self.setpoint();
        let mut gap_us = self.tick_us;
        let mut delay_us = chance.below(u64::from(self.deadline_us) + 1) as u32;
        if self.lasting.fast > 0 {
            self.lasting.fast -= 1;
            (gap_us, delay_us) = (self.tick_us / 4, 0);
        }
        if self.lasting.late > 0 {
            self.lasting.late -= 1;
            delay_us = self.deadline_us + 1 + chance.below(3) as u32;
        }
        if hot {
            self.disturb(chance, &mut setpoint, &mut gap_us);
        }
        self.sequence = setpoint.sequence;
        let stray = if hot { stray(chance) } else { Stray::Nothing };
        Act::Send { setpoint, gap_us, delay_us, stray }
    }

    /// What the mode asks for: acknowledge, arm, begin anew.
    fn on_mode(&mut self, chance: &mut Chance, mode: Mode) -> Option<Act> {
        match (mode, self.phase) {
            (Mode::Off, Phase::Waiting(0)) => {
                self.phase = Phase::Waiting(40);
                self.stubborn = false;
                if self.image.is_none() {
                    return Some(self.use_image(Some(false)));
                }
                return Some(Act::Command(Command::Acknowledge));
            }
            (Mode::Off, Phase::Waiting(_)) => {}
            (Mode::Off, _) => {
                self.phase = Phase::Waiting(3 + chance.below(40));
                self.stubborn = chance.one_in(3);
            }
            (Mode::Bypass, Phase::Waiting(0) | Phase::Afterwards(0)) => {
                if self.image.is_none() {
                    return Some(self.use_image(Some(false)));
                }
                return Some(self.arm(chance));
            }
            (Mode::Bypass, Phase::Plunging(_) | Phase::Milling) if self.patience > 3 => {
                // On as before, or from the start, or from the middle: nothing of it is armed.
                match chance.below(3) {
                    0 => self.cursor.rewind(),
                    1 => self.cursor.place_at(chance.below(self.cursor.len() as u64) as usize),
                    _ => {}
                }
                self.phase = Phase::Afterwards(chance.below(30));
            }
            (Mode::Armed | Mode::Active | Mode::Hold, _) if self.patience > 1_500 => {
                self.patience = 0;
                return Some(Act::Command(Command::Disarm));
            }
            _ => {}
        }
        None
    }

    fn use_image(&mut self, image: Option<bool>) -> Act {
        self.image = image;
        Act::Image(image)
    }

    /// The next part: over the start, above the gate.
    fn arm(&mut self, chance: &mut Chance) -> Act {
        if !self.still_frames {
            self.frame = frame(chance, self.axes);
        }
        let again = !self.armed_before.is_empty() && chance.one_in(5);
        let request = if again {
            let before = self.armed_before[chance.below(self.armed_before.len() as u64) as usize];
            self.request(before)
        } else {
            self.serial = self.serial.wrapping_add(1);
            if self.image == Some(false) {
                self.armed_before.push(self.serial);
            }
            self.request(self.serial)
        };
        self.cursor.rewind();
        self.phase = Phase::Plunging(self.plunge_ticks + 3);
        self.lasting = Lasting::default();
        (self.aside, self.aside_goal, self.lift_nm) = ([0; 2], [0; 2], 0);
        self.patience = 0;
        Act::Command(Command::Arm(if chance.one_in(12) { spoilt(chance, request) } else { request }))
    }

    fn request(&self, part_serial: u32) -> ArmRequest {
        let binding = self.bindings[usize::from(self.image == Some(true))];
        ArmRequest { binding, part_serial, frame: self.frame }
    }

    /// A command that nobody expects.
    fn command(&mut self, chance: &mut Chance) -> Option<Act> {
        match chance.below(40) {
            0 => Some(Act::Command(Command::Acknowledge)),
            1 => Some(Act::Command(Command::Disarm)),
            2 | 3 => {
                let frame = if self.still_frames { self.frame } else { frame(chance, self.axes) };
                let serial = self.armed_before.last().copied().unwrap_or(1).wrapping_add(chance.below(3) as u32);
                let request = ArmRequest { frame, ..self.request(serial) };
                Some(Act::Command(Command::Arm(if chance.one_in(2) { spoilt(chance, request) } else { request })))
            }
            4 => Some(Act::Reset),
            5 => {
                let to = [Some(true), Some(false), None][chance.below(3) as usize];
                Some(self.use_image(to))
            }
            _ => None,
        }
    }

    /// Something into the setpoint, or from now on.
    fn disturb(&mut self, chance: &mut Chance, setpoint: &mut Setpoint, gap_us: &mut u32) {
        let some = |chance: &mut Chance| 1 + chance.below(60);
        let about =
            |chance: &mut Chance, nm: i64| nm * [50, 97, 99, 101, 103, 120, 180][chance.below(7) as usize] / 100;
        match chance.below(26) {
            0 => {
                let stop = [Flags::EMERGENCY_STOP, Flags::ABORT, Flags::TOOL_CHANGE, Flags::PROGRAM_END];
                setpoint.flags = setpoint.flags.with(stop[chance.below(4) as usize]);
            }
            1 => setpoint.flags = Flags(setpoint.flags.0 & !Flags::DRIVES_ENABLED.0),
            2 => setpoint.flags = Flags(chance.below(128) as u16),
            3 => setpoint.frame_crc ^= 1 << chance.below(32),
            4..=6 => {
                let turned = chance.below(4) as usize;
                let nm = about(chance, self.tolerance_nm);
                self.aside_goal = [[nm, 0], [0, nm], [-nm, 0], [0, -nm]][turned];
            }
            7 => self.aside_goal = [0; 2],
            8 => self.lift_nm = self.half_pass_nm() + about(chance, self.tolerance_nm),
            9 => self.lift_nm = -self.half_pass_nm() - about(chance, self.tolerance_nm),
            10 => self.lift_nm = self.heights[2] - self.heights[1] + about(chance, self.tolerance_nm),
            11 => self.lift_nm = 0,
            12 => self.lasting.backwards = 40 + some(chance) * 6,
            13 => {
                self.lasting.hold = 4 + some(chance);
                self.lasting.moves_at = if chance.one_in(2) { self.lasting.hold - 3 } else { 0 };
            }
            14 => self.lasting.still = some(chance),
            15 => {
                let axis = chance.below(2) as usize;
                let nm = about(chance, self.max_step_nm);
                let map = self.frame.axes[axis].axis;
                setpoint.axes[usize::from(map) % AXES] += if chance.one_in(2) { nm } else { -nm };
            }
            16 => setpoint.axes[chance.below(AXES as u64) as usize] = (chance.bits() as i64) >> chance.below(60),
            // At the limit of what may be lost, and beyond it.
            17 | 18 => setpoint.sequence = setpoint.sequence.wrapping_add(chance.below(self.max_lost + 4) as u32),
            19 => setpoint.sequence = setpoint.sequence.wrapping_sub(chance.below(70) as u32),
            20 => setpoint.sequence = chance.bits() as u32,
            21 => self.lasting.late = 1 + chance.below(self.max_lost + 3),
            22 => self.lasting.fast = 100 + chance.below(40),
            23 => *gap_us = self.silence_us + self.tick_us * chance.below(3) as u32,
            24 => self.lasting.dead_spindle = 300 + some(chance),
            _ => self.lasting.stale_spindle = 300 + some(chance),
        }
    }

    /// From the middle of the pass to its ends, nm.
    const fn half_pass_nm(&self) -> i64 {
        self.heights[1] - i64::midpoint(self.heights[0], self.heights[1])
    }

    /// One tick on; gives program X, Y, Z.
    fn place(&mut self) -> [i64; 3] {
        let [low, high, gate] = self.heights;
        let pass = i64::midpoint(low, high);
        let z = match &mut self.phase {
            Phase::Waiting(left) => {
                *left = left.saturating_sub(1);
                gate + 10_000_000
            }
            Phase::Plunging(left) => {
                *left -= 1;
                if *left <= 0 {
                    self.phase = Phase::Milling;
                    pass
                } else {
                    pass + (gate - pass) * *left / self.plunge_ticks
                }
            }
            Phase::Milling | Phase::Afterwards(_) => {
                if let Phase::Afterwards(left) = &mut self.phase {
                    *left = left.saturating_sub(1);
                }
                if self.lasting.hold == 0 && self.lasting.still == 0 {
                    let back = self.lasting.backwards > 0;
                    self.lasting.backwards = self.lasting.backwards.saturating_sub(1);
                    self.cursor.advance(if back { -self.feed_nm } else { self.feed_nm });
                }
                if self.cursor.at_end() { gate + 3_000_000 } else { pass + self.lift_nm }
            }
        };
        for (now, goal) in self.aside.iter_mut().zip(self.aside_goal) {
            let step = (self.max_step_nm / 4).max(1);
            *now += (goal - *now).clamp(-step, step);
        }
        let [x, y] = self.cursor.xy();
        [x + self.aside[0], y + self.aside[1], z]
    }

    fn setpoint(&mut self) -> Setpoint {
        let [x, y, z] = self.place();
        let mut axes = [7_000_000i64; AXES];
        for (map, nm) in self.frame.axes.iter().zip(self.frame.machine_nm(x, y, z)) {
            axes[usize::from(map.axis) % AXES] = nm;
        }
        let mut flags = Flags::SPINDLE_LOADED;
        if !matches!(self.phase, Phase::Waiting(_)) || self.stubborn {
            flags = flags.with(Flags::DRIVES_ENABLED);
        }
        let lasting = &mut self.lasting;
        if lasting.hold > 0 {
            lasting.hold -= 1;
            flags = flags.with(Flags::FEED_HOLD);
        }
        lasting.still = lasting.still.saturating_sub(1);
        if lasting.hold > 0 && lasting.hold == lasting.moves_at {
            self.aside_goal[0] = self.aside[0] + self.tolerance_nm * 5 / 4;
        }
        let dead = lasting.dead_spindle > 0;
        let stale = lasting.stale_spindle > 0;
        lasting.dead_spindle = lasting.dead_spindle.saturating_sub(1);
        lasting.stale_spindle = lasting.stale_spindle.saturating_sub(1);
        self.sequence = self.sequence.wrapping_add(1);
        Setpoint {
            axes,
            spindle_millirpm: if dead { 0 } else { self.nominal_millirpm },
            spindle_age_ticks: if stale { self.stale_ticks } else { 0 },
            sequence: self.sequence,
            frame_crc: self.frame.crc,
            flags,
        }
    }
}

fn stray(chance: &mut Chance) -> Stray {
    match chance.below(20) {
        0 => Stray::Before,
        1 => Stray::Behind,
        2 => Stray::Noise(chance.bits()),
        _ => Stray::Nothing,
    }
}

/// A request with one thing wrong.
fn spoilt(chance: &mut Chance, mut request: ArmRequest) -> ArmRequest {
    let binding = &mut request.binding;
    let numbers = [
        &mut binding.program_crc,
        &mut binding.feature,
        &mut binding.pass,
        &mut binding.tool,
        &mut binding.tool_offset,
        &mut binding.setup,
    ];
    let frame = &mut request.frame;
    match chance.below(10) {
        wrong @ 0..6 => *numbers.into_iter().nth(wrong as usize).expect("one of six") ^= 1 << chance.below(32),
        6 => frame.crc ^= 1 << chance.below(32),
        7 => {
            frame.sine = frame.sine.wrapping_add(1 << 20);
            *frame = frame.sealed();
        }
        8 => {
            frame.axes[1] = frame.axes[0];
            *frame = frame.sealed();
        }
        _ => {
            frame.axes[2].axis = 6 + chance.below(250) as u8;
            *frame = frame.sealed();
        }
    }
    request
}

/// A clamping of the part: offset, turned by any angle, mirrored or not, on any axes.
fn frame(chance: &mut Chance, axes: u8) -> Frame {
    let angle = match chance.below(3) {
        0 => chance.below(360) as f64 / 57.3,
        _ => chance.below(4) as f64 * std::f64::consts::FRAC_PI_2,
    };
    let one = f64::from(TURN_ONE);
    let (cosine, sine) = ((angle.cos() * one).round() as i32, (angle.sin() * one).round() as i32);
    let first = chance.below(axes.into()) as u8;
    let map = |k: u8, reversed| AxisMap { axis: (first + k) % axes, reversed };
    let axes = [map(0, chance.one_in(2)), map(1, chance.one_in(2)), map(2, chance.one_in(4))];
    let offset_nm = [(); 3].map(|()| chance.around(500_000_000));
    Frame { offset_nm, cosine, sine, axes, crc: 0 }.sealed()
}
