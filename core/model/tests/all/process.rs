//! Several passes along one wall: the field of stock against the model of one pass, and against what must be so.
use crate::corner;
use corner::*;
use truepath_model::correct::{Band, Node, Profile, Update, commanded, profile};
use truepath_model::cut::*;
use truepath_model::process::{
    Aim, AimWorkspace, Depths, ImmersionGrid, Load, Mill, Order, Part, Reached, Slices, Wall, aim,
};
use truepath_units::geometry::{Block, Side, Vector};
use truepath_units::{Offset, Real};

const FORWARD: Order = Order { first: 0, reversed: false, feed: Real::ONE };
const BACK: Order = Order { reversed: true, ..FORWARD };

/// A wall under work: stock, machine and buffers.
pub struct Bench<'a> {
    pub mill: Mill<'a>,
    pub slices: Slices,
    pub left: Vec<Offset>,
    pub walls: Vec<Wall>,
    moved: Vec<Vector>,
    depths: Box<Depths>,
}

impl<'a> Bench<'a> {
    pub fn new(machine: Loop<'a>, grid: &'a ImmersionGrid, slices: Slices) -> Self {
        let path = machine.path;
        let mill = Mill::new(machine, grid, slices);
        let mut left = vec![Offset::ZERO; Part::needed(path, slices)];
        Part::raw(path, slices, &mut left).unwrap();
        let moved = vec![Vector::ZERO; mill.displacements_needed()];
        let walls = vec![Wall::default(); mill.walls_needed()];
        Self { mill, slices, left, walls, moved, depths: Box::new(Depths::NONE) }
    }
    fn path(&self) -> &'a Path<'a> {
        self.mill.machine().path
    }
    /// Runs a pass and takes its wall.
    pub fn cut(&mut self, order: &Order, nodes: &[Node]) -> Load {
        let path = self.path();
        let mut part = Part::of(self.slices, &mut self.left);
        let command = |i| commanded(path, nodes, i);
        let load = self.mill.run(&part, order, command, &mut self.depths, &mut self.moved);
        self.mill.walls(order, &self.moved, &mut self.walls);
        part.take(path, &self.walls);
        load
    }
    /// Designs a pass, runs it and takes its wall.
    pub fn aimed(&mut self, order: &Order, wanted: Aim) -> (Vec<Node>, Reached) {
        let path = self.path();
        let count = path.count();
        let mut nodes = vec![Node::default(); count];
        let mut part = Part::of(self.slices, &mut self.left);
        let mut workspace = AimWorkspace {
            moved: &mut self.moved,
            walls: &mut self.walls,
            shifts: &mut vec![Update::default(); count],
            best: &mut vec![Node::default(); count],
            depths: &mut self.depths,
        };
        let reached = aim(&self.mill, (&part, order), (wanted, 16), &mut nodes, &mut workspace);
        part.take(path, &self.walls);
        (nodes, reached)
    }
    /// What is left at an arc length, slice by slice, um.
    fn at(&self, mm: f64) -> Vec<f64> {
        let from = self.path().index_at(Offset::from_mm(real(mm))) * self.slices.count();
        self.left[from..from + self.slices.count()].iter().map(|e| e.nm() as f64 / 1e3).collect()
    }
    /// The largest and the smallest of what is left on the contour beyond 8 mm from its ends, um.
    fn extremes(&self) -> (f64, f64) {
        let path = self.path();
        let margin = Offset::from_um(8_000);
        let inner = (path.first()..path.first() + path.count())
            .filter(|i| path.samples()[*i].s >= margin && path.samples()[*i].s <= path.length() - margin);
        let all = inner.flat_map(|i| &self.left[i * self.slices.count()..(i + 1) * self.slices.count()]);
        let um: Vec<f64> = all.map(|e| e.nm() as f64 / 1e3).collect();
        (um.iter().copied().fold(f64::MIN, f64::max), um.iter().copied().fold(f64::MAX, f64::min))
    }
}

fn straight() -> Vec<Block> {
    use truepath_units::geometry::{Curve, Point};
    chain(&[Curve::line(Point::from_nm(0, 0), Point::from_nm(60_000_000, 0)).unwrap()], 400.0)
}

fn edged() -> Coefficients {
    Coefficients { kte: real(12.0), kre: real(16.0), ..coefficients() }
}

/// A machine of edged teeth.
fn on<'a>(path: &'a Path<'a>, table: &'a ForceTable, compliance: Compliance) -> Loop<'a> {
    Loop { coefficients: edged(), ..machine(path, table, compliance) }
}

fn soft(k: f64) -> Compliance {
    Compliance::from_stiffness(real(k), real(k))
}

#[test]
fn one_pass_over_an_even_stock_is_that_of_the_model_of_one_pass() {
    for law in [WallLaw::Mean, WallLaw::Helical] {
        let blocks = crate::corner::corner();
        let setup = setup(law);
        let path = path(&blocks, &setup, 250);
        let table = ForceTable::new(Real::ZERO);
        let machine = on(&path, &table, soft(3000.0));
        let grid = ImmersionGrid::new();
        let mut bench = Bench::new(machine, &grid, Slices::new(12));
        bench.cut(&FORWARD, &[]);
        let mut states = vec![State::REST; path.working().len()];
        machine.run(path.working().start, &mut states, |_| Vector::ZERO);
        let mut displacements = vec![Vector::ZERO; states.len()];
        let mut profiles = vec![Profile::default(); path.count()];
        profile(&machine, &states, Band::WHOLE, &mut displacements, &mut profiles);
        let mut worst = 0.0f64;
        let mut largest = 0.0f64;
        for (k, expected) in profiles.iter().enumerate() {
            let left = &bench.left[(path.first() + k) * 12..][..12];
            let mean = left.iter().map(|e| e.nm() as f64).sum::<f64>() / 12e3;
            worst = worst.max((mean - expected.mean.nm() as f64 / 1e3).abs());
            largest = largest.max(mean);
        }
        // The mean law is the same physics; at the instant the tool yields before the force of the mean engagement is reached.
        let allowed = if law == WallLaw::Mean { 0.8 } else { 0.03 * largest };
        assert!(worst < allowed, "{law:?}: {worst} of {largest} um");
    }
}

