//! The arguments of calls that move.

use super::number::{Short, push_separated, short_ratio};

/// An argument, with the separator behind it.
#[derive(Clone, Copy)]
pub(super) struct Argument {
    value: i64,
    /// `None` when it is too long: it is written from its value then.
    text: Option<Short>,
}

impl Argument {
    /// A length.
    #[inline]
    pub(super) fn length(value: i64, unit: i64) -> Self {
        Self { value, text: short_ratio(value, unit) }
    }

    /// How often an arc turns, with its direction.
    pub(super) fn turns(clockwise: bool, turns: i64) -> Self {
        Self { value: turns, text: Some(Short::turns(clockwise, turns.unsigned_abs())) }
    }

    /// Its text, when that is short.
    #[inline]
    pub(super) const fn short(&self) -> Option<Short> {
        self.text
    }

    /// Appends it.
    pub(super) fn push(&self, text: &mut Vec<u8>, unit: i64) {
        match self.text {
            Some(short) => short.push(text),
            None => push_separated(text, self.value, unit),
        }
    }
}

/// Where the axes stand: often in the same place for many lines.
pub(super) struct Places {
    unit: i64,
    axes: [Argument; 3],
}

impl Places {
    /// At the origin.
    pub(super) fn new(unit: i64) -> Self {
        Self { unit, axes: [Argument::length(0, unit); 3] }
    }

    /// With the axes where they stand now.
    #[inline]
    pub(super) fn at(&mut self, places: [i64; 3], unit: i64) -> &[Argument; 3] {
        for (axis, value) in self.axes.iter_mut().zip(places) {
            if axis.value != value || unit != self.unit {
                *axis = Argument::length(value, unit);
            }
        }
        self.unit = unit;
        &self.axes
    }
}
