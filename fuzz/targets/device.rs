//! Any bytes as what reaches a whole device over both of its links: requests whose frame and checksum are right and whose content is
//! anything, bytes as they are, setpoints, an image in all its pieces, time and resets. Whatever comes, a message never begins a
//! correction, nobody but the controller's word that the drives are disabled leads out of Off, and what a device says can be read.
#![no_main]

use std::cell::RefCell;

use libfuzzer_sys::fuzz_target;
use serde::Serialize;
use serde::ser::SerializeTuple;
use truepath_core::checksum::crc32;
use truepath_core::geometry::Point;
use truepath_core::image::{
    Binding, CorrectionLimits, DeviceClass, FeedLaw, FineOffset, ImageNode, ImageSettings, PathWindow, build,
    image_bytes,
};
use truepath_core::link::{
    Ask, CHUNK_BYTES, Item, MAX_SETPOINT_BYTES, PACKET_BYTES, Reply, Request, ResetCause, Response, SetpointFrame,
    decode, encode,
};
use truepath_core::rewrite::{ArmRequest, Flags, Frame, Mode, Setpoint};
use truepath_core::units::{Offset, Position, Real};
use truepath_fw::computation::ProgressMeter;
use truepath_fw::config_service::{Board, IMAGE_BYTES, Memory, Restart};
use truepath_fw::device::Device;
use truepath_fw::flash::{BANK_BYTES, BANK_WORDS, Nor, WordState};

/// Longest content of a drawn request, bytes.
const CONTENT_BYTES: usize = 160;
/// The binding of the image that a step uploads.
const BINDING: Binding = Binding { program_crc: 0x1234_5678, feature: 1, pass: 1, tool: 3, tool_offset: 3, setup: 1 };

type Whole = Device<'static, Nor<'static>>;

thread_local! {
    /// The memory of the device, from one input to the next.
    static MEMORY: RefCell<Option<(Nor<'static>, Memory<'static>)>> = RefCell::new(Some(memory()));
    static IMAGE: Vec<u8> = image();
}

fuzz_target!(|bytes: &[u8]| {
    let (flash, memory) = MEMORY.take().expect("one input at a time");
    let (bank, words) = flash.into_memory();
    let mut tape = Tape(bytes);
    let board = Board {
        name: "fuzz",
        last_reset: ResetCause::PowerOn,
        class: DeviceClass::Bench,
        present: tape.byte() & 1 == 0,
        id: [7; 12],
        secret: None,
        counter_hz: 1_000_000,
    };
    let mut tested =
        Tested { device: Some(Device::start(Nor::erased(bank, words), memory, board, 0)), now_us: 0, sequence: 0 };
    tested.is_off();
    while !tape.0.is_empty() {
        tested.step(&mut tape);
    }
    let (flash, memory, _) = tested.device.take().expect("the device").into_parts();
    MEMORY.set(Some((flash, memory)));
});

/// A device on its way through an input.
struct Tested {
    /// Always there but during a reset.
    device: Option<Whole>,
    now_us: u64,
    sequence: u32,
}

impl Tested {
    fn step(&mut self, tape: &mut Tape<'_>) {
        self.now_us += 1;
        match tape.byte() % 10 {
            0..=2 => {
                let length = usize::from(tape.byte()) % CONTENT_BYTES;
                let content = tape.take(length);
                self.ask(&Raw(content));
            }
            3 => {
                let length = tape.byte().into();
                let bytes = tape.take(length).to_vec();
                self.told(&bytes);
            }
            4 | 5 => self.setpoint(tape),
            6 => self.upload(tape),
            7 => {
                let request =
                    ArmRequest { binding: BINDING, part_serial: tape.byte().into(), frame: Frame::identity() };
                let ask = if tape.byte() & 1 == 0 { Ask::AcknowledgeDrivesDisabled } else { Ask::Arm(request) };
                self.ask(&Request { id: 7, ask });
            }
            8 => {
                self.now_us += u64::from(tape.word()) << (tape.byte() % 16);
                let (device, now_us) = self.device();
                let was = device.state().mode();
                let restart = device.watch(now_us);
                assert!(may_follow(was, device.state().mode()), "time: {was:?} became {:?}", device.state().mode());
                self.restart(restart);
            }
            _ => {
                let cause = if tape.byte() & 1 == 0 { ResetCause::PowerOn } else { ResetCause::Software };
                self.reset(cause);
            }
        }
    }

