//! Lines and arcs: where they lead, about which centre, and in which direction they begin and end.

use super::super::super::flow::{Next, Sentence};
use super::super::super::shifts::sin_cos_degrees;
use super::super::super::{
    CornerError, Decimal, GcodeError, GcodeErrorKind, KlartextError, Number, SettingError, Span, Statement, Word,
    klartext_letter as letter,
};
use super::super::Execution;
use super::super::arc::centre_from_radius;
use super::super::klartext_memory::{Asked, Lowered};
use truepath_units::geometry::{Point, Vector};
use truepath_units::{Offset, Position, Real, atan2, div_rounded};

/// A turn in millionths of a degree.
const TURN: i64 = 360_000_000;
/// Radii from which on a tangent arc is a line, 100 m.
const STRAIGHT_NM: i128 = 100_000_000_000;
/// Letters of the axes, and those of steps along them.
const AXES: [(u8, u8); 9] = [
    (b'X', b'x'),
    (b'Y', b'y'),
    (b'Z', b'z'),
    (b'A', b'a'),
    (b'B', b'b'),
    (b'C', b'c'),
    (b'U', b'u'),
    (b'V', b'v'),
    (b'W', b'w'),
];
/// Letters of the words that name a place.
pub(super) const PLACE: &[u8] = b"XYZABCUVWxyzabcuvwPpHh";

/// Along what a move goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Way {
    Line,
    Arc { centre: Point, counter_clockwise: bool },
}

impl Way {
    /// Its direction at a place on it.
    fn direction(self, at: Point, from: Point, to: Point) -> Option<Vector> {
        let vector = match self {
            Self::Line => to.from(from),
            Self::Arc { centre, counter_clockwise } => {
                let spoke = at.from(centre);
                if counter_clockwise { Vector { x: -spoke.y, y: spoke.x } } else { Vector { x: spoke.y, y: -spoke.x } }
            }
        };
        (vector.length_squared() > 0).then_some(vector)
    }
}

impl<'p> Execution<'p, '_, '_> {
    /// A block of a contour, or one that positions.
    pub(super) fn path(&mut self, sentence: &Sentence<'p>) -> Result<Next, GcodeError> {
        let corner = sentence.words.iter().find(|w| is_corner(w)).copied();
        self.klartext.corner_taken = corner.is_some();
        let of = |wanted: u8| sentence.words.iter().find(|w| w.letter == wanted).copied();
        let mut words = Lowered::new();
        let asked = self.functions(sentence, &mut words)?;
        let rapid = self.feeds(sentence, &mut words)?;
        let before = words.len();
        let from = self.at.point();
        let mut turns = 0;
        if let Some(place) = self.polar_target(sentence, &mut turns)? {
            let span = self.block_span();
            self.put(&mut words, b'X', self.written(place.x), span)?;
            self.put(&mut words, b'Y', self.written(place.y), span)?;
        }
        self.axis_targets(sentence, &mut words, asked.machine)?;
        let named = words.len() > before;
        let to = self.target_point(&words)?;
        let span = self.block_span();
        let statement = sentence.statement;
        let mut way = Some(Way::Line);
        match statement {
            Statement::Line | Statement::PolarLine => {
                if named || corner.is_some() {
                    self.put_code(&mut words, if rapid { 0 } else { 10 }, span)?;
                }
                if asked.machine && named {
                    self.put_code(&mut words, 530, span)?;
                    way = None;
                }
                self.refuse_others(sentence, &[PLACE, &[letter::SIDE, letter::ROUNDING, letter::CHAMFER]])?;
            }
            _ => {
                if let Some(corner) = corner {
                    return Err(self.error(CornerError::WithoutLine.into(), corner.span));
                }
                let turned = of(letter::TURN);
                let arc = self.arc_way(statement, from, to, turned, of(letter::RADIUS))?;
                way = Some(arc);
                match arc {
                    Way::Line => self.put_code(&mut words, 10, span)?,
                    Way::Arc { centre, counter_clockwise } => {
                        self.put_code(&mut words, if counter_clockwise { 30 } else { 20 }, span)?;
                        match (statement, of(letter::RADIUS)) {
                            (Statement::RadiusArc, Some(radius)) => {
                                self.put(&mut words, b'R', radius.value, radius.span)?;
                            }
                            (Statement::Arc | Statement::PolarArc, _) => {
                                let [x, y] = self.klartext.pole;
                                self.put(&mut words, b'I', x.unwrap_or(Number::ZERO), span)?;
                                self.put(&mut words, b'J', y.unwrap_or(Number::ZERO), span)?;
                            }
                            _ => {
                                self.put(&mut words, b'I', self.written(centre.x), span)?;
                                self.put(&mut words, b'J', self.written(centre.y), span)?;
                            }
                        }
                        if turns > 0 {
                            self.put(&mut words, b'P', Number::Computed(f64::from(turns).max(0.0)), span)?;
                        }
                    }
                }
                self.refuse_others(sentence, &[PLACE, &[letter::SIDE, letter::TURN, letter::RADIUS]])?;
            }
        }
        if let Some(corner) = corner {
            let name = if corner.letter == letter::ROUNDING { b'r' } else { b'c' };
            self.put(&mut words, name, corner.value, corner.span)?;
        }
        let moves = from.zip(to).filter(|(from, to)| from != to || matches!(way, Some(Way::Arc { .. })));
        let ends = way.zip(moves).map(|(way, (from, to))| (way.direction(from, from, to), way.direction(to, from, to)));
        if self.klartext.lead.is_some() && named {
            let Some((Some(start), _)) = ends.filter(|_| !rapid) else {
                return Err(self.error(KlartextError::ContourMissing.into(), span));
            };
            self.begin_contour(start)?;
        }
        self.side(of(letter::SIDE), &mut words)?;
        let next = self.lower(sentence, &words)?;
        if named {
            self.klartext.rapid = rapid;
            match (ends, from, to) {
                (Some((_, end)), ..) => self.klartext.direction = end,
                (None, Some(from), Some(to)) if from == to => {}
                _ => self.klartext.direction = None,
            }
        }
        let calls = self.klartext.calls_cycle && named;
        self.carry_out(Asked { cycle: asked.cycle || calls, ..asked })?;
        Ok(next)
    }

