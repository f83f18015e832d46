//! From the ball's centre to the error of the wall it touched.
//!
//! Ball radius R, centre S, n̂ the outward normal of the wall into the pocket: contact = S − R·n̂, both coordinates.
//! The normal is that of the nominal contour at the foot of S; a point belongs to the place of the contour it lies
//! at, not to its number in the file.

use super::read::Reading;
use crate::geometry::{Contour, Direction, Nearest, Point, Side};
use crate::units::{Offset, Position, Real};

/// How the readings were taken and what they touched.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Setting {
    /// Radius of the probe's ball; zero when the file holds the surface itself.
    pub ball_radius: Offset,
    /// Cutter radius: the wall lies this far from the path.
    pub cutter_radius: Offset,
    /// Side of travel of the wall.
    pub wall: Side,
    /// Z of the cutter's tip during the cut.
    pub tip_z: Position,
    /// Engaged depth.
    pub axial_depth: Offset,
    /// Whether Z of a reading is the lowest point of the ball instead of its centre.
    pub z_is_tip: bool,
    /// A reading farther than this from the nominal wall belongs to something else.
    pub reach: Offset,
}

/// A touched place of the wall.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Contact {
    /// The reading it comes from: line of the file, counted from 1.
    pub line: u32,
    /// Contact point.
    pub point: Point,
    /// Arc length of the contour.
    pub s: Offset,
    /// Normal towards the wall.
    pub normal: Direction,
    /// Height above the cutter's tip as a fraction of the engaged depth.
    pub height: Real,
    /// Wall error: positive, material left.
    pub error: Offset,
}

impl Contact {
    /// What a lent buffer is filled with before contacts are written into it.
    pub const BLANK: Self = Self {
        line: 0,
        point: Point::from_nm(0, 0),
        s: Offset::ZERO,
        normal: Direction::X,
        height: Real::ZERO,
        error: Offset::ZERO,
    };
}

/// Why a reading is set aside.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rejected {
    /// Farther from the nominal wall than [`Setting::reach`].
    OffTheWall {
        /// Distance from the nominal wall; positive on the free side.
        distance: Offset,
    },
    /// Above or below the engaged depth.
    OffHeight {
        /// Height above the tip.
        height: Offset,
    },
}

/// What explains that most readings are off the wall.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Suspicion {
    /// They fit when read as inches.
    Inches,
    /// They fit when inches are read as millimetres.
    Millimetres,
    /// They fit when taken as surface points, or the ball's diameter was given as its radius or the other way.
    BallRadius,
    /// They fit a wall on the other side of travel.
    OtherSide,
    /// Nothing simple: probably another frame (machine instead of work coordinates).
    Frame,
}

/// Turns readings into contacts.
#[derive(Clone, Copy, Debug)]
pub struct Contacts<'a> {
    contour: Contour<'a>,
    setting: Setting,
}

impl<'a> Contacts<'a> {
    /// For a contour and a setting.
    pub const fn new(contour: Contour<'a>, setting: Setting) -> Self {
        Self { contour, setting }
    }

    /// The contact of a reading.
    ///
    /// # Errors
    /// [`Rejected`] when the reading is off the wall or off the engaged depth.
    pub fn contact(&self, reading: &Reading) -> Result<Contact, Rejected> {
        let [x, y, z] = reading.position;
        let setting = &self.setting;
        let centre = Point { x, y };
        let (nearest, error) = self.foot(centre);
        let Some(nearest) = nearest.filter(|_| error.abs() <= setting.reach) else {
            return Err(Rejected::OffTheWall { distance: error });
        };
        let lift = if setting.z_is_tip { setting.ball_radius } else { Offset::ZERO };
        let above_tip = z - setting.tip_z + lift;
        if above_tip < Offset::ZERO || above_tip > setting.axial_depth {
            return Err(Rejected::OffHeight { height: above_tip });
        }
        let place = self.contour.at(nearest.s, nearest.block).ok_or(Rejected::OffTheWall { distance: error })?;
        let normal = setting.wall.normal(place.heading);
        Ok(Contact {
            line: reading.line,
            point: centre + normal.times(setting.ball_radius),
            s: nearest.s,
            normal,
            height: above_tip.over(setting.axial_depth),
            error,
        })
    }

    /// The place of the contour a ball centre belongs to, and the wall error it shows there.
    fn foot(&self, centre: Point) -> (Option<Nearest>, Offset) {
        let expected = self.setting.cutter_radius - self.setting.ball_radius;
        let mut best: Option<(Nearest, Offset)> = None;
        self.contour.feet(centre, |foot| {
            let towards_wall = match self.setting.wall {
                Side::Left => foot.left,
                Side::Right => -foot.left,
            };
            let error = expected - towards_wall;
            if best.is_none_or(|(b, e)| (!foot.beside, error.abs()) < (!b.beside, e.abs())) {
                best = Some((foot, error));
            }
        });
        // Beyond an end or a corner there is no normal to measure along.
        let distance = best.map_or(Offset::MAX, |(_, e)| e);
        (best.map(|(b, _)| b).filter(|b| b.beside), distance)
    }

    /// How many of the readings lie on the wall after a change of their coordinates.
    fn fitting(&self, readings: &[Reading], change: impl Fn(Position) -> Position) -> usize {
        readings
            .iter()
            .filter(|r| {
                let [x, y, _] = r.position;
                let (foot, error) = self.foot(Point { x: change(x), y: change(y) });
                foot.is_some() && error.abs() <= self.setting.reach
            })
            .count()
    }
}

/// Names what is wrong when more than half of the readings are off the wall; `None` when they are on it.
pub fn suspect(contacts: &Contacts, readings: &[Reading]) -> Option<Suspicion> {
    let enough = |n: usize| n.saturating_mul(2) > readings.len();
    if enough(contacts.fitting(readings, |p| p)) {
        return None;
    }
    let times = |numerator: i64, denominator: i64| {
        move |p: Position| Position::from_nm((p - Position::ZERO).scaled(Real::ratio(numerator, denominator)).nm())
    };
    if enough(contacts.fitting(readings, times(254, 10))) {
        return Some(Suspicion::Inches);
    }
    if enough(contacts.fitting(readings, times(10, 254))) {
        return Some(Suspicion::Millimetres);
    }
    let other = Contacts::new(contacts.contour, Setting { wall: contacts.setting.wall.other(), ..contacts.setting });
    if enough(other.fitting(readings, |p| p)) {
        return Some(Suspicion::OtherSide);
    }
    let ball = contacts.setting.ball_radius;
    for radius in [Offset::ZERO, ball + ball, Offset::from_nm(ball.nm() / 2)] {
        let other = Contacts::new(contacts.contour, Setting { ball_radius: radius, ..contacts.setting });
        if radius != ball && enough(other.fitting(readings, |p| p)) {
            return Some(Suspicion::BallRadius);
        }
    }
    Some(Suspicion::Frame)
}
