//! Batches of the bench link: the same bytes as over the links, in their order, in a time of their own.

use crate::wire_support;
use truepath_core::link::{Ask, Reply, Response, decode};
use truepath_core::rewrite::{Flags, Mode};
use truepath_fw::bench::{Channel, Records, Writer};
use truepath_fw::config_service::Restart;
use wire_support::part::{FEED, PASS, straight};
use wire_support::*;

fn batch(records: &[(Channel, Vec<u8>)]) -> Vec<u8> {
    let mut bytes = vec![0xEE; records.iter().map(|(_, content)| content.len() + 8).sum()];
    let mut writer = Writer::new(&mut bytes);
    records.iter().for_each(|(channel, content)| writer.put(*channel, content));
    let (used, overflow) = writer.finish();
    assert!(!overflow);
    bytes.truncate(used);
    bytes
}

fn time(us: u32) -> (Channel, Vec<u8>) {
    (Channel::Time, us.to_le_bytes().to_vec())
}

#[test]
fn records_come_back_as_they_were_written() {
    let records: Vec<(Channel, Vec<u8>)> = (0..9u8)
        .map(|n| ([Channel::Setpoint, Channel::Config, Channel::Time][usize::from(n % 3)], vec![n; usize::from(n)]))
        .collect();
    let bytes = batch(&records);
    assert_eq!(bytes.len() % 4, 0);
    // The layout of the document, by hand.
    assert_eq!(bytes[..4], [0, 0, 0, 0]);
    assert_eq!(bytes[4..12], [1, 0, 1, 0, 1, 0, 0, 0]);
    let read: Vec<_> = Records::new(&bytes).map(|record| (record.channel, record.bytes.to_vec())).collect();
    assert_eq!(read, records);
    for cut in 1..bytes.len() {
        let mut short = Records::new(&bytes[..cut]);
        while short.next().is_some() {}
        assert!(short.consumed() <= cut);
        assert_eq!(short.is_malformed(), short.consumed() < cut);
    }
}

#[test]
fn a_batch_gives_the_bytes_that_the_links_give() {
    let image = image_of(straight());
    let (mut by_links, mut by_batch) = (Rig::active(&image), Rig::active(&image));
    let mut records = vec![];
    let mut expected = vec![];
    for i in 0..400u32 {
        by_links.now_us += 1_000;
        by_links.setpoint.sequence += 1 + u32::from(i % 50 == 7);
        let [x, ..] = by_links.setpoint.axes;
        by_links.setpoint.axes = [x + FEED, 0, PASS, 0, 0, 0];
        let mut packet = by_links.frame();
        if i % 31 == 5 {
            packet[9] ^= 2;
        }
        let status = request(2_000 + i as u16, Ask::Status);
        let now_us = by_links.now_us;
        by_links.device().watch(now_us);
        by_links.device().setpoint_bytes(&packet, now_us, |bytes| expected.push((Channel::Setpoint, bytes.to_vec())));
        by_links.device().config_bytes(&status, now_us, |bytes| expected.push((Channel::Config, bytes.to_vec())));
        // Cut between two records.
        let (head, tail) = packet.split_at(i as usize % packet.len());
        records.extend([time(1_000), (Channel::Setpoint, head.to_vec()), (Channel::Setpoint, tail.to_vec())]);
        records.push((Channel::Config, status));
    }
    let (input, mut output, mut now_us) = (batch(&records), vec![0; 1 << 20], by_batch.now_us);
    let done = by_batch.device().batch(&input, &mut output, &mut now_us, None);
    assert_eq!((done.consumed, done.restart, done.overflow, done.malformed), (input.len(), None, false, false));
    let found: Vec<_> =
        Records::new(&output[..done.written]).map(|record| (record.channel, record.bytes.to_vec())).collect();
    assert!(found == expected);
    assert_eq!(now_us, by_links.now_us);
}

#[test]
fn the_time_of_a_batch_runs_out_as_any_other() {
    let mut rig = Rig::new();
    rig.enable();
    let input = batch(&[time(10_000), time(9_999), (Channel::Config, request(1, Ask::Status)), time(1)]);
    let (mut output, mut now_us) = ([0; 4_096], rig.now_us);
    let done = rig.device().batch(&input, &mut output, &mut now_us, None);
    let mut answer = Records::new(&output[..done.written]).next().unwrap().bytes.to_vec();
    assert_eq!(answer.pop(), Some(0));
    let answer: Response<'_> = decode(&mut answer).unwrap();
    assert!(matches!(answer.answer, Ok(Reply::Status(status)) if status.mode == Mode::Bypass));
    assert_eq!(rig.device().state().mode(), Mode::Off);
}

#[test]
fn a_restart_ends_the_batch() {
    let mut rig = Rig::new();
    rig.setpoint.flags = Flags::default();
    let restart = (Channel::Config, request(1, Ask::Restart { watchdog: true }));
    let input = batch(&[restart, (Channel::Config, request(2, Ask::Hello))]);
    let (mut output, mut now_us) = ([0; 4_096], 0);
    let done = rig.device().batch(&input, &mut output, &mut now_us, None);
    assert_eq!(done.restart, Some(Restart { watchdog: true }));
    assert!(done.consumed < input.len());
    assert_eq!(Records::new(&output[..done.written]).count(), 1);
}

#[test]
fn an_output_that_is_full_and_an_input_that_is_no_record_are_told() {
    let mut rig = Rig::new();
    let hello = (Channel::Config, request(1, Ask::Hello));
    let (input, mut now_us) = (batch(&[hello.clone(), hello]), 0);
    let done = rig.device().batch(&input, &mut [0; 60], &mut now_us, None);
    assert!(done.overflow && done.consumed == input.len());
    for wrong in [[3, 0, 0, 0], [0, 1, 0, 0], [0, 0, 9, 0]] {
        let done = rig.device().batch(&wrong, &mut [0; 60], &mut now_us, None);
        assert!(done.malformed && done.consumed == 0 && done.written == 0);
    }
}
