//! Cutting force of a helical cutter at any instant, and its mean over a revolution.
//!
//! A flute is followed in immersion angle instead of height: along a helical edge φ and z are proportional, so the force on the
//! engaged part of a flute is a difference of one primitive G(φ) = ∫₀^φ g dφ of the force density g per unit depth. Only G is
//! tabulated (once per feed); instants, heights and engaged arcs need no further integration and are exact to the table's 10⁻⁹.
//!
//! Per tooth and unit depth: tangential `Ktc·h·(h/0.05)^(−m) + Kte`, radial likewise, chip thickness `h = f·sin φ` plus what
//! runout adds: a tooth cuts what the teeth before it left, `h = min over k of (k·f·sin φ + R_j − R_(j−k))`, nothing if negative.
//! Resolved along n and t as in the general form of P23 eq (1), for the force on the tool.
//!
//! Limits: circular tooth paths (f « r), edge force only where a chip is cut, no dynamics.

use std::f64::consts::PI;

use super::arcs::EngagedArcs;
use super::chip::{chip_thickness, density};
use super::machine::Machine;
use super::setup::Cut;

/// Cells of the primitive over 0…π.
const CELLS: usize = 1024;
/// Below this lag over the whole depth the flutes count as straight, rad.
const STRAIGHT_RAD: f64 = 1e-6;

/// (n, t) components of a force on the tool, N (or N/mm for densities).
pub type NormalTangential = [f64; 2];

/// One node of the primitive: values and slopes of the chip and the edge part.
#[derive(Debug, Clone, Copy, Default)]
struct Node {
    sum: [f64; 4],
    slope: [f64; 4],
}

/// Force model of the cutter at one feed.
#[derive(Debug, Clone)]
pub struct Flutes {
    teeth: usize,
    depth: f64,
    lag_rad_per_mm: f64,
    /// +1: φ grows as the cutter turns (conventional); −1: it falls (climb).
    sense: f64,
    /// One table, or one a tooth with runout.
    tables: Vec<Vec<Node>>,
    /// Their mean, if there are several.
    mean: Option<Vec<Node>>,
}

impl Flutes {
    /// Tabulates the force for `feed_mm_per_min`.
    pub fn new(cut: &Cut, machine: &Machine, climb: bool, feed_mm_per_min: f64) -> Self {
        let feed = cut.feed_per_tooth_mm(feed_mm_per_min);
        let sense = if climb { -1.0 } else { 1.0 };
        let tables: Vec<Vec<Node>> = (0..machine.runout_mm.len().max(1))
            .map(|tooth| {
                let chip = |phi: f64| chip_thickness(phi, feed, tooth, &machine.runout_mm);
                tabulate(|phi| density(machine, sense, phi, chip(phi)))
            })
            .collect();
        Self {
            teeth: cut.teeth,
            depth: cut.axial_depth_mm,
            lag_rad_per_mm: cut.helix_deg.to_radians().tan() / cut.radius_mm,
            sense,
            mean: (tables.len() > 1).then(|| averaged(&tables)),
            tables,
        }
    }

    /// Lag of the edge per height, rad/mm.
    pub(super) fn lag_rad_per_mm(&self) -> f64 {
        self.lag_rad_per_mm
    }

    /// +1 where φ grows as the cutter turns (conventional), −1 where it falls (climb).
    pub(super) fn sense(&self) -> f64 {
        self.sense
    }

    /// Teeth of the cutter.
    pub(super) fn teeth(&self) -> usize {
        self.teeth
    }

    /// ∫₀^φ g dφ of the force density g per unit depth of a tooth, or of the mean of all; `edge_factor` multiplies the edge part.
    pub(super) fn primitive(&self, tooth: Option<usize>, phi: f64, edge_factor: f64) -> NormalTangential {
        let sum = sum_at(self.table(tooth), phi);
        [sum[0] + edge_factor * sum[2], sum[1] + edge_factor * sum[3]]
    }

    /// The force density of a tooth, N/mm.
    pub(super) fn density(&self, tooth: usize, phi: f64, edge_factor: f64) -> NormalTangential {
        let g = slope_at(self.table(Some(tooth)), phi);
        [g[0] + edge_factor * g[2], g[1] + edge_factor * g[3]]
    }

    fn table(&self, tooth: Option<usize>) -> &[Node] {
        match (tooth, &self.mean) {
            (None, Some(mean)) => mean,
            (None, None) => &self.tables[0],
            (Some(tooth), _) => &self.tables[tooth % self.tables.len()],
        }
    }

    /// Teeth that pass the wall differently: 1, or all of them with runout.
    pub fn distinct_teeth(&self) -> usize {
        self.tables.len()
    }

    /// Mean force over a revolution, N. `edge_factor` multiplies the edge part (wear).
    pub fn mean(&self, arcs: &EngagedArcs, edge_factor: f64) -> NormalTangential {
        let per_table = self.teeth as f64 * self.depth / (2.0 * PI) / self.tables.len() as f64;
        let mut force = [0.0; 2];
        for &[a, b] in arcs.intervals() {
            for table in &self.tables {
                accumulate(&mut force, table, a, b, per_table, edge_factor);
            }
        }
        force
    }

