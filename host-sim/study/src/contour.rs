//! A contour drawn move by move: the path of the cutter's centre, with the kinds of its stretches.
//!
//! `inside` turns away from the wall (an inside corner or a concave wall), `outside` towards it. Radii are those of the
//! centre path: an inside wall of radius Rp has Rp − r, an outside one Rp + r. Coordinates are rounded as a post-processor
//! rounds them, to 0.1 µm.

use truepath_plant::{Point, Side};

use super::draw::rounded;

/// Kind of a stretch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A straight wall.
    Straight,
    /// An inside corner or concave arc.
    Inside,
    /// An outside corner or convex arc.
    Outside,
    /// A curve in short lines.
    Curve,
}

/// A stretch of the contour.
#[derive(Clone, Copy, Debug)]
pub struct Stretch {
    /// What it is.
    pub kind: Kind,
    /// Where it begins along the contour, mm.
    pub from_mm: f64,
    /// Where it ends, mm.
    pub to_mm: f64,
}

/// A move of the program.
#[derive(Clone, Copy, Debug)]
pub struct Move {
    /// End, mm.
    pub to: Point,
    /// Centre from the start, and whether counter-clockwise; `None` for a line.
    pub arc: Option<(Point, bool)>,
    /// Feed as a share of that of the cut.
    pub feed: f64,
}

/// A contour.
#[derive(Clone, Debug)]
pub struct Contour {
    /// Start, mm.
    pub start: Point,
    /// Side of travel on which the wall lies.
    pub side: Side,
    /// The moves.
    pub moves: Vec<Move>,
    /// The stretches in order.
    pub stretches: Vec<Stretch>,
    here: Point,
    heading: f64,
    length_mm: f64,
    feed: f64,
}

fn grid(p: Point) -> Point {
    p.map(|c| rounded(c, 1e-4))
}

impl Contour {
    /// Begins at `start` in the direction `heading_deg`.
    pub fn new(start: Point, heading_deg: f64, side: Side) -> Self {
        let start = grid(start);
        Self {
            start,
            side,
            moves: Vec::new(),
            stretches: Vec::new(),
            here: start,
            heading: heading_deg.to_radians(),
            length_mm: 0.0,
            feed: 1.0,
        }
    }

    /// Length, mm.
    pub fn length_mm(&self) -> f64 {
        self.length_mm
    }

    /// Whether it ends where it began.
    pub fn closed(&self) -> bool {
        let end = self.moves.last().map_or(self.start, |m| m.to);
        (end[0] - self.start[0]).hypot(end[1] - self.start[1]) < 0.01
    }

    /// The following moves have this share of the feed.
    pub fn feed(&mut self, share: f64) -> &mut Self {
        self.feed = share;
        self
    }

    /// Goes straight on, mm.
    pub fn straight(&mut self, length: f64) -> &mut Self {
        let to = self.ahead(length);
        self.push(to, None);
        self.advance(to, self.heading, length, Kind::Straight)
    }

    /// Turns away from the wall by `degrees` on a centre path of `radius`, mm.
    pub fn inside(&mut self, radius: f64, degrees: f64) -> &mut Self {
        self.turn(radius, degrees, -self.side.sign(), Kind::Inside, None)
    }

    /// Turns towards the wall by `degrees` on a centre path of `radius`, mm.
    pub fn outside(&mut self, radius: f64, degrees: f64) -> &mut Self {
        self.turn(radius, degrees, self.side.sign(), Kind::Outside, None)
    }

    /// As [`Self::inside`] and [`Self::outside`], in lines of about `step` mm.
    pub fn in_lines(&mut self, kind: Kind, radius: f64, degrees: f64, step: f64) -> &mut Self {
        let towards_wall = if kind == Kind::Outside { 1.0 } else { -1.0 };
        self.turn(radius, degrees, towards_wall * self.side.sign(), kind, Some(step))
    }

    /// A curve in lines of about `step` mm: `along` gives places beside the present heading (forwards, towards the left) for
    /// a share 0…1 of it; the first is the present place. `length` is about its length.
    pub fn curve(&mut self, step: f64, length: f64, along: impl Fn(f64) -> Point) -> &mut Self {
        let (origin, (sin, cos)) = (self.here, self.heading.sin_cos());
        let pieces = (length / step).ceil().max(1.0) as usize;
        let (mut heading, mut travelled) = (self.heading, 0.0);
        let mut last = origin;
        for k in 1..=pieces {
            let [u, v] = along(k as f64 / pieces as f64);
            let to = grid([origin[0] + u * cos - v * sin, origin[1] + u * sin + v * cos]);
            self.push(to, None);
            heading = (to[1] - last[1]).atan2(to[0] - last[0]);
            travelled += (to[0] - last[0]).hypot(to[1] - last[1]);
            last = to;
        }
        self.advance(last, heading, travelled, Kind::Curve)
    }

    fn turn(&mut self, radius: f64, degrees: f64, left: f64, kind: Kind, lines: Option<f64>) -> &mut Self {
        let sweep = degrees.to_radians();
        let normal = self.heading + left * std::f64::consts::FRAC_PI_2;
        let centre = [self.here[0] + radius * normal.cos(), self.here[1] + radius * normal.sin()];
        let at = |share: f64| {
            let angle = normal + std::f64::consts::PI + left * sweep * share;
            grid([centre[0] + radius * angle.cos(), centre[1] + radius * angle.sin()])
        };
        let end = at(1.0);
        match lines {
            None => {
                let from_start = grid([centre[0] - self.here[0], centre[1] - self.here[1]]);
                self.push(end, Some((from_start, left > 0.0)));
            }
            Some(step) => {
                let pieces = (radius * sweep / step).ceil().max(2.0);
                for k in 1..=pieces as usize {
                    self.push(at(k as f64 / pieces), None);
                }
            }
        }
        self.advance(end, self.heading + left * sweep, radius * sweep, kind)
    }

    fn ahead(&self, length: f64) -> Point {
        grid([self.here[0] + length * self.heading.cos(), self.here[1] + length * self.heading.sin()])
    }

    fn push(&mut self, to: Point, arc: Option<(Point, bool)>) {
        self.moves.push(Move { to, arc, feed: self.feed });
    }

    fn advance(&mut self, to: Point, heading: f64, length: f64, kind: Kind) -> &mut Self {
        self.stretches.push(Stretch { kind, from_mm: self.length_mm, to_mm: self.length_mm + length });
        (self.here, self.heading) = (to, heading);
        self.length_mm += length;
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn four_inside_quarter_turns_close_a_pocket_on_either_side_of_travel() {
        for side in [Side::Left, Side::Right] {
            let mut contour = Contour::new([812.3, -431.7], 37.0, side);
            contour.straight(20.0);
            for length in [30.0, 40.0, 30.0, 20.0] {
                contour.inside(4.0, 90.0).straight(length);
            }
            assert!(contour.closed());
            assert_eq!(contour.stretches.len(), 9);
            assert!((contour.length_mm() - (140.0 + 4.0 * 2.0 * std::f64::consts::PI)).abs() < 1e-9);
        }
    }
}
