//! APPR and DEP: the ways to the contour and from it.
//!
//! Their radii and lengths are those of the path of the cutter's centre: the TNC's own example leads a cutter of radius
//! 10 to the contour along an arc of 5. With the first point of the contour, its direction there and the side of the cutter,
//! APPR leads
//!
//! | form | from the start point to an auxiliary point | and on |
//! |---|---|---|
//! | LT | `LEN` before the contour, in its direction | straight |
//! | LN | `LEN` beside it | straight |
//! | CT | on an arc of `R` and `CCA`, tangent to the contour; `R` below 0 on the side of the wall | along the arc |
//! | LCT | where the line is tangent to the arc of `R` | along the arc |
//!
//! and DEP the same backwards. The direction of the contour is known when its first move comes: until then APPR waits.
//! No wall depends on leads, so they are computed in floating point.

use super::super::super::block::BlockWords;
use super::super::super::compensation::{Cutter, StartUp, Waiting};
use super::super::super::flow::{Next, Sentence};
use super::super::super::{
    Axes, Canon, Form, GcodeError, GcodeErrorKind, KlartextBlock, KlartextError, Line, Span, Statement, WarningKind,
    Word, klartext_letter as letter,
};
use super::super::Execution;
use super::super::klartext_memory::{Lead, Lowered, Shape};

use super::path::PLACE;
use truepath_units::geometry::{Curve, Point, Side, Vector};
use truepath_units::{Offset, Position, div_rounded};

/// A place or a vector of the plane, nm.
type Plane = [f64; 2];

/// An arc of a lead.
#[derive(Clone, Copy, Debug)]
struct LeadArc {
    centre: Plane,
    counter_clockwise: bool,
}

impl<'p> Execution<'p, '_, '_> {
    /// APPR: its modes now, its way with the first move of the contour.
    pub(super) fn approach(&mut self, sentence: &Sentence<'p>, form: Form, polar: bool) -> Result<Next, GcodeError> {
        let span = self.block_span();
        if self.klartext.lead.is_some() {
            return Err(self.error(KlartextError::ContourMissing.into(), span));
        }
        let of = |wanted: u8| sentence.words.iter().find(|w| w.letter == wanted).copied();
        let mut words = Lowered::new();
        let asked = self.functions(sentence, &mut words)?;
        let rapid = self.klartext.rapid;
        let feed = of(letter::FEED).filter(|_| rapid);
        if feed.is_none() {
            self.feeds(sentence, &mut words)?;
        }
        let from = self.at;
        let to = self.place_of(sentence, polar)?;
        let shape = self.shape(sentence, form)?;
        self.refuse_others(sentence, &[PLACE, &[letter::SIDE, letter::LENGTH, letter::RADIUS, letter::ANGLE]])?;
        if from.point().is_none() || to.point().is_none() {
            let axis = if from.x.is_none() { b'X' } else { b'Y' };
            return Err(self.error(GcodeErrorKind::PositionUnknown { axis }, span));
        }
        let next = self.lower(sentence, &words)?;
        self.carry_out(asked)?;
        let (line, source) = (self.line, self.source);
        self.klartext.lead = Some(Lead { shape, side: of(letter::SIDE), line, source, from, to, rapid, feed });
        self.klartext.direction = None;
        self.klartext.rapid = false;
        self.at = to;
        Ok(next)
    }

