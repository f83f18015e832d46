//! Five rules that are stricter than the contract, each with the situation in which a servo that keeps the contract breaks
//! it. `docs/safety.md` says why the contract is right and the stricter rule is not.

use truepath_bench::attack::{Checker, HostServo, Servo, Setup};
use truepath_bench::traffic::Command;
use truepath_bench::{EXAMPLE_FEED, EXAMPLE_PASS, Example};
use truepath_core::link::{DeviceSettings, MAX_SETPOINT_BYTES, SetpointFrame};
use truepath_core::rewrite::{ArmRequest, Flags, Frame, Mode, Output, Reason, Setpoint};

const MM: i64 = 1_000_000;
/// Z of the pass, and a place in the gate above it.
const PASS: i64 = EXAMPLE_PASS;
const GATE: i64 = PASS + 3 * MM;
/// Way per tick.
const FEED: i64 = EXAMPLE_FEED;

/// 10 mm along X at 1 kHz; everywhere 50 µm in X and Y.
fn straight() -> Setup {
    let Example { settings, nodes } = Example::along_x(101, |_| [50, 50]);
    Setup::of(DeviceSettings::at_1_khz(), settings, nodes, FEED)
}

/// A controller without faults; every answer is judged.
struct Script<'a> {
    servo: HostServo<'a>,
    checker: Checker,
    request: ArmRequest,
    next: Setpoint,
    now_us: u64,
}

impl<'a> Script<'a> {
    /// Armed, over the start in the gate, with the pace known.
    fn armed(setup: &'a Setup) -> Self {
        Self::armed_at(setup, [0, 0, GATE])
    }
    /// Armed at a place.
    fn armed_at(setup: &'a Setup, [x, y, z]: [i64; 3]) -> Self {
        let binding = setup.images()[0].settings().binding;
        let frame = Frame::identity();
        let mut script = Self {
            servo: HostServo::new(setup),
            checker: Checker::new(setup),
            request: ArmRequest { binding, part_serial: 1, frame },
            next: Setpoint { spindle_millirpm: 1_500_000, frame_crc: frame.crc, ..Setpoint::default() },
            now_us: 0,
        };
        for _ in 0..33 {
            script.send(x, y, z);
        }
        assert!(script.command(Command::Acknowledge));
        script.next.flags = Flags::DRIVES_ENABLED;
        assert!(script.command(Command::Arm(script.request)));
        script.send(x, y, z);
        script
    }
    /// In the pass, the correction settled.
    fn active(setup: &'a Setup) -> Self {
        let mut script = Self::armed(setup);
        for k in 0..=100 {
            script.send(0, 0, GATE + (PASS - GATE) * k / 100);
        }
        for _ in 0..300 {
            assert_eq!(script.forward().mode, Mode::Active);
        }
        script
    }
    fn command(&mut self, command: Command) -> bool {
        let before = self.servo.mode();
        let done = self.servo.command(&command, self.now_us).is_ok();
        self.checker.commanded(&command, done, before, self.now_us).unwrap();
        self.checker.looked(self.servo.mode(), self.servo.drive_enable()).unwrap();
        done
    }
    /// Bytes come out of the cable for a frame that went in.
    fn deliver(&mut self, packet: &[u8], bytes: &[u8]) -> Option<Output> {
        self.checker.delivered(bytes, self.now_us, bytes != packet);
        let answer = self.servo.receive(bytes, self.now_us, 50);
        self.checker.heard(answer.as_ref(), self.now_us + 50).unwrap();
        answer
    }
    fn packet(&mut self, x: i64, y: i64, z: i64) -> Vec<u8> {
        self.now_us += 1_000;
        self.next.sequence += 1;
        self.next.axes = [x, y, z, 0, 0, 0];
        let mut packet = [0; MAX_SETPOINT_BYTES + 2];
        let used = SetpointFrame { axes: 3, setpoint: self.next }.encode_packet(&mut packet).unwrap();
        self.checker.sent(&packet[..used], &self.next);
        packet[..used].to_vec()
    }
    fn send(&mut self, x: i64, y: i64, z: i64) -> Output {
        let packet = self.packet(x, y, z);
        self.deliver(&packet, &packet).unwrap()
    }
    fn forward(&mut self) -> Output {
        let [x, y, z, ..] = self.next.axes;
        self.send(x + FEED, y, z)
    }
    /// What is left of the correction goes out by its ramp.
    fn ramps_out(&mut self) {
        for _ in 0..122 {
            if self.forward().mode == Mode::Bypass {
                return;
            }
        }
        panic!("the correction stays");
    }
}

