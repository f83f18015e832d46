//! The moves of one block: which code moves, and along what.

use super::super::block::BlockWords;
use super::super::compensation::CompensationError;
use super::super::group::Group;
use super::super::{
    Axes, Canon, CycleError, GCode, GcodeError, GcodeErrorKind, Motion, SettingError, Span, WarningKind,
};
use super::Execution;
use super::axes::PLACE_LETTERS;

impl Execution<'_, '_, '_> {
    /// Executes the codes that use axis words: those for one block, then the motion.
    pub(super) fn moves(&mut self, block: &mut BlockWords<'_>) -> Result<(), GcodeError> {
        let explicit = block.code(Group::Motion);
        if let Some((code, span)) = explicit {
            self.set_motion(code, span)?;
        }
        if let Some((code, span)) = block.code(Group::OneShot)
            && self.one_shot(block, code, span)?
        {
            return Ok(());
        }
        let named = block.has_unused(&PLACE_LETTERS);
        if named
            && self.modal.motion.is_none()
            && let Some(motion) = self.before_cycle
        {
            self.warn(WarningKind::MotionBehindCycle, self.first_axis(block));
            self.modal.motion = Some(motion);
        }
        if !named && explicit.is_none() && !block.has_unused(b"IJKRP") {
            return Ok(());
        }
        let span = self.block_span();
        match self.modal.motion {
            None if named => Err(self.error(GcodeErrorKind::NoMotion, self.first_axis(block))),
            None => Ok(()),
            // A bare G0 or G1 goes where the machine stands, which LinuxCNC prints.
            Some(motion @ (Motion::Traverse | Motion::Feed))
                if named || (explicit.is_some() && self.options.machine.is_some()) =>
            {
                let to = self.destination(block)?;
                if motion == Motion::Traverse {
                    return self.traverse_to(to, span);
                }
                self.check_feed()?;
                self.check_revolutions()?;
                match self.corner_word(block)? {
                    Some((corner, word)) => self.feed_to_corner(to, corner, word),
                    None => self.feed_to(to, span),
                }
            }
            Some(Motion::Traverse | Motion::Feed) => Ok(()),
            Some(Motion::Arc { counter_clockwise }) => {
                let [first, second, _] = self.modal.plane.axes();
                let centre = [first, second].map(super::cycle::centre_letter);
                if named || block.has_unused(&centre) || block.has_unused(b"R") || self.options.machine.is_some() {
                    self.arc(block, counter_clockwise)
                } else {
                    Ok(())
                }
            }
            Some(Motion::Spline(code)) if code.tenths() == 52 => self.control_point(block, code),
            Some(motion) => match (motion, explicit) {
                (Motion::Spline(code), _) if named => self.bezier(block, code),
                (Motion::Cycle(code), _) if named => self.cycle(block, code),
                (Motion::Probe { away, must }, _) if named => self.probe(block, away, must),
                (Motion::Tap, _) if named => self.tap(block, GCode::from_tenths(331), span),
                (_, Some((code, span))) => Err(self.error(SettingError::AxesMissing(code).into(), span)),
                _ => Ok(()),
            },
        }
    }

    /// The codes for one block; `true` when nothing more moves in it.
    fn one_shot(&mut self, block: &mut BlockWords<'_>, code: GCode, span: Span) -> Result<bool, GcodeError> {
        let machine = matches!(code.tenths(), 280..=301) || (code.tenths() == 530 && Self::names_axes(block));
        if machine && self.modal.compensated {
            return Err(self.error(CompensationError::Forbidden.into(), span));
        }
        match code.tenths() {
            100 => self.set_table(block, span)?,
            280 | 300 => {
                self.reference(block, code.tenths() == 300, span)?;
                return Ok(true);
            }
            281 | 301 => self.store_reference(code.tenths() == 301, span)?,
            520 => self.local_origin(block, code, span)?,
            920 => self.name_place(block, code, span)?,
            921..=923 => self.local_family(code, span)?,
            530 if Self::names_axes(block) => {
                self.machine_move(block, span)?;
                return Ok(true);
            }
            530 => self.warn(WarningKind::BareG53, span),
            _ => {}
        }
        Ok(false)
    }

    /// G10: which table L names.
    fn set_table(&mut self, block: &mut BlockWords<'_>, span: Span) -> Result<(), GcodeError> {
        let code = GCode::from_tenths(100);
        let Some(word) = block.use_word(b'L') else { return Err(self.word_missing(code, b'L', span)) };
        match self.whole(word)? {
            2 => self.set_work_offset(block, false),
            20 => self.set_work_offset(block, true),
            way @ (1 | 10 | 11) => self.set_tool(block, way),
            // Radius and its wear at Fanuc and Haas: no path depends on D.
            12 | 13 if self.options.dialect.has_macro_b() => {
                for letter in [b'P', b'R'] {
                    block.use_word(letter);
                }
                Ok(())
            }
            // Reloads the tool table.
            0 => Ok(()),
            _ => {
                let kind = SettingError::NotBetween { letter: b'L', least: 0, greatest: 20 };
                Err(self.error(kind.into(), word.span))
            }
        }
    }

    fn first_axis(&self, block: &BlockWords<'_>) -> Span {
        PLACE_LETTERS.iter().find_map(|&l| block.word(l)).map_or(self.block_span(), |w| w.span)
    }

    /// Sets the motion that stays.
    pub(super) fn set_motion(&mut self, code: GCode, span: Span) -> Result<(), GcodeError> {
        let before = self.modal.motion;
        let motion = match code.tenths() {
            0 => Some(Motion::Traverse),
            10 => Some(Motion::Feed),
            20 => Some(Motion::Arc { counter_clockwise: false }),
            30 => Some(Motion::Arc { counter_clockwise: true }),
            50..=52 => Some(Motion::Spline(code)),
            331 => Some(Motion::Tap),
            tenths @ 382..=385 => {
                Some(Motion::Probe { away: matches!(tenths, 384 | 385), must: matches!(tenths, 382 | 384) })
            }
            730 | 740 | 760 | 810..=890 => Some(Motion::Cycle(code)),
            _ => None,
        };
        if code.tenths() == 53 {
            self.end_spline(span)?;
        } else if motion != before {
            if self.splines.is_open() {
                return Err(self.error(CycleError::SplineOpen.into(), span));
            }
            self.splines.interrupted();
            let series = matches!((before, motion), (Some(Motion::Cycle(_)), Some(Motion::Cycle(_))));
            if !series || !self.options.dialect.keeps_words_of_cycles() {
                self.cycle = None;
            }
        }
        if !matches!(motion, Some(Motion::Cycle(_))) {
            self.initial_level = None;
        }
        if matches!(motion, Some(Motion::Traverse | Motion::Feed)) && !self.options.is_linuxcnc_itself() {
            self.before_cycle = motion;
        }
        self.modal.motion = motion;
        Ok(())
    }

    /// Moves there without cutting.
    pub(super) fn traverse_to(&mut self, to: Axes, span: Span) -> Result<(), GcodeError> {
        let from = core::mem::replace(&mut self.at, to);
        self.emit_move(Canon::Traverse { from, to }, span)
    }

    /// Moves there in a line, cutting.
    pub(super) fn feed_to(&mut self, to: Axes, span: Span) -> Result<(), GcodeError> {
        if self.at.point().is_none() && to.point().is_some() {
            let axis = if self.at.x.is_none() { b'X' } else { b'Y' };
            self.warn(WarningKind::StartUnknown { axis }, span);
        }
        let from = core::mem::replace(&mut self.at, to);
        self.emit_move(Canon::Feed { from, to }, span)
    }
}
