//! A slot: the cutter at full immersion, a wall on either side.
//!
//! Engagement comes from where the (yielding) cutter has been ([`swept`](super::swept)), the force from the core's
//! tables: the mean over a revolution of an engaged stretch [a, b] is G(b) − G(a), and the force at the instant a height
//! of the wall is made likewise. The near wall is made where the immersion is 0, the other where it is π: seen from
//! there the same cut is of the other sense (climb and conventional) and its immersion is counted the other way. The
//! elastic loop is closed at every station. A force across the feed shifts the slot as a whole; with an even number of
//! teeth both walls are made at the same instant and the slot keeps the cutter's width, with an odd number it does not.
//!
//! Limits: the walls' end effects at sharp corners are predicted, not followed (see [`Station::held`]); a tooth's
//! instantaneous displacement does not change its chip.

use std::cell::Cell;
use std::f64::consts::PI;

use truepath_core::cut::{Coefficients, CutSetup, ForceTable, Milling, SplitForce, WallLaw};
use truepath_core::units::Real;
use truepath_ground::units::{float, mm};
use truepath_job::pass::Pass;

use super::envelope::Side;
use super::error::PocketError;
use super::machine::Machine;
use super::process::{Cutting, Process, Walls};
use super::station::{MOST_STATIONS, Station, slot_stations};
use super::swept::{Cells, Frame, engaged};

/// Heights of the walls: midpoints of even slices of the engaged depth.
pub(super) const HEIGHTS: usize = 12;
/// Steps of the elastic loop.
const STEPS: usize = 60;
/// Residual at which it counts as solved, mm.
const CLOSED_MM: f64 = 1e-7;
/// Residual that is reported, mm.
const OPEN_MM: f64 = 5e-4;
/// Circles that may be looked at in one pass.
const MOST_CHECKS: u64 = 2_000_000_000;

/// Stretches of immersion that cut.
type Arcs = Vec<[f64; 2]>;

/// A slot along a path.
#[derive(Debug)]
pub struct Slot {
    stations: Vec<Station>,
    nominal: Vec<f64>,
    setup: CutSetup,
    coefficients: Coefficients,
    table: ForceTable,
    machine: Machine,
    sides: [Side; 2],
}

/// The cutter at one station, under the mean force.
#[derive(Clone, Debug)]
struct State {
    arcs: Arcs,
    force: [f64; 2],
    displaced: [f64; 2],
}

fn real(v: f64) -> Real {
    Real::from_bits((v * 4_294_967_296.0).round() as i64)
}

fn minus(a: SplitForce, b: SplitForce) -> SplitForce {
    SplitForce {
        chip_n: a.chip_n - b.chip_n,
        chip_t: a.chip_t - b.chip_t,
        edge_n: a.edge_n - b.edge_n,
        edge_t: a.edge_t - b.edge_t,
    }
}

/// The slot of a job along its contour.
///
/// # Errors
/// A cutter that is not described, a path that is too long, a cutter too soft for it.
pub fn slotting(pass: &Pass) -> Result<Slot, PocketError> {
    let machine = Machine::of(&pass.job)?;
    let stations =
        slot_stations(&pass.path_contour(), (pass.core.setup.wall, pass.core.setup.radius), pass.core.step())?;
    Slot::new(stations, pass.core.setup, pass.core.coefficients(), machine)
}

impl Slot {
    /// Of stations with the near wall on the setup's side.
    ///
    /// # Errors
    /// As [`Process::cut`].
    pub fn new(
        stations: Vec<Station>,
        setup: CutSetup,
        coefficients: Coefficients,
        machine: Machine,
    ) -> Result<Self, PocketError> {
        let radius = mm(setup.radius);
        let sides = [Side::new(&stations, radius, 1.0), Side::new(&stations, radius, -1.0)];
        let table = ForceTable::new(coefficients.size_exponent);
        let nominal = Vec::new();
        let mut slot = Self { stations, nominal, setup, coefficients, table, machine, sides };
        let still = vec![[0.0; 2]; slot.stations.len()];
        let states = slot.march(&still, 0.0)?;
        slot.nominal = states.iter().map(|s| angle(&s.arcs)).collect();
        Ok(slot)
    }

    /// The setup seen from the other wall.
    fn setup_of(&self, far: bool) -> CutSetup {
        let milling = match (self.setup.milling, far) {
            (milling, false) => milling,
            (Milling::Climb, true) => Milling::Conventional,
            (Milling::Conventional, true) => Milling::Climb,
        };
        CutSetup { milling, ..self.setup }
    }

