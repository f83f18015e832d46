//! Which column is which force: axes, signs and units, held against what a cut of this geometry can make.
//!
//! Whatever the metal, the tangential force drives the cutter back and the radial one pushes the edge off, and is the smaller
//! of both. The means of a cut give the two as if there were chip force alone; of the eight ways to name two columns with
//! their signs, seven make a negative force or a radial one above the tangential in a slot. In a partial cut a second way may pass:
//! there the shape of a revolution decides (`analysis`).

use crate::cut::{Cut, Term};

/// How two columns become forces on the tool.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Assignment {
    /// Whether the first column is across the feed.
    pub swapped: bool,
    /// Signs of the forces along the feed and across it.
    pub signs: [f64; 2],
}

/// Radial over tangential force, the whole of both, that metals and edges make: 0.1 with a sharp rake, above 1 where the edge
/// rubs.
const RADIAL: [f64; 2] = [0.03, 1.15];
/// Tangential force over the area of the chip, N/mm²: soft aluminium to hard steel with thin chips.
const SPECIFIC: [f64; 2] = [60.0, 40_000.0];

impl Assignment {
    /// The columns as named.
    pub const NAMED: Self = Self { swapped: false, signs: [1.0, 1.0] };

    /// All of them.
    pub fn every() -> impl Iterator<Item = Self> {
        let signs = [[1.0, 1.0], [-1.0, -1.0], [1.0, -1.0], [-1.0, 1.0]];
        [false, true].into_iter().flat_map(move |swapped| signs.into_iter().map(move |signs| Self { swapped, signs }))
    }

    /// Forces on the tool, feed and across, from two columns.
    pub fn apply(self, [first, second]: [f64; 2]) -> [f64; 2] {
        let [feed, across] = if self.swapped { [second, first] } else { [first, second] };
        [self.signs[0] * feed, self.signs[1] * across]
    }

    /// The same of whole signals.
    pub fn apply_all(self, [first, second]: [Vec<f64>; 2]) -> [Vec<f64>; 2] {
        let [feed, across] = if self.swapped { [second, first] } else { [first, second] };
        let turned = |values: Vec<f64>, sign: f64| values.into_iter().map(|v| sign * v).collect();
        [turned(feed, self.signs[0]), turned(across, self.signs[1])]
    }

    /// In the words of `[record]`, for columns that were multiplied by `applied` before.
    pub fn words(self, columns: [&str; 2], applied: [f64; 2]) -> String {
        let [feed, across] = if self.swapped { [1, 0] } else { [0, 1] };
        let named = |k: usize, sign: f64| format!("{}{}", if sign * applied[k] < 0.0 { "-" } else { "" }, columns[k]);
        let (feed, across) = (named(feed, self.signs[0]), named(across, self.signs[1]));
        format!("feed = \"{feed}\", across = \"{across}\", force_on = \"tool\"")
    }
}

/// Tangential and radial force over the chip alone, N/mm², that make two means.
pub fn secant(cut: &Cut, [feed, across]: [f64; 2]) -> [f64; 2] {
    let chip = cut.mean(Term::Chip);
    // feed = −Kt·c − Kr·s, across = Kt·s − Kr·c.
    let size = chip.cos * chip.cos + chip.sin * chip.sin;
    [(chip.sin * across - chip.cos * feed) / size, (-chip.sin * feed - chip.cos * across) / size]
}

/// Whether forces on the tool can be those of the cuts.
pub fn is_possible(forces: &[(&Cut, [f64; 2])]) -> bool {
    let mut sum = [0.0; 2];
    for (cut, force) in forces {
        let [t, r] = secant(cut, *force);
        sum = [sum[0] + t, sum[1] + r];
    }
    sum[0] > 0.0 && (RADIAL[0]..=RADIAL[1]).contains(&(sum[1] / sum[0]))
}

/// The assignments under which columns can be forces of the cuts.
pub fn possible(columns: &[(&Cut, [f64; 2])]) -> Vec<Assignment> {
    let applied = |a: Assignment| columns.iter().map(|(cut, pair)| (*cut, a.apply(*pair))).collect::<Vec<_>>();
    Assignment::every().filter(|a| is_possible(&applied(*a))).collect()
}

/// By what a unit is wrong, 1 where forces are those of metals: 1000 for kilonewtons read as newtons.
pub fn wrong_unit(forces: &[(&Cut, [f64; 2])]) -> Option<f64> {
    let mean = forces.iter().map(|(cut, force)| {
        let [t, r] = secant(cut, *force);
        t.hypot(r)
    });
    let mean = mean.sum::<f64>() / forces.len().max(1) as f64;
    let within = |by: f64| (SPECIFIC[0]..=SPECIFIC[1]).contains(&(by * mean));
    if within(1.0) { None } else { [1000.0, 0.001].into_iter().find(|by| within(*by)).or(Some(1.0)) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    fn cut(arc_rad: [f64; 2]) -> Cut {
        Cut {
            diameter_mm: 25.0,
            teeth: 2,
            helix_deg: 45.0,
            axial_depth_mm: 3.0,
            arc_rad,
            feed_per_tooth_mm: 0.1,
            spindle_rpm: 6000.0,
        }
    }

    #[test]
    fn of_eight_ways_to_name_the_columns_of_a_slot_one_is_possible() {
        let slot = cut([0.0, PI]);
        // Fx and Fy of the public record: the axes are swapped.
        let found = possible(&[(&slot, [171.27, -76.75])]);
        assert_eq!(found, [Assignment { swapped: true, signs: [1.0, 1.0] }]);
        assert_eq!(found[0].words(["Fx", "Fy"], [1.0; 2]), "feed = \"Fy\", across = \"Fx\", force_on = \"tool\"");
        assert_eq!(possible(&[(&slot, [76.75, -171.27])]), [Assignment { swapped: false, signs: [-1.0, -1.0] }]);
    }

    #[test]
    fn the_true_assignment_is_possible_at_every_engagement() {
        for arc in [[0.0, 0.6], [0.0, 1.2], [PI - 0.6, PI], [PI - 1.3, PI], [0.5, 2.4]] {
            let cut = cut(arc);
            let (chip, edge) = (cut.mean(Term::Chip), cut.mean(Term::Edge));
            let (kt, ke, rt, re) = (767.0, 27.7, 168.8, 26.6);
            let feed = -(kt * chip.cos + ke * edge.cos) - (rt * chip.sin + re * edge.sin);
            let across = kt * chip.sin + ke * edge.sin - (rt * chip.cos + re * edge.cos);
            assert!(is_possible(&[(&cut, [feed, across])]), "{arc:?}");
            assert_eq!(wrong_unit(&[(&cut, [feed, across])]), None);
            assert_eq!(wrong_unit(&[(&cut, [1e-3 * feed, 1e-3 * across])]), Some(1000.0));
        }
    }
}
