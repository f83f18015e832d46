//! What a controller does, so that every situation of the setpoint path occurs.

use truepath_core::rewrite::{Flags, Mode};

use crate::machine::Machine;
use crate::measure::{Series, Situation};

/// Way of a tick at the nominal feed, nm.
const FEED: i64 = 6_667;
/// Way of a tick that passes eight segments of 0.1 mm, nm.
const FASTEST: i64 = 799_000;
/// Distance of the nodes, nm.
const SPACING: i64 = 100_000;
/// Above the pass, outside the gate.
const CLEAR: i64 = 30_000_000;
/// Above the pass, inside the gate.
const GATE: i64 = 1_000_000;
/// Parts of a run: the same with other phases of setpoints and nodes.
const PARTS: i64 = 32;

/// Runs the script; every tick is measured.
pub fn run(machine: &mut Machine, nodes: usize, all: &mut [Series; Situation::ALL.len()]) {
    let end = (nodes as i64 - 1) * SPACING;
    let mut send = |machine: &mut Machine, situation: Situation, along: i64, beside: i64, above: i64| {
        machine.send(along, beside, above, all.get_mut(situation as usize));
    };
    for part in 0..PARTS {
        for _ in 0..20 {
            send(machine, Situation::Bypass, 0, 0, CLEAR);
        }
        machine.arm();
        for _ in 0..20 {
            send(machine, Situation::Armed, 0, 0, GATE);
        }
        while machine.mode() == Mode::Armed {
            send(machine, Situation::Entry, 0, 0, 0);
        }
        send(machine, Situation::Entry, 0, 0, 0);

        // Beside the path by up to 0.15 mm, gently. Every other part goes on like that over many nodes; the others soon
        // go on in steps that pass eight segments, each from another place between two nodes.
        let slow = part % 2 == 0;
        let until = if slow { 3_000_000.min(end - SPACING) } else { part * SPACING / PARTS };
        let beside = (part % 4 - 1) * 50_000;
        let mut along = 0;
        let mut reached = 0;
        while along <= until {
            reached += (beside - reached).clamp(-2_000, 2_000);
            send(machine, Situation::Feed, along, reached, 0);
            along += FEED + part;
        }
        if !slow {
            for _ in 0..20 {
                if along + FASTEST < end {
                    along += FASTEST;
                    send(machine, Situation::Fastest, along, reached, 0);
                }
            }
        }
        assert!(machine.mode() == Mode::Active, "the correction ended before its time");
        machine.flags(Flags::FEED_HOLD);
        for _ in 0..60 {
            send(machine, Situation::Hold, along, reached, 0);
        }
        machine.flags(Flags::default());
        assert!(machine.mode() == Mode::Hold, "feed hold does not hold");

        // The tool goes aside by more than the tolerance: a fault, and the correction ramps out.
        send(machine, Situation::FaultRamp, along, reached + 900_000, 0);
        while machine.mode() != Mode::Bypass {
            send(machine, Situation::FaultRamp, along, reached + 900_000, 0);
        }
    }
}
