//! A machine that runs one pass after another along a wall.

use super::depths::{Depths, part_of};
use super::grid::{ANGLES, Cumulative, Force, ImmersionGrid};
use super::part::{Part, Wall};
use super::slices::{MAX_SLICES, Slices};
use crate::cut::{Compliance, Envelope, Loop, Milling, Passage, WallLaw, mixed};
use truepath_units::geometry::{Direction, Vector};
use truepath_units::{Offset, Real, shift_rounded_i63, sin_cos};

/// How a pass is run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Order {
    /// The slice at whose lower border the tip lies: 0 for the depth of the path itself, more for a raised tip.
    pub first: usize,
    /// Against the direction of the path: climb becomes conventional.
    pub reversed: bool,
    /// Feed over the programmed feed.
    pub feed: Real,
}

/// What a pass asks of machine and cutter.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Load {
    /// How the elastic loop fared.
    pub passage: Passage,
    /// The largest mean force over a revolution, N.
    pub force: Real,
    /// The largest engagement angle, rad.
    pub engaged: Real,
    /// The thickest chip of a tooth, mm, as the mean along the contour of what it is at every place.
    pub chip: Real,
}

/// A machine at work on a wall: what [`Loop`] is for one pass over an even stock.
#[derive(Clone, Debug)]
pub struct Mill<'a> {
    machine: Loop<'a>,
    grid: &'a ImmersionGrid,
    slices: Slices,
    /// The angle over which a tooth passes a slice, rad.
    lag: Real,
    pitch: Real,
    /// Wall error beside the model.
    residual: &'a [Offset],
}

/// Residual at which a loop counts as solved.
const TOLERANCE: Offset = Offset::from_nm(20);
/// The square of every length that rounds to more than that is at least this, nm².
const SOLVED: u128 = {
    let nm = TOLERANCE.nm().unsigned_abs() as u128;
    nm.saturating_mul(nm).saturating_add(nm).saturating_add(1)
};
/// Residual above which a sample is reported as unsettled.
const UNSETTLED: Offset = Offset::from_nm(500);
/// Iterations of a loop; from the second number on it is damped.
const ITERATIONS: [u32; 2] = [40, 16];
/// Depths are looked at anew when the loop has moved the cutter farther than this from where they were looked at.
const LOOKED: Offset = Offset::from_um(40);
/// How often at most.
const LOOKS: usize = 3;

/// A pass under way.
struct March<'m> {
    mill: &'m Mill<'m>,
    part: &'m Part<'m>,
    order: Order,
    climb: bool,
    /// How far the cutter is displaced in every slice, as a factor, and the same less one.
    factor: [Real; MAX_SLICES],
    beyond: [Real; MAX_SLICES],
    /// How much a force in every slice displaces, over what it would spread over the height: what is pushed farther by a force
    /// pushes farther by the same (reciprocity, Maxwell and Betti).
    lever: [Real; MAX_SLICES],
    /// Feed, feed per tooth (mm), the force at it, and where it is asked for.
    force: Option<(Real, Real, Cumulative, Windows)>,
    /// Displacement by the mean force, and at the instant of every slice, at the last place.
    mean: Vector,
    instants: [Vector; MAX_SLICES],
}

/// What a place asked of the cutter.
struct Settled {
    residual: Offset,
    force: (Real, Real),
    leaves: Real,
    feed_per_tooth: Real,
}

/// An angle on the grid, and the force up to it.
#[derive(Clone, Copy, Debug, Default)]
struct Edge {
    cell: usize,
    share: Real,
    force: Force,
}

/// The angles that a tooth has in one slice while one passes the wall in another: where they begin (rad; what lies before 0 does not cut),
/// and their ends.
#[derive(Clone, Copy, Debug, Default)]
struct Window {
    from: Real,
    begins: Edge,
    ends: Edge,
}

/// How many teeth are kept; they lie a pitch apart, and mostly the engaged angles hold no more of them.
const KEPT: usize = 2;
/// How many slices one may lie above another or below it.
const APART: usize = MAX_SLICES.saturating_mul(2);

/// The windows by how many slices (and [`MAX_SLICES`] more) the one slice lies above the other, as the teeth follow each other.
struct Windows([[Window; KEPT]; APART]);

/// One place of the cutter, with what is around it.
struct Place<'p> {
    depths: &'p Depths,
    /// Displacement at which the depths were looked at.
    looked: Vector,
    normal: Direction,
    heading: Direction,
    force: &'p Cumulative,
    windows: &'p Windows,
    factor: &'p [Real; MAX_SLICES],
    lever: &'p [Real; MAX_SLICES],
    first: usize,
    /// Angles that matter in each slice.
    rows: [u8; MAX_SLICES],
    climb: bool,
}

