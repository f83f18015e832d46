//! An independent reader of five-axis programs and independent kinematics, with which rewritten programs are judged.
//!
//! Nothing of it is shared with the product: words are found by splitting, coordinates are `f64`, a machine is two
//! rotation matrices, and an error is the largest of densely sampled distances.

#![allow(dead_code, reason = "every test file uses a part of it")]

/// X, Y, Z in mm, A, B, C in degrees.
pub type Place = [f64; 6];

/// A G1 of the program.
#[derive(Clone, Debug)]
pub struct Feed {
    /// Its line, counted from 1.
    pub line: usize,
    pub from: Place,
    pub to: Place,
    /// F, and whether it is one over minutes.
    pub feed: f64,
    pub inverse: bool,
}

/// Reads a plain program: G0 G1 G20 G21 G90 G91 G93 G94, axis words, F.
pub fn feeds(text: &str) -> Vec<Feed> {
    let (mut at, mut scale, mut absolute, mut cuts) = ([0.0; 6], 1.0, true, false);
    let (mut feed, mut inverse) = (0.0, false);
    let mut moves = Vec::new();
    for (k, line) in text.lines().enumerate() {
        let words = words(line);
        for (letter, value) in &words {
            match (*letter, (value * 10.0).round() as i32) {
                ('G', 0) => cuts = false,
                ('G', 10) => cuts = true,
                ('G', 200) => scale = 25.4,
                ('G', 210) => scale = 1.0,
                ('G', 900) => absolute = true,
                ('G', 910) => absolute = false,
                ('G', 930) => inverse = true,
                ('G', 940) => inverse = false,
                ('F', _) => feed = *value,
                _ => {}
            }
        }
        let mut to = at;
        let mut named = false;
        for (letter, value) in &words {
            let Some(axis) = "XYZABC".find(*letter) else { continue };
            let value = if axis < 3 { value * scale } else { *value };
            to[axis] = if absolute { value } else { at[axis] + value };
            named = true;
        }
        if named && cuts {
            moves.push(Feed { line: k + 1, from: at, to, feed, inverse });
        }
        at = to;
    }
    moves
}

fn words(line: &str) -> Vec<(char, f64)> {
    let (mut plain, mut inside) = (String::new(), false);
    for c in line.chars() {
        match c {
            '(' => inside = true,
            ')' => inside = false,
            ';' => break,
            _ if !inside && !c.is_whitespace() => plain.push(c.to_ascii_uppercase()),
            _ => {}
        }
    }
    let mut words = Vec::new();
    let mut rest = plain.as_str();
    while let Some(letter) = rest.chars().next() {
        let number: String = rest.chars().skip(1).take_while(|c| c.is_ascii_digit() || "+-.".contains(*c)).collect();
        rest = &rest[1 + number.len()..];
        if letter.is_ascii_alphabetic() && !number.is_empty() {
            words.push((letter, number.parse().expect("a number")));
        }
    }
    words
}

/// What a machine file says, once more.
#[derive(Clone, Copy, Debug)]
pub struct Machine {
    /// Letter (3 A, 4 B, 5 C), on the head, point, sense; the carrying axis first, the table before the head.
    pub axes: [(usize, bool, [f64; 3], f64); 2],
    /// Gauge point to tip.
    pub length: f64,
}

impl Machine {
    /// The file.
    pub fn toml(&self) -> String {
        let head = self.axes.map(|a| a.1);
        let kind = match head {
            [false, false] => "table-table",
            [true, true] => "head-head",
            _ => "table-head",
        };
        let mut text = format!("version = 1\nkind = \"{kind}\"\n");
        for (letter, head, point, sense) in self.axes {
            let axis = ["A", "B", "C"][letter - 3];
            let turns = if sense > 0.0 { "right-hand" } else { "left-hand" };
            let on = if head { "head" } else { "table" };
            text +=
                &format!("[[rotary]]\naxis = \"{axis}\"\non = \"{on}\"\npoint_mm = {point:?}\nturns = \"{turns}\"\n");
        }
        text + &format!("[tool]\nlength_mm = {:?}\n", self.length)
    }

    /// The tip in the part's frame.
    pub fn tip(&self, place: &Place) -> [f64; 3] {
        let turn = |p: [f64; 3], (letter, _, c, sense): (usize, bool, [f64; 3], f64), way: f64| {
            let angle = (way * sense * place[letter]).to_radians();
            let (s, k) = angle.sin_cos();
            let q = [p[0] - c[0], p[1] - c[1], p[2] - c[2]];
            let r = match letter {
                3 => [q[0], k * q[1] - s * q[2], s * q[1] + k * q[2]],
                4 => [k * q[0] + s * q[2], q[1], -s * q[0] + k * q[2]],
                _ => [k * q[0] - s * q[1], s * q[0] + k * q[1], q[2]],
            };
            [r[0] + c[0], r[1] + c[1], r[2] + c[2]]
        };
        // Head points are measured from the gauge point, which is a tool length above the tip.
        let mut hang = [0.0; 3];
        for (letter, _, point, sense) in self.axes.iter().rev().filter(|a| a.1).copied() {
            hang = turn(hang, (letter, true, [point[0], point[1], point[2] + self.length], sense), 1.0);
        }
        let mut p = [place[0] + hang[0], place[1] + hang[1], place[2] + hang[2]];
        for axis in self.axes.iter().filter(|a| !a.1).copied() {
            p = turn(p, axis, -1.0);
        }
        p
    }

