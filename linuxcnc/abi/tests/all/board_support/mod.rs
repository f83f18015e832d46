//! A controller and a board at both ends of a setpoint link, with a cable between them that loses, delays and damages;
//! and drives, which look at every tick whether they were made to jump.

use crate::rewrite_support;
pub use rewrite_support::*;

use truepath_abi::board::{Board, BoardSettings, Cause, Driven, PACKET_BYTES};
use truepath_core::link::{
    AnswerFrame, Deframer, DeviceSettings, Endpoint, Framed, MAX_STUFFED, SetpointFrame, unstuff,
};
use truepath_core::rewrite::{ArmRequest, Flags, Frame, Mode, Output, Rewriter, Setpoint, Settings, SpentList};

pub const AXES: u8 = 3;
/// Limits of the test machine: those of the test image, per tick at 1 kHz.
pub const STEP_NM: i32 = 20_000;

pub fn board_settings() -> BoardSettings {
    BoardSettings {
        axes: AXES,
        tick_hz: 1_000,
        clamp_nm: 500_000,
        slew_nm_per_s: 20_000_000,
        acceleration_nm_per_s2: 1_000_000_000,
        joint_limits_nm: [(i64::MIN, i64::MAX); 6],
    }
}

/// What the cable does to the frames of one tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cable {
    /// Both arrive.
    Good,
    /// The setpoint is lost.
    NoSetpoint,
    /// The answer is lost.
    NoAnswer,
    /// The answer arrives with the next one, before it.
    Late,
    /// A byte of the answer is changed.
    Damaged,
    /// The answer is cut off in the middle.
    CutOff,
    /// The answer arrives twice.
    Twice,
}

pub struct Rig {
    pub board: Board,
    pub settings: BoardSettings,
    pub device: Endpoint,
    pub rewriter: Rewriter<'static>,
    deframer: Deframer<MAX_STUFFED>,
    pub request: ArmRequest,
    pub next: Setpoint,
    pub drives_on: bool,
    pub now_us: u64,
    /// Answers under way.
    late: Vec<u8>,
    /// Changes an answer before it leaves the board, for boards with a mistake.
    pub mistake: Option<fn(&mut Output)>,
    pub last: Option<(Driven, bool)>,
}

impl Rig {
    pub fn new(settings: BoardSettings) -> Self {
        let image = image_with(&rewrite_support::settings(), &nodes(straight()));
        let device = DeviceSettings { axes: AXES, ..DeviceSettings::at_1_khz() };
        let frame = Frame::identity();
        Self {
            board: Board::new(settings).unwrap(),
            settings,
            device: Endpoint::new(device, SpentList::EMPTY),
            request: ArmRequest { binding: image.settings().binding, part_serial: 1, frame },
            rewriter: Rewriter::new(Settings::at_1_khz(), Some(image)).unwrap(),
            deframer: Deframer::new(),
            next: Setpoint {
                axes: [0, 0, CLEAR, 0, 0, 0],
                spindle_millirpm: SPINDLE,
                frame_crc: frame.crc,
                ..Setpoint::default()
            },
            drives_on: false,
            now_us: 0,
            late: vec![],
            mistake: None,
            last: None,
        }
    }

    /// One tick; every property that holds in all ticks is asserted here.
    #[track_caller]
    pub fn tick(&mut self, cable: Cable) -> Driven {
        self.now_us += 1_000;
        self.next.flags.0 &= !Flags::DRIVES_ENABLED.0;
        if self.drives_on {
            self.next.flags = self.next.flags.with(Flags::DRIVES_ENABLED);
        }
        self.device.watch(&self.rewriter, self.now_us);
        let mut packet = [0; PACKET_BYTES];
        let bytes = self.board.begin(&self.next, self.drives_on, &mut packet);
        let mut arriving = std::mem::take(&mut self.late);
        if cable != Cable::NoSetpoint {
            let mut answer = self.answer(&packet[..bytes]);
            let middle = answer.len() / 2;
            match cable {
                Cable::Good | Cable::NoSetpoint => {}
                Cable::NoAnswer => answer.clear(),
                Cable::Late => self.late.append(&mut answer),
                Cable::Damaged => answer.iter_mut().skip(middle).take(1).for_each(|b| *b = if *b == 9 { 8 } else { 9 }),
                Cable::CutOff => answer.truncate(middle),
                Cable::Twice => answer.extend_from_within(..),
            }
            arriving.extend(answer);
        }
        self.board.take(&arriving);
        let driven = self.board.finish();
        self.assert_no_jump(&driven);
        self.last = Some((driven, self.drives_on));
        driven
    }

