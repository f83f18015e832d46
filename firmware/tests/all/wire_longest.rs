//! How much a single request makes the device do: the work of every one of them is bounded by the size of a slot, and the
//! setpoint path stands in front of all of it.

use std::cell::Cell;
use std::rc::Rc;

use crate::wire_support;
use embedded_storage::nor_flash::{ErrorType, NorFlash, ReadNorFlash};
use truepath_core::image::{DeviceClass, Role};
use truepath_core::link::{
    Ask, CHUNK_BYTES, DeviceSettings, Item, PACKET_BYTES, Reply, Request, ResetCause, Response, Slot, decode, encode,
    encode_request,
};
use truepath_fw::computation::ProgressMeter;
use truepath_fw::config_service::{Board, IMAGE_BYTES, Memory};
use truepath_fw::device::Device;
use truepath_fw::flash::{BANK_BYTES, BANK_WORDS, Nor, SECTOR_BYTES, WordState};
use truepath_fw::slots::SLOT_IMAGE_BYTES;
use wire_support::*;

/// Bytes read, words programmed, sectors erased.
type Work = Rc<Cell<[usize; 3]>>;

/// Bytes of the log and some words more.
const LOG: usize = 13 << 10;

/// A flash that counts.
struct Counted(Nor<'static>, Work);

impl Counted {
    fn count(&self, what: usize, by: usize) {
        let mut work = self.1.get();
        work[what] += by;
        self.1.set(work);
    }
}

impl ErrorType for Counted {
    type Error = <Nor<'static> as ErrorType>::Error;
}

impl ReadNorFlash for Counted {
    const READ_SIZE: usize = Nor::READ_SIZE;
    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), Self::Error> {
        self.count(0, bytes.len());
        self.0.read(offset, bytes)
    }
    fn capacity(&self) -> usize {
        self.0.capacity()
    }
}

impl NorFlash for Counted {
    const WRITE_SIZE: usize = Nor::WRITE_SIZE;
    const ERASE_SIZE: usize = Nor::ERASE_SIZE;
    fn erase(&mut self, from: u32, to: u32) -> Result<(), Self::Error> {
        self.count(2, (to - from) as usize / SECTOR_BYTES);
        self.0.erase(from, to)
    }
    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), Self::Error> {
        self.count(1, bytes.len() / Nor::WRITE_SIZE);
        self.0.write(offset, bytes)
    }
}

/// A device that tells what each request cost.
struct Meter {
    device: Device<'static, Counted>,
    work: Work,
    id: u16,
    session: Option<u64>,
    challenge: Option<([u8; 12], [u8; 32])>,
    /// Of each kind of request the most of each work.
    most: Vec<(String, [usize; 3])>,
}

impl Meter {
    fn new(present: bool) -> Self {
        fn lent<T: Clone>(blank: T, count: usize) -> &'static mut [T] {
            vec![blank; count].leak()
        }
        let bank = Nor::erased(lent(0xFF, BANK_BYTES), lent(WordState::Blank, BANK_WORDS));
        let memory = Memory {
            image: lent(0, IMAGE_BYTES),
            recording: lent(0, 48_000),
            program: lent(0, 65_536),
            job: lent(0, 512),
            probe: lent(0, 65_536),
            meter: Box::leak(Box::new(ProgressMeter::new())),
        };
        let work = Work::default();
        let board = Board {
            name: "test",
            last_reset: ResetCause::PowerOn,
            class: DeviceClass::Bench,
            present,
            id: [3; 12],
            secret: None,
            counter_hz: 1_000_000,
        };
        let device = Device::start(Counted(bank, Rc::clone(&work)), memory, board, 0);
        Self { device, work, id: 0, session: None, challenge: None, most: vec![] }
    }

    fn ask(&mut self, ask: Ask<'_>) {
        self.id += 1;
        let mut packet = [0; PACKET_BYTES];
        let used = encode_request(&Request { id: self.id, ask }, self.session, &mut packet).unwrap();
        self.work.set([0; 3]);
        let mut answer = vec![];
        self.device.config_bytes(&packet[..used], 0, |bytes| answer.extend_from_slice(bytes));
        answer.pop();
        let response: Response<'_> = decode(&mut answer).unwrap();
        match response.answer.unwrap() {
            Reply::Challenge { device, nonce, .. } => self.challenge = Some((device, nonce)),
            Reply::LoggedIn { session } => self.session = Some(session),
            _ => {}
        }
        let kind = format!("{ask:?}").split([' ', '(']).next().unwrap().to_owned();
        let work = self.work.get();
        match self.most.iter_mut().find(|(of, _)| *of == kind) {
            Some((_, most)) => (0..3).for_each(|k| most[k] = most[k].max(work[k])),
            None => self.most.push((kind, work)),
        }
    }

    fn upload(&mut self, item: Item, bytes: &[u8], crc: u32) {
        self.ask(Ask::Begin { item, length: bytes.len() as u32, crc });
        for (k, bytes) in bytes.chunks(CHUNK_BYTES).enumerate() {
            self.ask(Ask::Chunk { offset: (k * CHUNK_BYTES) as u32, bytes });
        }
        self.ask(Ask::Commit);
    }
}

/// An image of as many nodes as a slot holds, up and down in rows of half a metre.
fn largest(first: i64) -> Vec<u8> {
    let place = |k: i64| {
        let (row, along) = (k / 5_000, k % 5_000);
        (first + if row % 2 == 0 { along } else { 4_999 - along } * 100_000, row * 100_000)
    };
    image_of((0..truepath_core::image::DEVICE_NODES as i64).map(place).collect())
}