    /// The tip at a parameter of a move whose words are joints, or the tip.
    fn during(&self, from: &Place, to: &Place, t: f64, tip: bool) -> [f64; 3] {
        let mix = |a: &Place, b: &Place| std::array::from_fn(|i| a[i] + (b[i] - a[i]) * t);
        if !tip {
            return self.tip(&mix(from, to));
        }
        self.tip(&mix(&self.joints(from), &self.joints(to)))
    }

    /// The joints of a place whose XYZ are the tip: kinematics are a turn and a shift of XYZ, undone by their transpose.
    fn joints(&self, place: &Place) -> Place {
        let with = |xyz: [f64; 3]| [xyz[0], xyz[1], xyz[2], place[3], place[4], place[5]];
        let origin = self.tip(&with([0.0; 3]));
        let columns = [0, 1, 2].map(|i| {
            let mut unit = [0.0; 3];
            unit[i] = 1.0;
            let p = self.tip(&with(unit));
            [p[0] - origin[0], p[1] - origin[1], p[2] - origin[2]]
        });
        let off = [place[0] - origin[0], place[1] - origin[1], place[2] - origin[2]];
        with(columns.map(|c| c[0] * off[0] + c[1] * off[1] + c[2] * off[2]))
    }

    /// The point that a move starts or ends at.
    pub fn end(&self, place: &Place, tip: bool) -> [f64; 3] {
        if tip { [place[0], place[1], place[2]] } else { self.tip(place) }
    }

    /// The largest sampled distance of a move from the chord between two points.
    pub fn error(&self, piece: &Feed, chord: ([f64; 3], [f64; 3]), tip: bool) -> f64 {
        (0..=200)
            .map(|k| from_segment(self.during(&piece.from, &piece.to, f64::from(k) / 200.0, tip), chord))
            .fold(0.0, f64::max)
    }
}

fn from_segment(p: [f64; 3], (a, b): ([f64; 3], [f64; 3])) -> f64 {
    let d = [b[0] - a[0], b[1] - a[1], b[2] - a[2]];
    let q = [p[0] - a[0], p[1] - a[1], p[2] - a[2]];
    let square = d.iter().map(|v| v * v).sum::<f64>();
    let along = d.iter().zip(q).map(|(d, q)| d * q).sum::<f64>();
    let t = if square > 0.0 { (along / square).clamp(0.0, 1.0) } else { 0.0 };
    (0..3).map(|i| (q[i] - t * d[i]).powi(2)).sum::<f64>().sqrt()
}

/// The pieces of the rewritten program for each move of the original.
pub fn matched<'m>(original: &[Feed], rewritten: &'m [Feed]) -> Vec<&'m [Feed]> {
    let near = |a: &Place, b: &Place| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-9);
    let mut rest = rewritten;
    let pieces = original.iter().map(|wanted| {
        assert!(near(&rest[0].from, &wanted.from), "line {}: starts elsewhere", wanted.line);
        let end = rest.iter().position(|piece| near(&piece.to, &wanted.to)).expect("its end is reached");
        let (pieces, others) = rest.split_at(end + 1);
        rest = others;
        pieces
    });
    let pieces = pieces.collect();
    assert!(rest.is_empty(), "moves that the original does not have");
    pieces
}

/// A trunnion with axes off the origin.
pub const TRUNNION: Machine =
    Machine { axes: [(3, false, [0.0, 3.0, -25.0], 1.0), (5, false, [1.0, 2.0, 0.0], -1.0)], length: 0.0 };
/// B on C, both on the table.
pub const TABLES_BC: Machine =
    Machine { axes: [(4, false, [5.0, 0.0, -40.0], -1.0), (5, false, [0.0, 0.0, 0.0], 1.0)], length: 0.0 };
/// C on the table, B on the head.
pub const TABLE_HEAD: Machine =
    Machine { axes: [(5, false, [0.0, 0.0, 0.0], 1.0), (4, true, [0.0, 0.0, 40.0], 1.0)], length: 110.0 };
/// B on A, both in the head.
pub const HEADS: Machine =
    Machine { axes: [(3, true, [0.0, 0.0, 60.0], 1.0), (4, true, [2.0, 0.0, 30.0], 1.0)], length: 95.0 };