    /// R0, RL, RR where they change something.
    pub(super) fn side(&mut self, word: Option<Word>, words: &mut Lowered) -> Result<(), GcodeError> {
        use truepath_units::geometry::Side;
        let Some(word) = word else { return Ok(()) };
        let wall = match word.value.exactly_times(1) {
            Some(1) => Some(Side::Right),
            Some(2) => Some(Side::Left),
            _ => None,
        };
        if wall == self.modal.wall {
            return Ok(());
        }
        let tenths = match wall {
            None => 400,
            Some(Side::Right) => 410,
            Some(Side::Left) => 420,
        };
        self.put_code(words, tenths, word.span)
    }

    /// The axis words, with what is counted from the present place added to it. In machine coordinates they stay as they are.
    pub(super) fn axis_targets(
        &mut self,
        sentence: &Sentence<'p>,
        words: &mut Lowered,
        machine: bool,
    ) -> Result<(), GcodeError> {
        for word in &sentence.words {
            let Some(axis) = AXES.iter().position(|(whole, step)| [*whole, *step].contains(&word.letter)) else {
                continue;
            };
            let Some(&(whole, step)) = AXES.get(axis) else { continue };
            if word.letter == whole {
                self.put(words, whole, word.value, word.span)?;
                continue;
            }
            if machine {
                return Err(self.error(SettingError::MachineMoveIncremental.into(), word.span));
            }
            let by = self.axis_value(Word { letter: step.to_ascii_uppercase(), ..*word }, axis)?;
            let value = match axis.checked_sub(3).and_then(|a| self.modal.auxiliary.get(a)) {
                Some(at) if axis < 6 => {
                    let at = at.saturating_add(by.nm());
                    Decimal::new(at, 6).map_or(Number::ZERO, Number::Exact)
                }
                Some(at) => self.written(Position::from_nm(at.saturating_add(by.nm()))),
                None => {
                    let Some(at) = self.at.get(axis) else {
                        return Err(self.error(GcodeErrorKind::PositionUnknown { axis: whole }, word.span));
                    };
                    self.written(at + by)
                }
            };
            self.put(words, whole, value, word.span)?;
        }
        Ok(())
    }

