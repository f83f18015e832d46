//! The calls that move.

use std::io::Write;

use truepath_core::gcode::{Axes, Canon, FeedMode, Modal, Plane};
use truepath_core::geometry::Point;
use truepath_core::units::Position;

use super::argument::Argument;
use super::call::{Calls, real};

/// An arc in any plane: its ends and centre in the order of the plane's axes.
struct Arc {
    plane: Plane,
    to: Axes,
    centre: Point,
    counter_clockwise: bool,
    turns: u32,
}

impl<W: Write> Calls<'_, W> {
    /// Prints a step that moves an axis.
    pub(super) fn motion(&mut self, canon: &Canon, modal: &Modal) {
        match *canon {
            Canon::Traverse { to, .. } => {
                self.go(to);
                self.straight(b"STRAIGHT_TRAVERSE(", modal);
            }
            Canon::Feed { to, .. } => {
                self.inverse_time(modal, distance, to);
                self.go(to);
                self.straight(b"STRAIGHT_FEED(", modal);
            }
            Canon::Arc { to, centre, counter_clockwise, turns, .. } => {
                self.arc(&Arc { plane: Plane::Xy, to, centre, counter_clockwise, turns }, modal);
            }
            Canon::PlaneArc { plane, to, centre, counter_clockwise, turns, .. } => {
                self.arc(&Arc { plane, to, centre, counter_clockwise, turns }, modal);
            }
            Canon::Spline { to, points, .. } => {
                self.go(to);
                self.lines.call("NURBS_FEED", &format!("{points}, ..."));
            }
            Canon::Probe { to, .. } => {
                self.lines.call("TURN_PROBE_ON", "");
                self.go(to);
                self.straight(b"STRAIGHT_PROBE(", modal);
                self.lines.call("TURN_PROBE_OFF", "");
            }
            Canon::Tap { from, to } => {
                self.go(to);
                self.lines.open("RIGID_TAP");
                let unit = modal.units.nanometres();
                self.lines.push_values(&self.at.map(|v| (v, unit)), ", ");
                self.lines.close();
                self.go(from);
            }
            // Without knowledge of the machine: its coordinates less the offsets are those of the program.
            Canon::MachineMove { to, rapid } => {
                self.go(modal.shifts.to_program(to));
                if rapid {
                    self.straight(b"STRAIGHT_TRAVERSE(", modal);
                } else {
                    self.straight(b"STRAIGHT_FEED(", modal);
                }
            }
            Canon::Reference { axes, via, .. } => {
                self.go(via);
                self.straight(b"STRAIGHT_TRAVERSE(", modal);
                let zero = modal.shifts.to_program(Axes::ORIGIN);
                for (axis, _) in axes.into_iter().enumerate().filter(|(_, moves)| *moves) {
                    let mut one = Axes::UNKNOWN;
                    one.set(axis, zero.get(axis));
                    self.go(one);
                }
                self.straight(b"STRAIGHT_TRAVERSE(", modal);
            }
            _ => {}
        }
    }

    #[inline]
    fn straight<const N: usize>(&mut self, name: &[u8; N], modal: &Modal) {
        let [a, b, c, ..] = modal.auxiliary;
        let unit = modal.units.nanometres();
        self.lines.call_move(name, self.places.at(self.at, unit), unit, [a, b, c]);
    }

    fn arc(&mut self, arc: &Arc, modal: &Modal) {
        let [first, second, third] = arc.plane.axes();
        let turns = i64::from(arc.turns) + 1;
        let length = |from: [i64; 3], to: [i64; 3]| {
            let (i, j) = (arc.centre.x.nm(), arc.centre.y.nm());
            let angle = |p: [i64; 3]| ((p[second] - j) as f64).atan2((p[first] - i) as f64);
            let radius = ((from[first] - i) as f64).hypot((from[second] - j) as f64);
            let sweep = if arc.counter_clockwise { angle(to) - angle(from) } else { angle(from) - angle(to) };
            let turn = std::f64::consts::TAU;
            // Less than a millionth of a turn is a full one.
            let sweep = if sweep.rem_euclid(turn) < turn * 1e-6 { turn } else { sweep.rem_euclid(turn) };
            (radius * (sweep + turn * (turns - 1) as f64)).hypot((to[third] - from[third]) as f64)
        };
        self.inverse_time(modal, length, arc.to);
        self.go(arc.to);
        let unit = modal.units.nanometres();
        let [a, b, c, ..] = modal.auxiliary;
        let places = self.places.at(self.at, unit);
        let (x, y, z) = (places[first], places[second], places[third]);
        let (i, j) = (Argument::length(arc.centre.x.nm(), unit), Argument::length(arc.centre.y.nm(), unit));
        let turns = Argument::turns(!arc.counter_clockwise, turns);
        self.lines.call_move(b"ARC_FEED(", &[x, y, i, j, turns, z], unit, [a, b, c]);
    }

    /// In G93 the feed of a move is its length by the time F gives.
    fn inverse_time(&mut self, modal: &Modal, length: impl Fn([i64; 3], [i64; 3]) -> f64, to: Axes) {
        if modal.feed_mode != FeedMode::InverseTime {
            return;
        }
        let mut there = self.at;
        for (there, to) in there.iter_mut().zip([to.x, to.y, to.z]) {
            *there = to.map_or(*there, Position::nm);
        }
        let length = length(self.at, there) / modal.units.nanometres() as f64;
        self.feed_rate(length * modal.feed.map_or(0.0, real));
    }
}

fn distance(from: [i64; 3], to: [i64; 3]) -> f64 {
    let squares = from.iter().zip(to).map(|(a, b)| ((b - a) as f64).powi(2));
    squares.sum::<f64>().sqrt()
}
