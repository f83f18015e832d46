//! Machines of every kind, random moves, and the kinematics a second time: 4×4 matrices multiplied joint by joint.
#![allow(dead_code)]

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{RngCore, SeedableRng};
use truepath_multiaxis::Joints;
use truepath_multiaxis::chord::SLACK_MM;
use truepath_multiaxis::machine::{Counted, Letter, Machine, Rotary, Sense, Side, Tool};
use truepath_multiaxis::vector::Vector;

pub const LETTERS: [Letter; 3] = [Letter::A, Letter::B, Letter::C];
pub const SIDES: [[Side; 2]; 3] = [[Side::Table, Side::Table], [Side::Table, Side::Head], [Side::Head, Side::Head]];

/// Every kind with every ordered pair of letters: 18 machines.
pub fn types() -> Vec<([Side; 2], [Letter; 2])> {
    let pairs = LETTERS.iter().flat_map(|&a| LETTERS.iter().filter(move |&&b| a != b).map(move |&b| [a, b]));
    pairs.flat_map(|pair| SIDES.map(|sides| (sides, pair))).collect()
}

/// What the certified error of a piece that is proved to keep a tolerance is at most, mm: the slack of the certificate is
/// not that of the proof.
pub fn with_slack(tolerance: f64) -> f64 {
    tolerance + SLACK_MM.max(1e-5 * tolerance) + 1e-9
}

/// A draw of reproducible numbers.
pub struct Draw(ChaCha8Rng);

impl Draw {
    pub fn new(seed: u64) -> Self {
        Self(ChaCha8Rng::seed_from_u64(seed))
    }
    /// Uniform in 0…1.
    pub fn unit(&mut self) -> f64 {
        (self.0.next_u64() >> 11) as f64 / (1u64 << 53) as f64
    }
    pub fn within(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }
    /// Evenly over the decades between two positive numbers.
    pub fn decades(&mut self, low: f64, high: f64) -> f64 {
        self.within(low.ln(), high.ln()).exp()
    }
    pub fn vector(&mut self, size: f64) -> Vector {
        [0; 3].map(|_| self.within(-size, size))
    }
    pub fn chance(&mut self, probability: f64) -> bool {
        self.unit() < probability
    }
    /// A machine of a type with offsets up to 150 mm, either sense, tool lengths 20…300 mm; one in four counts the
    /// centre of a ball.
    pub fn machine(&mut self, (sides, letters): ([Side; 2], [Letter; 2])) -> Machine {
        let mut axis = |side, letter| Rotary {
            letter,
            side,
            point_mm: self.vector(150.0),
            sense: if self.chance(0.5) { Sense::RightHand } else { Sense::LeftHand },
            limits_deg: None,
        };
        let rotary = [axis(sides[0], letters[0]), axis(sides[1], letters[1])];
        let ball = self.chance(0.25);
        let tool = Tool {
            length_mm: self.within(20.0, 300.0),
            ball_radius_mm: ball.then(|| self.within(0.5, 10.0)),
            helix_deg: 30.0,
            counted: if ball { Counted::BallCentre } else { Counted::Tip },
        };
        Machine::new(rotary, tool).expect("two letters and lengths in range")
    }
    /// A move as programs hold them: chords up to 20 mm, turns up to 10° a move; one in ten does not move the tip, one
    /// in twenty does not turn one axis, one in a hundred turns as far as 360°.
    pub fn ends(&mut self, machine: &Machine) -> [Joints; 2] {
        let tip = self.vector(200.0);
        let length = if self.chance(0.1) { 0.0 } else { self.decades(0.01, 20.0) };
        let way = self.vector(1.0).map(|part| part * length);
        let there = [tip[0] + way[0], tip[1] + way[1], tip[2] + way[2]];
        let words = [0; 2].map(|_| self.within(-180.0, 180.0));
        let furthest = if self.chance(0.01) { 360.0 } else { self.decades(0.05, 10.0) };
        let turn = [0; 2].map(|_| if self.chance(0.05) { 0.0 } else { self.within(-furthest, furthest) });
        let turned = [words[0] + turn[0], words[1] + turn[1]];
        let joints = |tip, words: [f64; 2]| machine.inverse_counted(tip, words.map(f64::to_radians));
        [joints(tip, words), joints(there, turned)]
    }
}

type Matrix = [[f64; 4]; 4];

fn times(a: &Matrix, b: &Matrix) -> Matrix {
    std::array::from_fn(|i| std::array::from_fn(|j| (0..4).map(|k| a[i][k] * b[k][j]).sum()))
}

fn translation(v: Vector) -> Matrix {
    [[1.0, 0.0, 0.0, v[0]], [0.0, 1.0, 0.0, v[1]], [0.0, 0.0, 1.0, v[2]], [0.0, 0.0, 0.0, 1.0]]
}

fn rotation(letter: Letter, angle: f64) -> Matrix {
    let (s, c) = angle.sin_cos();
    let mut m = translation([0.0; 3]);
    let (i, j) = match letter {
        Letter::A => (1, 2),
        Letter::B => (2, 0),
        Letter::C => (0, 1),
    };
    (m[i][i], m[i][j], m[j][i], m[j][j]) = (c, -s, s, c);
    m
}

/// The turn of an axis: to its point, round, and back.
fn joint(axis: &Rotary, point: Vector, angle: f64) -> Matrix {
    let turned = times(&translation(point), &rotation(axis.letter, angle));
    times(&turned, &translation(point.map(|x| -x)))
}

/// From the tool's frame (origin at the tip, z up its axis) to the part's, as T eq (2) has it: every joint a matrix. The
/// table's turn is undone by the turn through the opposite angle.
pub fn tool_to_part(machine: &Machine, joints: &Joints) -> Matrix {
    let mut table = translation([0.0; 3]);
    let mut head = translation([0.0; 3]);
    for (i, axis) in machine.rotary().iter().enumerate() {
        let angle = axis.sense.sign() * joints.rotary[i];
        match axis.side {
            Side::Table => table = times(&joint(axis, axis.point_mm, -angle), &table),
            Side::Head => {
                let mut pivot = axis.point_mm;
                pivot[2] += machine.tool().length_mm;
                head = times(&head, &joint(axis, pivot, angle));
            }
        }
    }
    times(&times(&table, &translation(joints.xyz)), &head)
}

/// The point `height` above the tip, by matrices.
pub fn place_by_matrices(machine: &Machine, joints: &Joints, height: f64) -> Vector {
    let m = tool_to_part(machine, joints);
    std::array::from_fn(|i| m[i][2] * height + m[i][3])
}

/// Distance of a point from a segment, by brute thought: the foot held between the ends.
pub fn from_segment(p: Vector, a: Vector, b: Vector) -> f64 {
    let (mut along, mut square) = (0.0, 0.0);
    for i in 0..3 {
        along += (p[i] - a[i]) * (b[i] - a[i]);
        square += (b[i] - a[i]) * (b[i] - a[i]);
    }
    let s = if square > 0.0 { (along / square).clamp(0.0, 1.0) } else { 0.0 };
    (0..3).map(|i| (p[i] - a[i] - s * (b[i] - a[i])).powi(2)).sum::<f64>().sqrt()
}
