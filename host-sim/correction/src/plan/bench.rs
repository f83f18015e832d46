//! The identified machine, ready to cut processes.

use std::sync::Arc;

use truepath_core::correct::{Node, Update, commanded};
use truepath_core::cut::Path;
use truepath_core::geometry::Vector;
use truepath_core::process::{Aim, AimWorkspace, Depths, Load, Mill, Part, Slices, Wall, aim};
use truepath_core::units::Offset;
use truepath_ground::units::{float, mm};

use super::process::{Cut, PassOrder};
use crate::surface::wall::{WallFigures, WallMap};

/// A machine at work on one wall, at one resolution.
#[derive(Clone, Debug)]
pub struct Bench<'a> {
    mill: Mill<'a>,
    slices: Slices,
    /// Minutes along the contour at the programmed feed.
    minutes: f64,
    /// Wall error that parts have shown beside the model, as [`Mill::with_residual`] takes it.
    residual: Arc<[Offset]>,
}

/// A pass as it was designed and cut.
#[derive(Clone, Debug)]
pub struct CutPass {
    /// What was asked.
    pub order: PassOrder,
    /// The commanded displacements, one per sample of the contour.
    pub nodes: Vec<Node>,
    /// What it asks of machine and cutter.
    pub load: Load,
}

/// A part after some cuts.
#[derive(Clone, Debug)]
pub struct Stage {
    /// What is left, sample by sample of the path, all slices side by side.
    pub left: Vec<Offset>,
    /// The passes so far.
    pub passes: Vec<CutPass>,
}

/// Buffers of a run, for one thread.
struct Buffers {
    moved: Vec<Vector>,
    walls: Vec<Wall>,
    shifts: Vec<Update>,
    best: Vec<Node>,
    depths: Box<Depths>,
}

impl<'a> Bench<'a> {
    /// Of a machine, at so many slices.
    pub fn new(mill: Mill<'a>, slices: Slices) -> Self {
        let path = mill.machine().path;
        let samples = &path.samples()[path.first()..path.first() + path.count()];
        let feed = |at: usize| float(samples[at].feed).max(1e-3);
        let minutes = (1..samples.len()).map(|k| mm(samples[k].s - samples[k - 1].s) / feed(k)).sum();
        Self { mill, slices, minutes, residual: Arc::default() }
    }

    /// The same with what parts have shown beside the model: the walls of the passes to size have it, because it was seen
    /// on them.
    #[must_use]
    pub fn with_residual(self, residual: Vec<Offset>) -> Self {
        Self { residual: residual.into(), ..self }
    }

