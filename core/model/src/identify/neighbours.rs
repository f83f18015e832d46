//! The machines that lie one standard deviation away from the one that was identified.

use super::fit::Fit;
use super::parameters::{COUNT, Parameter, Parameters, Prior};
use super::solve::square_root;
use truepath_units::Real;

/// 1/√2: of two squares each counts half.
const HALF_OF_SQUARES: Real = Real::ratio(707_106_781, 1_000_000_000);

/// Machines displaced along each column of a square root of the covariance, each with its share: the square root of the sum of
/// the squared changes of a quantity, each times its share, is its standard deviation.
///
/// Difference and cross term of the compliance have the other sign on a part that is turned or mirrored: both ways are gone,
/// each counts half, so that the turned part has the same deviation; to the last bit, because the first is that from what
/// was believed to what was found, which turns as well. The others have one way.
pub fn neighbours<'a>(prior: &'a Prior, fit: &'a Fit) -> impl Iterator<Item = (Parameters, Real)> + 'a {
    let columns = Parameter::ALL.iter().zip(square_root(&fit.covariance));
    let moving = columns.filter(|(_, column)| column.iter().any(|v| v.abs() >= Real::ratio(1, 1000)));
    moving.flat_map(move |(parameter, column)| {
        let turns = matches!(parameter, Parameter::ComplianceDifference | Parameter::ComplianceCross);
        let found = column.iter().zip(&fit.theta).fold(Real::ZERO, |sum, (c, t)| sum + *c * *t);
        let (on, back) = (Real::ONE, Real::from_int(-1));
        let (first, second) = if turns && found < Real::ZERO { (back, on) } else { (on, back) };
        let share = if turns { HALF_OF_SQUARES } else { Real::ONE };
        let displaced = move |way: Real| {
            let mut theta: [Real; COUNT] = fit.theta;
            for (t, c) in theta.iter_mut().zip(&column) {
                *t += *c * way;
            }
            (prior.at(&theta), share)
        };
        [Some(first), turns.then_some(second)].into_iter().flatten().map(displaced)
    })
}