    /// Mean force (normal, tangential), N.
    fn mean(&self, arcs: &[[f64; 2]], feed: f64) -> [f64; 2] {
        let helix = self.setup.helix();
        let at = |angle: f64| self.table.mean((&self.setup, &helix), &self.coefficients, real(angle));
        self.total(arcs.iter().map(|[a, b]| minus(at(*b), at(*a))), feed)
    }

    /// Force in the frame of the near wall at the instant one of the walls is made at a height, N.
    fn at_wall(&self, far: bool, arcs: &[[f64; 2]], fraction: f64, feed: f64) -> [f64; 2] {
        let setup = self.setup_of(far);
        let helix = setup.helix();
        let height = setup.axial_depth * real(fraction);
        let at = |angle: f64| self.table.at_height((&setup, &helix), &self.coefficients, real(angle), height);
        let seen = |[a, b]: [f64; 2]| if far { [PI - b, PI - a] } else { [a, b] };
        let parts = arcs.iter().map(|arc| {
            let [a, b] = seen(*arc);
            minus(at(b), at(a))
        });
        let [n, t] = self.total(parts, feed);
        [if far { -n } else { n }, t]
    }

    fn total(&self, parts: impl Iterator<Item = SplitForce>, feed: f64) -> [f64; 2] {
        let scale = self.coefficients.chip_scale(self.setup.feed_per_tooth(real(feed)));
        parts.map(|part| part.total(scale)).fold([0.0; 2], |sum, (n, t)| [sum[0] + float(n), sum[1] + float(t)])
    }

    /// Marches along the path with the elastic loop closed.
    fn march(&self, shifts: &[[f64; 2]], force: f64) -> Result<Vec<State>, PocketError> {
        let radius = mm(self.setup.radius);
        let mut cells = Cells::new(2.0 * radius);
        let checks = Cell::new(0u64);
        let compliance = self.machine.mean();
        let mut states: Vec<State> = Vec::with_capacity(self.stations.len());
        let (mut displaced, mut worst, mut places) = ([0.0; 2], 0.0f64, 0);
        for (station, shift) in self.stations.iter().zip(shifts) {
            let commanded = add(station.point, *shift);
            let answer = |d: [f64; 2]| {
                let (normal, heading) = (station.normal, station.heading);
                let frame = Frame { centre: add(commanded, d), normal, heading, radius };
                let earlier = cells.near(frame.centre).inspect(|_| checks.set(checks.get() + 1));
                let arcs = engaged(&frame, earlier);
                let force = self.mean(&arcs, station.feed_mm_per_min).map(|f| force * f);
                let [fx, fy] = in_xy(station, force);
                State { arcs, force, displaced: [compliance[0] * fx, compliance[1] * fy] }
            };
            let (state, open) = closed(answer, displaced);
            if open > OPEN_MM {
                places += 1;
            }
            worst = worst.max(open);
            displaced = state.displaced;
            cells.push(add(commanded, displaced));
            states.push(state);
            if checks.get() > MOST_CHECKS {
                return Err(PocketError::TooLong { needed: self.stations.len(), most: MOST_STATIONS });
            }
        }
        // A cutter that comes into a sharp corner meets a load that jumps; a few open places there are no soft machine.
        if places > self.stations.len() / 50 + 4 {
            return Err(PocketError::Unsettled { places, worst_mm: worst });
        }
        Ok(states)
    }

    /// Errors of both walls at every height.
    fn walls(&self, states: &[State], shifts: &[[f64; 2]], force: f64) -> [Vec<Vec<f64>>; 2] {
        let heights =
            |far: bool| (0..HEIGHTS).map(move |k| (far, (k as f64 + 0.5) / HEIGHTS as f64)).collect::<Vec<_>>();
        [false, true].map(|far| {
            let one = |(far, fraction): (bool, f64)| {
                let compliance = self.machine.at(fraction);
                // In a straight slot the engaged arc is the same from station to station.
                let mut known: Option<(Arcs, f64, [f64; 2])> = None;
                let centre = |((state, station), shift): ((&State, &Station), &[f64; 2])| {
                    let feed = station.feed_mm_per_min;
                    let found = match &known {
                        Some((arcs, at, found)) if *arcs == state.arcs && *at == feed => *found,
                        _ => match self.setup.law {
                            WallLaw::Mean => self.mean(&state.arcs, feed),
                            WallLaw::Helical => self.at_wall(far, &state.arcs, fraction, feed),
                        },
                    };
                    known = Some((state.arcs.clone(), feed, found));
                    let [fx, fy] = in_xy(station, found.map(|f| force * f));
                    add(add(station.point, *shift), [compliance[0] * fx, compliance[1] * fy])
                };
                let centres: Vec<[f64; 2]> = states.iter().zip(&self.stations).zip(shifts).map(centre).collect();
                self.sides[usize::from(far)].errors(&self.stations, &centres)
            };
            heights(far).into_iter().map(one).collect()
        })
    }
}