    /// The path.
    pub const fn path(&self) -> &'a Path<'a> {
        self.mill.machine().path
    }
    /// The machine.
    pub const fn machine(&self) -> &truepath_core::cut::Loop<'a> {
        self.mill.machine()
    }
    /// Another machine on the same wall, with the same times.
    #[must_use]
    pub fn of<'b>(&'b self, machine: truepath_core::cut::Loop<'b>) -> Bench<'b> {
        let mill = self.mill.with(machine);
        Bench { mill, slices: self.slices, minutes: self.minutes, residual: Arc::clone(&self.residual) }
    }
    /// The slices of the wall.
    pub const fn slices(&self) -> Slices {
        self.slices
    }
    /// Minutes of one pass along the contour at the programmed feed, without the ways to it and from it.
    pub const fn minutes(&self) -> f64 {
        self.minutes
    }

    /// The raw part.
    pub fn raw(&self) -> Stage {
        let path = self.path();
        let mut left = vec![Offset::ZERO; Part::needed(path, self.slices)];
        let raw = Part::raw(path, self.slices, &mut left).is_some();
        debug_assert!(raw, "the buffer is as long as is needed");
        Stage { left, passes: Vec::new() }
    }

    /// The part after one pass of the program as it is, which shows what planning is for.
    pub fn as_programmed(&self) -> Stage {
        let whole = Cut::whole(Aim::Middle);
        self.run(self.raw(), &whole, |part, order, _, buffers| self.unmoved(part, order, buffers))
    }

    /// The walls that one pass of the program as it is makes of the raw part: sample by sample of the contour, all slices side by side.
    pub fn programmed_walls(&self) -> Vec<Wall> {
        let (mut left, mut buffers) = (self.raw().left, self.buffers());
        let part = Part::of(self.slices, &mut left);
        for order in Cut::whole(Aim::Middle).orders(self.slices) {
            self.unmoved(&part, &order, &mut buffers);
        }
        buffers.walls
    }

    /// A pass along the path of the program, whose walls are in the buffers.
    fn unmoved(&self, part: &Part, order: &PassOrder, buffers: &mut Buffers) -> Load {
        let load = self.mill.run(part, &order.order, |_| Vector::ZERO, &mut buffers.depths, &mut buffers.moved);
        self.mill.walls(&order.order, &buffers.moved, &mut buffers.walls);
        load
    }

    /// The part after one more cut, designed in at most `turns` steps a pass.
    pub fn cut(&self, stage: Stage, cut: &Cut, turns: u32) -> Stage {
        self.run(stage, cut, |part, order, nodes, buffers| {
            let mill = self.mill_of(order);
            if cut.spring {
                let command = |index| commanded(self.path(), nodes, index);
                let load = mill.run(part, &order.order, command, &mut buffers.depths, &mut buffers.moved);
                mill.walls(&order.order, &buffers.moved, &mut buffers.walls);
                return load;
            }
            let mut workspace = AimWorkspace {
                moved: &mut buffers.moved,
                walls: &mut buffers.walls,
                shifts: &mut buffers.shifts,
                best: &mut buffers.best,
                depths: &mut buffers.depths,
            };
            aim(&mill, (part, &order.order), (order.aim, turns), nodes, &mut workspace).load
        })
    }

    /// What is left when the passes of a process are run by this machine as they were designed, perhaps for another.
    pub fn follow(&self, passes: &[CutPass]) -> Vec<Offset> {
        self.follow_on(self.raw().left, passes)
    }

    /// The same from what other passes left.
    pub fn follow_on(&self, mut left: Vec<Offset>, passes: &[CutPass]) -> Vec<Offset> {
        let path = self.path();
        let mut buffers = self.buffers();
        for pass in passes {
            let mut part = Part::of(self.slices, &mut left);
            let command = |index| commanded(path, &pass.nodes, index);
            let mill = self.mill_of(&pass.order);
            mill.run(&part, &pass.order.order, command, &mut buffers.depths, &mut buffers.moved);
            mill.walls(&pass.order.order, &buffers.moved, &mut buffers.walls);
            part.take(path, &buffers.walls);
        }
        left
    }

    /// Passes that were designed on another bench of the same wall, as commands of this one.
    pub fn taken_over(&self, passes: &[CutPass], from: &Bench) -> Vec<CutPass> {
        let (own, theirs) = (self.path(), from.path());
        let contour = own.samples().iter().skip(own.first()).take(own.count());
        let last = theirs.first() + theirs.count() - 1;
        let at: Vec<usize> =
            contour.map(|s| theirs.index_at(s.s).clamp(theirs.first(), last) - theirs.first()).collect();
        let pass = |pass: &CutPass| {
            let mut order = pass.order;
            order.order.first = order.order.first * self.slices.count() / from.slices.count();
            CutPass { order, nodes: at.iter().map(|k| pass.nodes[*k]).collect(), load: pass.load }
        };
        passes.iter().map(pass).collect()
    }

    /// What is left, changed as a coarser bench of the same wall says: by what another machine leaves there beside the identified one.
    pub fn changed_like(&self, left: &[Offset], coarse: &Bench, (like, other): (&[Offset], &[Offset])) -> Vec<Offset> {
        let (count, fewer) = (self.slices.count(), coarse.slices.count());
        let mut changed = left.to_vec();
        for (column, sample) in changed.chunks_mut(count).zip(self.path().samples()) {
            let beside = coarse.path().index_at(sample.s) * fewer;
            for (k, error) in column.iter_mut().enumerate() {
                let at = beside + k * fewer / count;
                *error += other[at] - like[at];
            }
        }
        changed
    }

    /// What is left with an error beside it: one entry for every sample of the contour, slice by slice, mm.
    pub fn beside(&self, left: &[Offset], error_mm: &[f64]) -> Vec<Offset> {
        let mut left = left.to_vec();
        let from = self.path().first() * self.slices.count();
        for (left, error) in left.iter_mut().skip(from).zip(error_mm) {
            *left += Offset::from_nm((error * 1e6).round() as i64);
        }
        left
    }

    /// The figures of what is left.
    pub fn figures(&self, left: &[Offset]) -> WallFigures {
        WallFigures::of(self.path(), self.slices, left)
    }

    /// What is left, unrolled.
    pub fn map(&self, left: &[Offset]) -> WallMap {
        WallMap::of(self.path(), self.slices, left)
    }

    /// The machine as it cuts a pass.
    fn mill_of(&self, order: &PassOrder) -> Mill<'_> {
        if order.is_to_size() { self.mill.clone().with_residual(&self.residual) } else { self.mill.clone() }
    }

    fn buffers(&self) -> Buffers {
        let count = self.path().count();
        Buffers {
            moved: vec![Vector::ZERO; self.mill.displacements_needed()],
            walls: vec![Wall::default(); self.mill.walls_needed()],
            shifts: vec![Update::default(); count],
            best: vec![Node::default(); count],
            depths: Box::new(Depths::NONE),
        }
    }

    fn run(
        &self,
        mut stage: Stage,
        cut: &Cut,
        design: impl Fn(&Part, &PassOrder, &mut [Node], &mut Buffers) -> Load,
    ) -> Stage {
        let path = self.path();
        let mut buffers = self.buffers();
        let mut nodes = vec![Node::default(); path.count()];
        let before = stage.passes.len();
        for order in cut.orders(self.slices) {
            let same = |pass: &&CutPass| pass.order.order.first == order.order.first;
            if cut.spring
                && let Some(earlier) = stage.passes[..before].iter().rev().find(same)
            {
                nodes.copy_from_slice(&earlier.nodes);
            }
            let mut part = Part::of(self.slices, &mut stage.left);
            // The walls of the design are in the buffers.
            let load = design(&part, &order, &mut nodes, &mut buffers);
            part.take(path, &buffers.walls);
            stage.passes.push(CutPass { order, nodes: nodes.clone(), load });
        }
        stage
    }
}
