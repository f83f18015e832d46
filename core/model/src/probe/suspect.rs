//! What is wrong when most readings are off the wall: unit, side, ball, axes, normals, frame.
//!
//! Each mistake is tried on the readings; the first under which most of them fit is named. The frame comes last: the
//! shift of the readings is found by least squares on the distances from the wall, with little weight on those far off,
//! from where the file has them and from where the middles of readings and contour coincide.

use super::contact::{Contacts, Setting};
use super::reading::{Outcome, Reading};
use truepath_units::geometry::{Point, Vector};
use truepath_units::{Offset, Position, Real, errors};

errors! {
    /// What explains that most readings are off the wall.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
    pub enum Suspicion {
        /// They fit when read as inches.
        Inches = "M011", "they fit when read as inches";
        /// They fit when inches are read as millimetres.
        Millimetres = "M012", "they fit when read as millimetres";
        /// They fit with a ball twice as large: its radius was given as its diameter.
        BallTwice = "M013", "they fit with a ball twice as large";
        /// They fit with a ball half as large: its diameter was given twice.
        BallHalf = "M013", "they fit with a ball half as large";
        /// Ball centres are expected, and they fit as surface points.
        Surface = "M013", "they fit as surface points, and ball centres are expected";
        /// Surface points are expected, and they fit as ball centres.
        Centre = "M017", "they fit as ball centres, and surface points are expected";
        /// They fit a wall on the other side of travel.
        OtherSide = "M016", "they fit a wall on the other side of travel";
        /// They fit with X and Y exchanged.
        Swapped = "M018", "they fit with X and Y exchanged";
        /// They fit with the sign of X turned.
        MirroredX = "M019", "they fit with the sign of X turned";
        /// They fit with the sign of Y turned.
        MirroredY = "M019", "they fit with the sign of Y turned";
        /// They fit, and the normals in the file point the other way.
        Normals = "M021", "the normals in the file point into the wall";
        /// They fit after one shift of all: another frame.
        Shifted {
            /// What the readings have too much, rounded to a tenth of a millimetre.
            by: [Offset; 2],
        } = "M014", "they fit after one shift of all";
        /// Nothing simple explains it.
        Frame = "M014", "probably they are in another frame";
    }
}

/// Readings that a shift is computed from, at most.
const SHIFT_SAMPLE: usize = 24;
/// Steps of the search for a shift.
const SHIFT_STEPS: u32 = 12;

/// Distances in mm below this weigh the same; larger ones weigh less, so that a stray point does not bend the shift.
const NEAR_MM: Real = Real::ratio(1, 20);

impl Contacts<'_> {
    /// How many of the touches lie on the wall after a change of their coordinates and of their distance from it.
    fn fitting(
        &self,
        readings: &[Reading],
        change: impl Fn(Point) -> Point,
        radius: impl Fn(Offset) -> Offset,
    ) -> usize {
        let on_wall = |r: &&Reading| {
            let (foot, error) = self.foot(change(r.place()), radius(r.radius));
            foot.is_some() && error.abs() <= self.setting.reach
        };
        touched(readings).filter(on_wall).count()
    }

    /// How many of the touches have a normal that points into the wall they lie on.
    fn turned_normals(&self, readings: &[Reading]) -> usize {
        let turned = |r: &&Reading| {
            let nearest = self.foot(r.place(), r.radius).0;
            let place = nearest.and_then(|n| self.contour.at(n.s, n.block));
            place.zip(r.normal).is_some_and(|(place, n)| n.dot(self.setting.wall.normal(place.heading)) > Real::HALF)
        };
        touched(readings).filter(turned).count()
    }

    /// One shift that brings most of the readings to the wall.
    fn shift(&self, readings: &[Reading], enough: impl Fn(usize) -> bool) -> Option<[Offset; 2]> {
        let starts = [Vector::from_nm(0, 0), self.middle()?.from(middle(touched(readings).map(Reading::place))?)];
        starts.into_iter().find_map(|start| {
            let shift = self.settled(readings, start);
            enough(self.fitting(readings, |p| p + shift, |r| r)).then_some([-shift.x, -shift.y].map(tenth))
        })
    }

    fn settled(&self, readings: &[Reading], start: Vector) -> Vector {
        let every = touched(readings).count().div_ceil(SHIFT_SAMPLE).max(1);
        let mut shift = start;
        for _ in 0..SHIFT_STEPS {
            // Normal equations of Σ w (error − n·Δ)², lengths in mm.
            let (mut xx, mut xy, mut yy, mut bx, mut by) = (Real::ZERO, Real::ZERO, Real::ZERO, Real::ZERO, Real::ZERO);
            for reading in touched(readings).step_by(every) {
                let (Some(nearest), error) = self.foot(reading.place() + shift, reading.radius) else { continue };
                let Some(place) = self.contour.at(nearest.s, nearest.block) else { continue };
                let normal = self.setting.wall.normal(place.heading);
                let error = error.mm();
                let weight = Real::ONE.over(error.abs().max(NEAR_MM));
                (xx, xy) = (xx + weight * normal.x * normal.x, xy + weight * normal.x * normal.y);
                yy += weight * normal.y * normal.y;
                (bx, by) = (bx + weight * normal.x * error, by + weight * normal.y * error);
            }
            // On a straight wall the shift along it is open: a weak pull to zero closes it.
            let pull = (xx + yy).over(Real::from_int(1_000)).max(Real::ratio(1, 1_000_000));
            (xx, yy) = (xx + pull, yy + pull);
            let determinant = xx * yy - xy * xy;
            if determinant <= Real::ZERO {
                break;
            }
            let step = |numerator: Real| Offset::from_mm(numerator.over(determinant));
            let (dx, dy) = (step(yy * bx - xy * by), step(xx * by - xy * bx));
            shift = Vector { x: shift.x + dx, y: shift.y + dy };
        }
        shift
    }

    /// Middle of the contour.
    fn middle(&self) -> Option<Point> {
        middle(self.contour.blocks().iter().flat_map(|b| [b.curve.start(), b.curve.end()]))
    }
}

