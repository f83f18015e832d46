//! What every law of correction leaves on the same machine.

use truepath_chart::axis::number;
use truepath_chart::curve::{Band, Curve};
use truepath_chart::panel::{Panel, panels};
use truepath_chart::style::{INK_AFTER, INK_BEFORE, INKS, Ink};
use truepath_chart::view::View;
use truepath_ground::diagnostics::Failure;
use truepath_ground::length::Unit;

/// Spread over the height from which it is drawn, mm.
const HEIGHT_TOLD: f64 = 0.001;

/// The wall one law leaves.
#[derive(Clone, Debug, PartialEq)]
pub struct LawWall {
    /// Name of the law.
    pub law: String,
    /// What it is.
    pub title: String,
    /// Largest error where it is judged, mm.
    pub max_error_mm: Option<f64>,
    /// Arc length, error of the target, lowest and highest over the height, mm.
    pub places: Vec<[f64; 4]>,
}

/// The walls of all laws.
#[derive(Clone, Debug, PartialEq)]
pub struct Compared {
    /// Whether a virtual machine was milled on, or the identified one predicted.
    pub on_plant: bool,
    /// What is not judged at either end, mm.
    pub trim_mm: f64,
    /// One a law, without correction first.
    pub laws: Vec<LawWall>,
}

impl LawWall {
    /// Colour and dashes of a law, the same whichever laws there are.
    fn ink(&self, at: usize) -> Ink {
        match self.law.as_str() {
            "none" => INKS[6],
            "constant" => INKS[4],
            "mirror" => INKS[3],
            "paper" => INK_BEFORE,
            "model" => INK_AFTER,
            _ => INKS[at % INKS.len()],
        }
    }

    fn judged(&self, trim_mm: f64) -> impl Iterator<Item = [f64; 4]> + '_ {
        let ends = truepath_trial::compare::judged(self.places.last().map_or(0.0, |p| p[0]), trim_mm);
        self.places.iter().map(move |p| if ends.contains(&p[0]) { *p } else { [p[0], f64::NAN, f64::NAN, f64::NAN] })
    }

    fn curve(&self, at: usize, trim_mm: f64, unit: Unit) -> Curve {
        let decimals = if unit == Unit::Inch { 4 } else { 3 };
        let largest = self
            .max_error_mm
            .map_or_else(String::new, |max| format!(": largest {} {}", number(unit.said(max), decimals), unit.name()));
        let points = self.judged(trim_mm).map(|p| (unit.said(p[0]), unit.said(p[1]))).collect();
        Curve::new(format!("{}{largest}", self.title), self.ink(at), points)
    }
}

/// Draws the walls of all laws; and again, where some of them make the others a line, those no worse than half again what no
/// correction leaves, with the spread over the height of the last one.
///
/// # Errors
/// As [`panels`].
pub fn compare(view: &View, compared: &Compared) -> Result<Vec<u8>, Failure> {
    let unit = view.unit;
    let worst = |law: &LawWall| law.max_error_mm.unwrap_or(0.0);
    let limit = 1.5 * compared.laws.first().map_or(0.0, worst);
    let each = || compared.laws.iter().enumerate();
    let all: Vec<Curve> = each().map(|(at, law)| law.curve(at, compared.trim_mm, unit)).collect();
    let near = each().filter(|(_, law)| worst(law) <= limit);
    let mut near = Panel::new(
        format!("wall error ({})", unit.name()),
        near.map(|(at, law)| law.curve(at, compared.trim_mm, unit)).collect(),
    );
    // A cutter without helix leaves the same at every height: nothing to show.
    let spread = |p: &[f64; 4]| p[3] - p[2] > HEIGHT_TOLD;
    near.band = compared.laws.last().filter(|law| law.judged(compared.trim_mm).any(|p| spread(&p))).map(|law| Band {
        name: format!("{}: over the height", law.title),
        edges: law.judged(compared.trim_mm).map(|p| (unit.said(p[0]), unit.said(p[2]), unit.said(p[3]))).collect(),
        colour: law.ink(compared.laws.len() - 1).colour,
    });
    let on = if compared.on_plant { "on a virtual machine" } else { "on the identified machine" };
    let whole = Panel::new(format!("wall error ({})", unit.name()), all);
    let rows = if near.curves.len() < whole.curves.len() { vec![whole, near] } else { vec![near] };
    panels(view, &format!("What every law leaves {on}"), &rows)
}
