//! The stock of a pass as it was touched before it was cut: a probe file → the allowance along the contour.
//!
//! The touches lie on the wall that roughing left, about the job's allowance before the finished one. The file is read as every
//! probe file is; each touch is held against the contour moved by the allowance, its deviation added to that. Touches of one place
//! are averaged over their heights.
//!
//! Limits: one clamping; stock that varies over the height counts by its mean.

use truepath_core::geometry::Contour;
use truepath_core::job::{self, ContourPass, JobError, REACH};
use truepath_core::probe::{Contact, Contacts, CutWith, Outcome, Reading, Rejected, Setting, suspect};
use truepath_core::units::{Offset, Position, Real};
use truepath_ground::diagnostics::{Failure, InputError, Source};
use truepath_ground::length::Unit;
use truepath_ground::rows::median;
use truepath_ground::units::mm;

use crate::allowance::{Allowance, Place};
use crate::codes::{K004, K005, K006};
use crate::feature::Plan;
use crate::job::JobFile;
use crate::probe_format::{LARGEST_FILE, Settled, settled};
use crate::refusal::{line_span, suspected};

/// The stock that was touched.
#[derive(Clone, Debug)]
pub struct ProbedStock {
    /// The allowance along the contour.
    pub allowance: Allowance,
    /// What is said of it.
    pub facts: StockFacts,
}

/// What is said of stock that was touched.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct StockFacts {
    /// Name of the file.
    pub file: String,
    /// Touches used.
    pub touches: usize,
    /// Touches set aside.
    pub set_aside: usize,
    /// Places they are on.
    pub places: usize,
    /// What the job says, mm.
    pub expected_mm: f64,
    /// Mean along the contour, mm.
    pub mean_mm: f64,
    /// Least along the contour, mm.
    pub least_mm: f64,
    /// Most along the contour, mm.
    pub most_mm: f64,
    /// Standard deviation of the allowance, root mean square along the contour, mm.
    pub sigma_mm: f64,
}

impl StockFacts {
    /// In a sentence.
    pub fn text(&self, unit: Unit) -> String {
        let name = unit.name();
        let Self { file, touches, places, expected_mm, mean_mm, least_mm, most_mm, sigma_mm, .. } = self;
        format!(
            "{file}: the stock was touched at {places} places ({touches} touches): {:.3} to {:.3} {name} on the wall, mean {:.3} \
             {name} where the job says {:.3} {name}; known to {:.3} {name} (one sigma)",
            unit.of(*least_mm),
            unit.of(*most_mm),
            unit.of(*mean_mm),
            unit.of(*expected_mm),
            unit.of(*sigma_mm)
        )
    }
}

/// A touch farther from the expected stock than this share of the allowance is of something else.
const WITHIN: Real = Real::ratio(9, 10);
/// Stock with less than this share of the expected allowance is the finished wall, or nearly.
const LEAST: f64 = 0.5;
/// Touches nearer to each other along the contour than this are of one place, mm.
const ONE_PLACE_MM: f64 = 0.5;
/// Places from which stock is said to be known, at least.
const PLACES: usize = 4;
/// Longest stretch without a place, as a share of the contour.
const GAP: f64 = 0.4;
/// Places along the contour at which figures are taken.
const FIGURES: u32 = 200;

/// The pass whose stock was touched.
pub(crate) struct TouchedPass<'a> {
    pub(crate) job: &'a JobFile,
    pub(crate) core: &'a ContourPass,
    pub(crate) plan: Option<&'a Plan>,
    pub(crate) contour: Contour<'a>,
    /// The failure for an error of the core, pointing into the file where the error is there.
    pub(crate) refused: &'a dyn Fn(&JobError) -> Failure,
}

