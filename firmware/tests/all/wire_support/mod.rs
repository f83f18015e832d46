//! A device in process with a controller and an operator before it; everything goes over the bytes of the links.

// Shared with the tests of the wire, which use more of it.
#[allow(dead_code)]
#[path = "../../../../core/wire/tests/all/rewrite_support/mod.rs"]
pub mod part;
pub mod update;

use std::cell::RefCell;

use ed25519_dalek::{Signer, SigningKey};
use embedded_storage::nor_flash::ReadNorFlash;
use part::{CLEAR, GATE, MM, PASS, SPINDLE};
use truepath_core::image::{
    DeviceClass, DeviceClasses, Image, PublicKey, Role, build, image_bytes, sign, signed_bytes,
};
use truepath_core::link::{
    AccessError, AnswerFrame, Ask, CHUNK_BYTES, Denial, DeviceSettings, DeviceStatus, Item, PACKET_BYTES, Reply,
    Request, ResetCause, Response, SetpointFrame, Slot, decode, encode, encode_request, login_message, unstuff,
};
use truepath_core::rewrite::{ArmRequest, Flags, Frame, Mode, Output, Setpoint};
use truepath_fw::computation::ProgressMeter;
use truepath_fw::config_service::{Board, IMAGE_BYTES, Memory, Restart};
use truepath_fw::device::Device;
use truepath_fw::flash::{BANK_BYTES, Cut, FLASH_BYTES, Nor, WORD_BYTES, WordState};
use truepath_fw::loader::prepare;

pub type Bank = Nor<'static>;

/// Frames of three axes the recorder holds.
pub const RECORDED: usize = 200;

fn lent<T: Clone>(blank: T, count: usize) -> &'static mut [T] {
    vec![blank; count].leak()
}

/// Bytes of an image along points, with the settings of a part.
pub fn image_of(points: Vec<(i64, i64)>) -> Vec<u8> {
    image_with(&part::settings(), points)
}

pub fn image_with(settings: &truepath_core::image::ImageSettings, points: Vec<(i64, i64)>) -> Vec<u8> {
    let nodes = part::nodes(points);
    let mut bytes = vec![0; image_bytes(nodes.len())];
    build(settings, &nodes, &mut bytes).unwrap();
    bytes
}

/// Somebody who signs images.
pub fn owner(seed: u8) -> SigningKey {
    SigningKey::from_bytes(&[seed; 32])
}
pub fn public(key: &SigningKey) -> PublicKey {
    PublicKey(key.verifying_key().to_bytes())
}
/// An image signed for some classes of device.
pub fn signed(image: &[u8], key: &SigningKey, classes: DeviceClasses) -> Vec<u8> {
    counted(image, key, classes, 1_700_000_000)
}
/// The same with a counter.
pub fn counted(image: &[u8], key: &SigningKey, classes: DeviceClasses, counter: u32) -> Vec<u8> {
    let mut bytes = vec![0; signed_bytes(image)];
    sign(image, &public(key), classes, counter, |message| key.sign(message).to_bytes(), &mut bytes).unwrap();
    bytes
}

/// The checksum that names an image.
pub fn name(image: &[u8]) -> u32 {
    Image::new_checked(image).unwrap().crc()
}

pub struct Rig {
    device: Option<Device<'static, Bank>>,
    pub now_us: u64,
    pub id: u16,
    pub setpoint: Setpoint,
    pub restart: Option<Restart>,
    packet: Vec<u8>,
    /// Number of its session.
    pub session: Option<u64>,
    /// Whether it logs in where it has to, with the key of an [`owner`].
    pub logs_in: bool,
}