    fn device(&mut self) -> (&mut Whole, u64) {
        (self.device.as_mut().expect("the device"), self.now_us)
    }

    /// A request, or what is framed like one.
    fn ask<T: Serialize>(&mut self, message: &T) -> Option<Vec<u8>> {
        let mut packet = [0; PACKET_BYTES];
        let used = encode(message, &mut packet).ok()?;
        self.told(&packet[..used])
    }

    /// Bytes of the configuration link; gives the last answer.
    fn told(&mut self, bytes: &[u8]) -> Option<Vec<u8>> {
        let (device, now_us) = self.device();
        let was = device.state().mode();
        let mut answer = None;
        let restart = device.config_bytes(bytes, now_us, |bytes| answer = Some(bytes.to_vec()));
        let is = device.state().mode();
        if let Some(answer) = &answer {
            let mut packet = answer.clone();
            let read: Response<'_> = decode(&mut packet).expect("an answer that can be read");
            if was == Mode::Off && is != Mode::Off {
                assert!(is == Mode::Bypass && read.answer.is_ok(), "Off became {is:?} by {read:?}");
            }
        }
        assert!(is == was || may_follow(was, is) || answer.is_some(), "{was:?} became {is:?} without an answer");
        assert!(is == was || !matches!(is, Mode::Active | Mode::Hold), "a message led from {was:?} to {is:?}");
        assert!(is != Mode::Off || !device.drive_enable(), "the drives are enabled in Off");
        self.restart(restart);
        answer
    }

    /// A setpoint whose frame is right.
    fn setpoint(&mut self, tape: &mut Tape<'_>) {
        let place = |tape: &mut Tape<'_>| i64::from(tape.word() as i16) * 1_000;
        self.sequence = self.sequence.wrapping_add(if tape.byte() < 240 { 1 } else { tape.byte().into() });
        let setpoint = Setpoint {
            axes: [place(tape), place(tape), place(tape) - 10_000_000, 0, 0, 0],
            spindle_millirpm: 1_500_000,
            spindle_age_ticks: 0,
            sequence: self.sequence,
            frame_crc: Frame::identity().crc,
            flags: Flags(tape.byte().into()),
        };
        let axes = self.device().0.servo().axes();
        let mut packet = [0; MAX_SETPOINT_BYTES + 2];
        let used = SetpointFrame { axes, setpoint }.encode_packet(&mut packet).expect("room");
        self.now_us += 1_000;
        let (device, now_us) = self.device();
        let was = device.state().mode();
        device.setpoint_bytes(&packet[..used], now_us, |_| ());
        let is = device.state().mode();
        assert!(was != Mode::Off || is == Mode::Off, "a setpoint led out of Off");
        assert!(is != Mode::Armed || was == Mode::Armed, "a setpoint armed");
    }

    /// The image, perhaps with a changed byte, in all its pieces; then it is made the active one.
    fn upload(&mut self, tape: &mut Tape<'_>) {
        let mut image = IMAGE.with(Vec::clone);
        let (at, change) = (usize::from(tape.word()), tape.byte());
        if let Some(byte) = image.get_mut(at) {
            *byte ^= change;
        }
        let (length, crc) = (image.len() as u32, crc32(&image));
        self.ask(&Request { id: 1, ask: Ask::Begin { item: Item::Image, length, crc } });
        for (k, bytes) in image.chunks(CHUNK_BYTES).enumerate() {
            let offset = (k * CHUNK_BYTES) as u32;
            self.ask(&Request { id: k as u16 + 2, ask: Ask::Chunk { offset, bytes } });
        }
        self.ask(&Request { id: 100, ask: Ask::Commit });
        let own = image.last_chunk::<4>().map_or(0, |crc| u32::from_le_bytes(*crc));
        let slot = tape.byte() & 1;
        self.ask(&Request { id: 101, ask: Ask::Activate { slot, crc: own } });
    }

    fn restart(&mut self, asked: Option<Restart>) {
        if let Some(Restart { watchdog }) = asked {
            self.reset(if watchdog { ResetCause::Watchdog } else { ResetCause::Software });
        }
    }