#[test]
fn correction_on_another_axis_is_that_of_the_arming_that_was_granted_not_of_one_that_was_refused() {
    let setup = straight();
    let mut script = Script::active(&setup);
    // X and Y of this request are on the axes 1 and 2.
    let mut frame = Frame::identity();
    frame.axes.rotate_left(1);
    assert!(!script.command(Command::Arm(ArmRequest { part_serial: 2, frame: frame.sealed(), ..script.request })));
    let output = script.forward();
    assert!(output.correction_nm[0] != 0 && output.mode == Mode::Active);
}

#[test]
fn on_but_stopped_is_a_correction_on_its_way_out() {
    let setup = straight();
    let mut script = Script::active(&setup);
    script.next.flags = Flags::DRIVES_ENABLED.with(Flags::PROGRAM_END);
    assert_eq!(script.forward().reason, Reason::ProgramEnd);
    // The emergency stop finds it leaving: the state is Active up to zero, and the first reason stays.
    script.next.flags = Flags::EMERGENCY_STOP;
    let output = script.forward();
    assert_eq!((output.mode, output.reason), (Mode::Active, Reason::ProgramEnd));
    assert!(output.correction_nm[0] != 0);
    script.ramps_out();
}

#[test]
fn a_damaged_frame_that_is_followed_has_lost_nothing_but_what_stood_beside_it() {
    let setup = straight();
    let mut script = Script::active(&setup);
    let [x, y, z, ..] = script.next.axes;
    // The cable adds a delimiter in front: what lies between delimiters is the frame that was sent, bit for bit.
    let packet = script.packet(x + FEED, y, z);
    assert_eq!(script.deliver(&packet, &[0]), None);
    assert_eq!(script.deliver(&packet, &packet).unwrap().mode, Mode::Active);
    // The delimiter is lost, and comes with what follows.
    let packet = script.packet(x + 2 * FEED, y, z);
    let (content, end) = packet.split_at(packet.len() - 1);
    assert_eq!(script.deliver(&packet, content), None);
    assert_eq!(script.deliver(&packet, end).unwrap().mode, Mode::Active);
    // One bit of the frame itself, and nothing is followed.
    for bit in 0..8 * (packet.len() - 1) {
        let packet = script.packet(x + 3 * FEED, y, z);
        script.next.sequence -= 1;
        let mut damaged = packet.clone();
        damaged[bit / 8] ^= 1 << (bit % 8);
        assert!(
            damaged.split_inclusive(|&b| b == 0).all(|piece| script.deliver(&packet, piece).is_none()),
            "bit {bit}"
        );
    }
}

#[test]
fn on_above_the_pass_away_from_the_start_is_the_regular_end() {
    let setup = straight();
    let mut script = Script::active(&setup);
    while script.next.axes[0] < 10 * MM {
        script.forward();
    }
    // It lifts off at the end of the path.
    let output = script.send(10 * MM, 0, PASS + 3 * MM);
    assert_eq!((output.mode, output.reason), (Mode::Active, Reason::Completed));
    assert!(output.correction_nm[0] != 0);
    script.ramps_out();
    // In the middle of the path it is a fault in the same tick.
    let mut script = Script::active(&setup);
    let [x, y, ..] = script.next.axes;
    let output = script.send(x, y, PASS + 3 * MM);
    assert_eq!((output.mode, output.reason), (Mode::Fault, Reason::LeftPass));
}

#[test]
fn a_correction_that_began_in_the_pass_began_over_the_start_all_the_same() {
    let setup = straight();
    let mut script = Script::armed_at(&setup, [-2 * MM, 0, GATE]);
    // Down before the path, where nothing begins, and in the pass over to the start.
    let [x, y, z] = [-2 * MM, 0, PASS];
    script.send(x, y, z);
    let mut began = None;
    for k in 1..=400 {
        let output = script.send(x + k * FEED, y, z);
        if output.mode == Mode::Active && began.is_none() {
            began = Some(x + k * FEED);
        }
    }
    // With the first setpoint within the tolerance of 0.2 mm.
    let began = began.unwrap();
    assert!((-MM / 5..-MM / 5 + FEED).contains(&began), "{began}");
}