    /// Leads to the contour, which begins in this direction; then compensation is on.
    pub(super) fn begin_contour(&mut self, start: Vector) -> Result<(), GcodeError> {
        let Some(lead) = self.klartext.lead.take() else { return Ok(()) };
        let here = (self.line, self.source);
        (self.line, self.source) = (lead.line, lead.source);
        let span = self.block_span();
        let (Some(from), Some(to)) = (lead.from.point(), lead.to.point()) else {
            return Err(self.error(KlartextError::Lead.into(), span));
        };
        let wall = match lead.side.and_then(|w| w.value.exactly_times(1)) {
            Some(1) => Some(Side::Right),
            Some(2) => Some(Side::Left),
            _ => None,
        };
        let radius = if wall.is_some() { self.radius_of_cutter(span)? } else { None };
        let left = match wall {
            Some(wall) => wall == Side::Right,
            None => start.cross(from.from(to)) > 0,
        };
        let (direction, aside) = (unit(start), normal(unit(start), left));
        let begin = moved(place(to), aside, radius.map_or(0.0, |r| r.nm() as f64));
        let Some((auxiliary, arc)) = lead.shape.backwards(begin, direction, aside, left, place(from)) else {
            return Err(self.error(KlartextError::Lead.into(), span));
        };
        let [at, beside] = [auxiliary, begin].map(|p| Axes { z: lead.to.z, ..at(p) });
        self.at = lead.from;
        let mut sentence = Sentence::new(self.text);
        (sentence.line, sentence.source) = (lead.line, lead.source);
        // All of it is written anew where compensation is taken out, and the last piece of it is the entry.
        let switches = wall.filter(|_| wall != self.modal.wall);
        (self.modal.wall, self.modal.compensated) = (wall, radius.is_some());
        if lead.rapid {
            self.traverse_to(at, span)?
        } else {
            self.feed_to(at, span)?
        }
        if let Some(feed) = lead.feed {
            let mut words = Lowered::new();
            self.put(&mut words, b'F', feed.value, feed.span)?;
            self.lower(&sentence, &words)?;
        }
        if switches.is_some() {
            self.emit(Canon::Compensation { wall, offset_number: self.modal.radius_offset }, span)?;
            if radius.is_none() {
                self.warn(WarningKind::CompensationNotApplied, span);
            }
        }
        self.lead_to(beside, arc, span)?;
        if let Some(radius) = radius.filter(|r| *r != Offset::ZERO) {
            let side = if left == (radius > Offset::ZERO) { Side::Left } else { Side::Right };
            let cutter = Cutter { side, radius: radius.abs() };
            self.compensation.start(cutter, self.modal.plane, StartUp::Next);
        }
        // The way on, from where the cutter stands to the contour as it is programmed: it begins the path beside it.
        if beside != lead.to {
            self.feed_to(lead.to, span)?;
        }
        self.at = lead.to;
        (self.line, self.source) = here;
        Ok(())
    }

    /// DEP: compensation ends where the contour does, and the cutter leaves it.
    pub(super) fn depart(&mut self, sentence: &Sentence<'p>, form: Form, polar: bool) -> Result<Next, GcodeError> {
        let span = self.block_span();
        let Some(direction) = self.klartext.direction.filter(|_| self.klartext.lead.is_none()) else {
            return Err(self.error(KlartextError::TangentMissing.into(), span));
        };
        let mut words = Lowered::new();
        let asked = self.functions(sentence, &mut words)?;
        self.feeds(sentence, &mut words)?;
        let to = self.place_of(sentence, polar)?;
        let shape = self.shape(sentence, form)?;
        self.refuse_others(sentence, &[PLACE, &[letter::SIDE, letter::LENGTH, letter::RADIUS, letter::ANGLE]])?;
        let next = self.lower(sentence, &words)?;
        self.stop_compensation(span)?;
        self.compensation.name_place_left(&mut self.at);
        self.compensation.forget_place_left();
        let (Some(end), Some(goal)) = (self.at.point(), to.point()) else {
            return Err(self.error(KlartextError::Lead.into(), span));
        };
        let left = match self.modal.wall {
            Some(wall) => wall == Side::Right,
            None => direction.cross(goal.from(end)) > 0,
        };
        let aside = normal(unit(direction), left);
        // Backwards, it is a lead to the contour with the direction and the side of its sense turned.
        let back = unit(direction).map(neg);
        let Some((auxiliary, arc)) = shape.backwards(place(end), back, aside, !left, place(goal)) else {
            return Err(self.error(KlartextError::Lead.into(), span));
        };
        let arc = arc.map(|arc| LeadArc { counter_clockwise: !arc.counter_clockwise, ..arc });
        // Its moves are still written anew where compensation is taken out.
        if self.modal.wall.is_some() {
            self.emit(Canon::Compensation { wall: None, offset_number: None }, span)?;
        }
        let last = if form == Form::LineArc { to } else { Axes { z: to.z, ..at(auxiliary) } };
        if form == Form::LineArc {
            let z = self.at.z;
            self.lead_to(Axes { z, ..at(auxiliary) }, arc, span)?;
            self.feed_to(last, span)?;
        } else {
            self.lead_to(last, arc, span)?;
        }
        (self.modal.wall, self.modal.radius_offset, self.modal.compensated) = (None, None, false);
        self.klartext.direction = None;
        self.klartext.rapid = false;
        self.carry_out(asked)?;
        Ok(next)
    }

