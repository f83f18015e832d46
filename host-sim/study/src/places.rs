//! Where a user touches the part: the middle of straight walls, the thirds of long ones, seldom a corner, four or so places
//! round a curve. After the first correction three more, where the contour bends most. Or where `truepath probe` would have them.

use truepath_correction::further::next_part;
use truepath_correction::learning::History;
use truepath_correction::verification::{Settings, ball_with_room, plan};
use truepath_ground::diagnostics::Failure;
use truepath_ground::rows::ascending;
use truepath_ground::units::float;
use truepath_job::pass::Pass;

use super::contour::{Contour, Kind, Stretch};
use super::draw::{Draw, rounded};

/// A straight wall is long from here on and gets two places, mm.
const LONG_MM: f64 = 40.0;

/// Shortest straight wall that is touched, mm.
const SHORT_MM: f64 = 14.0;

/// Places at which a user touches the first part, mm along the contour, in its order. `trim` mm at the ends are avoided.
pub fn first(draw: &mut Draw, contour: &Contour, trim: f64) -> Vec<f64> {
    let mut places = Vec::new();
    for stretch in &contour.stretches {
        let length = stretch.to_mm - stretch.from_mm;
        let shares: &[f64] = match stretch.kind {
            Kind::Straight if length >= LONG_MM => &[1.0 / 3.0, 2.0 / 3.0],
            Kind::Straight if length >= SHORT_MM => &[0.5],
            Kind::Straight => &[],
            Kind::Curve => &[0.12, 0.3, 0.5, 0.7, 0.88],
            Kind::Inside | Kind::Outside if length >= LONG_MM => &[0.12, 0.37, 0.62, 0.87],
            // One corner in eight is touched.
            Kind::Inside | Kind::Outside if draw.chance(0.125) => &[0.5],
            Kind::Inside | Kind::Outside => &[],
        };
        for share in shares {
            let place = stretch.from_mm + share * length + draw.between(-0.08, 0.08) * length.min(LONG_MM);
            places.push(rounded(place, 0.1));
        }
    }
    keep(places, contour, trim)
}

/// What a verification program of a job would touch.
#[derive(Clone, Debug)]
pub struct Chosen {
    /// Places, mm along the contour.
    pub places_mm: Vec<f64>,
    /// Heights, shares of the depth.
    pub levels: Vec<f64>,
    /// The ball that the plan advises in place of the job's, mm.
    pub smaller_ball_mm: Option<f64>,
}

/// The places that a verification program of the job would touch.
///
/// # Errors
/// A contour that cannot be touched.
pub fn chosen(pass: &Pass) -> Result<Chosen, Failure> {
    let plan = plan(pass, &Settings::default(), &mut |_| ())?;
    let depth = float(pass.core.setup.axial_depth);
    let heights = plan.places.first().map(|place| place.heights.as_slice()).unwrap_or_default();
    let levels = heights.iter().map(|height| height.above_tip_mm / depth).collect();
    let places_mm = plan.places.iter().map(|place| place.s_mm).collect();
    Ok(Chosen { places_mm, levels, smaller_ball_mm: plan.smaller_ball_mm })
}

/// The same, by a job with the ball that the plan advises where that is asked for: `with_ball` reads the job with another one.
/// Gives the pass, and the ball if it is another.
///
/// # Errors
/// A contour that cannot be touched.
pub fn chosen_with_ball(
    pass: Pass,
    advised: bool,
    with_ball: impl FnOnce(f64) -> Result<Pass, Failure>,
) -> Result<(Pass, Option<f64>, Chosen), Failure> {
    let chosen = chosen(&pass);
    let smaller = match &chosen {
        _ if !advised => None,
        Ok(chosen) => chosen.smaller_ball_mm,
        Err(_) => ball_with_room(&pass, &Settings::default()),
    };
    let Some(smaller) = smaller else { return Ok((pass, None, chosen?)) };
    let pass = with_ball(smaller)?;
    let chosen = self::chosen(&pass)?;
    Ok((pass, Some(smaller), chosen))
}

/// The places of the next part that `truepath probe --next` would touch, given the parts of a history, mm along the contour.
///
/// # Errors
/// A contour that cannot be touched.
pub fn chosen_next(pass: &Pass, history: &History) -> Result<Vec<f64>, Failure> {
    let settings = Settings { exactly: true, ..Settings::default() };
    let plan = next_part(pass, history, None, &settings, &mut |_| ())?;
    Ok(plan.places.iter().map(|place| place.s_mm).collect())
}

/// `count` places spread evenly over the contour.
pub fn spread(contour: &Contour, trim: f64, count: usize) -> Vec<f64> {
    let room = contour.length_mm() - 2.0 * trim;
    let place = |k: usize| rounded(trim + room * (k as f64 + 0.5) / count as f64, 0.1);
    keep((0..count).map(place).collect(), contour, trim)
}

/// Three more places, where the contour bends most: in one corner its beginning, middle and end, in two the middles and
/// the beginning of the first, in more the middles of three of them; on a curve the thirds between the first places.
pub fn more(contour: &Contour, trim: f64) -> Vec<f64> {
    let at = |stretch: &Stretch, share: f64| stretch.from_mm + share * (stretch.to_mm - stretch.from_mm);
    let bent: Vec<&Stretch> = contour.stretches.iter().filter(|s| s.kind != Kind::Straight).collect();
    let places = match bent.as_slice() {
        [] => [0.2, 0.5, 0.8].map(|share| share * contour.length_mm()).to_vec(),
        [one] if one.to_mm - one.from_mm >= LONG_MM => [0.21, 0.5, 0.79].map(|share| at(one, share)).to_vec(),
        [one] => [0.05, 0.5, 0.95].map(|share| at(one, share)).to_vec(),
        [one, two] => vec![at(one, 0.1), at(one, 0.6), at(two, 0.5)],
        many => [0, many.len() / 2, many.len() - 1].map(|k| at(many[k], 0.5)).to_vec(),
    };
    keep(places.into_iter().map(|s| rounded(s, 0.1)).collect(), contour, trim)
}

/// The two lists in the order of the contour, places nearer than 1 mm to another left out.
pub fn together(first: &[f64], more: &[f64]) -> Vec<f64> {
    let mut all: Vec<f64> = first.iter().chain(more).copied().collect();
    ascending(&mut all);
    all.dedup_by(|b, a| *b - *a < 1.0);
    all
}

fn keep(mut places: Vec<f64>, contour: &Contour, trim: f64) -> Vec<f64> {
    let end = contour.length_mm() - trim;
    places.retain(|s| (trim..=end).contains(s));
    ascending(&mut places);
    places
}