impl<'a> Mill<'a> {
    /// A machine on its path, with a part in so many slices.
    pub fn new(machine: Loop<'a>, grid: &'a ImmersionGrid, slices: Slices) -> Self {
        let setup = machine.path.setup();
        let helix = machine.path.helix();
        let lag = helix.lag_per_mm * slices.thickness(setup.axial_depth);
        Self { machine, grid, slices, lag, pitch: helix.pitch, residual: &[] }
    }

    /// The same, whose walls have an error beside the model: for one sample of the contour after the other all slices.
    #[must_use]
    pub const fn with_residual(self, residual: &'a [Offset]) -> Self {
        Self { residual, ..self }
    }

    /// The same with another machine on the path.
    #[must_use]
    pub const fn with<'b>(&'b self, machine: Loop<'b>) -> Mill<'b> {
        Mill {
            machine,
            grid: self.grid,
            slices: self.slices,
            lag: self.lag,
            pitch: self.pitch,
            residual: self.residual,
        }
    }
    /// The machine.
    pub const fn machine(&self) -> &Loop<'a> {
        &self.machine
    }
    /// Displacements that [`Mill::run`] fills.
    pub fn displacements_needed(&self) -> usize {
        self.machine.path.working().len().saturating_mul(self.slices.count())
    }
    /// Walls that [`Mill::walls`] fills.
    pub fn walls_needed(&self) -> usize {
        self.machine.path.count().saturating_mul(self.slices.count())
    }

    /// Runs a pass over a part, which stays as it is. `moved` gets the displacement of the cutter from its nominal place at the instant
    /// at which it makes the wall: for one slice after the other the working samples of the path.
    pub fn run(
        &self,
        part: &Part,
        order: &Order,
        commanded: impl Fn(usize) -> Vector,
        depths: &mut Depths,
        moved: &mut [Vector],
    ) -> Load {
        let path = self.machine.path;
        let working = path.working();
        let length = working.len();
        let contour = path.first()..path.first().saturating_add(path.count());
        let mut march = March::new(self, part, *order);
        let (mut load, mut places) = (Load::default(), 0i32);
        for step in 0..length {
            let ahead = if order.reversed { length.saturating_sub(1).saturating_sub(step) } else { step };
            let index = working.start.saturating_add(ahead);
            let command = commanded(index);
            let Some(at) = march.settle(index, command, depths) else { break };
            load.passage.unsettled = load.passage.unsettled.saturating_add(u32::from(at.residual > UNSETTLED));
            load.passage.worst_residual = load.passage.worst_residual.max(at.residual);
            if contour.contains(&index) {
                load.force = load.force.max((at.force.0 * at.force.0 + at.force.1 * at.force.1).sqrt());
                load.engaged = load.engaged.max(at.leaves);
                let thickest = if at.leaves > Real::FRAC_PI_2 { Real::ONE } else { sin_cos(at.leaves).0 };
                load.chip += thickest * at.feed_per_tooth;
                places = places.saturating_add(1);
            }
            for (k, (instant, factor)) in march.instants.iter().zip(march.factor).enumerate().take(self.slices.count())
            {
                if let Some(slot) = moved.get_mut(k.saturating_mul(length).saturating_add(ahead)) {
                    *slot = if k < order.first { command } else { command + instant.scaled(factor) };
                }
            }
        }
        load.chip = load.chip / Real::from_int(places.max(1));
        load
    }

    /// Reads the walls of a pass off `moved`: for one sample of the contour after the other all slices.
    pub fn walls(&self, order: &Order, moved: &[Vector], walls: &mut [Wall]) {
        let path = self.machine.path;
        let (working, count) = (path.working(), self.slices.count());
        let length = working.len();
        // The force here is that of a cutter that runs true; of runout the reach of its longest tooth counts.
        let smaller = self.machine.undersize - path.setup().runout.longest(path.setup().teeth);
        walls.fill(Wall::default());
        for k in order.first..count {
            let from = k.saturating_mul(length);
            let moved = moved.get(from..from.saturating_add(length)).unwrap_or_default();
            let envelope = Envelope::new(path, working.start, moved);
            let mut guess = path.first();
            for index in 0..path.count() {
                let at = path.first().saturating_add(index);
                if !path.samples().get(at).is_some_and(|s| s.on_wall) {
                    continue;
                }
                let Some(wall) = envelope.error(at, guess) else { continue };
                guess = wall.made_by.saturating_add(1);
                let own = wall.made_by.saturating_sub(path.first()).min(path.count().saturating_sub(1));
                let at = index.saturating_mul(count).saturating_add(k);
                let beside = smaller + self.residual.get(at).copied().unwrap_or_default();
                if let Some(slot) = walls.get_mut(at) {
                    *slot = Wall { error: Some(wall.error + beside), made_by: own as u32 };
                }
            }
        }
    }

    /// The displacement by a force (normal, in travel), N.
    fn pushed(&self, place: &Place, force: (Real, Real)) -> Vector {
        let compliance: &Compliance = &self.machine.compliance;
        compliance.displacement(place.normal, place.heading, force)
    }

    /// The mean force over a revolution with the cutter displaced by `at`, (normal, in travel), N.
    fn mean_force(&self, place: &Place, at: Vector) -> (Real, Real) {
        let beside = place.beside(at - place.looked);
        let mut all = Force::default();
        for k in place.first..self.slices.count() {
            let mut sum = Force::default();
            let rows = usize::from(place.rows.get(k).copied().unwrap_or(0));
            let (Some(depth), Some(factor)) = (place.depths.depth.get(k), place.factor.get(k)) else { break };
            let depths = depth.iter().zip(&beside).take(rows).map(|(d, b)| d.saturating_add(part_of(*b, *factor)));
            let mut before: Option<i64> = None;
            for (row, depth) in depths.enumerate() {
                // A stretch adds the force up to where it ends and takes away that up to where it begins.
                let edge = match before {
                    None if depth > 0 => Some(place.force.at(row)),
                    Some(d) if (d > 0) != (depth > 0) => {
                        Some(place.force.within(row.saturating_sub(1), crossing(d, depth)))
                    }
                    _ => None,
                };
                if let Some(edge) = edge {
                    sum = if depth > 0 { sum.minus(edge) } else { sum.plus(edge) };
                }
                before = Some(depth);
            }
            if before.is_some_and(|d| d > 0) {
                sum = sum.plus(place.force.at(rows.saturating_sub(1)));
            }
            all = all.plus(sum.part(place.lever_at(k)));
        }
        let setup = self.machine.path.setup();
        let share = Real::from_int(setup.teeth.into()) / Real::TAU * self.slices.thickness(setup.axial_depth);
        all.scaled(share)
    }

    /// The force at the instant at which a tooth passes slice `of` at the wall, with the cutter displaced by `at`, N.
    fn instant_force(&self, place: &Place, of: usize, at: Vector) -> (Real, Real) {
        let beside = place.beside(at - place.looked);
        let mut sum = Force::default();
        for k in place.first..self.slices.count() {
            let rows = usize::from(place.rows.get(k).copied().unwrap_or(0));
            if rows == 0 {
                continue;
            }
            // In climb milling the tooth at the wall has its upper part still in the stock.
            let above =
                if place.climb { (k as i64).saturating_sub(of as i64) } else { (of as i64).saturating_sub(k as i64) };
            let end = self.grid.angle.get(rows.saturating_sub(1)).copied().unwrap_or(Real::ZERO);
            let kept = place.windows.of(above);
            let mut own = Force::default();
            for tooth in 0.. {
                let next;
                let window = match kept.get(tooth) {
                    Some(window) => window,
                    None => {
                        next = self.window(place.force, above, tooth);
                        &next
                    }
                };
                if window.from >= end {
                    break;
                }
                let last = if window.from + self.lag > end { self.edge(place.force, end) } else { window.ends };
                own = own.plus(self.stretch(place, k, (&window.begins, &last), &beside));
            }
            sum = sum.plus(own.part(place.lever_at(k)));
        }
        sum.scaled(self.machine.path.helix().mm_per_lag)
    }

    /// An angle on the grid.
    fn edge(&self, force: &Cumulative, angle: Real) -> Edge {
        let (cell, share) = self.grid.locate(angle);
        Edge { cell, share, force: force.within(cell, share) }
    }

    /// The angles of a tooth in a slice that lies so many above that of the wall, in the sense in which the teeth lean.
    fn window(&self, force: &Cumulative, above: i64, tooth: usize) -> Window {
        let begins = self.lag * Real::from_int(above as i32) - self.lag * Real::HALF;
        let turns = ((-(begins + self.lag)) / self.pitch).floor().saturating_add(1).saturating_add(tooth as i64);
        let from = begins + self.pitch * Real::from_int(turns as i32);
        Window { from, begins: self.edge(force, from.max(Real::ZERO)), ends: self.edge(force, from + self.lag) }
    }

    /// All windows at a feed.
    fn windows(&self, force: &Cumulative) -> Windows {
        let mut all = [[Window::default(); KEPT]; APART];
        for (at, teeth) in all.iter_mut().enumerate() {
            let above = (at as i64).saturating_sub(MAX_SLICES as i64);
            if above.unsigned_abs() < self.slices.count() as u64 {
                for (tooth, window) in teeth.iter_mut().enumerate() {
                    *window = self.window(force, above, tooth);
                }
            }
        }
        Windows(all)
    }

    /// ∫ of the force density over the engaged part of a stretch of angles in a slice.
    fn stretch(&self, place: &Place, k: usize, (from, to): (&Edge, &Edge), beside: &[i64; ANGLES]) -> Force {
        let (Some(depth), Some(factor)) = (place.depths.depth.get(k), place.factor.get(k)) else {
            return Force::default();
        };
        let row = |row: usize| {
            let (d, b) = (depth.get(row).copied().unwrap_or(-1), beside.get(row).copied().unwrap_or(0));
            d.saturating_add(part_of(b, *factor))
        };
        let within = |cell: usize, share: Real| {
            let (a, b) = (row(cell), row(cell.saturating_add(1)));
            a.saturating_add(part_of(b.saturating_sub(a), share))
        };
        let mut cell = from.cell;
        let (mut d, mut begins) = (within(cell, from.share), from.force);
        let mut sum = Force::default();
        loop {
            let ends = cell >= to.cell;
            let (next, up_to) = if ends {
                (within(to.cell, to.share), to.force)
            } else {
                (row(cell.saturating_add(1)), place.force.at(cell.saturating_add(1)))
            };
            let piece = up_to.minus(begins);
            sum = match (d > 0, next > 0) {
                (true, true) => sum.plus(piece),
                (true, false) => sum.plus(piece.part(crossing(d, next))),
                (false, true) => sum.plus(piece.part(Real::ONE - crossing(d, next))),
                (false, false) => sum,
            };
            if ends {
                return sum;
            }
            (d, begins, cell) = (next, up_to, cell.saturating_add(1));
        }
    }
}

