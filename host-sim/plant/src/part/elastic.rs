//! Zeros of small steep problems: a displacement that its own force answers with itself.

use crate::vector::{Point, add, along, dot, norm, scaled, sub};

/// What a search keeps from one place to the next: the displacement, and how the answer changes with it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Guess {
    pub(super) at: Point,
    /// About the inverse of the slope of (displacement − answer).
    inverse: [Point; 2],
}

/// Steps of the search that learns the slope.
const STEPS: usize = 30;
/// Careful steps after it.
const CAREFUL: usize = 80;
/// No step is longer, mm.
const LONGEST_MM: f64 = 0.2;
/// Halvings of an interval about a kink.
const HALVINGS: usize = 40;

impl Guess {
    pub(super) const REST: Self = Self { at: [0.0; 2], inverse: [[0.8, 0.0], [0.0, 0.8]] };

    /// Finds the displacement that `answer` gives back, to `closed` mm; returns by how much it stayed open.
    ///
    /// Broyden's method, which keeps what it learnt for the next place; after that damped steps; and where the answer has a kink
    /// or a jump, halving along `normal`.
    pub(super) fn settle(&mut self, normal: Point, closed: f64, mut answer: impl FnMut(Point) -> Point) -> f64 {
        let mut open = |d: Point| sub(answer(d), d);
        let mut d = self.at;
        let mut r = open(d);
        let (mut best, mut least) = (d, norm(r));
        for _ in 0..STEPS {
            if least < closed {
                self.at = best;
                return least;
            }
            let [a, b] = self.inverse;
            let mut step = [dot(a, r), dot(b, r)];
            let long = norm(step);
            if !long.is_finite() {
                self.inverse = Self::REST.inverse;
                continue;
            }
            if long > LONGEST_MM {
                step = scaled(step, LONGEST_MM / long);
            }
            let next = add(d, step);
            let answered = open(next);
            let change = sub(r, answered);
            let guessed = [dot(a, change), dot(b, change)];
            let size = dot(step, guessed);
            if size.abs() > 1e-4 * dot(step, step) {
                // H + (s − H·y)(sᵀH)/(sᵀ·H·y)
                let left = scaled(sub(step, guessed), 1.0 / size);
                let right = [step[0] * a[0] + step[1] * b[0], step[0] * a[1] + step[1] * b[1]];
                self.inverse = [along(a, right, left[0]), along(b, right, left[1])];
            } else {
                self.inverse = Self::REST.inverse;
            }
            (d, r) = (next, answered);
            let size = norm(r);
            if size < least {
                (best, least) = (d, size);
            } else if size > 4.0 * least {
                self.inverse = [scaled(Self::REST.inverse[0], 0.3), scaled(Self::REST.inverse[1], 0.3)];
                d = best;
                r = open(d);
            }
        }
        self.inverse = Self::REST.inverse;
        (d, r) = (best, open(best));
        for turn in 0..CAREFUL {
            if least < closed {
                break;
            }
            d = along(d, r, 0.2 / (1.0 + turn as f64 / 15.0));
            r = open(d);
            if norm(r) < least {
                (best, least) = (d, norm(r));
            }
        }
        if least >= closed {
            let (place, size) = halved(best, normal, least, &mut open);
            if size < least {
                (best, least) = (place, size);
            }
        }
        self.at = best;
        least
    }
}

/// Halves the displacement along `normal`, with the part across it following, until the two sides of a kink meet.
fn halved(start: Point, normal: Point, size: f64, open: &mut impl FnMut(Point) -> Point) -> (Point, f64) {
    let mut side = |x: f64, d: Point| {
        let d = along(d, normal, x);
        (d, dot(open(d), normal))
    };
    let (mut lo, mut hi, mut width) = (0.0, 0.0, size.max(1e-4));
    while side(lo, start).1 < 0.0 && width < 1.0 {
        lo -= width;
        width *= 2.0;
    }
    width = size.max(1e-4);
    while side(hi, start).1 > 0.0 && width < 1.0 {
        hi += width;
        width *= 2.0;
    }
    for _ in 0..HALVINGS {
        let middle = 0.5 * (lo + hi);
        if side(middle, start).1 >= 0.0 { lo = middle } else { hi = middle }
    }
    // Where the force jumps, it is between its values on the two sides; what remains is open across the normal only.
    let d = along(start, normal, 0.5 * (lo + hi));
    let r = open(d);
    let across = sub(r, scaled(normal, dot(r, normal)));
    (d, norm(across).max(hi - lo))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_steep_answer_is_found_and_the_slope_is_kept() {
        // d = C·k·(x0 − d) with a gain of 20: plain repetition diverges.
        let answer = |d: Point| [20.0 * (0.1 - d[0]) + 0.3 * d[1], 0.2 * d[0] - 3.0 * d[1]];
        let mut guess = Guess::REST;
        assert!(guess.settle([1.0, 0.0], 1e-9, answer) < 1e-9);
        let found = guess.at;
        assert!(norm(sub(answer(found), found)) < 1e-8);
        let mut calls = 0;
        guess.settle([1.0, 0.0], 1e-9, |d| {
            calls += 1;
            add(answer(d), [0.001, 0.0])
        });
        assert!(calls <= 6, "{calls}");
    }

    #[test]
    fn a_jump_is_met_from_both_sides() {
        let answer = |d: Point| if d[0] < 0.05 { [0.2, 0.0] } else { [-0.1, 0.0] };
        let mut guess = Guess::REST;
        let open = guess.settle([1.0, 0.0], 1e-6, answer);
        assert!(open < 1e-6 && (guess.at[0] - 0.05).abs() < 1e-6, "{open} {guess:?}");
    }
}