/// Solves d = answer(d): secant steps of depth one, damped where they do not help. Returns the residual as well.
fn closed(answer: impl Fn([f64; 2]) -> State, start: [f64; 2]) -> (State, f64) {
    let mut d = start;
    let mut before: Option<([f64; 2], [f64; 2])> = None;
    let mut state = answer(d);
    let mut best = (state.clone(), f64::INFINITY);
    for step in 0..STEPS {
        let open = sub(state.displaced, d);
        let size = open[0].hypot(open[1]);
        if size < best.1 {
            best = (state.clone(), size);
        }
        if size < CLOSED_MM {
            break;
        }
        let damping = [1.0, 0.5, 0.2][(step / 20).min(2)];
        let mut next = [d[0] + damping * open[0], d[1] + damping * open[1]];
        if let (Some((d0, open0)), true) = (before, step < 15) {
            let change = sub(open, open0);
            let norm = (change[0] * change[0] + change[1] * change[1]).max(1e-30);
            let gamma = (open[0] * change[0] + open[1] * change[1]) / norm;
            if gamma.abs() < 3.0 {
                let back = add(sub(d, d0), change);
                next = [state.displaced[0] - gamma * back[0], state.displaced[1] - gamma * back[1]];
            }
        }
        before = Some((d, open));
        d = next;
        state = answer(d);
    }
    best
}

fn add(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0] + b[0], a[1] + b[1]]
}

fn sub(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0] - b[0], a[1] - b[1]]
}

fn in_xy(station: &Station, [n, t]: [f64; 2]) -> [f64; 2] {
    [n * station.normal[0] + t * station.heading[0], n * station.normal[1] + t * station.heading[1]]
}

fn angle(arcs: &[[f64; 2]]) -> f64 {
    arcs.iter().map(|[a, b]| b - a).sum()
}

impl Process for Slot {
    fn stations(&self) -> &[Station] {
        &self.stations
    }

    fn nominal(&self) -> &[f64] {
        &self.nominal
    }

    fn limit_mm(&self) -> f64 {
        mm(self.setup.radius)
    }

    fn intended_mm(&self, station: usize) -> f64 {
        let [n, t] = self.mean(&[[0.0, PI]], self.stations[station].feed_mm_per_min);
        let [fx, fy] = in_xy(&self.stations[station], [n, t]);
        let [cx, cy] = self.machine.mean();
        (cx * fx).hypot(cy * fy)
    }

    fn cut(&self, shifts: &[[f64; 2]], force: f64) -> Result<Vec<Cutting>, PocketError> {
        let states = self.march(shifts, force)?;
        let [near, far] = self.walls(&states, shifts, force);
        let [mean, tip] = [self.machine.mean(), self.machine.at(0.0)];
        // NaN where there is no wall; `max` takes the other one.
        let height = |rows: &[Vec<f64>], i: usize| {
            let finite = || rows.iter().map(|row| row[i]).filter(|e| e.is_finite());
            finite().fold(f64::NAN, f64::max) - finite().fold(f64::NAN, f64::min)
        };
        let over = |rows: &[Vec<f64>], i: usize| rows.iter().map(|row| row[i]).sum::<f64>() / HEIGHTS as f64;
        Ok(states
            .iter()
            .zip(&self.stations)
            .enumerate()
            .map(|(i, (state, station))| {
                let [dx, dy] = state.displaced;
                Cutting {
                    engaged_rad: angle(&state.arcs),
                    force_n: state.force,
                    deflection_mm: dx * station.normal[0] + dy * station.normal[1],
                    tip_mm: (dx * tip[0] / mean[0]).hypot(dy * tip[1] / mean[1]),
                    walls: Walls { near: over(&near, i), far: over(&far, i) },
                    height_mm: height(&near, i).max(height(&far, i)),
                }
            })
            .collect())
    }
}
