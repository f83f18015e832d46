//! The pen: where the written program stands, and the words that move it.

use truepath_core::gcode::{Axes, Modal};

use super::fit::Shape;
use super::grid::Grid;
use super::klartext::Drawn;

/// A point of the plane, nanometres, program coordinates.
pub(super) type Place = [f64; 2];

/// The place reached by the text written so far, under the modes of the block being written.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pen {
    pub(super) at: Place,
    grid: Grid,
    absolute: bool,
    absolute_centres: bool,
}

impl Pen {
    pub(super) const fn new(at: Place, modal: &Modal) -> Self {
        Self { at, grid: Grid::of(modal.units), absolute: modal.absolute, absolute_centres: modal.absolute_centres }
    }
    /// The same place under the modes of another block.
    pub(super) const fn under(self, modal: &Modal) -> Self {
        Self::new(self.at, modal)
    }
    pub(super) const fn grid(&self) -> Grid {
        self.grid
    }
    /// Where the grid of written points has its origin: in incremental programs at the present place.
    fn base(&self, axis: usize) -> f64 {
        if self.absolute { 0.0 } else { self.at[axis] }
    }
    /// The place nearest to a point that can be written from here.
    pub(super) fn nearest(&self, point: [i64; 2]) -> Place {
        [0, 1].map(|axis| {
            let base = self.base(axis);
            base + self.grid.nm(self.grid.steps_of(point[axis] as f64 - base))
        })
    }
    /// Whether a point is where the pen is, as far as the grid can tell.
    pub(super) fn is_at(&self, point: [i64; 2]) -> bool {
        [0, 1].into_iter().all(|axis| self.grid.steps_of(point[axis] as f64 - self.at[axis]) == 0)
    }
    /// The value of an X or Y word that leads to `target`.
    pub(super) fn value(&self, axis: usize, target: f64) -> String {
        self.grid.text(self.grid.steps_of(target - self.base(axis)))
    }
    /// Moves along a piece to `target` and gives its words; the centre is in program coordinates.
    pub(super) fn draw(&mut self, target: Place, shape: &Shape) -> String {
        let mut words = format!("X{} Y{}", self.value(0, target[0]), self.value(1, target[1]));
        if let Shape::Arc { centre, .. } = shape {
            let text = |axis: usize| {
                let from = if self.absolute_centres { 0.0 } else { self.at[axis] };
                self.grid.text(self.grid.steps_of(centre[axis] - from))
            };
            words.push_str(&format!(" I{} J{}", text(0), text(1)));
        }
        self.at = target;
        words
    }
    /// The same as the values of a conversational block.
    pub(super) fn drawn(&mut self, target: Place, shape: &Shape) -> Drawn {
        let to = [0, 1].map(|axis| self.value(axis, target[axis]));
        let text = |v: f64| self.grid.text(self.grid.steps_of(v));
        let arc = match shape {
            Shape::Arc { centre, counter_clockwise } => Some((centre.map(text), *counter_clockwise)),
            Shape::Line => None,
        };
        self.at = target;
        Drawn { to, arc }
    }
}

/// The place of a known position.
pub(super) fn place(axes: Axes) -> Option<[i64; 2]> {
    axes.point().map(|p| [p.x.nm(), p.y.nm()])
}