    /// Switches off and on: settings are those that were kept, and the device is in Off.
    fn reset(&mut self, cause: ResetCause) {
        let before = self.settings();
        let now_us = self.now_us;
        self.device = self.device.take().map(|device| device.reset(cause, now_us));
        self.is_off();
        let after = self.settings();
        if let (Some(before), Some(after)) = (before, after) {
            assert_eq!(before, after, "settings over a reset");
        }
    }

    /// The settings in use; `None` where the device does not say them to everybody.
    fn settings(&mut self) -> Option<Vec<u8>> {
        let mut answer = self.ask(&Request { id: 9, ask: Ask::Settings })?;
        let read: Response<'_> = decode(&mut answer).expect("an answer that can be read");
        let Ok(Reply::Settings(settings)) = read.answer else { return None };
        assert!(settings.check().is_ok(), "{settings:?}");
        Some(format!("{settings:?}").into_bytes())
    }

    fn is_off(&mut self) {
        let (device, _) = self.device();
        assert!(
            device.state().mode() == Mode::Off && !device.drive_enable(),
            "after a reset: {:?}",
            device.state().mode()
        );
    }
}

/// Whether a mode may follow another without a message that asks for it.
fn may_follow(was: Mode, is: Mode) -> bool {
    was == is || is == Mode::Off || was != Mode::Off && is == Mode::Bypass
}

/// Bytes that are taken from the front; zeros behind their end.
struct Tape<'a>(&'a [u8]);

impl<'a> Tape<'a> {
    fn take(&mut self, count: usize) -> &'a [u8] {
        let (taken, rest) = self.0.split_at(count.min(self.0.len()));
        self.0 = rest;
        taken
    }
    fn byte(&mut self) -> u8 {
        self.take(1).first().copied().unwrap_or_default()
    }
    fn word(&mut self) -> u16 {
        u16::from_le_bytes([self.byte(), self.byte()])
    }
}

/// Bytes that are framed as they are.
struct Raw<'a>(&'a [u8]);

impl Serialize for Raw<'_> {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut all = serializer.serialize_tuple(self.0.len())?;
        for byte in self.0 {
            all.serialize_element(byte)?;
        }
        all.end()
    }
}

fn memory() -> (Nor<'static>, Memory<'static>) {
    fn lasting<T: Clone>(value: T, count: usize) -> &'static mut [T] {
        vec![value; count].leak()
    }
    let memory = Memory {
        image: lasting(0, IMAGE_BYTES),
        recording: lasting(0, 9_600),
        program: lasting(0, 4_096),
        job: lasting(0, 512),
        probe: lasting(0, 4_096),
        meter: Box::leak(Box::new(ProgressMeter::new())),
    };
    (Nor::erased(lasting(0, BANK_BYTES), lasting(WordState::Blank, BANK_WORDS)), memory)
}

/// Along X, 0.1 mm apart; everywhere 50 µm in Y.
fn image() -> Vec<u8> {
    let fine = |um| FineOffset::checked_from_offset(Offset::from_um(um)).expect("small");
    let settings = ImageSettings {
        binding: BINDING,
        closed: false,
        feed: FeedLaw::new(fine(44), 6, 1_500_000, Real::ZERO, Real::ratio(1, 4), Real::ratio(3, 2)),
        limits: CorrectionLimits {
            clamp: Offset::from_um(500),
            warn: Offset::from_um(200),
            slew_nm_per_s: 20_000_000,
            acceleration_nm_per_s2: 1_000_000_000,
        },
        window: PathWindow {
            tolerance: Offset::from_um(200),
            z_low: Position::from_nm(-10_000_000),
            z_high: Position::from_nm(-10_000_000),
            gate_height: Offset::from_um(5_000),
        },
        node_step: Offset::from_um(100),
    };
    let node = |i: i64| ImageNode {
        point: Point::from_nm(i * 100_000, 0),
        chip: [fine(0), fine(50)],
        edge: [fine(0), fine(0)],
    };
    let nodes: Vec<ImageNode> = (0..=20).map(node).collect();
    let mut bytes = vec![0; image_bytes(nodes.len())];
    build(&settings, &nodes, &mut bytes).expect("an image");
    bytes
}
