//! Canned cycles: G73, G74, G76 (Fanuc), G81 … G89 as the moves they stand for.
//!
//! The sequences are those that LinuxCNC's interpreter prints. R and Z stay from hole to hole while the cycle stays;
//! in G91 they are distances (R from the height before, Z from R) and every repetition moves on by the axis words. A
//! height below R is raised to R first; the retract goes to R (G99) or to the height before the cycle (G98).
//!
//! Limits: G87 is LinuxCNC's back boring with K; the sideways step of Fanuc's G76 is left out, because it does not cut.

use super::super::block::BlockWords;
use super::super::{
    Axes, Canon, CycleError, FeedMode, GCode, GcodeError, GcodeErrorKind, Number, Plane, RetractLevel, Span, Spindle,
};
use super::Execution;
use super::memory::CycleMemory;
use truepath_units::Position;

/// How far above the last depth the rapid of a pecking cycle ends: 0.254 mm, or 0.010 in.
const PECK_CLEARANCE_NM: i64 = 254_000;

/// Holes of one block times the pecks of each; more are an error.
const PECKS: i64 = 100_000;

/// One hole: where it is, and its heights.
#[derive(Clone, Copy)]
struct Hole {
    plane: Plane,
    /// First and second axis.
    place: [Option<Position>; 2],
    clearance: Position,
    bottom: Position,
    retract: Position,
}

impl Hole {
    /// Its axis at a height.
    fn at(&self, height: Position) -> Axes {
        let mut to = Axes::UNKNOWN;
        let [first, second, third] = self.plane.axes();
        let [a, b] = self.place;
        to.set(first, a);
        to.set(second, b);
        to.set(third, Some(height));
        to
    }

    /// Beside its axis at a height.
    fn beside(&self, by: [i64; 2], height: Position) -> Axes {
        let mut aside = *self;
        for (place, by) in aside.place.iter_mut().zip(by) {
            *place = place.map(|p| Position::from_nm(p.nm().saturating_add(by)));
        }
        aside.at(height)
    }
}

