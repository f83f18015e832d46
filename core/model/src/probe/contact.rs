//! From the ball's centre to the error of the wall it touched.
//!
//! Ball radius R, centre S, n̂ the outward normal of the wall into the pocket: contact = S − R·n̂, both coordinates. For a
//! surface point R is zero: it is the contact itself.
//! The normal is that of the nominal contour at the foot of S; a point belongs to the place of the contour it lies
//! at, not to its number in the file. A normal in the file is only compared with it.

use super::reading::{Outcome, Reading};
use truepath_units::geometry::{Contour, Direction, Nearest, Point, Side};
use truepath_units::{Offset, Position, Real};

/// Other passes that cut alike, whose points count, at most.
pub const MOST_ALIKE: usize = 8;

/// How the readings were taken and what they touched.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Setting {
    /// Radius of the probe's ball.
    pub ball_radius: Offset,
    /// Cutter radius: the wall lies this far from the path.
    pub cutter_radius: Offset,
    /// Side of travel of the wall.
    pub wall: Side,
    /// Z of the cutter's tip during the cut.
    pub tip_z: Position,
    /// Tips of other passes that cut alike along the same path, above this one's; zero for none.
    pub alike: [Offset; MOST_ALIKE],
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
    /// The probe did not touch.
    Missed,
    /// An approach: the next reading is of the same place.
    Superseded,
    /// The same point as in another line.
    Repeat {
        /// That line.
        of: u32,
    },
    /// The normal in the file is more than 30° off that of the wall.
    Normal {
        /// More than 90°: it points into the material.
        opposite: bool,
    },
}

/// Turns readings into contacts.
#[derive(Clone, Copy, Debug)]
pub struct Contacts<'a> {
    pub(super) contour: Contour<'a>,
    pub(super) setting: Setting,
}

/// Cosine of 30°: a normal farther off belongs to another wall.
const NORMAL_LIMIT: Real = Real::ratio(866_025_404, 1_000_000_000);

impl<'a> Contacts<'a> {
    /// For a contour and a setting.
    pub const fn new(contour: Contour<'a>, setting: Setting) -> Self {
        Self { contour, setting }
    }

    /// Z of the cutter's tip during the cut.
    pub const fn tip_z(&self) -> Position {
        self.setting.tip_z
    }

    /// The contact of a reading.
    ///
    /// # Errors
    /// [`Rejected`] when the reading is a miss or an approach, off the wall or off the engaged depth, or has the normal
    /// of another wall.
    pub fn contact(&self, reading: &Reading) -> Result<Contact, Rejected> {
        match reading.outcome {
            Outcome::Touched => {}
            Outcome::Missed => return Err(Rejected::Missed),
            Outcome::Superseded => return Err(Rejected::Superseded),
        }
        let [x, y, z] = reading.position;
        let setting = &self.setting;
        let centre = Point { x, y };
        let (nearest, error) = self.foot(centre, reading.radius);
        let Some(nearest) = nearest.filter(|_| error.abs() <= setting.reach) else {
            return Err(Rejected::OffTheWall { distance: error });
        };
        let lift = if setting.z_is_tip { setting.ball_radius } else { Offset::ZERO };
        let above_tip = z - setting.tip_z + lift;
        let others = setting.alike.iter().filter(|tip| **tip != Offset::ZERO).map(|tip| above_tip - *tip);
        let mut heights = core::iter::once(above_tip).chain(others);
        let engaged = |height: &Offset| *height >= Offset::ZERO && *height <= setting.axial_depth;
        let above_tip = heights.find(engaged).ok_or(Rejected::OffHeight { height: above_tip })?;
        let place = self.contour.at(nearest.s, nearest.block).ok_or(Rejected::OffTheWall { distance: error })?;
        let normal = setting.wall.normal(place.heading);
        if let Some(cosine) = reading.normal.map(|free| -free.dot(normal)).filter(|c| *c < NORMAL_LIMIT) {
            return Err(Rejected::Normal { opposite: cosine < Real::ZERO });
        }
        Ok(Contact {
            line: reading.line,
            point: centre + normal.times(reading.radius),
            s: nearest.s,
            normal,
            height: above_tip.over(setting.axial_depth),
            error,
        })
    }

    /// The place of the contour a ball centre belongs to, and the wall error it shows there.
    pub(super) fn foot(&self, centre: Point, radius: Offset) -> (Option<Nearest>, Offset) {
        let expected = self.setting.cutter_radius - radius;
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
}
