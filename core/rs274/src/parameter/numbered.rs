//! Numbered parameters: those of a call level, and a table of all others.
//!
//! The table is one of open addressing: only numbers that were set take room. Number 0 is Fanuc's "vacant", stands in no
//! table and marks a free place.

use super::super::{Dialect, ParameterError};

/// Local parameters a level has room for: Fanuc's `#1` … `#33`.
pub(super) const LOCALS: usize = 33;
/// Levels of calls, the main program included.
pub(super) const LEVELS: usize = 11;

/// The local parameters of a level.
pub(super) type LocalValues = [f64; LOCALS];

/// Numbered parameters that were set.
#[derive(Debug)]
pub(super) struct Table<'a> {
    numbers: &'a mut [u16],
    values: &'a mut [f64],
}

impl<'a> Table<'a> {
    pub(super) const fn new(numbers: &'a mut [u16], values: &'a mut [f64]) -> Self {
        Self { numbers, values }
    }

    pub(super) fn clear(&mut self) {
        self.numbers.fill(0);
    }

    /// The place of a number, or the free place where it would stand.
    fn place(&self, number: u16) -> Option<usize> {
        let length = self.numbers.len();
        let first = usize::from(number).checked_rem(length)?;
        let (before, after) = self.numbers.split_at_checked(first)?;
        let fits = |n: &u16| *n == number || *n == 0;
        match after.iter().position(fits) {
            Some(steps) => first.checked_add(steps),
            None => before.iter().position(fits),
        }
    }

    pub(super) fn get(&self, number: u16) -> Option<f64> {
        let place = self.place(number)?;
        if self.numbers.get(place) == Some(&number) { self.values.get(place).copied() } else { None }
    }

    pub(super) fn set(&mut self, number: u16, value: f64) -> Result<(), ParameterError> {
        if number == 0 {
            return Err(ParameterError::Number { largest: u16::MAX });
        }
        let full = ParameterError::TooMany { limit: u16::try_from(self.numbers.len()).unwrap_or(u16::MAX) };
        let place = self.place(number).ok_or(full)?;
        let (Some(slot), Some(stored)) = (self.numbers.get_mut(place), self.values.get_mut(place)) else {
            return Err(full);
        };
        *slot = number;
        *stored = value;
        Ok(())
    }
}

/// The local parameters of all levels.
#[derive(Debug)]
pub(in super::super) struct Levels<'a> {
    values: &'a mut [LocalValues; LEVELS],
    depth: u8,
    /// How many numbers are local: 30 in LinuxCNC, 33 in Fanuc.
    locals: u8,
    /// The value of what was never set: 0 in LinuxCNC, no number in Fanuc.
    vacant: f64,
}

impl<'a> Levels<'a> {
    pub(super) const fn new(values: &'a mut [LocalValues; LEVELS]) -> Self {
        Self { values, depth: 0, locals: 30, vacant: 0.0 }
    }

    /// The present level, 0 for the main program.
    pub(in super::super) const fn depth(&self) -> u8 {
        self.depth
    }

    fn index(&self, number: u16) -> Option<usize> {
        if number > u16::from(self.locals) { None } else { usize::from(number).checked_sub(1) }
    }

    pub(super) fn get(&self, number: u16) -> Option<f64> {
        self.values.get(usize::from(self.depth))?.get(self.index(number)?).copied()
    }

    /// Sets a local parameter; `false` when the number is none.
    pub(super) fn set(&mut self, number: u16, value: f64) -> bool {
        let place = self.index(number);
        match (self.values.get_mut(usize::from(self.depth)), place) {
            (Some(level), Some(place)) => level.get_mut(place).is_some_and(|slot| {
                *slot = value;
                true
            }),
            _ => false,
        }
    }

    /// The value of what was never set.
    pub(super) const fn vacant(&self) -> f64 {
        self.vacant
    }

    /// At the start of a program; what the local parameters of the main program hold stays.
    pub(super) fn start(&mut self, dialect: Dialect) {
        self.depth = 0;
        self.locals = dialect.locals();
        self.vacant = if dialect.has_macro_b() { f64::NAN } else { 0.0 };
        if dialect.has_macro_b() {
            self.fill();
        }
    }

    /// One level deeper, where nothing is set. The reader bounds the calls, so there is room.
    pub(super) fn enter(&mut self) {
        self.depth = self.depth.saturating_add(1);
        self.fill();
    }

    /// One level up.
    pub(super) fn leave(&mut self) {
        self.depth = self.depth.saturating_sub(1);
    }

    fn fill(&mut self) {
        if let Some(level) = self.values.get_mut(usize::from(self.depth)) {
            level.fill(self.vacant);
        }
    }

    /// Back to the main program, whose local parameters are 0.
    pub(super) fn clear(&mut self) {
        self.depth = 0;
        self.vacant = 0.0;
        self.fill();
    }
}