    /// Force at the instant at which `tooth` makes the wall at `height_mm` above the tip, N.
    pub fn at_wall(&self, tooth: usize, height_mm: f64, arcs: &EngagedArcs, edge_factor: f64) -> NormalTangential {
        self.at_immersion(tooth, self.sense * self.lag_rad_per_mm * height_mm, arcs, edge_factor)
    }

    /// Force at the instant at which the tip of `tooth` is at the immersion `tip_rad`, N.
    pub fn at_immersion(&self, tooth: usize, tip_rad: f64, arcs: &EngagedArcs, edge_factor: f64) -> NormalTangential {
        let pitch = 2.0 * PI / self.teeth as f64;
        let lag = self.lag_rad_per_mm * self.depth;
        let around = 2 * self.teeth as i64;
        let mut force = [0.0; 2];
        for later in -around..=around {
            let tip = tip_rad - self.sense * pitch * later as f64;
            let top = tip - self.sense * lag;
            let (lo, hi) = (tip.min(top), tip.max(top));
            let which = (tooth as i64 + later).rem_euclid(self.teeth as i64) as usize;
            let table = &self.tables[which % self.tables.len()];
            for &[a, b] in arcs.intervals() {
                if lag < STRAIGHT_RAD {
                    if tip >= a && tip <= b {
                        let g = slope_at(table, tip);
                        force[0] += self.depth * (g[0] + edge_factor * g[2]);
                        force[1] += self.depth * (g[1] + edge_factor * g[3]);
                    }
                } else if lo < b && hi > a {
                    accumulate(&mut force, table, lo.max(a), hi.min(b), 1.0 / self.lag_rad_per_mm, edge_factor);
                }
            }
        }
        force
    }
}

/// Primitive over 0…π by Simpson's rule per cell.
fn tabulate(g: impl Fn(f64) -> [f64; 4]) -> Vec<Node> {
    let cell = PI / CELLS as f64;
    let mut node = Node { sum: [0.0; 4], slope: g(0.0) };
    let mut table = vec![node];
    for k in 1..=CELLS {
        let (mid, end) = (g((k as f64 - 0.5) * cell), g(k as f64 * cell));
        for i in 0..4 {
            node.sum[i] += cell / 6.0 * (node.slope[i] + 4.0 * mid[i] + end[i]);
        }
        node.slope = end;
        table.push(node);
    }
    table
}

/// The mean of several primitives.
fn averaged(tables: &[Vec<Node>]) -> Vec<Node> {
    let share = 1.0 / tables.len() as f64;
    let node = |k: usize| {
        let mut mean = Node::default();
        for table in tables {
            for i in 0..4 {
                mean.sum[i] += share * table[k].sum[i];
                mean.slope[i] += share * table[k].slope[i];
            }
        }
        mean
    };
    (0..=CELLS).map(node).collect()
}

/// Adds `scale · (G(b) − G(a))`, chip and edge part together.
fn accumulate(force: &mut [f64; 2], table: &[Node], a: f64, b: f64, scale: f64, edge: f64) {
    let (from, to) = (sum_at(table, a), sum_at(table, b));
    for i in 0..2 {
        force[i] += scale * (to[i] - from[i] + edge * (to[i + 2] - from[i + 2]));
    }
}

fn cell_of(phi: f64) -> (usize, f64) {
    let x = (phi / PI).clamp(0.0, 1.0) * CELLS as f64;
    let k = (x as usize).min(CELLS - 1);
    (k, x - k as f64)
}

/// Hermite interpolation of the primitive.
fn sum_at(table: &[Node], phi: f64) -> [f64; 4] {
    let (k, u) = cell_of(phi);
    let (p, q) = (&table[k], &table[k + 1]);
    let cell = PI / CELLS as f64;
    let v = 1.0 - u;
    std::array::from_fn(|i| {
        p.sum[i] * v * v * (1.0 + 2.0 * u)
            + q.sum[i] * u * u * (3.0 - 2.0 * u)
            + cell * u * v * (v * p.slope[i] - u * q.slope[i])
    })
}

fn slope_at(table: &[Node], phi: f64) -> [f64; 4] {
    let (k, u) = cell_of(phi);
    std::array::from_fn(|i| table[k].slope[i] * (1.0 - u) + table[k + 1].slope[i] * u)
}

#[cfg(test)]
mod tests {
    use super::super::setup::Spindle;
    use super::*;

    fn cut() -> Cut {
        Cut {
            radius_mm: 10.0,
            teeth: 6,
            helix_deg: 30.0,
            axial_depth_mm: 10.0,
            feed_mm_per_min: 400.0,
            feed_changes: vec![],
            spindle_rpm: 1500.0,
            spindle: Spindle::Clockwise,
            allowance_mm: 3.0,
            surface: None,
            memory_mm: None,
        }
    }

    fn p6m5() -> Machine {
        Machine { ktc_n_per_mm2: 1147.7, krc_n_per_mm2: 0.3 * 1147.7, ..Machine::rigid() }
    }

