//! A small machine for the tests of the rewriter: images of simple paths, and a controller that numbers setpoints.

use truepath_units::geometry::Point;
use truepath_units::{Offset, Position, Real};
use truepath_wire::image::{
    Binding, CorrectionLimits, FeedLaw, FineOffset, Image, ImageNode, ImageSettings, PathWindow, build, image_bytes,
};
use truepath_wire::rewrite::{ArmRequest, Flags, Frame, Mode, Output, Rewriter, Setpoint, Settings, State};

/// Marsaglia's xorshift, 64 bits.
pub struct Random(pub u64);

impl Random {
    pub fn next(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0
    }
    pub fn below(&mut self, n: u64) -> u64 {
        (self.next() >> 16) % n
    }
    pub fn around(&mut self, magnitude: i64) -> i64 {
        self.below(2 * magnitude as u64 + 1) as i64 - magnitude
    }
    pub fn once_in(&mut self, n: u64) -> bool {
        self.below(n) == 0
    }
}

pub const MM: i64 = 1_000_000;
/// Z of the pass.
pub const PASS: i64 = -10 * MM;
/// Above the pass, inside the gate.
pub const GATE: i64 = PASS + 3 * MM;
/// Above the gate.
pub const CLEAR: i64 = PASS + 30 * MM;
/// Way per tick at the nominal feed: 400 mm/min at 1 kHz.
pub const FEED: i64 = 6_667;
/// 1500 rpm.
pub const SPINDLE: u32 = 1_500_000;

pub fn settings() -> ImageSettings {
    ImageSettings {
        binding: Binding { program_crc: 0x1234_5678, feature: 1, pass: 2, tool: 3, tool_offset: 3, setup: 5 },
        closed: false,
        // 400 mm/min, 1500 rpm, six teeth: 44,444 nm.
        feed: FeedLaw::new(
            FineOffset::from_bits(11_377_778),
            6,
            SPINDLE,
            Real::ratio(1, 4),
            Real::ratio(1, 4),
            Real::ratio(3, 2),
        ),
        limits: CorrectionLimits {
            clamp: Offset::from_um(500),
            warn: Offset::from_um(200),
            slew_nm_per_s: 20_000_000,
            acceleration_nm_per_s2: 1_000_000_000,
        },
        window: PathWindow {
            tolerance: Offset::from_um(200),
            z_low: Position::from_nm(PASS),
            z_high: Position::from_nm(PASS),
            gate_height: Offset::from_um(5_000),
        },
        node_step: Offset::from_um(100),
    }
}

pub fn fine(nm: i64) -> FineOffset {
    FineOffset::checked_from_offset(Offset::from_nm(nm)).unwrap()
}

pub fn image_with(settings: &ImageSettings, nodes: &[ImageNode]) -> Image<'static> {
    let buffer = vec![0; image_bytes(nodes.len())].leak();
    build(settings, nodes, buffer).unwrap()
}

/// The correction of the test paths at the i-th node: smooth, both parts, both signs.
pub fn profile(i: usize) -> [i64; 4] {
    let bump = |shift: i64, height: i64| {
        let u = (i as i64 + shift) % 60 - 30;
        height * (900 - u * u) / 900
    };
    [-20_000 - bump(0, 40_000), 30_000 + bump(10, 60_000), 4_000, -bump(25, 25_000)]
}

/// Nodes along points that are about 0.1 mm apart.
pub fn nodes(points: impl IntoIterator<Item = (i64, i64)>) -> Vec<ImageNode> {
    let node = |(i, (x, y)): (usize, (i64, i64))| {
        let [a, b, c, d] = profile(i).map(fine);
        ImageNode { point: Point::from_nm(x, y), chip: [a, b], edge: [c, d] }
    };
    points.into_iter().enumerate().map(node).collect()
}

/// A straight of 10 mm along X, 101 nodes.
pub fn straight() -> Vec<(i64, i64)> {
    (0..=100).map(|i| (i * MM / 10, 0)).collect()
}

/// Points 0.1 mm apart on the figure eight x = R sin u, y = R/2 sin 2u; it starts and crosses itself at the origin.
pub fn eight(radius_mm: f64) -> Vec<(i64, i64)> {
    let place = |u: f64| (radius_mm * u.sin(), radius_mm / 2.0 * (2.0 * u).sin());
    let (mut u, mut points) = (0.3, vec![]);
    while u < 0.3 + std::f64::consts::TAU - 0.05 {
        let (x, y) = place(u);
        points.push(((x * 1e6).round() as i64, (y * 1e6).round() as i64));
        let speed = radius_mm * (u.cos().powi(2) + (2.0 * u).cos().powi(2)).sqrt();
        u += 0.1 / speed;
    }
    points
}

