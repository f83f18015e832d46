//! The client of the configuration link on bad wires: nothing is carried out twice, uploads go on where they stopped.

use std::collections::VecDeque;
use std::io;
use std::time::{Duration, Instant};

use crate::hil_support::{image, probability, serve};
use truepath::command::hil::{Kind, Options, Source, open, run};
use truepath_bench::records::{Channel, Records};
use truepath_bench::{Arrival, BenchError, Bulk, Chance, Client, InProcess, Probability, Wire, records};
use truepath_core::checksum::crc32;
use truepath_core::image::Image;
use truepath_core::link::{Ask, Denial, DeviceSettings, Item, Reply, ResetCause, SetpointFrame, Slot};
use truepath_core::rewrite::{ArmRequest, Frame, Setpoint};

/// A wire to a device in process that loses and damages what goes either way.
struct BadWire {
    device: InProcess,
    chance: Chance,
    loss: Probability,
    damage: Probability,
    /// Packets after which the device is reset.
    reset_after: Option<u32>,
    arrived: VecDeque<u8>,
}

impl BadWire {
    fn new(seed: u64, loss: f64, damage: f64) -> Self {
        Self {
            device: InProcess::start().unwrap(),
            chance: Chance::new(seed, 0),
            loss: probability(loss),
            damage: probability(damage),
            reset_after: None,
            arrived: VecDeque::new(),
        }
    }
    fn spoil(&mut self, mut bytes: Vec<u8>) -> Vec<u8> {
        if self.chance.happens(self.loss) {
            bytes.clear();
        } else if self.chance.happens(self.damage) && !bytes.is_empty() {
            let at = self.chance.below(bytes.len() as u64) as usize;
            bytes[at] ^= 1 << self.chance.below(8);
        }
        bytes
    }
    fn client(self) -> Client<Self> {
        Client::new(self, 7).with_patience(Duration::from_millis(1), 60)
    }
}

impl Wire for BadWire {
    fn send(&mut self, bytes: &[u8]) -> io::Result<()> {
        if let Some(left) = &mut self.reset_after {
            *left = left.saturating_sub(1);
            if *left == 0 {
                self.reset_after = None;
                self.device.reset(ResetCause::BrownOut);
            }
        }
        let sent = self.spoil(bytes.to_vec());
        let mut batch = vec![];
        records::write(Channel::Config, &sent, &mut batch);
        let back = self.device.run(&batch).unwrap();
        for record in Records::new(&back) {
            let got = self.spoil(record.bytes.to_vec());
            self.arrived.extend(got);
        }
        Ok(())
    }
    fn receive(&mut self, _within: Duration) -> io::Result<Option<Arrival>> {
        // In small pieces, as a UART gives them.
        let bytes: Vec<u8> = (0..17).map_while(|_| self.arrived.pop_front()).collect();
        Ok((!bytes.is_empty()).then(|| Arrival { at: Instant::now(), bytes }))
    }
}

#[test]
fn an_image_arrives_whole_over_a_wire_that_loses_and_damages_a_third() {
    let bytes = image(2);
    for seed in 0..4 {
        let mut client = BadWire::new(seed, 0.15, 0.15).client();
        let mut reached = 0;
        let committed = client
            .upload(Item::Image, &bytes, |at| {
                assert!(at >= reached, "back from {reached} to {at}");
                reached = at;
            })
            .unwrap();
        assert_eq!(committed.crc, Image::new_checked(&bytes).unwrap().crc());
        assert!(client.retries() > 20);
        let slots = client.slots().unwrap();
        assert!(matches!(slots[usize::from(committed.slot)], Slot::Image { crc, .. } if crc == committed.crc));
    }
}

#[test]
fn an_upload_interrupted_by_a_reset_goes_on_where_it_stopped() {
    let bytes = image(0);
    for after in [2, 3, 9, 20, 33] {
        let mut wire = BadWire::new(1, 0.0, 0.0);
        wire.reset_after = Some(after);
        let mut client = wire.client();
        let first = client.upload(Item::Image, &bytes, |_| ());
        // The device has forgotten the upload, but not what was written.
        let lost = matches!(first, Err(BenchError::Denied(Denial::NoUpload)));
        assert!(lost, "{after}: {first:?}");
        let mut from = None;
        let committed = client.upload(Item::Image, &bytes, |at| _ = from.get_or_insert(at)).unwrap();
        assert_eq!(committed.crc, Image::new_checked(&bytes).unwrap().crc());
        // Whole flash words of the chunks before are still there: Begin and the lost chunk came before the reset.
        let kept = u64::from(after.saturating_sub(2)) * 1024;
        assert!(from.unwrap() >= kept.saturating_sub(32) && from.unwrap() <= kept + 32, "{after}: {from:?} of {kept}");
    }
}