fn touched(readings: &[Reading]) -> impl Iterator<Item = &Reading> {
    readings.iter().filter(|r| r.outcome == Outcome::Touched)
}

/// Middle of the box around points.
fn middle(points: impl Iterator<Item = Point>) -> Option<Point> {
    let (low, high) = points.fold(None, |bounds: Option<(Point, Point)>, p| {
        let (low, high) = bounds.unwrap_or((p, p));
        let (least, most) =
            (Point { x: low.x.min(p.x), y: low.y.min(p.y) }, Point { x: high.x.max(p.x), y: high.y.max(p.y) });
        Some((least, most))
    })?;
    let half = |low: Position, high: Position| low + Offset::from_nm((high - low).nm() / 2);
    Some(Point { x: half(low.x, high.x), y: half(low.y, high.y) })
}

fn tenth(length: Offset) -> Offset {
    let tenths = truepath_units::div_rounded(i128::from(length.nm()), 100_000);
    Offset::from_nm(i64::try_from(tenths).unwrap_or(0).saturating_mul(100_000))
}

/// Names what is wrong when more than half of the touches are off the wall; `None` when they are on it.
pub fn suspect(contacts: &Contacts, readings: &[Reading]) -> Option<Suspicion> {
    let all = touched(readings).count();
    let enough = |n: usize| n.saturating_mul(2) > all;
    let as_is = |p: Point| p;
    let same = |radius: Offset| radius;
    if all == 0 {
        return None;
    }
    if enough(contacts.fitting(readings, as_is, same)) {
        return enough(contacts.turned_normals(readings)).then_some(Suspicion::Normals);
    }
    let times = |numerator: i64, denominator: i64| {
        let factor = Real::ratio(numerator, denominator);
        let scaled = move |p: Position| Position::from_nm((p - Position::ZERO).scaled(factor).nm());
        move |p: Point| Point { x: scaled(p.x), y: scaled(p.y) }
    };
    if enough(contacts.fitting(readings, times(254, 10), same)) {
        return Some(Suspicion::Inches);
    }
    if enough(contacts.fitting(readings, times(10, 254), same)) {
        return Some(Suspicion::Millimetres);
    }
    let other = Contacts::new(contacts.contour, Setting { wall: contacts.setting.wall.other(), ..contacts.setting });
    if enough(other.fitting(readings, as_is, same)) {
        return Some(Suspicion::OtherSide);
    }
    let ball = contacts.setting.ball_radius;
    let centres = |radius: Offset| if radius == Offset::ZERO { ball } else { radius };
    if enough(contacts.fitting(readings, as_is, |_| Offset::ZERO)) {
        return Some(Suspicion::Surface);
    }
    if enough(contacts.fitting(readings, as_is, centres)) {
        return Some(Suspicion::Centre);
    }
    if enough(contacts.fitting(readings, as_is, |radius| radius + radius)) {
        return Some(Suspicion::BallTwice);
    }
    if enough(contacts.fitting(readings, as_is, |radius| Offset::from_nm(radius.nm() / 2))) {
        return Some(Suspicion::BallHalf);
    }
    let turned = |p: Position| Position::ZERO - (p - Position::ZERO);
    if enough(contacts.fitting(readings, |p| Point { x: p.y, y: p.x }, same)) {
        return Some(Suspicion::Swapped);
    }
    if enough(contacts.fitting(readings, |p| Point { x: turned(p.x), y: p.y }, same)) {
        return Some(Suspicion::MirroredX);
    }
    if enough(contacts.fitting(readings, |p| Point { x: p.x, y: turned(p.y) }, same)) {
        return Some(Suspicion::MirroredY);
    }
    // Any two points fit after some shift.
    let shift = (all > 2).then(|| contacts.shift(readings, enough)).flatten();
    Some(shift.map_or(Suspicion::Frame, |by| Suspicion::Shifted { by }))
}