/// The stock of a pass in a file of touches; `None` where another contour of the program was touched and this one was not.
///
/// # Errors
/// What is wrong with the file; `K004` for touches of the finished wall, `K005` for too few, `K006` for touches elsewhere.
pub(crate) fn read(pass: &TouchedPass<'_>, file: &Source) -> Result<Option<ProbedStock>, Failure> {
    let Settled { probe, text, .. } = settled(pass.job, file)?;
    let (file, unit) = (&text, Unit::from(pass.core.contour.units));
    let mut core = pass.core.clone();
    core.job.probe = Some(probe);
    core.cut_with = CutWith::Anything;
    let lines = file.bytes().iter().filter(|b| matches!(b, b'\n' | b'\r')).count() + 1;
    let mut readings = vec![Reading::default(); lines.min(LARGEST_FILE)];
    let count = job::readings(&core, file.bytes(), &mut readings).map_err(|error| (pass.refused)(&error))?;
    readings.truncate(count);
    let finished = of_every_depth(pass, job::setting(&core).map_err(|error| (pass.refused)(&error))?);
    let expected = core.setup.allowance;
    let contour = pass.contour;
    let stock =
        Setting { cutter_radius: finished.cutter_radius - expected, reach: expected.scaled(WITHIN), ..finished };
    let on_stock = Contacts::new(contour, stock);
    let alone = pass.plan.as_ref().is_none_or(|plan| plan.others.is_empty());
    if alone {
        refuse_strange(
            &on_stock,
            Contacts::new(contour, Setting { reach: REACH, ..finished }),
            &readings,
            expected,
            (file, unit),
        )
        .map_err(|error| error.with_keys_in(pass.job.unit))?;
    }
    let mut contacts: Vec<Contact> = readings.iter().filter_map(|r| on_stock.contact(r).ok()).collect();
    contacts.sort_unstable_by_key(|c| (c.s, c.height, c.error, c.line));
    let touched = readings.iter().filter(|r| r.outcome == Outcome::Touched).count();
    if contacts.is_empty() && !alone {
        return Ok(None);
    }
    let mut found: Vec<f64> = contacts.iter().map(|c| mm(expected + c.error)).collect();
    let median = median(&mut found);
    if let Some(first) = contacts.first().filter(|_| median < LEAST * mm(expected)) {
        return Err(finished_wall((file, unit), first.line, median, expected).into());
    }
    let places = places(&contacts, expected, mm(probe.noise));
    let length_mm = mm(contour.length());
    refuse_sparse(&places, &contour, &contacts, (file, unit))?;
    let allowance = Allowance::new(places, (length_mm, contour.is_closed()), mm(expected));
    let allowance = allowance.ok_or_else(|| Failure::Internal("places without an allowance".to_owned()))?;
    let along: Vec<f64> = (0..=FIGURES).map(|k| length_mm * f64::from(k) / f64::from(FIGURES)).collect();
    let mean = |value: &dyn Fn(f64) -> f64| along.iter().map(|s| value(*s)).sum::<f64>() / along.len() as f64;
    let facts = StockFacts {
        file: file.name().to_owned(),
        touches: contacts.len(),
        set_aside: touched - contacts.len(),
        places: allowance.places().len(),
        expected_mm: mm(expected),
        mean_mm: mean(&|s| allowance.at(s)),
        least_mm: along.iter().map(|s| allowance.at(*s)).fold(f64::INFINITY, f64::min),
        most_mm: along.iter().map(|s| allowance.at(*s)).fold(0.0, f64::max),
        sigma_mm: mean(&|s| allowance.sigma_at(s).powi(2)).sqrt(),
    };
    Ok(Some(ProbedStock { allowance, facts }))
}

/// Before any pass the stock stands at every depth of the feature.
fn of_every_depth(pass: &TouchedPass<'_>, setting: Setting) -> Setting {
    let tips = || pass.plan.iter().flat_map(|plan| &plan.passes).filter_map(|depth| depth.z);
    let tip_z: Position = tips().fold(setting.tip_z, Position::min);
    let highest: Position = tips().fold(setting.tip_z, Position::max);
    Setting { tip_z, axial_depth: setting.axial_depth + (highest - tip_z), ..setting }
}

/// Touches averaged over the heights of their place.
fn places(contacts: &[Contact], expected: Offset, noise_mm: f64) -> Vec<Place> {
    let groups: Vec<&[Contact]> = contacts.chunk_by(|a, b| mm(b.s - a.s) < ONE_PLACE_MM).collect();
    let mean = |group: &[Contact], of: fn(&Contact) -> f64| group.iter().map(of).sum::<f64>() / group.len() as f64;
    let error = |c: &Contact| mm(c.error);
    // What the heights of a place differ by is what a touch is uncertain by.
    let squares = groups.iter().map(|group| {
        let middle = mean(group, error);
        group.iter().map(|c| (error(c) - middle).powi(2)).sum::<f64>()
    });
    let freedom = contacts.len() - groups.len();
    let scatter = if freedom > 0 { squares.sum::<f64>() / freedom as f64 } else { 0.0 };
    let variance = scatter.max(noise_mm.powi(2));
    let place = |group: &&[Contact]| Place {
        s_mm: mean(group, |c| mm(c.s)),
        allowance_mm: mm(expected) + mean(group, error),
        sigma_mm: (variance / group.len() as f64).sqrt(),
    };
    groups.iter().map(place).collect()
}

