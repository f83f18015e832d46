//! One session: a set-up, a controller, a cable and a servo, every event told to the checker.

use truepath_core::link::{MAX_SETPOINT_BYTES, SetpointFrame};
use truepath_core::rewrite::Setpoint;

use super::attacker::{Act, Attacker, Stray};
use super::checker::Checker;
use super::rule::Alarm;
use super::servo::{Make, Servo};
use super::setup::Setup;
use super::tally::Tally;
use crate::chance::{Chance, Probability};
use crate::injector::{Delivery, FaultInjector, Faults};
use crate::traffic::Command;

/// Most setpoints of a session.
const LONGEST: u64 = 2_500;

/// Runs one; what it did is added to the tally.
///
/// # Errors
/// The first alarm.
pub fn session(chance: &mut Chance, make: Make<'_>, tally: &mut Tally) -> Result<(), Box<Alarm>> {
    let setup = Setup::draw(chance);
    let mut run = Run {
        axes: setup.settings().axes,
        cable: FaultInjector::new(faults(chance), chance.bits()),
        servo: make(&setup),
        checker: Checker::new(&setup),
        now_us: 1_000_000,
        setpoints: 0,
    };
    let mut attacker = Attacker::new(&setup, chance);
    let length = 300 + chance.below(LONGEST - 300);
    let mut result = Ok(());
    while run.setpoints < length && !chance.is_over() {
        let act = attacker.next(chance, run.servo.mode());
        result = run.act(&act);
        if result.is_err() {
            break;
        }
    }
    tally.sessions += 1;
    tally.setpoints += run.setpoints;
    run.checker.add_to(tally);
    result
}

struct Run<'a> {
    axes: u8,
    cable: FaultInjector<Sent>,
    servo: Box<dyn Servo + 'a>,
    checker: Checker,
    now_us: u64,
    setpoints: u64,
}

/// What goes with a frame through the cable.
#[derive(Clone, Debug)]
struct Sent {
    /// Its bytes.
    packet: Vec<u8>,
    delay_us: u32,
}

impl Run<'_> {
    fn act(&mut self, act: &Act) -> Result<(), Box<Alarm>> {
        match *act {
            Act::Send { setpoint, gap_us, delay_us, stray } => {
                self.setpoints += 1;
                self.now_us += u64::from(gap_us);
                self.send(&setpoint, delay_us, stray)
            }
            Act::Command(command) => self.command(&command),
            Act::Reset => {
                self.servo.reset();
                self.checker.reset();
                self.look()
            }
            Act::Image(to) => {
                self.servo.exchange_image(to);
                self.checker.image_exchanged(to);
                self.look()
            }
        }
        .map_err(|alarm| Box::new(Alarm { setpoint: self.setpoints, ..*alarm }))
    }

    fn command(&mut self, command: &Command) -> Result<(), Box<Alarm>> {
        let before = self.servo.mode();
        let done = self.servo.command(command, self.now_us).is_ok();
        self.checker.commanded(command, done, before, self.now_us)?;
        self.look()
    }

    fn send(&mut self, setpoint: &Setpoint, delay_us: u32, stray: Stray) -> Result<(), Box<Alarm>> {
        let mut packet = [0; MAX_SETPOINT_BYTES + 2];
        let frame = SetpointFrame { axes: self.axes, setpoint: *setpoint };
        // Six axes fit; the number of axes was checked with the settings.
        let used = frame.encode_packet(&mut packet).unwrap_or(0);
        let packet = packet[..used].to_vec();
        self.checker.sent(&packet, setpoint);
        let mut out = Vec::new();
        let line = match stray {
            Stray::Nothing => packet.clone(),
            Stray::Before => [&[0], packet.as_slice()].concat(),
            Stray::Behind => [packet.as_slice(), &[0]].concat(),
            Stray::Noise(bytes) => [&bytes.to_le_bytes(), [0].as_slice(), packet.as_slice()].concat(),
        };
        self.cable.pass(&line, Sent { packet, delay_us }, |delivery| out.push(delivery));
        if out.is_empty() {
            // Held back: time passes all the same.
            return self.watch();
        }
        out.into_iter().try_for_each(|delivery| self.deliver(&delivery))
    }

    fn deliver(&mut self, delivery: &Delivery<Sent>) -> Result<(), Box<Alarm>> {
        self.now_us += u64::from(delivery.delay_us);
        self.watch()?;
        let Sent { packet, delay_us } = &delivery.content;
        for piece in delivery.bytes.split_inclusive(|&b| b == 0) {
            self.checker.delivered(piece, self.now_us, delivery.bytes != *packet);
            let answer = self.servo.receive(piece, self.now_us, *delay_us);
            let at_us = self.now_us + u64::from(*delay_us);
            self.checker.heard(answer.as_ref(), at_us)?;
            self.look()?;
        }
        Ok(())
    }

    fn watch(&mut self) -> Result<(), Box<Alarm>> {
        self.servo.watch(self.now_us);
        self.checker.watched(self.now_us, self.servo.mode())?;
        self.look()
    }

    fn look(&mut self) -> Result<(), Box<Alarm>> {
        self.checker.looked(self.servo.mode(), self.servo.drive_enable())
    }
}

/// A cable: without faults, with one kind of them, or with all.
fn faults(chance: &mut Chance) -> Faults {
    let share =
        |chance: &mut Chance| Probability::new([0.005, 0.02, 0.1][chance.below(3) as usize]).unwrap_or_default();
    let mut faults = Faults { pause_us: 20_000, ..Faults::default() };
    let kinds = match chance.below(7) {
        0..3 => 0,
        one @ 3..6 => 1 << (one - 3 + if chance.one_in(2) { 1 } else { 0 }),
        _ => 0b1111,
    };
    if kinds & 1 != 0 {
        faults.drop = share(chance);
    }
    if kinds & 2 != 0 {
        faults.corrupt = share(chance);
    }
    if kinds & 4 != 0 {
        faults.reorder = share(chance);
    }
    if kinds & 8 != 0 {
        faults.repeat = share(chance);
    }
    faults
}
