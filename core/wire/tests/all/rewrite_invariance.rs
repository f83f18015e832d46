//! Shifting by whole nanometres, turning by 90° and mirroring the image together with the setpoints shifts, turns and
//! mirrors the output to the last bit.

use crate::rewrite_support;
use rewrite_support::*;
use truepath_units::geometry::Point;
use truepath_wire::image::ImageNode;
use truepath_wire::rewrite::{Frame, Mode, Output, Settings};

/// A rigid motion: x' = a·x + b·y + shift, with whole a, b, c, d.
#[derive(Clone, Copy, Debug)]
struct Motion {
    matrix: [i64; 4],
    shift: (i64, i64),
}

impl Motion {
    fn turned<T: Copy + std::ops::Mul<Output = T> + std::ops::Add<Output = T> + From<i32>>(self, x: T, y: T) -> (T, T) {
        let [a, b, c, d] = self.matrix.map(|v| T::from(v as i32));
        (a * x + b * y, c * x + d * y)
    }
    fn place(self, (x, y): (i64, i64)) -> (i64, i64) {
        let (x, y) = self.turned(x, y);
        (x + self.shift.0, y + self.shift.1)
    }
    fn node(self, node: &ImageNode) -> ImageNode {
        let (x, y) = self.place((node.point.x.nm(), node.point.y.nm()));
        let part = |p: [truepath_wire::image::FineOffset; 2]| {
            let (x, y) = self.turned(p[0].bits(), p[1].bits());
            [x, y].map(truepath_wire::image::FineOffset::from_bits)
        };
        ImageNode { point: Point::from_nm(x, y), chip: part(node.chip), edge: part(node.edge) }
    }
}

const MOTIONS: [Motion; 6] = [
    Motion { matrix: [1, 0, 0, 1], shift: (-30_000_001, 2_999_999_999) },
    Motion { matrix: [0, -1, 1, 0], shift: (0, 0) },
    Motion { matrix: [-1, 0, 0, -1], shift: (17, -4) },
    Motion { matrix: [0, 1, -1, 0], shift: (0, 1) },
    Motion { matrix: [-1, 0, 0, 1], shift: (5_000_000_003, 0) },
    Motion { matrix: [0, 1, 1, 0], shift: (0, 0) },
];

/// Setpoints beside the path by up to 90 µm, with stops, a lost frame, a slower spindle and at last a jump off it.
fn setpoints() -> Vec<(i64, i64)> {
    let mut run: Vec<_> = along(&eight(8.0), FEED)
        .into_iter()
        .enumerate()
        .map(|(i, (x, y))| {
            let wave = |k: usize| (i * k % 3_001) as i64 * 40 - 60_000;
            (x + wave(1), y - wave(2))
        })
        .collect();
    run.truncate(run.len() - 300);
    let last = *run.last().unwrap();
    run.extend([last; 40]);
    run.extend([(last.0 + 600_000, last.1 - 100_000); 200]);
    run
}

fn outputs(motion: Motion, frame: Option<Frame>) -> Vec<Output> {
    // With a frame the image stays and the frame moves the setpoints; without, the image moves.
    let nodes: Vec<_> = nodes(eight(8.0));
    let moved: Vec<_> = nodes.iter().map(|n| motion.node(n)).collect();
    let image = image_with(&settings(), if frame.is_some() { &nodes } else { &moved });
    let mut m = Machine::new(Settings::at_1_khz(), image);
    if let Some(frame) = frame {
        m.request.frame = frame;
        m.next.frame_crc = frame.crc;
    }
    m.acknowledge();
    m.rewriter.arm(&mut m.state, &m.request).unwrap();
    let (x, y) = motion.place(eight(8.0)[0]);
    let mut out = vec![];
    for i in 0..200 {
        out.push(m.send(x, y, if i < 150 { GATE } else { PASS }));
    }
    assert_eq!(m.state.mode(), Mode::Hold);
    for (i, p) in setpoints().into_iter().enumerate() {
        let (x, y) = motion.place(p);
        m.next.spindle_millirpm = if i > 3_000 { SPINDLE - 111_111 } else { SPINDLE };
        m.next.sequence += u32::from(i == 2_000);
        out.push(m.send(x, y, PASS));
    }
    assert_eq!(m.state.mode(), Mode::Bypass);
    out
}

fn compare(motion: Motion, frame: Option<Frame>) {
    let still = Motion { matrix: [1, 0, 0, 1], shift: (0, 0) };
    let (plain, moved) = (outputs(still, None), outputs(motion, frame));
    let mut corrected = 0;
    for (tick, (a, b)) in plain.iter().zip(&moved).enumerate() {
        let (x, y) = motion.turned(a.correction_nm[0], a.correction_nm[1]);
        assert_eq!(b.correction_nm[..2], [x, y], "{motion:?}, tick {tick}");
        assert_eq!((a.mode, a.reason, a.status, a.place), (b.mode, b.reason, b.status, b.place));
        assert_eq!((b.axes[0], b.axes[1]), motion.place((a.axes[0], a.axes[1])));
        corrected += u32::from(a.correction_nm != [0; 6]);
    }
    assert!(corrected > 5_000);
}

#[test]
fn moving_image_and_setpoints_together_moves_the_output_to_the_last_bit() {
    for motion in MOTIONS {
        compare(motion, None);
    }
}

#[test]
fn a_frame_moves_the_output_as_moving_the_image_does() {
    for motion in MOTIONS {
        let [a, b, c, d] = motion.matrix.map(|v| v as i32);
        let mut frame = Frame::identity();
        // A reflection is a turn with the Y axis reversed.
        let mirrored = a * d - b * c < 0;
        frame.cosine = a << 30;
        frame.sine = (if mirrored { -c } else { c }) << 30;
        frame.axes[1].reversed = mirrored;
        frame.offset_nm = [motion.shift.0, motion.shift.1, 0];
        compare(motion, Some(frame.sealed()));
    }
}