    /// Coefficients identified from published slotting records.
    fn measured() -> Machine {
        Machine {
            ktc_n_per_mm2: 958.86,
            kte_n_per_mm: 15.758,
            krc_n_per_mm2: 250.863,
            kre_n_per_mm: 19.434,
            ..Machine::rigid()
        }
    }

    fn flutes(cut: &Cut, machine: &Machine, climb: bool) -> Flutes {
        Flutes::new(cut, machine, climb, cut.feed_mm_per_min)
    }

    fn straight() -> EngagedArcs {
        EngagedArcs::up_to(45.573f64.to_radians())
    }

    #[test]
    fn the_mean_force_of_the_papers_corner_is_150_n_straight_and_390_n_in_the_arc() {
        let f = flutes(&cut(), &p6m5(), true);
        let size = |deg: f64| {
            let [n, t] = f.mean(&EngagedArcs::up_to(deg.to_radians()), 1.0);
            n.hypot(t)
        };
        assert!((size(45.573) - 150.0).abs() < 0.5, "{}", size(45.573));
        assert!((size(79.047) - 390.0).abs() < 1.5, "{}", size(79.047));
    }

    #[test]
    fn measured_coefficients_give_the_published_mean_and_range() {
        let f = flutes(&cut(), &measured(), true);
        let [n, t] = f.mean(&straight(), 1.0);
        assert!((t.abs() - 139.83).abs() < 0.02, "{t}");
        assert!((n.abs() - 264.95).abs() < 0.02, "{n}");
        let over: Vec<_> =
            (0..2000).map(|k| f.at_immersion(0, f64::from(k) / 2000.0 * PI / 3.0, &straight(), 1.0)).collect();
        let range = |i: usize| {
            let sizes = over.iter().map(|f| f[i].abs());
            (sizes.clone().fold(f64::INFINITY, f64::min), sizes.fold(0.0, f64::max))
        };
        let (feed, normal) = (range(1), range(0));
        assert!((feed.0 - 92.2).abs() < 0.3 && (feed.1 - 194.6).abs() < 0.3, "{feed:?}");
        assert!((normal.0 - 140.2).abs() < 0.3 && (normal.1 - 394.2).abs() < 0.3, "{normal:?}");
        // The mean over a tooth period is the mean over a revolution.
        let mean: f64 = over.iter().map(|f| f[0]).sum::<f64>() / over.len() as f64;
        assert!((mean - n).abs() < 0.01, "{mean} {n}");
    }

    #[test]
    fn a_slot_in_conventional_sense_gives_the_published_mean() {
        let slot = Cut {
            radius_mm: 12.5,
            teeth: 2,
            helix_deg: 45.0,
            axial_depth_mm: 3.0,
            feed_mm_per_min: 250.0,
            spindle_rpm: 1000.0,
            ..cut()
        };
        let [n, t] = flutes(&slot, &measured(), false).mean(&EngagedArcs::up_to(PI), 1.0);
        assert!((t + 84.152).abs() < 0.002, "{t}");
        assert!((n - 209.882).abs() < 0.002, "{n}");
    }

    #[test]
    fn the_force_that_makes_the_wall_depends_on_the_height() {
        let f = flutes(&cut(), &p6m5(), true);
        let arc = EngagedArcs::up_to(79.047f64.to_radians());
        let heights = [0.1, 2.5, 5.0, 7.5, 9.9];
        let on_straight = [-90.0, -46.0, -39.0, -94.0, -140.0];
        let in_arc = [-379.0, -435.0, -456.0, -385.0, -317.0];
        for (k, &z) in heights.iter().enumerate() {
            let n = f.at_wall(0, z, &straight(), 1.0)[0];
            assert!((n - on_straight[k]).abs() < 0.8, "z = {z}: {n}");
            let n = f.at_wall(0, z, &arc, 1.0)[0];
            assert!((n - in_arc[k]).abs() < 0.8, "z = {z}: {n}");
        }
    }

    #[test]
    fn the_size_exponent_scales_the_force_by_the_feed_to_the_power_of_one_minus_it() {
        let machine = Machine { size_exponent: 0.2, ..p6m5() };
        let at = |feed| Flutes::new(&cut(), &machine, true, feed).mean(&straight(), 1.0);
        let (slow, fast) = (at(200.0), at(400.0));
        assert!((fast[0] / slow[0] - 2f64.powf(0.8)).abs() < 1e-9);
        assert!((fast[1] / slow[1] - 2f64.powf(0.8)).abs() < 1e-9);
    }

    #[test]
    fn straight_flutes_are_the_limit_of_a_small_helix() {
        let at = |helix_deg| {
            let cut = Cut { helix_deg, ..cut() };
            flutes(&cut, &p6m5(), true).at_immersion(0, 0.5, &straight(), 1.0)
        };
        let (none, small) = (at(0.0), at(0.01));
        assert!((none[0] - small[0]).abs() < 0.1 && (none[1] - small[1]).abs() < 0.1);
        assert!(none[0].hypot(none[1]) > 50.0);
    }
}