fn finished_wall((file, unit): (&Source, Unit), line: u32, found_mm: f64, expected: Offset) -> InputError {
    let name = unit.name();
    let found = format!(
        "the touches find {:.3} {name} on the nominal wall: they are of the finished wall, not of the stock",
        unit.of(found_mm)
    );
    let expected = unit.of(mm(expected));
    let expected = format!("touches of the stock before the pass, about {expected} {name} before the nominal wall");
    K004.error(found, expected).at(file, line_span(file, line))
}

/// Refuses touches most of which are not on the stock.
fn refuse_strange(
    on_stock: &Contacts<'_>,
    on_wall: Contacts<'_>,
    readings: &[Reading],
    expected: Offset,
    (file, unit): (&Source, Unit),
) -> Result<(), InputError> {
    let touched: Vec<&Reading> = readings.iter().filter(|r| r.outcome == Outcome::Touched).collect();
    let off = |reading: &Reading| {
        matches!(on_stock.contact(reading), Err(Rejected::OffTheWall { .. } | Rejected::Normal { .. }))
    };
    let astray: Vec<&&Reading> = touched.iter().filter(|r| off(r)).collect();
    let Some(first) = astray.first().filter(|_| 2 * astray.len() >= touched.len()) else { return Ok(()) };
    let mut errors: Vec<f64> = touched.iter().filter_map(|r| on_wall.contact(r).ok()).map(|c| mm(c.error)).collect();
    let median = median(&mut errors);
    if 2 * errors.len() > touched.len() && median < LEAST * mm(expected) {
        return Err(finished_wall((file, unit), first.line, median, expected));
    }
    let (guess, help) = suspect(on_stock, readings).map_or_else(
        || (String::new(), K006.remedy),
        |suspicion| {
            let (guess, help) = suspected(suspicion, unit);
            (format!("; {guess}"), help)
        },
    );
    let found = format!(
        "most touches are farther than {:.3} {name} from the expected stock, {} {name} before the nominal wall{guess}",
        unit.of(mm(expected.scaled(WITHIN))),
        unit.of(mm(expected)),
        name = unit.name()
    );
    let error = InputError::new(K006, found, "touches of the stock beside this contour", help);
    Err(error.at(file, line_span(file, first.line)))
}

/// Refuses places between which nothing is known of the stock.
fn refuse_sparse(
    places: &[Place],
    contour: &Contour,
    contacts: &[Contact],
    (file, unit): (&Source, Unit),
) -> Result<(), InputError> {
    let length = mm(contour.length());
    let expected = format!(
        "at least {PLACES} places, no stretch without one longer than {:.1} {}",
        unit.of(GAP * length),
        unit.name()
    );
    let line = contacts.iter().map(|c| c.line).max().unwrap_or(1);
    if places.len() < PLACES {
        let found = format!("the stock was touched at {} places of the contour", places.len());
        return Err(K005.error(found, expected).at(file, line_span(file, line)));
    }
    let (first, last) = (places.first().map_or(0.0, |p| p.s_mm), places.last().map_or(length, |p| p.s_mm));
    let ends = if contour.is_closed() { vec![(last, first + length)] } else { vec![(0.0, first), (last, length)] };
    let between = places.iter().zip(places.iter().skip(1)).map(|(a, b)| (a.s_mm, b.s_mm));
    match between.chain(ends).find(|(from, to)| to - from > GAP * length) {
        None => Ok(()),
        Some((from, to)) => {
            let ([from, to], name) = ([from, to].map(|s| unit.of(s)), unit.name());
            let found = format!("the stock was not touched between {from:.1} and {to:.1} {name} along the contour");
            Err(K005.error(found, expected).at(file, line_span(file, line)))
        }
    }
}