    /// Whether a step is the way between a lead and the path beside the contour, on which the cutter stands already.
    pub(in super::super) fn is_way_of_lead(&self, step: &Waiting<'p>) -> bool {
        let Canon::Feed { from, to } = step.canon else { return false };
        let (line, start) = (step.source.line, step.source.block.start);
        let block = || KlartextBlock::of(Line { number: line, start, text: step.source.block.of(step.text) });
        self.options.dialect.is_klartext()
            && from == to
            && block().is_ok_and(|block| matches!(block.statement, Statement::Approach(..)))
    }

    /// Where the words of a lead lead; what they do not name stays.
    fn place_of(&mut self, sentence: &Sentence<'p>, polar: bool) -> Result<Axes, GcodeError> {
        let mut words = Lowered::new();
        let mut to = self.at;
        if polar && let Some(place) = self.polar_target(sentence, &mut 0)? {
            (to.x, to.y) = (Some(place.x), Some(place.y));
        }
        self.axis_targets(sentence, &mut words, false)?;
        for word in &words {
            let axis = match word.letter {
                b'X' => 0,
                b'Y' => 1,
                b'Z' => 2,
                _ => return Err(self.error(KlartextError::Word.into(), word.span)),
            };
            to.set(axis, Some(Position::ZERO + self.length(*word)?));
        }
        Ok(to)
    }

    #[expect(clippy::float_arithmetic, reason = "leads, on which no wall depends")]
    fn shape(&mut self, sentence: &Sentence<'p>, form: Form) -> Result<Shape, GcodeError> {
        let of = |wanted: u8| sentence.words.iter().find(|w| w.letter == wanted).copied();
        let length = |execution: &mut Self, wanted: u8| {
            let nm = |length: Offset| length.nm() as f64;
            of(wanted).map(|word| execution.length(Word { letter: b'R', ..word }).map(nm)).transpose()
        };
        let (length, radius) = (length(self, letter::LENGTH)?, length(self, letter::RADIUS)?);
        let angle = of(letter::ANGLE).map(|word| self.angle(word)).transpose()?;
        let angle = angle.map(|millionths| (millionths as f64 / 1e6).to_radians());
        Ok(Shape { form, length, radius, angle })
    }

    /// Goes on to a place, along an arc or straight.
    fn lead_to(&mut self, to: Axes, arc: Option<LeadArc>, span: Span) -> Result<(), GcodeError> {
        let from = self.at;
        let (Some(start), Some(end)) = (from.point(), to.point()) else { return Ok(()) };
        let Some(LeadArc { centre, counter_clockwise }) = arc else { return self.feed_to(to, span) };
        let Some(centre) = at(centre).point() else { return Ok(()) };
        let curve = Curve::arc(start, end, centre, counter_clockwise);
        let curve = curve.map_err(|_| self.error(KlartextError::Lead.into(), span))?;
        self.at = to;
        self.emit(Canon::Arc { from, to, curve, centre, counter_clockwise, turns: 0 }, span)
    }

