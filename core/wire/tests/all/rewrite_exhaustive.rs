//! Bounded exhaustive check of the rewriter: from every kind of state, every sequence of events up to a depth, each answer held
//! against a model of the contract that knows modes, flags and limits only.
//!
//! What random streams meet rarely (an image that vanishes, then an acknowledgement in the same tick) is met here for certain.

use std::collections::HashSet;
use std::hash::{BuildHasher, BuildHasherDefault, DefaultHasher};

use truepath_wire::image::Image;
use truepath_wire::rewrite::{ArmRequest, Flags, Frame, Mode, Output, Reason, Rewriter, Setpoint, Settings, State};

use crate::rewrite_support::*;

/// What happens next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Event {
    Stay,
    Forward,
    Disabled,
    Abort,
    FeedHold,
    Retract,
    Plunge,
    Jump,
    Gap,
    OtherFrame,
    /// So long that every ramp and hold is over.
    Rest,
    NoImage,
    FirstImage,
    OtherImage,
    Acknowledge,
    ArmNext,
    ArmAgain,
    Disarm,
    PowerOff,
}

const EVENTS: [Event; 19] = [
    Event::Stay,
    Event::Forward,
    Event::Disabled,
    Event::Abort,
    Event::FeedHold,
    Event::Retract,
    Event::Plunge,
    Event::Jump,
    Event::Gap,
    Event::OtherFrame,
    Event::Rest,
    Event::NoImage,
    Event::FirstImage,
    Event::OtherImage,
    Event::Acknowledge,
    Event::ArmNext,
    Event::ArmAgain,
    Event::Disarm,
    Event::PowerOff,
];

/// Limits of the correction, nm, nm per tick, nm per tick²; and what whole nanometres hide.
const CLAMP: i32 = 500_000;
const VELOCITY: i32 = 20_000;
const ACCELERATION: i32 = 1_000;
const ROUNDING: i32 = 2;

/// Rewriters by the image they have: none, that of the arming, another.
struct Device {
    rewriters: [Rewriter<'static>; 3],
    binding: ArmRequest,
}

impl Device {
    fn new() -> Self {
        let image = |settings| image_with(settings, &nodes(straight()));
        let first = settings();
        let mut other = settings();
        other.limits.warn = other.limits.clamp;
        other.binding.program_crc ^= 1;
        let of = |image: Option<Image<'static>>| Rewriter::new(Settings::at_1_khz(), image).unwrap();
        let binding = ArmRequest { binding: first.binding, part_serial: 0, frame: Frame::identity() };
        Self { rewriters: [of(None), of(Some(image(&first))), of(Some(image(&other)))], binding }
    }
}

/// The rewriter, the controller before it, and what the contract knows of both.
#[derive(Clone, PartialEq, Eq, Hash)]
struct World {
    state: State,
    image: usize,
    next: Setpoint,
    /// Parts that were armed.
    serial: u32,
    /// Whether the last setpoint of `Off` said that the drives are enabled, or none has come since the drives were dropped.
    enabled: bool,
    correction: [i32; 2],
    velocity: [i32; 2],
}

impl World {
    /// Over the start, above the gate, in `Off`.
    fn begin() -> Self {
        let next = Setpoint {
            spindle_millirpm: SPINDLE,
            frame_crc: Frame::identity().crc,
            flags: Flags::DRIVES_ENABLED,
            axes: [0, 0, CLEAR, 7, 8, 9],
            ..Setpoint::default()
        };
        let [correction, velocity] = [[0; 2]; 2];
        Self { state: State::default(), image: 1, next, serial: 0, enabled: false, correction, velocity }
    }