/// Setpoints along a chain of points at a steady way per tick.
pub fn along(points: &[(i64, i64)], way: i64) -> Vec<(i64, i64)> {
    let (mut out, mut rest) = (vec![points[0]], way as f64);
    for pair in points.windows(2) {
        let (dx, dy) = ((pair[1].0 - pair[0].0) as f64, (pair[1].1 - pair[0].1) as f64);
        let length = dx.hypot(dy);
        while rest <= length {
            let t = rest / length;
            out.push((pair[0].0 + (dx * t).round() as i64, pair[0].1 + (dy * t).round() as i64));
            rest += way as f64;
        }
        rest -= length;
    }
    out.push(*points.last().unwrap());
    out
}

/// A rewriter with its state and the controller before it.
pub struct Machine {
    pub rewriter: Rewriter<'static>,
    pub state: State,
    pub next: Setpoint,
    pub request: ArmRequest,
}

impl Machine {
    pub fn new(settings: Settings, image: Image<'static>) -> Self {
        let frame = Frame::identity();
        let request = ArmRequest { binding: image.settings().binding, part_serial: 1, frame };
        let next = Setpoint {
            spindle_millirpm: SPINDLE,
            frame_crc: frame.crc,
            flags: Flags::DRIVES_ENABLED,
            ..Setpoint::default()
        };
        Self { rewriter: Rewriter::new(settings, Some(image)).unwrap(), state: State::default(), next, request }
    }
    pub fn on(points: impl IntoIterator<Item = (i64, i64)>) -> Self {
        Self::new(Settings::at_1_khz(), image_with(&settings(), &nodes(points)))
    }
    /// Armed, over the start, above the gate.
    pub fn armed(mut self) -> Self {
        self.acknowledge();
        self.rewriter.arm(&mut self.state, &self.request).unwrap();
        let first = self.rewriter.image().unwrap().header().origin;
        self.send(first.x.nm(), first.y.nm(), CLEAR);
        assert_eq!(self.state.mode(), Mode::Armed);
        self
    }
    /// Active in the pass at the start, the correction settled.
    pub fn active(self) -> Self {
        let mut machine = self.armed();
        machine.plunge();
        assert_eq!(machine.state.mode(), Mode::Active);
        machine
    }
    pub fn acknowledge(&mut self) {
        self.rewriter.acknowledge_drives_disabled(&mut self.state).unwrap();
    }
    pub fn send(&mut self, x: i64, y: i64, z: i64) -> Output {
        self.next.sequence = self.next.sequence.wrapping_add(1);
        self.next.axes = [x, y, z, 7, 8, 9];
        self.rewriter.tick(&mut self.state, &self.next)
    }
    /// The last setpoint again, as a new one.
    pub fn stay(&mut self) -> Output {
        let [x, y, z, ..] = self.next.axes;
        self.send(x, y, z)
    }
    /// Down through the gate into the pass over the present X and Y in 100 ticks.
    pub fn plunge(&mut self) -> Output {
        let [x, y, ..] = self.next.axes;
        for i in 0..100 {
            self.send(x, y, GATE + (PASS - GATE) * i / 100);
        }
        self.send(x, y, PASS)
    }
    pub fn run(&mut self, setpoints: &[(i64, i64)]) -> Output {
        let mut last = self.stay();
        for &(x, y) in setpoints {
            last = self.send(x, y, PASS);
        }
        last
    }
    /// Straight on by a number of nominal steps along X.
    pub fn forward(&mut self, ticks: i64) -> Output {
        let mut last = None;
        for _ in 0..ticks {
            let [x, y, z, ..] = self.next.axes;
            last = Some(self.send(x + FEED, y, z));
        }
        last.unwrap()
    }
    /// Standing still until the correction is out; gives the ticks it took.
    pub fn settle(&mut self) -> u32 {
        let most = self.rewriter.limits().unwrap().ramp_ticks();
        for tick in 0..=most {
            if self.stay().mode == Mode::Bypass {
                return tick;
            }
        }
        panic!("the correction is not out after {most} ticks");
    }
}

pub fn is_plain(output: &Output, setpoint: &Setpoint) -> bool {
    output.forward && output.axes == setpoint.axes && output.correction_nm == [0; 6]
}