    /// The radius by which RL and RR move the path aside; `None` where the program is the path of the centre.
    fn radius_of_cutter(&mut self, span: Span) -> Result<Option<Offset>, GcodeError> {
        let sentence = Sentence::new(self.text);
        let mut block = BlockWords::of(&sentence.words);
        block.gather(&sentence, self.options.dialect)?;
        let diameter = self.diameter_of_table(&mut block, span)?;
        let half = |d: Offset| Offset::from_nm(i64::try_from(div_rounded(d.nm().into(), 2)).unwrap_or(i64::MAX));
        Ok(diameter.map(half))
    }
}

impl Shape {
    /// From the place where the contour begins, in its direction, with the side of the cutter: the auxiliary point, and
    /// the arc from there.
    #[expect(clippy::float_arithmetic, reason = "leads, on which no wall depends")]
    fn backwards(
        self,
        begin: Plane,
        direction: Plane,
        aside: Plane,
        left: bool,
        from: Plane,
    ) -> Option<(Plane, Option<LeadArc>)> {
        let turned = |arc: LeadArc, by: f64| {
            let spoke = [begin[0] - arc.centre[0], begin[1] - arc.centre[1]];
            let (sine, cosine) = (libm::sin(by), libm::cos(by));
            [arc.centre[0] + spoke[0] * cosine - spoke[1] * sine, arc.centre[1] + spoke[0] * sine + spoke[1] * cosine]
        };
        match self.form {
            Form::Line => Some((moved(begin, direction, -self.length?), None)),
            Form::Normal => Some((moved(begin, aside, self.length?), None)),
            Form::Arc => {
                let radius = self.radius.filter(|r| *r != 0.0)?;
                let angle = self.angle.filter(|a| *a > 0.0 && *a <= core::f64::consts::TAU)?;
                let counter_clockwise = left == (radius > 0.0);
                let arc = LeadArc { centre: moved(begin, aside, radius), counter_clockwise };
                let auxiliary = turned(arc, if counter_clockwise { -angle } else { angle });
                Some((auxiliary, Some(arc)))
            }
            Form::LineArc => {
                let radius = self.radius.filter(|r| *r > 0.0)?;
                let arc = LeadArc { centre: moved(begin, aside, radius), counter_clockwise: left };
                let way = [from[0] - arc.centre[0], from[1] - arc.centre[1]];
                let far = libm::hypot(way[0], way[1]);
                if far < radius {
                    return None;
                }
                let (towards, half) = (libm::atan2(way[1], way[0]), libm::acos(radius / far));
                let angle = if left { towards + half } else { towards - half };
                let spoke = [libm::cos(angle), libm::sin(angle)];
                Some((moved(arc.centre, spoke, radius), Some(arc)))
            }
        }
    }
}

#[expect(clippy::float_arithmetic, reason = "leads, on which no wall depends")]
fn moved(from: Plane, along: Plane, by: f64) -> Plane {
    [from[0] + along[0] * by, from[1] + along[1] * by]
}

#[expect(clippy::float_arithmetic, reason = "leads, on which no wall depends")]
fn unit(vector: Vector) -> Plane {
    let [x, y] = [vector.x.nm() as f64, vector.y.nm() as f64];
    let length = libm::hypot(x, y).max(1.0);
    [x / length, y / length]
}

/// The unit vector to the left or to the right of another.
fn normal([x, y]: Plane, left: bool) -> Plane {
    if left { [neg(y), x] } else { [y, neg(x)] }
}

#[expect(clippy::float_arithmetic, reason = "leads, on which no wall depends")]
fn neg(value: f64) -> f64 {
    -value
}

const fn place(point: Point) -> Plane {
    [point.x.nm() as f64, point.y.nm() as f64]
}

/// The place in the plane, to the nanometre.
fn at([x, y]: Plane) -> Axes {
    let position = |v: f64| Some(Position::from_nm(libm::round(v) as i64));
    Axes { x: position(x), y: position(y), z: None }
}