#[test]
fn an_arming_whose_answer_was_lost_is_not_carried_out_twice() {
    let bytes = image(0);
    let binding = Image::new_checked(&bytes).unwrap().settings().binding;
    let mut refused = 0;
    for seed in 0..20 {
        let mut client = BadWire::new(seed, 0.0, 0.0).client();
        let committed = client.upload(Item::Image, &bytes, |_| ()).unwrap();
        client.done(Ask::Activate { slot: committed.slot, crc: committed.crc }).unwrap();
        client.done(Ask::Configure(DeviceSettings::at_1_khz())).unwrap();
        // Setpoints with the drives disabled at 1 kHz, so that these can be acknowledged and their rate is known.
        let mut batch = vec![];
        for sequence in 0..40 {
            let setpoint = Setpoint { sequence, ..Setpoint::default() };
            let mut packet = [0; 80];
            let used = SetpointFrame { axes: 3, setpoint }.encode_packet(&mut packet).unwrap();
            records::write(Channel::Time, &1_000u32.to_le_bytes(), &mut batch);
            records::write(Channel::Setpoint, &packet[..used], &mut batch);
        }
        client.wire().device.run(&batch).unwrap();
        client.done(Ask::AcknowledgeDrivesDisabled).unwrap();
        client.wire().loss = probability(0.5);
        let request = ArmRequest { binding, part_serial: 5, frame: Frame::identity() };
        // Carried out twice it would be refused: the pass of the part is spent.
        client.done(Ask::Arm(request)).unwrap();
        client.wire().loss = Probability::NEVER;
        assert!(client.done(Ask::Disarm).is_ok());
        refused += u32::from(matches!(client.ask(Ask::Arm(request)), Err(BenchError::Denied(Denial::Refused(_)))));
    }
    assert_eq!(refused, 20);
}

#[test]
fn a_dead_wire_is_told_as_silence_with_the_name_of_the_request() {
    let mut client = BadWire::new(1, 1.0, 0.0).client();
    let Err(BenchError::Silent(text)) = client.ask(Ask::Hello).map(|_| ()) else { panic!("an answer") };
    assert!(text.contains("Hello") && text.contains("60"), "{text}");
}

#[test]
fn an_item_of_another_length_or_content_begins_anew() {
    let mut client = BadWire::new(1, 0.0, 0.0).client();
    let [one, other] = [vec![b'('; 5_000], vec![b')'; 5_000]];
    client.ask(Ask::Begin { item: Item::Program, length: 5_000, crc: crc32(&one) }).unwrap();
    client.ask(Ask::Chunk { offset: 0, bytes: &one[..1000] }).unwrap();
    let resumed = client.ask(Ask::Begin { item: Item::Program, length: 5_000, crc: crc32(&one) }).unwrap();
    assert_eq!(resumed, Reply::Next { offset: 1000 });
    let committed = client.upload(Item::Program, &other, |_| ()).unwrap();
    assert_eq!(committed.crc, crc32(&other));
}

#[test]
fn a_device_behind_sockets_is_driven_frame_by_frame() {
    let folder = tempfile::tempdir().unwrap();
    serve(folder.path());
    let name = |file: &str| folder.path().join(file).display().to_string();
    let kind = Kind::Ports { names: [name("setpoint.sock"), name("config.sock")], bauds: [0; 2] };
    let faults = truepath_bench::Faults {
        drop: probability(0.02),
        corrupt: probability(0.05),
        reorder: probability(0.02),
        repeat: probability(0.02),
        ..Default::default()
    };
    for window in [1, 16] {
        let mut board = open(&kind, window, false).unwrap();
        let options =
            Options { source: Source::Random, count: 3_000, axes: 4, rate_hz: 2_000, faults, seed: window.into() };
        let report = run(&mut *board, &image(0), &options, &mut |_| ()).unwrap();
        assert!(report.identical, "{:?}", report.difference);
        assert_eq!(report.round_trip.unwrap().count as u64, report.answers);
    }
}
