//! The setpoint path interrupts the configuration service between any two of its closures; flash that wears out under it.

use crate::wire_support;

use embedded_storage::nor_flash::{ErrorType, NorFlash, ReadNorFlash};
use truepath_core::image::DeviceClass;
use truepath_core::link::{Ask, Denial, DeviceSettings, ResetCause, Response, SetpointFrame, Slot, decode};
use truepath_core::rewrite::{ArmRequest, Flags, Frame, Mode, Refusal, Setpoint};
use truepath_fw::computation::ProgressMeter;
use truepath_fw::config_service::{Board, ConfigService, IMAGE_BYTES, Memory};
use truepath_fw::flash::{BANK_BYTES, BANK_WORDS, Nor, NorError, WordState};
use truepath_fw::servo::{Servo, ServoAccess};
use truepath_fw::slots::Upload;
use wire_support::part::{self, straight};
use wire_support::{image_of, name, request};

fn bank() -> Nor<'static> {
    Nor::erased(vec![0; BANK_BYTES].leak(), vec![WordState::Blank; BANK_WORDS].leak())
}

/// A servo whose link falls silent before one of the closures of the configuration service.
struct Interrupted {
    servo: Servo<'static>,
    left: Option<u32>,
    now_us: u64,
}

impl ServoAccess<'static> for Interrupted {
    fn with<R>(&mut self, f: impl FnOnce(&mut Servo<'static>) -> R) -> R {
        match self.left {
            Some(0) => {
                self.left = None;
                self.servo.watch(self.now_us + 1_000_000);
            }
            left => self.left = left.map(|left| left - 1),
        }
        f(&mut self.servo)
    }
}

type TestService = ConfigService<'static, Nor<'static>>;

fn ask(service: &mut TestService, servo: &mut Interrupted, id: u16, ask: Ask<'_>) -> Result<(), Denial> {
    let mut answer = vec![];
    service.receive(&request(id, ask), servo.now_us, servo, &mut |bytes: &[u8]| answer.extend_from_slice(bytes));
    assert_eq!(answer.pop(), Some(0));
    let response: Response<'_> = decode(&mut answer).unwrap();
    response.answer.map(|_| ())
}

fn enable(service: &mut TestService, servo: &mut Interrupted) {
    servo.now_us += 2_000_000;
    // As many as it takes to know their rate.
    for sequence in 0..40 {
        servo.now_us += 1_000;
        let setpoint = Setpoint { sequence, flags: Flags::default(), ..Setpoint::default() };
        let (mut packet, now) = ([0; 128], servo.now_us);
        let used = SetpointFrame { axes: 3, setpoint }.encode_packet(&mut packet).unwrap();
        servo.servo.receive(&packet[..used], now, &now, &mut |_: &[u8]| {});
    }
    ask(service, servo, 1_000, Ask::AcknowledgeDrivesDisabled).unwrap();
    assert_eq!(servo.servo.mode(), Mode::Bypass);
}

#[test]
fn silence_between_any_two_steps_of_a_request_leaves_the_device_off_and_in_order() {
    let lent = |bytes| vec![0; bytes].leak();
    let memory = Memory {
        image: lent(IMAGE_BYTES),
        recording: lent(4_800),
        program: lent(64),
        job: lent(64),
        probe: lent(64),
        meter: Box::leak(Box::new(ProgressMeter::new())),
    };
    let board = Board {
        name: "test",
        last_reset: ResetCause::PowerOn,
        class: DeviceClass::Bench,
        present: false,
        id: [0; 12],
        secret: None,
        counter_hz: 1_000_000,
    };
    let (mut service, servo) = ConfigService::start(bank(), memory, board, 0);
    let mut servo = Interrupted { servo, left: None, now_us: 0 };
    ask(&mut service, &mut servo, 60, Ask::Configure(DeviceSettings::at_1_khz())).unwrap();
    let images = [image_of(straight()), image_of(wire_support::straight(10))];
    for (id, image) in (0..).step_by(10).zip(&images) {
        let length = image.len() as u32;
        let begin = Ask::Begin { item: truepath_core::link::Item::Image, length, crc: name(image) };
        ask(&mut service, &mut servo, id, begin).unwrap();
        for (k, bytes) in image.chunks(1_024).enumerate() {
            ask(&mut service, &mut servo, id + 1, Ask::Chunk { offset: k as u32 * 1_024, bytes }).unwrap();
        }
        ask(&mut service, &mut servo, id + 9, Ask::Commit).unwrap();
    }
    ask(&mut service, &mut servo, 50, Ask::Activate { slot: 0, crc: name(&images[0]) }).unwrap();
    let (mut part_serial, mut interrupted, mut spent_without_arming) = (0, 0, 0);
    for before in 0..8 {
        part_serial += 1;
        let arm = Ask::Arm(ArmRequest { binding: part::settings().binding, part_serial, frame: Frame::identity() });
        let requests = [
            arm,
            Ask::Activate { slot: 1, crc: name(&images[1]) },
            Ask::Activate { slot: 0, crc: name(&images[0]) },
            Ask::Deactivate,
            Ask::Commit,
        ];
        for (k, what) in requests.into_iter().enumerate() {
            enable(&mut service, &mut servo);
            ask(&mut service, &mut servo, 200, Ask::Activate { slot: 0, crc: name(&images[0]) }).unwrap();
            servo.left = Some(before);
            let answer = ask(&mut service, &mut servo, 300 + before as u16, what);
            let struck = servo.left.take().is_none();
            interrupted += u32::from(struck);
            assert_eq!(struck, servo.servo.mode() == Mode::Off, "{k}, {before}");
            if k == 0 && struck {
                enable(&mut service, &mut servo);
                match ask(&mut service, &mut servo, 400, arm) {
                    // Denied, but written to the ledger before: it stays spent.
                    Err(Denial::Refused(Refusal::PartRepeated { .. })) if answer.is_err() => spent_without_arming += 1,
                    other => assert_eq!((other, answer.is_err()), (Ok(()), true)),
                }
            }
            if servo.servo.mode() == Mode::Armed {
                ask(&mut service, &mut servo, 500, Ask::Disarm).unwrap();
            }
            servo.servo.watch(servo.now_us + 1_000_000);
        }
    }
    assert!(interrupted > 10 && spent_without_arming > 0, "{interrupted}, {spent_without_arming}");
}