#[test]
fn a_rigid_machine_leaves_nothing_whatever_the_passes() {
    let blocks = straight();
    let setup = setup(WallLaw::Helical);
    let path = path(&blocks, &setup, 500);
    let table = ForceTable::new(Real::ZERO);
    let machine = on(&path, &table, Compliance::default());
    let grid = ImmersionGrid::new();
    let mut bench = Bench::new(machine, &grid, Slices::new(12));
    bench.cut(&Order { first: 6, ..FORWARD }, &[]);
    let upper = bench.at(30.0);
    assert!(upper[6..].iter().all(|e| e.abs() < 0.01) && upper[..6].iter().all(|e| *e == 3000.0), "{upper:?}");
    bench.cut(&BACK, &[]);
    let (most, least) = bench.extremes();
    assert!(most.abs() < 0.01 && least.abs() < 0.01, "{most} {least}");
}

#[test]
fn spring_passes_come_nearer_each_time_and_never_put_anything_back() {
    let blocks = crate::corner::corner();
    let setup = setup(WallLaw::Helical);
    let path = path(&blocks, &setup, 500);
    let table = ForceTable::new(Real::ZERO);
    let machine = on(&path, &table, soft(1500.0));
    let grid = ImmersionGrid::new();
    let mut bench = Bench::new(machine, &grid, Slices::new(12));
    let mut before = f64::MAX;
    let mut left = bench.left.clone();
    for pass in 0..4 {
        bench.cut(&FORWARD, &[]);
        let (most, _) = bench.extremes();
        assert!(most < before * if pass == 0 { 1.0 } else { 0.8 }, "pass {pass}: {most} after {before}");
        assert!(bench.left.iter().zip(&left).all(|(now, then)| now <= then));
        (before, left) = (most, bench.left.clone());
    }
}

#[test]
fn a_reversed_pass_is_one_of_the_other_milling_on_the_reversed_path() {
    let blocks = straight();
    let climbing = setup(WallLaw::Helical);
    let other = CutSetup { wall: Side::Left, milling: Milling::Conventional, ..climbing };
    let table = ForceTable::new(Real::ZERO);
    let grid = ImmersionGrid::new();
    let there = path(&blocks, &climbing, 500);
    let machine = on(&there, &table, soft(1500.0));
    let mut back = Bench::new(machine, &grid, Slices::new(12));
    back.cut(&BACK, &[]);
    use truepath_units::geometry::{Curve, Point};
    let reverse = chain(&[Curve::line(Point::from_nm(60_000_000, 0), Point::from_nm(0, 0)).unwrap()], 400.0);
    let reversed = path(&reverse, &other, 500);
    let machine = Loop { path: &reversed, ..machine };
    let mut forth = Bench::new(machine, &grid, Slices::new(12));
    forth.cut(&FORWARD, &[]);
    for (a, b) in back.at(30.0).iter().zip(forth.at(30.0)) {
        assert!((a - b).abs() < 0.05, "{a} {b}");
    }
}

#[test]
fn the_cut_before_leaves_no_height_below_and_the_last_is_better_for_it() {
    let blocks = crate::corner::corner();
    let setup = setup(WallLaw::Helical);
    let path = path(&blocks, &setup, 500);
    let table = ForceTable::new(Real::ZERO);
    let machine = on(&path, &table, soft(1200.0));
    let grid = ImmersionGrid::new();
    let mut one = Bench::new(machine, &grid, Slices::new(24));
    let (_, reached) = one.aimed(&FORWARD, Aim::Middle);
    assert!(reached.miss < Offset::from_um(10), "{reached:?}");
    let (most, least) = one.extremes();
    let mut two = Bench::new(machine, &grid, Slices::new(24));
    two.aimed(&FORWARD, Aim::Least(Offset::from_um(10)));
    let (left, lowest) = two.extremes();
    assert!(lowest > 2.0 && lowest < 18.0, "{lowest}");
    assert!(left - lowest > 0.7 * (most - least), "no shift cures the height: {left} {lowest} {most} {least}");
    two.aimed(&BACK, Aim::Middle);
    let (after, below) = two.extremes();
    assert!(after.max(-below) < 0.5 * most.max(-least), "{after} {below} of {most} {least}");
}

#[test]
fn a_pass_in_air_takes_nothing_and_is_not_pushed() {
    let blocks = straight();
    let setup = setup(WallLaw::Helical);
    let path = path(&blocks, &setup, 500);
    let table = ForceTable::new(Real::ZERO);
    let machine = on(&path, &table, soft(1200.0));
    let grid = ImmersionGrid::new();
    let mut bench = Bench::new(machine, &grid, Slices::new(12));
    let away = Node { chip: Vector::from_nm(0, 5_000_000), edge: Vector::ZERO };
    let before = bench.left.clone();
    let load = bench.cut(&FORWARD, &vec![away; path.count()]);
    assert_eq!(bench.left, before);
    assert_eq!((load.force, load.engaged, load.chip), (Real::ZERO, Real::ZERO, Real::ZERO));
}
