//! Where the finished walls of a cut cross a line along X or Y.

use std::fmt;

use truepath_core::geometry::{Point, Shape};
use truepath_core::job::REACH;
use truepath_core::probe::{Contact, Contacts, Reading, Rejected, Setting};
use truepath_core::units::{Offset, Position};
use truepath_ground::diagnostics::Failure;
use truepath_ground::units::{float, mm, nm};

use crate::levels;
use crate::pass::{Pass, PathBuffer};

/// An axis that is measured along.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axis {
    /// X.
    X,
    /// Y.
    Y,
}

impl Axis {
    /// By name.
    pub const NAMES: [(&'static str, Self); 4] = [("x", Self::X), ("y", Self::Y), ("X", Self::X), ("Y", Self::Y)];

    /// The one across.
    #[must_use]
    pub const fn other(self) -> Self {
        match self {
            Self::X => Self::Y,
            Self::Y => Self::X,
        }
    }

    /// Its component of a pair.
    pub const fn of<T: Copy>(self, [x, y]: [T; 2]) -> T {
        match self {
            Self::X => x,
            Self::Y => y,
        }
    }

    /// The point at a coordinate along it and one across, mm.
    pub fn point(self, along: f64, across: f64) -> Point {
        let [x, y] = match self {
            Self::X => [along, across],
            Self::Y => [across, along],
        };
        Point { x: Position::ZERO + nm(x), y: Position::ZERO + nm(y) }
    }
}

impl fmt::Display for Axis {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.of(["X", "Y"]))
    }
}

/// A wall on a line of measurement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing {
    /// Coordinate along the line, mm.
    pub at_mm: f64,
    /// Towards the wall along the line: 1 or −1 where it is square to the line.
    pub towards: f64,
    /// Whether the wall is round there.
    pub is_round: bool,
    /// The nominal place.
    pub nominal: Contact,
}

/// The finished walls of a cut.
#[derive(Clone, Debug)]
pub struct Walls<'a> {
    on_wall: Contacts<'a>,
    pass: &'a Pass,
    /// Places of the wall in the order of travel, mm; `None` where no wall stands.
    places: Vec<Option<[f64; 2]>>,
}

/// Crossings nearer to each other than this are one, mm.
const ONE: f64 = 0.002;

impl<'a> Walls<'a> {
    /// Of a pass, at its own depth and at those that are cut alike.
    ///
    /// # Errors
    /// When the path cannot be sampled.
    pub fn of(pass: &'a Pass) -> Result<Self, Failure> {
        let mut buffer = PathBuffer::default();
        let path = pass.sample(&mut buffer)?;
        let contour = &path.samples()[path.first()..path.first() + path.count()];
        let coordinate = |p: Position| (p - Position::ZERO).nm() as f64 / 1e6;
        let place = |wall: Point| [coordinate(wall.x), coordinate(wall.y)];
        let places = contour.iter().map(|sample| sample.on_wall.then(|| place(path.wall(sample)))).collect();
        let core = levels::with_alike(pass, &levels::depths(pass)?);
        let setting = Setting {
            ball_radius: Offset::ZERO,
            cutter_radius: core.setup.radius,
            wall: core.setup.wall,
            tip_z: core.contour.z,
            alike: core.job.part.map(|part| part.alike).unwrap_or_default(),
            axial_depth: core.job.cut.axial_depth,
            z_is_tip: false,
            reach: REACH,
        };
        Ok(Self { on_wall: Contacts::new(pass.path_contour(), setting), pass, places })
    }

    /// The pass whose walls they are.
    pub const fn pass(&self) -> &'a Pass {
        self.pass
    }

    /// Z of the tip and of the top of the cut.
    pub fn heights(&self) -> [Position; 2] {
        let tip = self.on_wall.tip_z();
        [tip, tip + self.pass.job.numbers.cut.axial_depth]
    }

    /// The finished wall in the order of travel, mm.
    pub fn outline(&self) -> impl Iterator<Item = [f64; 2]> + '_ {
        self.places.iter().flatten().copied()
    }

    /// Least and largest coordinate of the walls along an axis, mm; `None` where there are none.
    pub fn extent(&self, axis: Axis) -> Option<[f64; 2]> {
        let all = || self.places.iter().flatten().map(|place| axis.of(*place));
        let least = all().min_by(f64::total_cmp)?;
        Some([least, all().max_by(f64::total_cmp)?])
    }

    /// The walls on the line along an axis at a coordinate across it, in the order along it; those that stand at a height.
    ///
    /// # Errors
    /// When the height is above or below the cut.
    pub fn crossings(&self, along: Axis, across_mm: f64, z: Position) -> Result<Vec<Crossing>, Rejected> {
        let mut found: Vec<Crossing> = Vec::new();
        for pair in self.places.windows(2) {
            let [Some(a), Some(b)] = [pair[0], pair[1]] else { continue };
            let [from, to] = [a, b].map(|place| along.other().of(place) - across_mm);
            // A place on the line belongs to the stretch that begins there.
            if (from > 0.0) == (to > 0.0) {
                continue;
            }
            let share = from / (from - to);
            let [near, far] = [a, b].map(|place| along.of(place));
            found.extend(self.settled(along, near + share * (far - near), across_mm, z)?);
        }
        found.sort_by(|a, b| a.at_mm.total_cmp(&b.at_mm));
        found.dedup_by(|b, a| (b.at_mm - a.at_mm).abs() < ONE);
        Ok(found)
    }

    /// The nominal wall on a line near a place that was taken from samples of it.
    fn settled(&self, along: Axis, near: f64, across: f64, z: Position) -> Result<Option<Crossing>, Rejected> {
        let mut at_mm = near;
        for _ in 0..4 {
            let contact = match self.contact(along.point(at_mm, across), z, 0) {
                Ok(contact) => contact,
                Err(height @ Rejected::OffHeight { .. }) => return Err(height),
                Err(_) => return Ok(None),
            };
            let towards = along.of([float(contact.normal.x), float(contact.normal.y)]);
            if towards.abs() < 0.1 {
                return Ok(None);
            }
            if contact.error.abs() <= Offset::from_nm(2) {
                let is_round = self.is_round(&contact);
                return Ok(Some(Crossing { at_mm, towards, is_round, nominal: contact }));
            }
            at_mm += mm(contact.error) / towards;
        }
        Ok(None)
    }

    /// What a touch of a surface point would be.
    ///
    /// # Errors
    /// As [`Contacts::contact`].
    pub fn contact(&self, place: Point, z: Position, line: u32) -> Result<Contact, Rejected> {
        self.on_wall.contact(&reading(place, z, line))
    }

    fn is_round(&self, contact: &Contact) -> bool {
        let blocks = &self.pass.blocks;
        let origin = blocks.first().map_or(Offset::ZERO, |block| block.s);
        let block = blocks.iter().rev().find(|block| block.s - origin <= contact.s).or(blocks.first());
        block.is_some_and(|block| matches!(block.curve.shape(), Shape::Arc { .. }))
    }
}

/// A reading of a surface point.
pub(super) fn reading(place: Point, z: Position, line: u32) -> Reading {
    Reading { position: [place.x, place.y, z], line, ..Reading::default() }
}