/// A bank in which bits fall over: as a word is programmed, or later.
struct Worn {
    nor: Nor<'static>,
    /// Words until one is programmed wrongly.
    wrong_after: u32,
    /// This byte reads wrongly.
    rotten: Option<u32>,
}

impl ErrorType for Worn {
    type Error = NorError;
}

impl ReadNorFlash for Worn {
    const READ_SIZE: usize = 1;
    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), NorError> {
        self.nor.read(offset, bytes)?;
        if let Some(byte) = self.rotten.and_then(|at| bytes.get_mut(at.checked_sub(offset)? as usize)) {
            *byte ^= 0x40;
        }
        Ok(())
    }
    fn capacity(&self) -> usize {
        self.nor.capacity()
    }
}

impl NorFlash for Worn {
    const WRITE_SIZE: usize = 32;
    const ERASE_SIZE: usize = Nor::ERASE_SIZE;
    fn erase(&mut self, from: u32, to: u32) -> Result<(), NorError> {
        self.nor.erase(from, to)
    }
    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), NorError> {
        let mut bytes = bytes.to_vec();
        if self.wrong_after == 0 {
            bytes[7] ^= 1;
        }
        self.wrong_after = self.wrong_after.wrapping_sub(1);
        self.nor.write(offset, &bytes)
    }
}

#[test]
fn a_word_that_is_not_what_was_programmed_is_noticed_before_the_commit_word() {
    let image = image_of(straight()[..10].to_vec());
    let binding = part::settings().binding;
    let mut scratch = vec![0; IMAGE_BYTES];
    let words = 2 + image.len().div_ceil(32) as u32;
    for wrong_after in 0..words {
        let mut flash = Worn { nor: bank(), wrong_after, rotten: None };
        let upload = Upload::begin(&mut flash, &[Slot::Empty; 2], image.len() as u32, name(&image));
        let written = upload.map_err(|(_, denial)| denial).and_then(|mut upload| {
            upload.chunk(&mut flash, 0, &image)?;
            upload.commit(&mut flash, &mut scratch, |_, _, _| Ok(()))
        });
        assert!(matches!(written, Err(Denial::Flash { .. })), "word {wrong_after}: {written:?}");
    }
    for rotten in (64..64 + image.len() as u32).step_by(13) {
        let mut flash = Worn { nor: bank(), wrong_after: u32::MAX, rotten: None };
        let mut upload = Upload::begin(&mut flash, &[Slot::Empty; 2], image.len() as u32, name(&image)).unwrap();
        upload.chunk(&mut flash, 0, &image).unwrap();
        flash.rotten = Some(rotten);
        let mut other = upload;
        assert!(matches!(other.commit_equal(&mut flash, &image, binding), Err(Denial::Flash { .. })), "{rotten}");
        assert!(upload.commit(&mut flash, &mut scratch, |_, _, _| Ok(())).is_err(), "{rotten}");
        flash.rotten = None;
        assert!(!matches!(truepath_fw::slots::survey(&mut flash, 0, &mut scratch), Slot::Image { .. }));
    }
}