impl<'m> March<'m> {
    fn new(mill: &'m Mill<'m>, part: &'m Part<'m>, order: Order) -> Self {
        let compliance = mill.machine.compliance;
        let (mut factor, mut beyond) = ([Real::ONE; MAX_SLICES], [Real::ZERO; MAX_SLICES]);
        for (k, (factor, beyond)) in factor.iter_mut().zip(beyond.iter_mut()).enumerate() {
            *factor = compliance.height_factor(mill.slices.fraction(k, order.first));
            *beyond = *factor - Real::ONE;
        }
        let lever = factor.map(|factor| factor / compliance.mean_factor());
        let climb = (mill.machine.path.setup().milling == Milling::Climb) != order.reversed;
        let (mean, instants) = (Vector::ZERO, [Vector::ZERO; MAX_SLICES]);
        Self { mill, part, order, climb, factor, beyond, lever, force: None, mean, instants }
    }

    /// Goes on to a sample: the equilibrium under the mean force, and that of the instant of every slice.
    fn settle(&mut self, index: usize, command: Vector, depths: &mut Depths) -> Option<Settled> {
        let (path, setup) = (self.mill.machine.path, self.mill.machine.path.setup());
        let sample = path.samples().get(index)?;
        let feed = sample.feed * self.order.feed;
        if self.force.as_ref().is_none_or(|(of, ..)| *of != feed) {
            let (machine, per_tooth) = (&self.mill.machine, setup.feed_per_tooth(feed));
            let milling = if self.climb { Milling::Climb } else { Milling::Conventional };
            let scale = machine.coefficients.chip_scale(per_tooth);
            let of = (&machine.coefficients, milling);
            let force = Cumulative::new(self.mill.grid, machine.table, of, scale);
            let windows = self.mill.windows(&force);
            self.force = Some((feed, per_tooth, force, windows));
        }
        let (_, feed_per_tooth, force, windows) = self.force.as_ref()?;
        let mut look = 1;
        let (place, mut residual) = loop {
            let frame = path.frame(index, command + self.mean)?;
            let toward = (sample.point + command + self.mean, &frame, !self.order.reversed);
            depths.look((path, self.part), self.mill.grid, toward, (self.mean, &self.beyond));
            let place = Place {
                rows: depths.rows_of_slices(self.order.first, self.mill.slices.count()),
                depths,
                looked: self.mean,
                normal: frame.normal,
                heading: if self.order.reversed { frame.heading.reversed() } else { frame.heading },
                force,
                windows,
                factor: &self.factor,
                lever: &self.lever,
                first: self.order.first,
                climb: self.climb,
            };
            let push = |at| self.mill.pushed(&place, self.mill.mean_force(&place, at));
            let (settled, left) = equilibrium(self.mean, push);
            let far = (settled - self.mean).length() > LOOKED;
            self.mean = settled;
            if !far || look >= LOOKS {
                break (place, left);
            }
            look = look.saturating_add(1);
        };
        for (k, instant) in self.instants.iter_mut().enumerate().take(self.mill.slices.count()).skip(self.order.first) {
            if setup.law == WallLaw::Mean {
                *instant = self.mean;
                continue;
            }
            let from = if *instant == Vector::ZERO { self.mean } else { *instant };
            let push = |at| self.mill.pushed(&place, self.mill.instant_force(&place, k, at));
            let (settled, left) = equilibrium(from, push);
            (*instant, residual) = (settled, residual.max(left));
        }
        let force = self.mill.mean_force(&place, self.mean);
        let leaves = place.depths.leaves(self.mill.grid, (self.order.first, self.mill.slices.count()));
        Some(Settled { residual, force, leaves, feed_per_tooth: *feed_per_tooth })
    }
}