#[test]
fn no_request_makes_the_device_do_more_than_a_slot_is_large() {
    let mut meter = Meter::new(false);
    meter.ask(Ask::Configure(DeviceSettings::at_1_khz()));
    let images = [largest(0), largest(7)];
    for (slot, image) in images.iter().enumerate() {
        meter.upload(Item::Image, image, name(image));
        meter.ask(Ask::Activate { slot: slot as u8, crc: name(image) });
    }
    // Once more into a slot that is full, with the other in use.
    let third = largest(9);
    meter.upload(Item::Image, &third, name(&third));
    meter.ask(Ask::Configure(DeviceSettings::at_1_khz()));
    for (item, bytes) in
        [(Item::Program, vec![b'('; 65_536]), (Item::Job, vec![1; 512]), (Item::Probe, vec![2; 65_536])]
    {
        meter.upload(item, &bytes, truepath_core::checksum::crc32(&bytes));
    }
    // An upload that broke off and goes on: how far it came has to be looked for.
    let again = largest(11);
    meter.ask(Ask::Begin { item: Item::Image, length: again.len() as u32, crc: name(&again) });
    for (k, bytes) in again.chunks(CHUNK_BYTES).take(300).enumerate() {
        meter.ask(Ask::Chunk { offset: (k * CHUNK_BYTES) as u32, bytes });
    }
    meter.ask(Ask::Begin { item: Item::Image, length: again.len() as u32, crc: name(&again) });

    for ask in
        [Ask::Hello, Ask::Status, Ask::List, Ask::Settings, Ask::Trace, Ask::Deactivate, Ask::Compute, Ask::Progress]
    {
        meter.ask(ask);
    }
    meter.ask(Ask::Log { from: 0 });
    for (kind, [read, programmed, erased]) in &meter.most {
        let most = match kind.as_str() {
            // The new image read back and checked, the one in use read again; how far an upload has come.
            "Commit" | "Begin" => 2 * SLOT_IMAGE_BYTES + 1_024,
            // With the search for room in the log.
            "Activate" => SLOT_IMAGE_BYTES + LOG,
            "Configure" | "Deactivate" | "Log" => LOG,
            _ => 1_024,
        };
        assert!(*read <= most, "{kind}: {read} bytes read, {most} permitted");
        // A chunk, or a record of the ledger with its entry in the log; a slot.
        assert!(*programmed <= 35 && *erased <= 3, "{kind}: {programmed} words, {erased} sectors");
    }
    let cost = |wanted: &str| meter.most.iter().find(|(kind, _)| kind == wanted).map(|(_, work)| *work);
    // The image is made behind the answer, in the thread of the lowest priority.
    assert_eq!(cost("Compute"), Some([0; 3]));
    assert!(cost("Commit") > Some([SLOT_IMAGE_BYTES, 0, 0]), "the largest image was measured");
    assert_eq!(meter.most.len(), 14);
}

/// An image of a feature, four nodes long, signed with a counter.
fn counted_image(feature: u32, counter: u32) -> Vec<u8> {
    let settings = part::settings();
    let binding = truepath_core::image::Binding { feature, ..settings.binding };
    let settings = truepath_core::image::ImageSettings { binding, ..settings };
    let plain = image_with(&settings, straight(0)[..4].to_vec());
    counted(&plain, &owner(1), truepath_core::image::DeviceClasses::ALL, counter)
}

#[test]
fn counters_of_as_many_passes_as_there_are_cost_a_request_a_bounded_reading() {
    let mut meter = Meter::new(true);
    meter.ask(Ask::Configure(DeviceSettings::at_1_khz()));
    for seed in 1..=4 {
        meter.ask(Ask::Provision(public(&owner(seed))));
    }
    meter.ask(Ask::Challenge);
    let (device, nonce) = meter.challenge.unwrap();
    meter.ask(login(&owner(1), Role::Engineer, &device, &nonce));
    // So often that the page of counters is used up, and the sector is changed with all of them in it.
    for k in 0..300 {
        let image = counted_image(k % 64, 1_000 + k);
        meter.upload(Item::Image, &image, name(&image));
        let held = slot_of(&mut meter, name(&image));
        meter.ask(Ask::Activate { slot: held, crc: name(&image) });
    }
    // And by records alone.
    for k in 0..130 {
        meter.ask(Ask::Configure(DeviceSettings { silence_us: 20_000 + k, ..DeviceSettings::at_1_khz() }));
    }
    let cost = |wanted: &str| meter.most.iter().find(|(kind, _)| kind == wanted).map(|(_, work)| *work).unwrap();
    for (kind, read, programmed) in
        [("Activate", 800 << 10, 240), ("Configure", 400 << 10, 240), ("Commit", 32 << 10, 1)]
    {
        let [bytes, words, sectors] = cost(kind);
        assert!(
            bytes <= read && words <= programmed && sectors <= 1,
            "{kind}: {bytes} bytes, {words} words, {sectors}"
        );
        println!("{kind}: {bytes} bytes read, {words} words, {sectors} sectors");
    }
    assert_eq!((cost("Activate")[2], cost("Configure")[2]), (1, 1), "the sector was changed by both");
}

/// Where an image lies.
fn slot_of(meter: &mut Meter, crc: u32) -> u8 {
    let mut packet = [0; PACKET_BYTES];
    let used = encode(&Request { id: 0, ask: Ask::List }, &mut packet).unwrap();
    let mut answer = vec![];
    meter.device.config_bytes(&packet[..used], 0, |bytes| answer.extend_from_slice(bytes));
    answer.pop();
    let response: Response<'_> = decode(&mut answer).unwrap();
    let Ok(Reply::Slots(slots)) = response.answer else { panic!() };
    slots.iter().position(|slot| matches!(slot, Slot::Image { crc: found, .. } if *found == crc)).unwrap() as u8
}
