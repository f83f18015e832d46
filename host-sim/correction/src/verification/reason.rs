//! Why a place is touched, in words.

use truepath_core::identify::{Parameter, Prior};
use truepath_core::units::{Offset, Real};
use truepath_ground::length::Unit;

use super::candidates::{Form, Site};
use super::covariance::Covariance;

/// An unknown and what the plan leaves of its uncertainty.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Unknown {
    /// Its name in reports.
    pub name: &'static str,
    /// In a machinist's words.
    pub words: &'static str,
    /// Standard deviation after the touches over that before, 0…1.
    pub remaining: f64,
    /// Whether the touches at least halve it.
    pub observable: bool,
}

/// An unknown counts as told by a place that takes this share of what is uncertain about it.
const TOLD: f64 = 0.15;
/// What is beside the model is named from this standard deviation on, mm.
const WORTH_NAMING: f64 = 0.0005;
/// Unknowns named for one place at most.
const NAMED: usize = 3;

const fn words(parameter: Parameter) -> &'static str {
    match parameter {
        Parameter::Compliance => "stiffness",
        Parameter::ComplianceDifference => "stiffness of X against Y",
        Parameter::ComplianceCross => "cross stiffness",
        Parameter::RadialRatio => "ratio of radial to tangential force",
        Parameter::EdgeLevel => "edge force",
        Parameter::EdgeRatio => "ratio of the edge forces",
        Parameter::Bend => "bending over height",
        Parameter::SizeExponent => "size exponent of the chip",
        Parameter::Undersize => "radius of the cutter",
        Parameter::DatumX => "datum shift in X",
        Parameter::DatumY => "datum shift in Y",
    }
}

/// What the plan leaves of every unknown that the job leaves open.
pub(super) fn unknowns(known: &Covariance, prior: &Prior) -> Vec<Unknown> {
    open(prior)
        .map(|(k, parameter)| {
            let remaining = known.remaining(k);
            Unknown { name: parameter.name(), words: words(parameter), remaining, observable: remaining <= 0.5 }
        })
        .collect()
}

fn open(prior: &Prior) -> impl Iterator<Item = (usize, Parameter)> {
    let sigma = prior.sigma;
    Parameter::ALL.into_iter().enumerate().filter(move |(k, _)| sigma[*k] != Real::ZERO)
}

/// What is there, in the unit of the program: `inside corner, wall radius 9 mm, facing X+ Y-`.
pub(super) fn place(site: &Site, unit: Unit) -> String {
    let name = unit.name();
    let form = match site.form {
        Form::Straight => "straight wall".to_owned(),
        Form::InsideArc(r) => format!("inside corner, wall radius {:.3} {name}", unit.of(r)),
        Form::OutsideArc(r) => format!("outside corner, wall radius {:.3} {name}", unit.of(r)),
    };
    let steady = if site.unsteady == Offset::ZERO { "" } else { ", where the load changes" };
    format!("{form}, facing {}{steady}", facing(site.normal))
}

/// Where a wall looks, from its normal towards the material: along the axes it has more than 10° of.
fn facing(normal: [f64; 2]) -> String {
    let axis = |name: &str, v: f64| (v.abs() > 0.17).then(|| format!("{name}{}", if v > 0.0 { '-' } else { '+' }));
    [axis("X", normal[0]), axis("Y", normal[1])].into_iter().flatten().collect::<Vec<_>>().join(" ")
}

/// What the touches there tell: `tells stiffness 100 -> 12 %, …`, the share of its uncertainty
/// before and after; and what stock and wall do there that no parameter says, the standard deviation before and after, mm.
pub(super) fn tells([before, after]: [&Covariance; 2], beside: [f64; 2], prior: &Prior, unit: Unit) -> String {
    let mut told: Vec<(f64, String)> = open(prior)
        .map(|(k, parameter)| (before.remaining(k), after.remaining(k), parameter))
        .filter(|(before, after, _)| 1.0 - after / before > TOLD)
        .map(|(before, after, parameter)| {
            let text = format!("{} {:.0} -> {:.0} %", words(parameter), 100.0 * before, 100.0 * after);
            (after / before, text)
        })
        .collect();
    told.sort_by(|a, b| a.0.total_cmp(&b.0));
    let of_parameters = told.into_iter().take(NAMED).map(|(_, text)| text);
    let [open, left] = beside;
    let is_told = 1.0 - left / open > TOLD && open >= WORTH_NAMING;
    let of_place = is_told.then(|| {
        let (open, left) = (unit.of(open), unit.of(left));
        format!("what only this place has (uneven stock, a wall that yields) {open:.4} -> {left:.4} {}", unit.name())
    });
    let names: Vec<String> = of_parameters.chain(of_place).collect();
    if names.is_empty() {
        "sharpens what the others tell, and shows when one of them is wrong".to_owned()
    } else {
        format!("tells {}", names.join(", "))
    }
}
