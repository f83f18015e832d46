//! The deframer: packets cut anywhere, garbage between them, overlong ones, and always in step again.

use proptest::prelude::*;
use truepath_wire::link::{Deframer, Framed, SetpointFrame, setpoint_bytes, unstuff};
use truepath_wire::rewrite::Setpoint;

/// Everything that comes out of a stream given in pieces; `None` stands for an overlong packet.
fn deframe<const N: usize>(pieces: &[Vec<u8>]) -> Vec<Option<Vec<u8>>> {
    let mut deframer = Deframer::<N>::new();
    let mut found = vec![];
    for piece in pieces {
        let mut rest = &piece[..];
        while let Some(framed) = deframer.feed(&mut rest) {
            found.push(match framed {
                Framed::Packet(packet) => Some(packet.to_vec()),
                Framed::Overlong => None,
            });
        }
        assert!(rest.is_empty());
    }
    found
}

/// The same by the plain meaning of the rule.
fn split(stream: &[u8], most: usize) -> Vec<Option<Vec<u8>>> {
    let mut packets: Vec<_> = stream.split(|&b| b == 0).collect();
    // What is behind the last 0x00 is not complete.
    packets.pop();
    let whole = packets.into_iter().filter(|p| !p.is_empty());
    whole.map(|p| (p.len() <= most).then(|| p.to_vec())).collect()
}

fn frame(sequence: u32) -> Vec<u8> {
    let mut packet = vec![0; setpoint_bytes(3) + 2];
    let setpoint = Setpoint { sequence, axes: [5, -5, 1 << 40, 0, 0, 0], ..Setpoint::default() };
    SetpointFrame { axes: 3, setpoint }.encode_packet(&mut packet).unwrap();
    packet
}

fn sequences(found: &[Option<Vec<u8>>]) -> Vec<u32> {
    let good = found.iter().flatten().filter_map(|packet| {
        let mut packet = packet.clone();
        unstuff(&mut packet).and_then(|raw| SetpointFrame::decode(raw, 3).ok())
    });
    good.map(|setpoint| setpoint.sequence).collect()
}

proptest! {
    #[test]
    fn any_stream_in_any_pieces_gives_the_same_packets(
        pieces in prop::collection::vec(prop::collection::vec(prop_oneof![3 => 1..=255u8, 1 => Just(0u8)], 0..40), 0..20),
    ) {
        prop_assert_eq!(deframe::<9>(&pieces), split(&pieces.concat(), 9));
        prop_assert_eq!(deframe::<16>(&pieces), split(&pieces.concat(), 16));
    }

    #[test]
    fn good_frames_come_through_whatever_garbage_lies_between_them(
        garbage in prop::collection::vec(prop::collection::vec(any::<u8>(), 0..200), 1..20),
        cut in 1..100usize,
    ) {
        let mut stream = vec![];
        for (i, noise) in garbage.iter().enumerate() {
            stream.extend(noise);
            // A sender that has reason to doubt begins with 0x00.
            stream.push(0);
            stream.extend(frame(i as u32));
        }
        let pieces: Vec<_> = stream.chunks(cut).map(<[u8]>::to_vec).collect();
        prop_assert_eq!(sequences(&deframe::<64>(&pieces)), (0..garbage.len() as u32).collect::<Vec<_>>());
    }

    #[test]
    fn a_frame_cut_off_anywhere_costs_itself_and_at_most_the_one_behind_it(at in 0..50usize, drop in 1..50usize) {
        let whole = [frame(1), frame(2), frame(3)].concat();
        let end = (at + drop).min(whole.len());
        let stream = [&whole[..at], &whole[end..], &frame(4), &frame(5)].concat();
        let found = sequences(&deframe::<64>(&[stream]));
        prop_assert!(found.ends_with(&[3, 4, 5]) || found.ends_with(&[4, 5]), "{:?}", found);
        prop_assert!(found.len() >= 3);
    }
}

#[test]
fn an_overlong_packet_is_dropped_told_once_and_the_next_one_is_whole() {
    let long = [vec![7; 10_000], vec![0], frame(8)].concat();
    let found = deframe::<64>(&[long]);
    assert_eq!(found.len(), 2);
    assert_eq!(found[0], None);
    assert_eq!(sequences(&found), [8]);
    let exact = [vec![7; 64], vec![0], vec![7; 65], vec![0]].concat();
    assert_eq!(deframe::<64>(&[exact]), [Some(vec![7; 64]), None]);
}

#[test]
fn empty_packets_are_passed_over() {
    assert_eq!(deframe::<8>(&[vec![0, 0, 0, 1, 0, 0, 2, 0]]), [Some(vec![1]), Some(vec![2])]);
}
