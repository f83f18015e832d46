//! Everything at once: a link that loses, repeats, exchanges, damages and delays frames at random, falls silent and is
//! reset, and an operator who acknowledges, arms and disarms at random. What must hold for every answer, holds.

use crate::link_support;
use link_support::*;
use truepath_wire::link::Endpoint;
use truepath_wire::rewrite::{Flags, Mode, Output, Setpoint};

const FRAMES: u32 = 300_000;

/// The line between controller and device with what it holds back.
struct Chaos {
    wire: Wire,
    random: Random,
    held: Option<Vec<u8>>,
    /// What was sent lately, to find the frame of an answer.
    sent: Vec<Setpoint>,
    last: Option<Output>,
    /// Frames followed since the last answer.
    followed: u32,
    seen: [u64; 6],
    corrected: u64,
}

impl Chaos {
    /// The bytes of a setpoint, with whatever the line does to them.
    fn transmit(&mut self, packet: Vec<u8>) {
        let r = &mut self.random;
        let mut bytes = match r.below(60) {
            0 => vec![],
            1 => [packet.clone(), packet].concat(),
            2 => {
                let mut damaged = packet;
                let at = r.below(damaged.len() as u64) as usize;
                damaged[at] ^= 1 << r.below(8);
                damaged
            }
            3 => packet[..r.below(packet.len() as u64) as usize].to_vec(),
            4 => (0..r.below(150)).map(|_| r.next() as u8).chain([0]).chain(packet).collect(),
            5 if self.held.is_none() => {
                self.held = Some(packet);
                return;
            }
            _ => packet,
        };
        if r.once_in(2) {
            bytes.extend(self.held.take().unwrap_or_default());
        }
        self.wire.delay_us = if r.once_in(40) { 501 } else { r.below(500) };
        let accepted = self.wire.endpoint.counters().accepted;
        let came = self.wire.receive(&bytes);
        self.followed += self.wire.endpoint.counters().accepted - accepted;
        if let Some(out) = came.and_then(|came| came.answer) {
            self.judge(&out);
        }
    }

    fn judge(&mut self, out: &Output) {
        let limits = self.wire.rewriter.limits().unwrap();
        let sent =
            self.sent.iter().rev().find(|s| s.sequence == out.sequence).expect("an answer to a frame that was sent");
        assert_eq!(out.uncorrected(&out.axes), sent.axes, "a setpoint that nobody sent");
        assert_eq!(out.forward, out.mode != Mode::Off);
        if matches!(out.mode, Mode::Off | Mode::Bypass | Mode::Armed) {
            assert_eq!(out.correction_nm, [0; 6]);
        }
        let clamp = limits.clamp().offset().nm();
        assert!(out.correction_nm.iter().all(|c| i64::from(*c).abs() <= clamp));
        assert_eq!(out.correction_nm[2..], [0; 4]);
        // Unless the drives were dropped, the correction moves by no more than its speed in the ticks followed.
        if let Some(last) = self.last.filter(|last| last.forward && out.forward) {
            let most = ((i64::from(limits.velocity().bits()) * i64::from(self.followed)) >> 8) + 1;
            for (now, before) in out.correction_nm.iter().zip(last.correction_nm) {
                assert!((i64::from(*now) - i64::from(before)).abs() <= most, "{last:?} {out:?}");
            }
        }
        self.seen[out.mode as usize] += 1;
        self.corrected += u64::from(out.correction_nm != [0; 6]);
        self.last = Some(*out);
        self.followed = 0;
    }

    /// Now and then something from outside the line.
    fn outside(&mut self, serial: u32) {
        let wire = &mut self.wire;
        match self.random.below(3_000) {
            0 => {
                wire.now_us += 25_000;
                wire.endpoint.watch(&wire.rewriter, wire.now_us);
            }
            1 => {
                wire.endpoint = Endpoint::new(*wire.endpoint.settings(), *wire.endpoint.state().spent());
                self.last = None;
            }
            2 => {
                let _ = wire.endpoint.disarm(&wire.rewriter);
            }
            3 => wire.next.sequence = self.random.next() as u32,
            4 => wire.next.sequence = wire.next.sequence.wrapping_sub(self.random.below(64) as u32),
            5 => wire.next.flags = Flags(self.random.next() as u16),
            6 => wire.next.axes[0] += self.random.below(4_000_000) as i64 - 2_000_000,
            7 => wire.next.flags = wire.next.flags.with(Flags::FEED_HOLD),
            _ => {}
        }
        if !wire.endpoint.drive_enable() {
            self.last = None;
            wire.next.flags = Flags::default();
            let _ = wire.endpoint.acknowledge(&wire.rewriter, wire.now_us);
        }
        if wire.endpoint.mode() == Mode::Bypass && self.random.once_in(20) {
            wire.next.flags = Flags::DRIVES_ENABLED;
            wire.request.part_serial = serial;
            let _ = wire.endpoint.arm(&wire.rewriter, &wire.request);
            // Back over the start, in the gate.
            (wire.next.axes[0], wire.next.axes[1], wire.next.axes[2]) = (0, 0, GATE);
        }
        if wire.next.flags.has(Flags::FEED_HOLD) && self.random.once_in(30) {
            wire.next.flags = Flags::DRIVES_ENABLED;
        }
    }

    /// The next setpoint: down to the pass, along it, back to the start behind its end.
    fn step(&self) -> [i64; 3] {
        let [x, y, z, ..] = self.wire.next.axes;
        if self.wire.next.flags.has(Flags::FEED_HOLD) {
            [x, y, z]
        } else if z > PASS {
            [x, y, (z - 40_000).max(PASS)]
        } else {
            [x + FEED, y, z]
        }
    }
}

#[test]
fn whatever_the_line_does_only_setpoints_that_were_sent_go_out_and_only_within_the_limits() {
    let mut chaos = Chaos {
        wire: Wire::bypass(),
        random: Random(0x9e37_79b9_7f4a_7c15),
        held: None,
        sent: vec![],
        last: None,
        followed: 0,
        seen: [0; 6],
        corrected: 0,
    };
    for serial in 0..FRAMES {
        chaos.outside(serial);
        let packet = chaos.wire.packet(chaos.step());
        chaos.sent.push(chaos.wire.next);
        if chaos.sent.len() > 200 {
            chaos.sent.drain(..100);
        }
        chaos.transmit(packet);
        let wire = &mut chaos.wire;
        wire.endpoint.watch(&wire.rewriter, wire.now_us);
    }
    // It must have been everywhere, with corrections.
    assert!(chaos.seen.iter().all(|&ticks| ticks > 100), "{:?}", chaos.seen);
    assert!(chaos.corrected > u64::from(FRAMES) / 4, "{}", chaos.corrected);
    let c = *chaos.wire.endpoint.counters();
    for (name, count) in [("lost", c.lost), ("repeated", c.repeated), ("damaged", c.damaged), ("late", c.late)] {
        assert!(count > 0, "{name}: {c:?}");
    }

    // And then a good line and an abort: at rest in `Bypass`, in the time of the longest ramp.
    let wire = &mut chaos.wire;
    wire.delay_us = 0;
    wire.next.flags = Flags::DRIVES_ENABLED.with(Flags::ABORT);
    wire.receive(&[0]);
    for _ in 0..4 + wire.rewriter.limits().unwrap().ramp_ticks() {
        wire.stay();
    }
    assert!(matches!(wire.endpoint.mode(), Mode::Bypass | Mode::Off));
    assert_eq!(wire.stay().output().correction_nm, [0; 6]);
}