    /// Where words of X and Y lead.
    pub(super) fn target_point(&mut self, words: &Lowered) -> Result<Option<Point>, GcodeError> {
        let mut to = self.at;
        for word in words.iter().filter(|w| matches!(w.letter, b'X' | b'Y')) {
            let place = Position::ZERO + self.length(*word)?;
            to.set(usize::from(word.letter == b'Y'), Some(place));
        }
        Ok(to.point())
    }

    /// CC: the pole; without coordinates it is where the tool stands.
    pub(super) fn set_pole(&mut self, sentence: &Sentence<'p>) -> Result<(), GcodeError> {
        let mut words = Lowered::new();
        let place = self.polar_target(sentence, &mut 0)?;
        self.refuse_others(sentence, &[PLACE])?;
        if let Some(place) = place {
            self.klartext.pole = [Some(self.written(place.x)), Some(self.written(place.y))];
            return Ok(());
        }
        self.axis_targets(sentence, &mut words, false)?;
        let of = |letter: u8| words.iter().find(|w| w.letter == letter);
        if words.is_empty() {
            let Some(at) = self.at.point() else {
                let axis = if self.at.x.is_none() { b'X' } else { b'Y' };
                return Err(self.error(GcodeErrorKind::PositionUnknown { axis }, self.block_span()));
            };
            self.klartext.pole = [Some(self.written(at.x)), Some(self.written(at.y))];
            return Ok(());
        }
        for (place, letter) in self.klartext.pole.iter_mut().zip([b'X', b'Y']) {
            *place = of(letter).map(|w| w.value).or(*place);
        }
        for word in words.iter().filter(|w| matches!(w.letter, b'X' | b'Y')) {
            self.length(*word)?;
        }
        Ok(())
    }

    /// The pole in X and Y.
    fn pole(&mut self) -> Result<Point, GcodeError> {
        let span = self.block_span();
        let [Some(x), Some(y)] = self.klartext.pole else {
            return Err(self.error(KlartextError::PoleMissing.into(), span));
        };
        let x = self.length(Word { letter: b'X', value: x, span })?;
        let y = self.length(Word { letter: b'Y', value: y, span })?;
        Ok(Point { x: Position::ZERO + x, y: Position::ZERO + y })
    }

    /// Where polar words lead, and how many times CP turns: the whole turns before the arc, plus one.
    pub(super) fn polar_target(
        &mut self,
        sentence: &Sentence<'p>,
        turns: &mut u32,
    ) -> Result<Option<Point>, GcodeError> {
        let of = |wanted: u8| sentence.words.iter().find(|w| w.letter == wanted).copied();
        let radius = (of(letter::POLAR_RADIUS), of(letter::POLAR_RADIUS_STEP));
        let angle = (of(letter::POLAR_ANGLE), of(letter::POLAR_ANGLE_STEP));
        if radius == (None, None) && angle == (None, None) {
            return Ok(None);
        }
        let pole = self.pole()?;
        let at = self.at.point();
        let here = at.map(|at| at.from(pole));
        let unknown = || KlartextError::PoleMissing;
        let span = self.block_span();
        if sentence.statement == Statement::PolarArc
            && let (None, Some(step)) = angle
        {
            let Some(here) = here else { return Err(self.error(unknown().into(), span)) };
            let by = self.angle(step)?;
            let turn = of(letter::TURN).and_then(|w| w.value.exactly_times(1));
            if by == 0 || turn.is_some_and(|turn| (turn > 0) != (by > 0)) {
                return Err(self.error(KlartextError::Rotation.into(), step.span));
            }
            let whole = (by.abs().saturating_sub(1)) / TURN;
            *turns = u32::try_from(whole.saturating_add(1)).unwrap_or(u32::MAX);
            if by % TURN == 0 {
                return Ok(at);
            }
            let (sine, cosine) = sin_cos_degrees(by % TURN);
            return Ok(Some(pole + here.turned(sine, cosine)));
        }
        let far = match (radius, here) {
            ((Some(word), _), _) => self.length(Word { letter: b'R', ..word })?,
            ((None, Some(word)), Some(here)) => here.length() + self.length(Word { letter: b'R', ..word })?,
            ((None, None), Some(here)) => here.length(),
            _ => return Err(self.error(unknown().into(), span)),
        };
        let direction = match (angle, here) {
            ((Some(word), _), _) => self.angle(word)?,
            ((None, step), Some(here)) => {
                let radians = atan2(here.y.nm(), here.x.nm());
                let now = Offset::from_nm(180_000_000).scaled(radians.over(Real::PI)).nm();
                now.saturating_add(step.map(|word| self.angle(word)).transpose()?.unwrap_or(0))
            }
            _ => return Err(self.error(unknown().into(), span)),
        };
        let (sine, cosine) = sin_cos_degrees(direction);
        Ok(Some(pole + Vector { x: far.scaled(cosine), y: far.scaled(sine) }))
    }