    /// Every rule that can be seen in one event; the error says which was broken.
    fn happen(&mut self, device: &Device, event: Event) -> Result<(), String> {
        let before = self.state.mode();
        let rewriter = &device.rewriters[self.image];
        let keeps = |world: &Self, what: &str, holds: bool| {
            if holds { Ok(()) } else { Err(format!("{what}: {before} became {}", world.state.mode())) }
        };
        match event {
            Event::Acknowledge => {
                let done = rewriter.acknowledge_drives_disabled(&mut self.state).is_ok();
                keeps(self, "an acknowledgement", done == (before == Mode::Off && !self.enabled))?;
                let after = if done { Mode::Bypass } else { before };
                (self.correction, self.velocity) =
                    if done { Default::default() } else { (self.correction, self.velocity) };
                keeps(self, "an acknowledgement", self.state.mode() == after)
            }
            Event::ArmAgain if self.serial == 0 => Ok(()),
            Event::ArmNext | Event::ArmAgain => {
                let serial = self.serial + u32::from(event == Event::ArmNext);
                let request = ArmRequest { part_serial: serial, ..device.binding };
                let done = rewriter.arm(&mut self.state, &request).is_ok();
                let may = before == Mode::Bypass && self.image == 1 && event == Event::ArmNext;
                self.serial = if done { serial } else { self.serial };
                keeps(self, "an arming", done == may && self.state.mode() == if done { Mode::Armed } else { before })
            }
            Event::Disarm => {
                let _ = rewriter.disarm(&mut self.state);
                // A ramp begins with the next setpoint, and is one of `Active`.
                let after = match before {
                    Mode::Armed => Mode::Bypass,
                    Mode::Hold => Mode::Active,
                    before => before,
                };
                keeps(self, "a disarming", self.state.mode() == after)
            }
            Event::PowerOff => {
                rewriter.power_off(&mut self.state, Reason::Silence);
                (self.enabled, self.correction, self.velocity) = (true, [0; 2], [0; 2]);
                keeps(self, "silence", self.state.mode() == Mode::Off)
            }
            Event::NoImage | Event::FirstImage | Event::OtherImage => {
                self.image =
                    [Event::NoImage, Event::FirstImage, Event::OtherImage].iter().position(|e| *e == event).unwrap();
                Ok(())
            }
            Event::Rest => (0..130).try_for_each(|_| self.tick(device, Event::Stay)),
            _ => self.tick(device, event),
        }
    }

    fn tick(&mut self, device: &Device, event: Event) -> Result<(), String> {
        let before = self.state.mode();
        let was_ending = self.state.reason() != Reason::None;
        let steady = self.next;
        let [x, y, z, ..] = &mut self.next.axes;
        match event {
            Event::Forward => *x += FEED,
            Event::Retract => *z = CLEAR,
            Event::Plunge => *z = if *z > GATE { GATE } else { PASS },
            Event::Jump => *y += 5 * MM,
            Event::Disabled => self.next.flags = Flags::default(),
            Event::Abort => self.next.flags = self.next.flags.with(Flags::ABORT),
            Event::FeedHold => self.next.flags = self.next.flags.with(Flags::FEED_HOLD),
            Event::OtherFrame => self.next.frame_crc ^= 1,
            _ => {}
        }
        self.next.sequence = self.next.sequence.wrapping_add(if event == Event::Gap { 10 } else { 1 });
        let out = device.rewriters[self.image].tick(&mut self.state, &self.next);
        let result = self.judge(event, before, was_ending, &out);
        self.next.flags = steady.flags;
        self.next.frame_crc = steady.frame_crc;
        result
    }

