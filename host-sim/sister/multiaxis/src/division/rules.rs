//! The rules of division: each gives the inner parameters of a division all of whose pieces are proved to fit.

use super::span::Span;

/// Pieces of one move, at most.
pub const MOST_PIECES: usize = 10_000;

/// How locations are inserted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Rule {
    /// Equal pieces.
    Equal,
    /// Halving, as in the paper.
    ///
    /// Of every piece that errs too much.
    Midpoint,
    /// Every piece as long as it can be.
    Longest,
    /// The one of the three with the fewest pieces.
    ///
    /// Of several the first.
    Fewest,
}

/// Why a move cannot be divided.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum DivisionError {
    /// A number is not finite.
    #[error("a position is not a finite number")]
    NotFinite,
    /// The tolerance is zero, negative or no number.
    #[error("the tolerance {0} mm is not above 0")]
    Tolerance(f64),
    /// More pieces than allowed.
    #[error("more than {MOST_PIECES} pieces would be needed")]
    TooManyPieces,
    /// The tolerance is below what `f64` resolves at this size.
    #[error("the tolerance {0} mm is below the rounding of the computation at these positions")]
    Unprovable(f64),
}

/// A piece narrower than this that does not fit will not fit when it is narrower still: rounding is in the way.
const NARROWEST: f64 = 1e-9;

/// Equal pieces: ⌈√(ε/tolerance)⌉, and more until all fit.
pub(super) fn equal(span: &Span<'_>, error: f64) -> Result<Vec<f64>, DivisionError> {
    let guess = (error / span.tolerance_mm()).sqrt().ceil();
    if guess.is_nan() || guess > MOST_PIECES as f64 {
        return Err(DivisionError::TooManyPieces);
    }
    let mut pieces = (guess as usize).max(2);
    while pieces <= MOST_PIECES {
        let knot = |i: usize| i as f64 / pieces as f64;
        if (0..pieces).all(|i| span.fits(knot(i), knot(i + 1))) {
            return Ok((1..pieces).map(knot).collect());
        }
        // One more; in long divisions in steps of about 1 %.
        pieces += 1 + pieces / 100;
    }
    Err(DivisionError::TooManyPieces)
}

/// Halving of every piece that does not fit.
pub(super) fn midpoint(span: &Span<'_>) -> Result<Vec<f64>, DivisionError> {
    let mut knots = Vec::new();
    let mut start = 0.0;
    // Ends of the pieces still to be looked at, the nearest last.
    let mut ends = vec![1.0];
    while let Some(&end) = ends.last() {
        if span.fits(start, end) {
            ends.pop();
            start = end;
            if end < 1.0 {
                knots.push(end);
            }
        } else {
            if end - start < NARROWEST {
                return Err(DivisionError::Unprovable(span.tolerance_mm()));
            }
            ends.push(f64::midpoint(start, end));
        }
        if knots.len() + ends.len() > MOST_PIECES {
            return Err(DivisionError::TooManyPieces);
        }
    }
    Ok(knots)
}

/// Every piece as long as it can be, from the start on; gives up beyond `most` pieces.
pub(super) fn longest(span: &Span<'_>, most: usize) -> Result<Vec<f64>, DivisionError> {
    let mut knots = Vec::new();
    let mut start = 0.0;
    let mut step: f64 = 1.0;
    while !span.fits(start, 1.0) {
        if knots.len() + 2 > most {
            return Err(DivisionError::TooManyPieces);
        }
        // Between a step that fits and one that does not.
        let (mut fits, mut fails) = (0.0, 1.0 - start);
        let mut next = step.min(fails / 2.0);
        while fails - fits > 1e-3 * fails {
            if span.fits(start, start + next) {
                fits = next;
                next = (fits * 1.1).min(f64::midpoint(fits, fails));
            } else {
                fails = next;
                next = if fits > 0.0 { f64::midpoint(fits, fails) } else { fails / 2.0 };
            }
            if fails < NARROWEST {
                return Err(DivisionError::Unprovable(span.tolerance_mm()));
            }
        }
        step = fits;
        start += fits;
        knots.push(start);
    }
    Ok(knots)
}

/// The shortest of the three.
pub(super) fn fewest(span: &Span<'_>, error: f64) -> Result<(Rule, Vec<f64>), DivisionError> {
    let equal = equal(span, error).map(|knots| (Rule::Equal, knots));
    // One knot cannot be undercut.
    if matches!(&equal, Ok((_, knots)) if knots.len() == 1) {
        return equal;
    }
    let midpoint = midpoint(span).map(|knots| (Rule::Midpoint, knots));
    let best = match (equal, midpoint) {
        (Ok(a), Ok(b)) => Ok(if b.1.len() < a.1.len() { b } else { a }),
        (Ok(a), Err(_)) | (Err(_), Ok(a)) => Ok(a),
        (Err(e), Err(_)) => Err(e),
    };
    // Only fewer pieces are of use.
    let most = best.as_ref().map_or(MOST_PIECES, |(_, knots)| knots.len());
    match longest(span, most) {
        Ok(knots) => Ok((Rule::Longest, knots)),
        Err(_) => best,
    }
}