    /// The board's answer to bytes.
    fn answer(&mut self, bytes: &[u8]) -> Vec<u8> {
        let (mut rest, mut sent) = (bytes, vec![]);
        while let Some(framed) = self.deframer.feed(&mut rest) {
            let Framed::Packet(packet) = framed else { continue };
            if !self.device.packet(&self.rewriter, packet, self.now_us).is_accepted() {
                continue;
            }
            let mut answer = [0; 200];
            if let Some(bytes) = self.device.answer_packet(self.now_us + 50, &mut answer) {
                if let Some(mistake) = self.mistake {
                    let raw = unstuff(&mut answer[..bytes - 1]).unwrap();
                    let mut frame = AnswerFrame::decode(raw, AXES).unwrap();
                    mistake(&mut frame.output);
                    frame.encode_packet(&mut answer).unwrap();
                }
                sent.extend_from_slice(&answer[..bytes]);
            }
        }
        sent
    }

    #[track_caller]
    fn assert_no_jump(&self, driven: &Driven) {
        let (before, drives_were_on) = self.last.map_or(([0; 6], false), |(d, on)| (d.correction_nm, on));
        for (now, before) in driven.correction_nm.into_iter().zip(before) {
            assert!(now.abs() <= self.settings.clamp_nm);
            let off = !self.drives_on && !drives_were_on && now == 0;
            let gone = !self.drives_on && driven.cause != Cause::None && now == 0;
            assert!(off || gone || (now - before).abs() <= STEP_NM + 1, "{before} to {now} nm: {driven:?}");
            if !driven.answered && self.settings.joint_limits_nm[0].1 == i64::MAX {
                assert!(now == before || gone, "held: {driven:?}");
            }
            if driven.cause != Cause::None && self.drives_on {
                assert!(now == before, "a lost link holds: {driven:?}");
            }
        }
        if driven.cause != Cause::None || !driven.board.forward {
            assert!(!driven.enable);
        }
    }

    /// Heard, acknowledged, drives on, standing above the start.
    pub fn ready(settings: BoardSettings) -> Self {
        let mut rig = Self::new(settings);
        for _ in 0..20 {
            rig.tick(Cable::Good);
        }
        rig.acknowledge();
        rig.drives_on = true;
        for _ in 0..40 {
            rig.tick(Cable::Good);
        }
        rig
    }
    pub fn acknowledge(&mut self) {
        self.device.acknowledge(&self.rewriter, self.now_us).unwrap();
    }
    /// In the middle of the path, the correction settled.
    pub fn active(settings: BoardSettings) -> Self {
        let mut rig = Self::ready(settings);
        rig.device.arm(&rig.rewriter, &rig.request).unwrap();
        for i in 0..=100 {
            rig.next.axes[2] = GATE + (PASS - GATE) * i / 100;
            rig.tick(Cable::Good);
        }
        rig.forward(700);
        assert_eq!(rig.device.mode(), Mode::Active);
        assert_ne!(rig.correction(), [0; 6]);
        rig
    }
    #[track_caller]
    pub fn forward(&mut self, ticks: u32) -> Driven {
        let mut last = self.last.unwrap().0;
        for _ in 0..ticks {
            last = self.go(Cable::Good);
        }
        last
    }
    /// One tick along the path.
    #[track_caller]
    pub fn go(&mut self, cable: Cable) -> Driven {
        self.next.axes[0] += FEED;
        self.tick(cable)
    }
    pub fn correction(&self) -> [i32; 6] {
        self.last.map_or([0; 6], |(driven, _)| driven.correction_nm)
    }
    /// The board is reset.
    pub fn reset_board(&mut self) {
        let spent = *self.device.state().spent();
        self.device = Endpoint::new(*self.device.settings(), spent);
    }
}

/// A right answer to a setpoint in a mode, as bytes.
pub fn answer_bytes(setpoint: &Setpoint, mode: Mode, correction_nm: [i32; 6]) -> Vec<u8> {
    let mut axes = setpoint.axes;
    axes.iter_mut().zip(correction_nm).for_each(|(axis, nm)| *axis = axis.wrapping_add(nm.into()));
    let output = Output {
        axes,
        correction_nm,
        forward: mode != Mode::Off,
        mode,
        reason: truepath_core::rewrite::Reason::None,
        status: truepath_core::rewrite::Status(0),
        place: truepath_core::rewrite::Place { node: 0, fraction: 0 },
        sequence: setpoint.sequence,
    };
    let mut packet = vec![0; 200];
    let bytes = AnswerFrame { axes: AXES, output }.encode_packet(&mut packet).unwrap();
    packet.truncate(bytes);
    packet
}

/// The setpoint that goes out in bytes.
pub fn sent(bytes: &[u8]) -> Setpoint {
    let start = usize::from(bytes[0] == 0);
    let mut packet = bytes[start..bytes.len() - 1].to_vec();
    SetpointFrame::decode(unstuff(&mut packet).unwrap(), AXES).unwrap()
}