    fn judge(&mut self, event: Event, before: Mode, was_ending: bool, out: &Output) -> Result<(), String> {
        let after = out.mode;
        let wrong = |what: &str| Err(format!("{event:?} in {before}, image {}: {what}: {out:?}", self.image));
        let [cx, cy, rest @ ..] = out.correction_nm;
        let sum = (0..6).all(|k| out.axes[k] == self.next.axes[k] + i64::from(out.correction_nm[k]));
        if after != self.state.mode() || !sum || rest != [0; 4] {
            return wrong("the sum");
        }
        if out.forward != (after != Mode::Off) {
            return wrong("what is forwarded");
        }
        if matches!(after, Mode::Off | Mode::Bypass | Mode::Armed) && [cx, cy] != [0; 2] {
            return wrong("a correction where there is none");
        }
        let possible: &[Mode] = match before {
            Mode::Off => &[Mode::Off],
            Mode::Bypass => &[Mode::Bypass],
            Mode::Armed => &[Mode::Armed, Mode::Active, Mode::Bypass],
            Mode::Active | Mode::Hold if self.image == 0 => &[Mode::Off, Mode::Bypass],
            Mode::Fault if self.image == 0 => &[Mode::Off, Mode::Bypass],
            Mode::Active | Mode::Hold => &[Mode::Active, Mode::Hold, Mode::Fault, Mode::Bypass],
            Mode::Fault => &[Mode::Fault, Mode::Bypass],
        };
        if !possible.contains(&after) {
            return wrong("the state");
        }
        let stops = matches!(event, Event::Disabled | Event::Abort | Event::Gap | Event::OtherFrame | Event::Jump);
        // Armed, the cutter is on its way to the start: rapids, drives that are not enabled yet, and a gap keeps the gate shut (that
        // too long a one disarms is the link's).
        let goes_on = after == Mode::Armed && !matches!(event, Event::Jump | Event::Disabled | Event::Gap)
            || matches!(after, Mode::Active | Mode::Hold) && out.reason == Reason::None;
        if goes_on && (stops || self.image != 1) {
            return wrong("it goes on");
        }
        if was_ending && matches!(after, Mode::Active | Mode::Hold) && out.reason == Reason::None {
            return wrong("an end is forgotten");
        }
        if after == Mode::Off {
            // Nothing goes out any more; what the axes have goes with the drive enable.
            (self.enabled, self.correction, self.velocity) =
                (self.next.flags.has(Flags::DRIVES_ENABLED), [0; 2], [0; 2]);
            return Ok(());
        }
        for (axis, now) in [cx, cy].into_iter().enumerate() {
            let velocity = now - self.correction[axis];
            if now.abs() > CLAMP
                || velocity.abs() > VELOCITY + ROUNDING
                || (velocity - self.velocity[axis]).abs() > ACCELERATION + ROUNDING
            {
                return wrong("the limits");
            }
            (self.correction[axis], self.velocity[axis]) = (now, velocity);
        }
        Ok(())
    }
}

/// From `Off` into the pass, and until the correction has settled there.
const IN_PASS: &[Event] = &[Event::Acknowledge, Event::ArmNext, Event::Stay, Event::Plunge, Event::Plunge];
const SETTLED: &[Event] = &[Event::Acknowledge, Event::ArmNext, Event::Stay, Event::Plunge, Event::Plunge, Event::Rest];

/// A way to each kind of state, in two pieces, and what is tried from there.
const BEGINNINGS: [(&str, [&[Event]; 2]); 9] = [
    ("off", [&[], &[]]),
    ("bypass", [IN_PASS.split_at(1).0, &[]]),
    ("armed", [IN_PASS.split_at(3).0, &[]]),
    ("gate", [IN_PASS.split_at(4).0, &[]]),
    ("active", [IN_PASS, &[Event::Forward]]),
    ("settled", [SETTLED, &[Event::Forward]]),
    ("hold", [SETTLED, &[Event::FeedHold]]),
    ("fault", [SETTLED, &[Event::Forward, Event::Abort]]),
    ("leaving", [SETTLED, &[Event::Forward, Event::Disarm, Event::Forward]]),
];

/// What an exhaustive run has seen.
#[derive(Default)]
struct Seen {
    /// Worlds with the depth left that was tried from them, by their digest.
    worlds: HashSet<u64>,
    changes: HashSet<(Mode, Mode)>,
    events: u64,
}

fn explore(device: &Device, world: &World, depth: u32, way: &mut Vec<Event>, seen: &mut Seen) {
    if depth == 0 || !seen.worlds.insert(BuildHasherDefault::<DefaultHasher>::default().hash_one((world, depth))) {
        return;
    }
    for event in EVENTS {
        let mut next = world.clone();
        way.push(event);
        seen.events += 1;
        if let Err(what) = next.happen(device, event) {
            panic!("{what}\nafter {way:?}");
        }
        seen.changes.insert((world.state.mode(), next.state.mode()));
        explore(device, &next, depth - 1, way, seen);
        way.pop();
    }
}

fn explored(depth: u32) -> Seen {
    let device = Device::new();
    let mut seen = Seen::default();
    for (name, way) in BEGINNINGS {
        let (mut world, mut way) = (World::begin(), way.concat());
        for &event in &way {
            world.happen(&device, event).unwrap_or_else(|what| panic!("{name}: {what}"));
        }
        explore(&device, &world, depth, &mut way, &mut seen);
    }
    seen
}

#[test]
fn no_sequence_of_five_events_from_any_state_breaks_a_rule() {
    let seen = explored(5);
    // Off by silence and by an image taken away; Hold by a hold; every way back to Bypass.
    for (from, to) in [
        (Mode::Off, Mode::Bypass),
        (Mode::Bypass, Mode::Armed),
        (Mode::Armed, Mode::Active),
        (Mode::Armed, Mode::Bypass),
        (Mode::Active, Mode::Fault),
        (Mode::Active, Mode::Off),
        (Mode::Active, Mode::Bypass),
        (Mode::Hold, Mode::Active),
        (Mode::Fault, Mode::Off),
        (Mode::Fault, Mode::Bypass),
    ] {
        assert!(seen.changes.contains(&(from, to)), "{from} never became {to}");
    }
    assert!(seen.events > 500_000, "{}", seen.events);
}

#[test]
#[ignore = "slow: ten million events"]
fn no_sequence_of_seven_events_from_any_state_breaks_a_rule() {
    let seen = explored(7);
    assert!(seen.events > 8_000_000, "{}", seen.events);
}