impl Place<'_> {
    fn lever_at(&self, slice: usize) -> Real {
        self.lever.get(slice).copied().unwrap_or(Real::ONE)
    }

    /// How much deeper every angle lies when the cutter moves by `by`, nm.
    fn beside(&self, by: Vector) -> [i64; ANGLES] {
        let mut beside = [0; ANGLES];
        let rows = beside.iter_mut().zip(&self.depths.normal).take(self.depths.rows);
        let (x, y) = (by.x.nm(), by.y.nm());
        if x.unsigned_abs().max(y.unsigned_abs()) < NARROW {
            for (slot, normal) in rows {
                let product = x.saturating_mul(normal.x.bits()).saturating_add(y.saturating_mul(normal.y.bits()));
                *slot = shift_rounded_i63(product, Real::FRACTION_BITS);
            }
        } else {
            for (slot, normal) in rows {
                *slot = by.along(*normal).nm();
            }
        }
        beside
    }
}

impl Windows {
    /// Those of a slice so many above that of the wall.
    fn of(&self, above: i64) -> &[Window] {
        let at = above.saturating_add(MAX_SLICES as i64).unsigned_abs() as usize;
        self.0.get(at).map_or(&[], |teeth| teeth)
    }
}

/// A component below that, nm, times one of a direction fits 64 bits, and so does the sum of two.
const NARROW: u64 = 1 << 29;