    /// An angle in millionths of a degree.
    pub(super) fn angle(&mut self, word: Word) -> Result<i64, GcodeError> {
        self.axis_value(Word { letter: b'A', ..word }, 3).map(Offset::nm)
    }

    /// The centre and the sense of an arc.
    fn arc_way(
        &mut self,
        statement: Statement,
        from: Option<Point>,
        to: Option<Point>,
        turn: Option<Word>,
        radius: Option<Word>,
    ) -> Result<Way, GcodeError> {
        let span = self.block_span();
        let (Some(from), Some(to)) = (from, to) else {
            let axis = if self.at.x.is_none() { b'X' } else { b'Y' };
            return Err(self.error(GcodeErrorKind::PositionUnknown { axis }, span));
        };
        if matches!(statement, Statement::TangentArc | Statement::PolarTangentArc) {
            return self.tangent(from, to, span);
        }
        let Some(turn) = turn else { return Err(self.error(KlartextError::Rotation.into(), span)) };
        let counter_clockwise = turn.value.exactly_times(1) == Some(1);
        let centre = match (statement, radius) {
            (Statement::RadiusArc, Some(word)) => {
                let radius = self.length(Word { letter: b'R', ..word })?;
                centre_from_radius(from, to, radius, counter_clockwise).map_err(|kind| self.error(kind, word.span))?
            }
            (Statement::RadiusArc, None) => return Err(self.error(GcodeErrorKind::ArcWithoutCentre, span)),
            _ => self.pole()?,
        };
        Ok(Way::Arc { centre, counter_clockwise })
    }

    /// The arc that begins in the direction in which the last move ended; a line where that leads straight on.
    fn tangent(&self, from: Point, to: Point, span: Span) -> Result<Way, GcodeError> {
        let missing = self.error(KlartextError::TangentMissing.into(), span);
        let Some(direction) = self.klartext.direction else { return Err(missing) };
        let way = to.from(from);
        let squared = i128::try_from(way.length_squared()).unwrap_or(i128::MAX);
        // The centre lies aside of the start by way² / (2 · aside · way), along the unit vector of aside.
        let aside = Vector { x: -direction.y, y: direction.x };
        let across = aside.dot(way);
        if squared == 0 {
            return Err(missing);
        }
        let bottom = across.saturating_mul(2);
        let offset = |part: Offset| {
            let top = i128::from(part.nm()).saturating_mul(squared);
            if bottom == 0 { i128::MAX } else { div_rounded(top, bottom) }
        };
        let (x, y) = (offset(aside.x), offset(aside.y));
        let far = |v: i128| v.saturating_abs() > STRAIGHT_NM;
        if far(x) || far(y) {
            return if direction.dot(way) > 0 { Ok(Way::Line) } else { Err(missing) };
        }
        let part = |v: i128| Offset::from_nm(i64::try_from(v).unwrap_or(i64::MAX));
        let centre = from + Vector { x: part(x), y: part(y) };
        Ok(Way::Arc { centre, counter_clockwise: across > 0 })
    }
}

/// RND or CHF of the block that follows.
const fn is_corner(word: &Word) -> bool {
    matches!(word.letter, letter::ROUNDING | letter::CHAMFER)
}
