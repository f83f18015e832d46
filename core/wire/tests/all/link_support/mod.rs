//! A controller at the other end of the setpoint link: every setpoint goes as bytes through the deframer and the
//! endpoint, every answer comes back as bytes.

pub use crate::rewrite_support::*;

use truepath_wire::image::Image;
use truepath_wire::link::{
    AnswerFrame, Deframer, DeviceSettings, Endpoint, Framed, LinkError, MAX_STUFFED, SetpointFrame, Verdict, unstuff,
};
use truepath_wire::rewrite::{
    ArmRequest, Flags, Frame, Mode, Output, Reason, Refusal, Rewriter, Setpoint, Settings, SpentList, Status,
};

/// All modes.
pub const MODES: [Mode; 6] = [Mode::Off, Mode::Bypass, Mode::Armed, Mode::Active, Mode::Hold, Mode::Fault];
/// Microseconds of a tick at 1 kHz.
pub const TICK_US: u64 = 1_000;
/// Axes of the test machine.
pub const AXES: u8 = 3;

/// What came of one frame: the verdict, and the answer if one was given.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Came {
    pub verdict: Verdict,
    pub answer: Option<Output>,
}

impl Came {
    /// The answer of a frame that must have one.
    #[track_caller]
    pub fn output(&self) -> Output {
        self.answer.unwrap_or_else(|| panic!("no answer: {:?}", self.verdict))
    }
}

pub struct Wire {
    pub rewriter: Rewriter<'static>,
    pub endpoint: Endpoint,
    pub deframer: Deframer<MAX_STUFFED>,
    pub next: Setpoint,
    pub request: ArmRequest,
    pub now_us: u64,
    /// Time from setpoint to setpoint.
    pub tick_us: u64,
    /// Time from arrival to answer.
    pub delay_us: u64,
}