/// Where between two depths of opposite signs the surface lies, 0…1.
fn crossing(a: i64, b: i64) -> Real {
    Real::from_bits((a << 32).checked_div(a.saturating_sub(b)).unwrap_or(0))
}

/// The fixed point of a push: secant steps (Anderson, depth one) from a first guess, then damped ones. Gives it, and what is left
/// unsolved.
fn equilibrium(guess: Vector, mut push: impl FnMut(Vector) -> Vector) -> (Vector, Offset) {
    let [most, damped] = ITERATIONS;
    let mut at = guess;
    let mut before: Option<(Vector, Vector)> = None;
    let mut best = (guess, Vector { x: Offset::MAX, y: Offset::MAX });
    for turn in 1..=most {
        let residual = push(at) - at;
        if is_shorter(residual, best.1) {
            best = (at + residual, residual);
        }
        if residual.length_squared() < SOLVED {
            return (best.0, residual.length());
        }
        let step = match before {
            Some((x0, r0)) if turn < damped => mixed(residual, residual - r0, at - x0),
            None => residual,
            Some(_) => residual.scaled(Real::ratio(3, 10)),
        };
        before = Some((at, residual));
        at = at + step;
    }
    (best.0, best.1.length())
}

/// Whether a length is shorter than another, both rounded to whole nanometres.
fn is_shorter(a: Vector, b: Vector) -> bool {
    let (square, other) = (a.length_squared(), b.length_squared());
    // Roots are needed only where the squares are so near to each other that both may round to one.
    if square.abs_diff(other) > other / 2 && other > 64 { square < other } else { a.length() < b.length() }
}