impl Rig {
    /// A device with the settings for 1 kHz.
    pub fn new() -> Self {
        let mut rig = Self::from_factory();
        rig.done(Ask::Configure(DeviceSettings::at_1_khz())).unwrap();
        rig
    }
    /// A device at which nobody is: its button was not held at its start.
    pub fn absent() -> Self {
        let mut rig = Self::new();
        let (flash, memory, board) = rig.device.take().unwrap().into_parts();
        rig.device = Some(Device::start(flash, memory, Board { present: false, ..board }, rig.now_us));
        rig
    }
    /// The same with a loader, which starts it at each reset.
    pub fn with_loader() -> Self {
        let mut rig = Self::of_flash(FLASH_BYTES);
        rig.done(Ask::Configure(DeviceSettings::at_1_khz())).unwrap();
        rig
    }
    /// A device as it leaves the factory.
    pub fn from_factory() -> Self {
        Self::of_flash(BANK_BYTES)
    }
    fn of_flash(bytes: usize) -> Self {
        let (bank, words) = (lent(0xFF, bytes), lent(WordState::Blank, bytes / WORD_BYTES));
        let memory = Memory {
            image: lent(0, IMAGE_BYTES),
            recording: lent(0, 48 * RECORDED),
            program: lent(0, 4_096),
            job: lent(0, 512),
            probe: lent(0, 4_096),
            meter: Box::leak(Box::new(ProgressMeter::new())),
        };
        let board = Board {
            name: "test",
            last_reset: ResetCause::PowerOn,
            class: DeviceClass::Bench,
            present: true,
            id: [3; 12],
            secret: None,
            counter_hz: 1_000_000,
        };
        let device = Device::start(Nor::erased(bank, words), memory, board, 0);
        let setpoint = Setpoint {
            axes: [0, 0, CLEAR, 0, 0, 0],
            spindle_millirpm: SPINDLE,
            frame_crc: Frame::identity().crc,
            ..Setpoint::default()
        };
        Self {
            device: Some(device),
            now_us: 0,
            id: 0,
            setpoint,
            restart: None,
            packet: vec![],
            session: None,
            logs_in: true,
        }
    }
    /// With an image in slot 0, in use.
    pub fn with_image(image: &[u8]) -> Self {
        let mut rig = Self::new();
        rig.upload(image).unwrap();
        rig.activate(0, name(image)).unwrap();
        rig
    }
    pub fn device(&mut self) -> &mut Device<'static, Bank> {
        self.device.as_mut().unwrap()
    }
    pub fn flash(&mut self) -> &mut Bank {
        self.device().flash()
    }

    /// A request, with the next id.
    pub fn ask(&mut self, ask: Ask<'_>) -> Result<Reply<'_>, Denial> {
        self.exchange(ask);
        let denial = decode::<Response<'_>>(&mut self.packet.clone()).unwrap().answer.err();
        let again = match denial {
            Some(Denial::Access(AccessError::Role { needed })) if self.logs_in => self.log_in_to(needed),
            Some(Denial::Access(AccessError::Ended { .. })) if self.logs_in => {
                self.session = None;
                return self.ask(ask);
            }
            _ => false,
        };
        match denial {
            Some(denial) if !again => return Err(denial),
            Some(_) => self.exchange(ask),
            None => {}
        }
        decode::<Response<'_>>(&mut self.packet).unwrap().answer
    }
    /// Sends a request of its session and keeps the one answer.
    fn exchange(&mut self, ask: Ask<'_>) {
        self.id = self.id.wrapping_add(1);
        let mut packet = [0; PACKET_BYTES];
        let used = encode_request(&Request { id: self.id, ask }, self.session, &mut packet).unwrap();
        let answers = self.raw(&packet[..used]);
        assert_eq!(answers.len(), 1, "one answer to {ask:?}");
        self.packet = answers.into_iter().next().unwrap();
        assert_eq!(decode::<Response<'_>>(&mut self.packet.clone()).unwrap().id, self.id);
    }
    /// Logs in with the key of an owner that the device trusts, if there is one.
    fn log_in_to(&mut self, role: Role) -> bool {
        let Reply::Keys(keys) = self.ask(Ask::Keys).unwrap() else { panic!() };
        let trusted = (1..=9).map(owner).find(|owner| keys.keys.find(public(owner).id()).is_some());
        trusted.is_some_and(|owner| self.log_in(&owner, role).is_ok())
    }
    /// The challenge: number of the device and nonce.
    pub fn challenge(&mut self) -> ([u8; 12], [u8; 32]) {
        let Reply::Challenge { device, nonce, .. } = self.ask(Ask::Challenge).unwrap() else { panic!() };
        (device, nonce)
    }
    /// Logs in with a key; its session is that of the requests from then on.
    pub fn log_in(&mut self, owner: &SigningKey, role: Role) -> Result<u64, Denial> {
        self.session = None;
        let (device, nonce) = self.challenge();
        let ask = login(owner, role, &device, &nonce);
        let Reply::LoggedIn { session } = self.ask(ask)? else { panic!() };
        self.session = Some(session);
        Ok(session)
    }
    /// Bytes on the configuration link; gives the packets that come back, without their delimiters.
    pub fn raw(&mut self, bytes: &[u8]) -> Vec<Vec<u8>> {
        let (mut out, now_us) = (vec![], self.now_us);
        let restart = self.device().config_bytes(bytes, now_us, |answer| out.push(answer.to_vec()));
        self.restart = self.restart.or(restart);
        for packet in &mut out {
            assert_eq!(packet.pop(), Some(0));
        }
        out
    }
    pub fn status(&mut self) -> DeviceStatus {
        let Reply::Status(status) = self.ask(Ask::Status).unwrap() else { panic!() };
        status
    }
    pub fn mode(&mut self) -> Mode {
        self.status().mode
    }
    pub fn slots(&mut self) -> [Slot; 2] {
        let Reply::Slots(slots) = self.ask(Ask::List).unwrap() else { panic!() };
        slots
    }
    pub fn settings(&mut self) -> DeviceSettings {
        let Reply::Settings(settings) = self.ask(Ask::Settings).unwrap() else { panic!() };
        settings
    }
    /// Number of the next entry of the log.
    pub fn logged_next(&mut self) -> u32 {
        let Reply::Log { next, .. } = self.ask(Ask::Log { from: u32::MAX }).unwrap() else { panic!() };
        next
    }
    pub fn done(&mut self, ask: Ask<'_>) -> Result<(), Denial> {
        self.ask(ask).map(|reply| assert_eq!(reply, Reply::Done))
    }
    pub fn begin(&mut self, image: &[u8]) -> Result<u32, Denial> {
        self.begin_item(Item::Image, image, name(image))
    }
    pub fn begin_item(&mut self, item: Item, bytes: &[u8], crc: u32) -> Result<u32, Denial> {
        next(self.ask(Ask::Begin { item, length: bytes.len() as u32, crc }))
    }
    pub fn chunk(&mut self, offset: u32, bytes: &[u8]) -> Result<u32, Denial> {
        next(self.ask(Ask::Chunk { offset, bytes }))
    }
    /// All that is missing, in chunks of a size.
    pub fn chunks(&mut self, mut offset: u32, bytes: &[u8], size: usize) -> Result<(), Denial> {
        while (offset as usize) < bytes.len() {
            let rest = &bytes[offset as usize..];
            offset = self.chunk(offset, &rest[..rest.len().min(size)])?;
        }
        Ok(())
    }
    pub fn commit(&mut self) -> Result<(u8, u32), Denial> {
        self.ask(Ask::Commit).map(|reply| match reply {
            Reply::Committed { slot, crc } => (slot, crc),
            other => panic!("{other:?}"),
        })
    }
    /// The whole of an upload; gives the slot.
    pub fn upload(&mut self, image: &[u8]) -> Result<u8, Denial> {
        let offset = self.begin(image)?;
        self.chunks(offset, image, CHUNK_BYTES)?;
        let (slot, crc) = self.commit()?;
        assert_eq!(crc, name(image));
        Ok(slot)
    }
    pub fn activate(&mut self, slot: u8, crc: u32) -> Result<(), Denial> {
        self.done(Ask::Activate { slot, crc })
    }

    /// A setpoint with the next sequence, a millisecond later; gives the answer.
    pub fn send(&mut self, x: i64, y: i64, z: i64) -> Option<Output> {
        self.setpoint.sequence = self.setpoint.sequence.wrapping_add(1);
        self.setpoint.axes = [x, y, z, 0, 0, 0];
        self.now_us += 1_000;
        self.again()
    }
    /// The last setpoint as a new one.
    pub fn stay(&mut self) -> Option<Output> {
        let [x, y, z, ..] = self.setpoint.axes;
        self.send(x, y, z)
    }
    /// The same frame, at the same time.
    pub fn again(&mut self) -> Option<Output> {
        let packet = self.frame();
        self.stream(&packet).pop()
    }
    /// The frame of the present setpoint, as it travels.
    pub fn frame(&self) -> Vec<u8> {
        let mut packet = [0; 128];
        let used = SetpointFrame { axes: 3, setpoint: self.setpoint }.encode_packet(&mut packet).unwrap();
        packet[..used].to_vec()
    }
    /// Bytes on the setpoint link; gives the answers.
    pub fn stream(&mut self, bytes: &[u8]) -> Vec<Output> {
        let (mut out, now_us) = (vec![], self.now_us);
        self.device().watch(now_us);
        self.device().setpoint_bytes(bytes, now_us, |answer| out.push(answer.to_vec()));
        let read = |mut packet: Vec<u8>| {
            assert_eq!(packet.pop(), Some(0));
            AnswerFrame::decode(unstuff(&mut packet).unwrap(), 3).unwrap().output
        };
        out.into_iter().map(read).collect()
    }
    /// Time goes by without setpoints.
    pub fn wait(&mut self, ms: u64) {
        self.now_us += ms * 1_000;
        let now_us = self.now_us;
        let restart = self.device().watch(now_us);
        self.restart = self.restart.or(restart);
    }

    /// Out of `Off`, drives enabled.
    pub fn enable(&mut self) {
        self.setpoint.flags = Flags::default();
        self.stay();
        self.done(Ask::AcknowledgeDrivesDisabled).unwrap();
        self.setpoint.flags = Flags::DRIVES_ENABLED;
        // As many as it takes to know their rate.
        assert!((0..40).all(|_| self.stay().unwrap().mode == Mode::Bypass));
    }
    pub fn request(&self, part_serial: u32) -> ArmRequest {
        ArmRequest { binding: part::settings().binding, part_serial, frame: Frame::identity() }
    }
    pub fn arm(&mut self, part_serial: u32) -> Result<(), Denial> {
        let request = self.request(part_serial);
        self.done(Ask::Arm(request))
    }
    /// From over the start down through the gate into the pass.
    pub fn plunge(&mut self) {
        self.send(0, 0, GATE);
        for i in 0..=100 {
            self.send(0, 0, GATE + (PASS - GATE) * i / 100);
        }
    }
    /// Active in the pass, part 1 armed.
    pub fn active(image: &[u8]) -> Self {
        let mut rig = Self::with_image(image);
        rig.enable();
        rig.arm(1).unwrap();
        rig.plunge();
        for i in 1..=300 {
            rig.send(i * part::FEED, 0, PASS);
        }
        assert_eq!(rig.mode(), Mode::Active);
        rig
    }
    /// Standing still until the correction is out.
    pub fn settle(&mut self) {
        for _ in 0..2_000 {
            if self.stay().is_some_and(|out| out.mode == Mode::Bypass) {
                return;
            }
        }
        panic!("the correction is not out after two seconds");
    }

    /// The power fails and comes back, or something else resets the device; the flash stays.
    pub fn reset(&mut self, cause: ResetCause) {
        let now_us = self.now_us;
        self.session = None;
        let (mut flash, memory, board) = self.device.take().unwrap().into_parts();
        flash.power_up();
        if flash.capacity() == FLASH_BYTES {
            let shared = RefCell::new(flash);
            prepare(&shared).unwrap();
            flash = shared.into_inner();
        }
        self.device = Some(Device::start(flash, memory, Board { last_reset: cause, ..board }, now_us));
    }
    /// What the flash holds.
    pub fn contents(&mut self) -> (Vec<u8>, Vec<WordState>) {
        let mut kept = (vec![], vec![]);
        self.with_memory(|bytes, words| kept = (bytes.to_vec(), words.to_vec()));
        kept
    }
    /// A device that holds it again.
    pub fn restore(&mut self, (bytes, words): &(Vec<u8>, Vec<WordState>)) {
        self.with_memory(|to, marks| {
            to.copy_from_slice(bytes);
            marks.copy_from_slice(words);
        });
    }
    fn with_memory(&mut self, f: impl FnOnce(&mut [u8], &mut [WordState])) {
        let (flash, memory, board) = self.device.take().unwrap().into_parts();
        let (bytes, words) = flash.into_memory();
        f(bytes, words);
        self.session = None;
        self.device = Some(Device::start(Nor::new(bytes, words), memory, board, self.now_us));
    }
    /// The program that came as an update.
    pub fn running(&mut self) -> Option<truepath_core::link::Firmware> {
        update::status(self).running
    }
    /// A device with the settings for 1 kHz and nothing else, in the same memory.
    pub fn wipe(&mut self) {
        use embedded_storage::nor_flash::NorFlash;
        self.flash().power_up();
        self.flash().erase(0, BANK_BYTES as u32).unwrap();
        self.reset(ResetCause::PowerOn);
        self.done(Ask::Configure(DeviceSettings::at_1_khz())).unwrap();
    }
    pub fn cut(&mut self, cut: Cut) {
        self.flash().cut(Some(cut));
    }
    pub fn operations(&mut self) -> u32 {
        self.flash().wear().operations()
    }
    pub fn has_power(&mut self) -> bool {
        self.flash().is_powered()
    }
}

/// The right answer to a challenge.
pub fn login(owner: &SigningKey, role: Role, device: &[u8; 12], nonce: &[u8; 32]) -> Ask<'static> {
    let key = public(owner).id();
    let signature = owner.sign(&login_message(device, nonce, key, role)).to_bytes();
    let (halves, _) = signature.as_chunks::<32>();
    Ask::Login { key, role, signature: [halves[0], halves[1]] }
}

/// A request as it travels.
pub fn request(id: u16, ask: Ask<'_>) -> Vec<u8> {
    let mut packet = [0; PACKET_BYTES];
    let used = encode(&Request { id, ask }, &mut packet).unwrap();
    packet[..used].to_vec()
}

fn next(answer: Result<Reply<'_>, Denial>) -> Result<u32, Denial> {
    answer.map(|reply| match reply {
        Reply::Next { offset } => offset,
        other => panic!("{other:?}"),
    })
}

/// A straight of 10 mm, as [`part::straight`], with one correction or another.
pub fn straight(shift_nm: i64) -> Vec<(i64, i64)> {
    part::straight().into_iter().map(|(x, y)| (x, y + shift_nm * (x % (2 * MM)) / MM)).collect()
}