impl Execution<'_, '_, '_> {
    /// Executes the cycle that is on with the words of this block.
    pub(super) fn cycle(&mut self, block: &mut BlockWords<'_>, code: GCode) -> Result<(), GcodeError> {
        let span = self.block_span();
        if self.modal.feed_mode == FeedMode::InverseTime {
            return Err(self.error(CycleError::InverseTime.into(), span));
        }
        let memory = self.cycle_words(block, code, span)?;
        self.cycle = Some(memory);
        let plane = self.modal.plane;
        let [first, second, third] = plane.axes();
        let repetitions = self.repetitions(block)?;
        let polar = self.polar_words(block)?;
        let by = self.axis_steps(block, [first, second])?;
        let before = self.at.get(third);
        let incremental = !self.modal.absolute;
        // The level before the first of a series of cycles is that of all of them.
        let initial = self.initial_level.or(before);
        self.initial_level = initial;
        let clearance = match (incremental, initial) {
            (false, _) => Position::from_nm(memory.clearance),
            (true, Some(height)) => Position::from_nm(height.nm().saturating_add(memory.clearance)),
            (true, None) => {
                let axis = self.letter(third);
                return Err(self.error(GcodeErrorKind::PositionUnknown { axis }, span));
            }
        };
        let bottom = if incremental { clearance.nm().saturating_add(memory.depth) } else { memory.depth };
        let bottom = Position::from_nm(bottom);
        if bottom > clearance {
            return Err(self.error(CycleError::BelowBottom { clearance, bottom }.into(), span));
        }
        self.check_feed()?;
        let raised = initial.is_some_and(|height| height < clearance);
        if raised {
            let mut up = self.at;
            up.set(third, Some(clearance));
            self.traverse_to(up, span)?;
        }
        let back = self.modal.retract == RetractLevel::Before;
        let retract = initial.filter(|_| back && !raised).unwrap_or(clearance);
        // The height of the way to the first hole: where the tool stands when that is above R.
        let way = before.map_or(clearance, |height| if height > clearance { height } else { retract });
        for repetition in 0..repetitions {
            let mut place = [self.at.get(first), self.at.get(second)];
            for (at, by) in place.iter_mut().zip(by) {
                *at = match by {
                    Some(to) if !incremental => Some(Position::from_nm(to)),
                    Some(by) => at.map(|p| Position::from_nm(p.nm().saturating_add(by))),
                    None => *at,
                };
            }
            if let Some(polar) = polar {
                let there = self.polar_place(polar, self.at)?;
                place = [Some(there.x), Some(there.y)];
            }
            let hole = Hole { plane, place, clearance, bottom, retract };
            let height = match (repetition, before) {
                (0, before) => before.map(|_| if raised { clearance } else { way }),
                _ => self.at.get(third),
            };
            let mut over = hole.at(clearance);
            over.set(third, height);
            self.traverse_to(over, span)?;
            if height != Some(clearance) {
                self.traverse_to(hole.at(clearance), span)?;
            }
            self.drill(&memory, &hole, span)?;
        }
        Ok(())
    }

    /// What happens between R and the bottom, and the retract.
    fn drill(&mut self, memory: &CycleMemory, hole: &Hole, span: Span) -> Result<(), GcodeError> {
        let (bottom, clear) = (hole.at(hole.bottom), hole.at(hole.retract));
        match memory.code.tenths() {
            730 | 830 => {
                self.peck(memory, hole, span)?;
                self.feed_to(bottom, span)?;
                self.traverse_to(clear, span)
            }
            740 | 840 => self.tap_cycle(memory, hole, span),
            850 => {
                self.feed_to(bottom, span)?;
                self.feed_to(hole.at(hole.clearance), span)?;
                self.traverse_to(clear, span)
            }
            860 => {
                self.feed_to(bottom, span)?;
                self.cycle_dwell(memory, span)?;
                let spindle = self.stop_for(memory.code, span)?;
                self.traverse_to(clear, span)?;
                self.turn(spindle, span)
            }
            870 => self.back_bore(memory, hole, span),
            880 => {
                self.feed_to(bottom, span)?;
                self.cycle_dwell(memory, span)?;
                let spindle = self.stop_for(memory.code, span)?;
                self.emit(Canon::Stop { optional: false }, span)?;
                self.turn(spindle, span)?;
                // The operator retracts by hand.
                self.at = clear;
                Ok(())
            }
            890 => {
                self.feed_to(bottom, span)?;
                self.cycle_dwell(memory, span)?;
                self.feed_to(clear, span)
            }
            820 => {
                self.feed_to(bottom, span)?;
                self.cycle_dwell(memory, span)?;
                self.traverse_to(clear, span)
            }
            _ => {
                self.feed_to(bottom, span)?;
                self.traverse_to(clear, span)
            }
        }
    }

    fn peck(&mut self, memory: &CycleMemory, hole: &Hole, span: Span) -> Result<(), GcodeError> {
        let Some(peck) = memory.peck else { return Ok(()) };
        let (top, bottom) = (hole.clearance.nm(), hole.bottom.nm());
        if top.saturating_sub(bottom).checked_div(peck).is_none_or(|pecks| pecks > PECKS) {
            return Err(self.error(CycleError::TooManyPecks { limit: PECKS as u32 }.into(), span));
        }
        let mut depth = top.saturating_sub(peck);
        while depth > bottom {
            self.feed_to(hole.at(Position::from_nm(depth)), span)?;
            if memory.code.tenths() == 830 {
                self.traverse_to(hole.at(hole.clearance), span)?;
            }
            self.traverse_to(hole.at(Position::from_nm(depth.saturating_add(PECK_CLEARANCE_NM))), span)?;
            depth = depth.saturating_sub(peck);
        }
        Ok(())
    }

    /// G74, G84: with a floating chuck; the spindle turns back at the bottom.
    fn tap_cycle(&mut self, memory: &CycleMemory, hole: &Hole, span: Span) -> Result<(), GcodeError> {
        let (turning, back) = if memory.code.tenths() == 840 {
            (Spindle::Clockwise, Spindle::CounterClockwise)
        } else {
            (Spindle::CounterClockwise, Spindle::Clockwise)
        };
        if self.options.machine.is_some() && self.modal.spindle != turning {
            return Err(self.error(CycleError::Spindle { code: memory.code, needed: turning }.into(), span));
        }
        self.feed_to(hole.at(hole.bottom), span)?;
        self.turn(back, span)?;
        self.emit(Canon::Dwell(memory.dwell.unwrap_or(Number::ZERO)), span)?;
        self.feed_to(hole.at(hole.retract), span)?;
        self.turn(turning, span)
    }

    /// G87: the tool passes beside the hole with the spindle stopped, and bores upwards to K.
    fn back_bore(&mut self, memory: &CycleMemory, hole: &Hole, span: Span) -> Result<(), GcodeError> {
        let [first, second, third] = self.modal.plane.axes();
        let word = |axis: usize| memory.aside.get(axis).copied().flatten();
        let missing = |letter| GcodeErrorKind::from(CycleError::WordMissing { code: memory.code, letter });
        let aside = match (word(first), word(second)) {
            (Some(a), Some(b)) => [a, b],
            (None, _) => return Err(self.error(missing(centre_letter(first)), span)),
            _ => return Err(self.error(missing(centre_letter(second)), span)),
        };
        let Some(top) = word(third) else {
            return Err(self.error(missing(centre_letter(third)), span));
        };
        let top = if self.modal.absolute { top } else { hole.bottom.nm().saturating_add(top) };
        let top = Position::from_nm(top);
        if top < hole.bottom || top > hole.clearance {
            let kind = CycleError::BackBoreTop { top, bottom: hole.bottom, clearance: hole.clearance };
            return Err(self.error(kind.into(), span));
        }
        self.traverse_to(hole.beside(aside, hole.clearance), span)?;
        let spindle = self.stop_for(memory.code, span)?;
        self.traverse_to(hole.beside(aside, hole.bottom), span)?;
        self.traverse_to(hole.at(hole.bottom), span)?;
        self.turn(spindle, span)?;
        self.feed_to(hole.at(top), span)?;
        self.feed_to(hole.at(hole.bottom), span)?;
        self.stop_for(memory.code, span)?;
        self.traverse_to(hole.beside(aside, hole.bottom), span)?;
        self.traverse_to(hole.beside(aside, hole.retract), span)?;
        self.traverse_to(hole.at(hole.retract), span)?;
        self.turn(spindle, span)
    }

    /// Stops the spindle; gives how it turned.
    fn stop_for(&mut self, code: GCode, span: Span) -> Result<Spindle, GcodeError> {
        let before = self.modal.spindle;
        if before == Spindle::Stopped && self.options.machine.is_some() {
            return Err(self.error(CycleError::Spindle { code, needed: Spindle::Clockwise }.into(), span));
        }
        self.turn(Spindle::Stopped, span)?;
        Ok(before)
    }

    /// Changes the spindle.
    pub(super) fn turn(&mut self, to: Spindle, span: Span) -> Result<(), GcodeError> {
        self.modal.spindle = to;
        self.emit(Canon::Spindle(to), span)
    }

    fn cycle_dwell(&mut self, memory: &CycleMemory, span: Span) -> Result<(), GcodeError> {
        match memory.dwell {
            Some(time) => self.emit(Canon::Dwell(time), span),
            None => Err(self.error(CycleError::WordMissing { code: memory.code, letter: b'P' }.into(), span)),
        }
    }
}

/// The letter of a centre coordinate.
pub(super) const fn centre_letter(axis: usize) -> u8 {
    match axis {
        0 => b'I',
        1 => b'J',
        _ => b'K',
    }
}
