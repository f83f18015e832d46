//! One tick of the rewriter while it corrects, in the middle of images of any number of segments.

use super::Work;
use super::rewrite_support::{FEED, Machine, PASS};
use std::hint::black_box;
use truepath_core::rewrite::Output;

/// Radius of the path, nm. A longer image goes round it more often; where it is, the rewriter knows by progress.
const RADIUS: f64 = 50e6;
/// Distance of the nodes, nm.
const NODE: f64 = 1e5;
/// Ticks that are repeated: four nodes at 6.7 µm a tick.
const WINDOW: u32 = 60;

/// A place on the path, nm of way from its start.
fn place(way: f64) -> (i64, i64) {
    let (sine, cosine) = (way / RADIUS).sin_cos();
    ((RADIUS * cosine).round() as i64, (RADIUS * sine).round() as i64)
}

/// A tick at nominal feed.
pub fn tick(segments: usize) -> Work {
    let mut machine = Machine::on((0..=segments).map(|i| place(i as f64 * NODE))).active();
    let length = segments as f64 * NODE;
    let before = ((length / FEED as f64) as u32 - WINDOW) / 2;
    let mut way = 0.0;
    let mut next = || {
        way += FEED as f64;
        place(way)
    };
    for _ in 0..before {
        let (x, y) = next();
        machine.send(x, y, PASS);
    }
    // The window is run again and again from the same state.
    let middle = machine.state;
    let setpoints: Vec<_> = (0..WINDOW)
        .map(|_| {
            let (x, y) = next();
            let out = machine.send(x, y, PASS);
            assert!(out.axes != machine.next.axes, "the rewriter does not correct: {out:?}");
            machine.next
        })
        .collect();
    let (rewriter, mut state, mut at) = (machine.rewriter, middle, 0);
    let mut output = Output::NONE;
    Box::new(move || {
        if at == setpoints.len() {
            (state, at) = (middle, 0);
        }
        rewriter.tick_into(&mut state, black_box(&setpoints[at]), &mut output);
        black_box(&output);
        at += 1;
    })
}