impl Wire {
    pub fn new(settings: Settings, image: Image<'static>) -> Self {
        let frame = Frame::identity();
        let device = DeviceSettings { rewriter: settings, axes: AXES, ..DeviceSettings::at_1_khz() };
        device.check().unwrap();
        Self {
            request: ArmRequest { binding: image.settings().binding, part_serial: 1, frame },
            rewriter: Rewriter::new(settings, Some(image)).unwrap(),
            endpoint: Endpoint::new(device, SpentList::EMPTY),
            deframer: Deframer::new(),
            next: Setpoint { spindle_millirpm: SPINDLE, frame_crc: frame.crc, ..Setpoint::default() },
            now_us: 0,
            tick_us: TICK_US,
            delay_us: 50,
        }
    }
    /// After a reset, with the straight path of 10 mm as image.
    pub fn reset() -> Self {
        Self::new(Settings::at_1_khz(), image_with(&settings(), &nodes(straight())))
    }
    pub fn bypass() -> Self {
        let mut wire = Self::reset();
        wire.send(0, 0, CLEAR);
        wire.endpoint.acknowledge(&wire.rewriter, wire.now_us).unwrap();
        wire.next.flags = Flags::DRIVES_ENABLED;
        wire.measured();
        wire
    }
    /// Standing until the pace of the setpoints is known.
    pub fn measured(&mut self) {
        for _ in 0..33 {
            self.stay();
        }
    }
    pub fn armed() -> Self {
        let mut wire = Self::bypass();
        wire.arm();
        wire.send(0, 0, CLEAR);
        wire
    }
    /// In the middle of the path, the correction settled.
    pub fn active() -> Self {
        let mut wire = Self::armed();
        for i in 0..=100 {
            wire.send(0, 0, GATE + (PASS - GATE) * i / 100);
        }
        wire.forward(700);
        wire
    }
    /// In a mode, with a correction where there can be one.
    pub fn in_mode(mode: Mode) -> Self {
        let wire = match mode {
            Mode::Off => {
                let mut wire = Self::reset();
                wire.next.flags = Flags::DRIVES_ENABLED;
                wire.send(0, 0, CLEAR);
                wire
            }
            Mode::Bypass => Self::bypass(),
            Mode::Armed => Self::armed(),
            Mode::Active => Self::active(),
            Mode::Hold => {
                let mut wire = Self::active();
                wire.next.flags = wire.next.flags.with(Flags::FEED_HOLD);
                wire.stay();
                wire
            }
            Mode::Fault => {
                let mut wire = Self::active();
                wire.next.flags = wire.next.flags.with(Flags::ABORT);
                wire.stay();
                wire.next.flags = Flags::DRIVES_ENABLED;
                wire
            }
        };
        assert_eq!(wire.endpoint.mode(), mode);
        wire
    }
    #[track_caller]
    pub fn arm(&mut self) {
        self.endpoint.arm(&self.rewriter, &self.request).unwrap();
    }
    /// The bytes of the next setpoint: one tick later, one sequence on.
    pub fn packet(&mut self, axes: [i64; 3]) -> Vec<u8> {
        let [x, y, z] = axes;
        self.now_us += self.tick_us;
        self.next.sequence = self.next.sequence.wrapping_add(1);
        self.next.axes = [x, y, z, 0, 0, 0];
        packet_of(&self.next)
    }
    /// Bytes to the device at the present time; the last packet among them counts.
    pub fn receive(&mut self, bytes: &[u8]) -> Option<Came> {
        let mut came = None;
        let mut rest = bytes;
        while let Some(framed) = self.deframer.feed(&mut rest) {
            let verdict = match framed {
                Framed::Packet(packet) => self.endpoint.packet(&self.rewriter, packet, self.now_us),
                Framed::Overlong => self.endpoint.damaged(LinkError::Stuffing),
            };
            let mut answer = [0; 200];
            let bytes = self.endpoint.answer_packet(self.now_us + self.delay_us, &mut answer);
            came = Some(Came { verdict, answer: bytes.map(|n| read(&mut answer[..n])) });
        }
        came
    }
    pub fn send(&mut self, x: i64, y: i64, z: i64) -> Came {
        let packet = self.packet([x, y, z]);
        self.receive(&packet).unwrap()
    }
    /// The last setpoint again, as a new one.
    pub fn stay(&mut self) -> Came {
        let [x, y, z, ..] = self.next.axes;
        self.send(x, y, z)
    }
    pub fn forward(&mut self, ticks: u32) -> Came {
        let mut last = None;
        for _ in 0..ticks {
            let [x, y, z, ..] = self.next.axes;
            last = Some(self.send(x.saturating_add(FEED), y, z));
        }
        last.unwrap()
    }
    /// As the mode has it: along the path when active, else standing.
    pub fn go_on(&mut self) -> Came {
        if self.endpoint.mode() == Mode::Active { self.forward(1) } else { self.stay() }
    }
    /// Frames that never arrive.
    pub fn lose(&mut self, frames: u32) {
        let [x, y, z, ..] = self.next.axes;
        let way = if self.endpoint.mode() == Mode::Active { FEED } else { 0 };
        for i in 1..=i64::from(frames) {
            self.packet([x + way * i, y, z]);
        }
    }
    /// Makes an event happen until its reason is told; that takes the stated ticks. Then the correction, which does not
    /// jump, ramps to zero within the stated ticks, which are the limits' own, and nothing is corrected any more.
    #[track_caller]
    pub fn ends(
        &mut self,
        noticed: Option<u32>,
        out: Option<u32>,
        reason: Reason,
        mut event: impl FnMut(&mut Self) -> Came,
    ) {
        let limits = self.rewriter.limits().unwrap();
        let (most, ramp) = (i64::from(limits.velocity().bits() >> 8) + 1, limits.ramp_ticks());
        let before = self.endpoint.state().axes().map(|axis| axis.correction().offset().nm());
        assert_ne!(before, [0; 2], "there must be a correction to end");
        let mut ticks = 1;
        let first = loop {
            let came = event(self);
            if self.endpoint.state().reason() != Reason::None {
                break came.output();
            }
            assert!(Some(ticks) < noticed, "not noticed after {ticks} ticks");
            ticks += 1;
        };
        assert_eq!((Some(ticks), first.reason), (noticed, reason));
        assert_eq!(first.mode, if reason.is_fault() { Mode::Fault } else { Mode::Active });
        for (now, before) in first.correction_nm.into_iter().zip(before) {
            let moved = (i64::from(now) - before).abs();
            assert!(moved <= most * i64::from(ticks + 3) || first.status.has(Status::JOINT_LIMITED), "{moved} nm");
        }
        assert_eq!(out, Some(ramp));
        assert!(self.ramp_out() <= ramp);
        // It does not come back by itself, wherever the cutter goes.
        assert_eq!(self.endpoint.state().reason(), reason);
        let answer = self.forward(10).output();
        assert!(is_plain(&answer, &self.next));
        let again = self.endpoint.arm(&self.rewriter, &self.request);
        assert_eq!(again, Err(Refusal::PartRepeated { part_serial: 1 }));
    }
    /// Standing still until the mode is `Bypass`; gives the ticks it took, and holds the limits on the way.
    #[track_caller]
    pub fn ramp_out(&mut self) -> u32 {
        let limits = self.rewriter.limits().unwrap().clone();
        let most = i64::from(limits.velocity().bits() >> 8) + 1;
        let mut before = None;
        for tick in 0..=limits.ramp_ticks() {
            let out = self.stay().output();
            assert!(out.forward);
            if let Some(before) = before.replace(out.correction_nm) {
                for (now, before) in out.correction_nm.into_iter().zip(before) {
                    assert!((i64::from(now) - i64::from(before)).abs() <= most);
                }
            }
            if out.mode == Mode::Bypass {
                assert!(is_plain(&out, &self.next));
                return tick;
            }
        }
        panic!("the correction is not out after {} ticks", limits.ramp_ticks());
    }
}

pub fn packet_of(setpoint: &Setpoint) -> Vec<u8> {
    let mut packet = vec![0; 200];
    let bytes = SetpointFrame { axes: AXES, setpoint: *setpoint }.encode_packet(&mut packet).unwrap();
    packet.truncate(bytes);
    packet
}

/// The output of an answer as it came, with its 0x00.
pub fn read(answer: &mut [u8]) -> Output {
    let (delimiter, packet) = answer.split_last_mut().unwrap();
    assert_eq!(*delimiter, 0);
    AnswerFrame::decode(unstuff(packet).unwrap(), AXES).unwrap().output
}
