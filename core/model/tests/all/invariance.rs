//! When program, stock, machine and probe points are shifted, turned by 90° or mirrored together, so is the
//! correction, to the last bit. Any other angle: within 2 nm of the turned correction (same machine, isotropic).
use crate::corner;
use crate::process::Bench;
use corner::*;
use proptest::prelude::*;
use truepath_model::correct::{Law, Node};
use truepath_model::cut::*;
use truepath_model::identify::{Cut, Fit, Observation, PredictionWorkspace, Prior, identify};
use truepath_model::process::{Aim, ImmersionGrid, Order, Slices};
use truepath_units::geometry::{Block, Curve, Point, Shape, Side, Vector};
use truepath_units::{Offset, Real};

/// A motion of the plane that maps whole nanometres to whole nanometres.
#[derive(Clone, Copy, Debug)]
struct Motion {
    quarter_turns: u8,
    mirror: bool,
    shift: (i64, i64),
}

impl Motion {
    const REST: Self = Self { quarter_turns: 0, mirror: false, shift: (0, 0) };

    fn raw(self, (mut x, mut y): (i64, i64)) -> (i64, i64) {
        if self.mirror {
            x = -x;
        }
        for _ in 0..self.quarter_turns {
            (x, y) = (-y, x);
        }
        (x, y)
    }
    fn vector(self, v: Vector) -> Vector {
        let (x, y) = self.raw((v.x.nm(), v.y.nm()));
        Vector::from_nm(x, y)
    }
    fn point(self, p: Point) -> Point {
        let (x, y) = self.raw((p.x.nm(), p.y.nm()));
        Point::from_nm(x + self.shift.0, y + self.shift.1)
    }
    fn compliance(self, c: Compliance) -> Compliance {
        let flip = |v: Real, yes: bool| if yes { -v } else { v };
        let odd = self.quarter_turns % 2 == 1;
        Compliance { difference: flip(c.difference, odd), cross: flip(c.cross, odd != self.mirror), ..c }
    }
    fn wall(self, wall: Side) -> Side {
        match (self.mirror, wall) {
            (false, side) => side,
            (true, Side::Left) => Side::Right,
            (true, Side::Right) => Side::Left,
        }
    }
    fn blocks(self, blocks: &[Block]) -> Vec<Block> {
        let curves: Vec<Curve> = blocks
            .iter()
            .map(|b| match b.curve.shape() {
                Shape::Line => Curve::line(self.point(b.curve.start()), self.point(b.curve.end())).unwrap(),
                Shape::Arc { centre, sweep } => Curve::arc(
                    self.point(b.curve.start()),
                    self.point(b.curve.end()),
                    self.point(centre),
                    (sweep > Real::ZERO) != self.mirror,
                )
                .unwrap(),
            })
            .collect();
        chain(&curves, 400.0)
    }
}

fn identified(motion: Motion, blocks: &[Block], wall: Side, prior: &Compliance, errors: &[i64]) -> (Fit, Vec<Node>) {
    let blocks = motion.blocks(blocks);
    // The spindle turns the other way on the mirrored machine, so climb stays climb.
    let milling = Milling::of(wall, true);
    // Every other part with a cutter that runs out.
    let runs_out = errors.iter().sum::<i64>() % 2 == 0;
    let runout = if runs_out { Runout { offset: Offset::from_um(8), behind: real(0.3) } } else { Runout::NONE };
    let setup = CutSetup { wall: motion.wall(wall), milling, runout, ..setup(WallLaw::Helical) };
    let path = path(&blocks, &setup, 500);
    let k = Coefficients { kte: real(12.0), kre: real(16.0), ..coefficients() };
    let prior = Prior::around(k, motion.compliance(*prior), WallLaw::Helical);
    let mut observations: Vec<Observation> = errors
        .iter()
        .enumerate()
        .map(|(i, e)| {
            let s =
                Offset::from_nm(path.samples()[path.first() + path.count() - 1].s.nm() / 13 * (1 + i as i64 / 2 * 2));
            let sample = path.samples()[path.index_at(s)];
            let height = Real::ratio(1 + 2 * (i as i64 % 2), 4);
            let point = Observation::new(sample.s, height, Offset::from_nm(*e), Offset::from_um(2), sample.normal);
            // Some are widths to another place.
            if i % 5 == 4 { point.with_across(path.samples()[path.first() + path.count() / 3].s) } else { point }
        })
        .collect();
    let need = PredictionWorkspace::needed(&path);
    let (mut s, mut d) = (vec![State::REST; need], vec![Vector::ZERO; need]);
    let mut lent = PredictionWorkspace { states: &mut s, displacements: &mut d };
    let cuts = [Cut { path, points: observations.len(), part: 0 }];
    let fit = identify(&cuts, (&prior, None), &mut [], &mut observations, |_, _| Vector::ZERO, &mut lent, &mut |_| ());
    let table = ForceTable::new(fit.parameters.coefficients.size_exponent);
    let machine = fit.parameters.machine(&path, &table);
    (fit, designed(&machine, Law::Model).0)
}

fn motions() -> impl Strategy<Value = Motion> {
    (0u8..4, any::<bool>(), -3_000_000_000i64..3_000_000_000, -3_000_000_000i64..3_000_000_000)
        .prop_map(|(quarter_turns, mirror, x, y)| Motion { quarter_turns, mirror, shift: (x, y) })
}

/// A line, an inside or outside arc, a sloped line.
fn contours() -> impl Strategy<Value = (Vec<Block>, Side)> {
    (any::<bool>(), 3_000_001i64..9_000_000, -2_000_000i64..2_000_000, 8_000_000i64..20_000_000).prop_map(
        |(inside, radius, slope, length)| {
            let radius = if inside { radius } else { radius + 10_000_000 };
            let turn = Point::from_nm(slope, -length);
            let start = Point::from_nm(0, 0);
            let first = Curve::line(start, turn).unwrap();
            // A left turn, tangent to the first line: the wall on the right is an inside corner.
            let across = first.start_heading().left().times(Offset::from_nm(radius));
            let centre = turn + across;
            let end = centre + first.start_heading().times(Offset::from_nm(radius));
            let arc = Curve::arc(turn, end, centre, true).unwrap();
            let out = end + first.start_heading().left().times(Offset::from_nm(length));
            let last = Curve::line(end, out).unwrap();
            (chain(&[first, arc, last], 400.0), if inside { Side::Right } else { Side::Left })
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn identification_and_correction_move_with_the_part_to_the_last_bit(
        motion in motions(),
        (blocks, wall) in contours(),
        errors in prop::collection::vec(-20_000i64..250_000, 4..12),
        difference in -200i64..200,
    ) {
        let prior = Compliance {
            mean: Real::ratio(9, 10),
            difference: Real::ratio(difference, 1000),
            cross: Real::ratio(difference, 5000),
            bend: Real::ZERO,
        };
        let (fit, nodes) = identified(Motion::REST, &blocks, wall, &prior, &errors);
        let (moved_fit, moved) = identified(motion, &blocks, wall, &prior, &errors);
        prop_assert_eq!(moved_fit.parameters.compliance, motion.compliance(fit.parameters.compliance));
        prop_assert_eq!(moved_fit.parameters.coefficients, fit.parameters.coefficients);
        prop_assert_eq!(moved_fit.parameters.datum, motion.vector(fit.parameters.datum));
        for (a, b) in nodes.iter().zip(&moved) {
            prop_assert_eq!(motion.vector(a.chip), b.chip);
            prop_assert_eq!(motion.vector(a.edge), b.edge);
        }
    }
}

/// The corner, turned about the origin by any angle, and its correction turned back, nm.
fn turned_correction(angle: f64, law: WallLaw) -> Vec<(f64, f64)> {
    let (sine, cosine) = angle.sin_cos();
    let at = |x: f64, y: f64| point(cosine * x - sine * y, sine * x + cosine * y);
    let blocks = chain(
        &[
            Curve::line(at(34.0, 80.0), at(34.0, 35.0)).unwrap(),
            Curve::arc(at(34.0, 35.0), at(39.0, 30.0), at(39.0, 35.0), true).unwrap(),
            Curve::line(at(39.0, 30.0), at(90.0, 30.0)).unwrap(),
        ],
        400.0,
    );
    let path = path(&blocks, &setup(law), 100);
    let table = ForceTable::new(Real::ZERO);
    let machine = machine(&path, &table, Compliance::from_stiffness(real(1150.0), real(1150.0)));
    let back = |v: Vector| {
        let (x, y) = (v.x.nm() as f64, v.y.nm() as f64);
        (cosine * x + sine * y, cosine * y - sine * x)
    };
    designed(&machine, Law::Model).0.iter().map(|n| back(n.total())).collect()
}

#[test]
fn a_turn_by_any_other_angle_turns_the_correction_within_two_nanometres_of_its_rounded_inputs() {
    let straight = turned_correction(0.0, WallLaw::Mean);
    for angle in [0.1, 0.7, 1.0, 2.5, -0.3] {
        let turned = turned_correction(angle, WallLaw::Mean);
        let worst = straight.iter().zip(&turned).map(|(a, b)| (a.0 - b.0).hypot(a.1 - b.1)).fold(0.0, f64::max);
        println!("{angle}: {worst:.2} nm");
        assert!(worst <= 2.0, "{angle}: {worst} nm");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(8))]

    #[test]
    fn two_planned_passes_move_with_the_part_to_the_last_bit(motion in motions(), (blocks, wall) in contours()) {
        let planned = |motion: Motion| -> Vec<Vector> {
            let blocks = motion.blocks(&blocks);
            let setup = CutSetup { wall: motion.wall(wall), milling: Milling::of(wall, true), ..setup(WallLaw::Helical) };
            let path = path(&blocks, &setup, 1000);
            let table = ForceTable::new(Real::ZERO);
            let compliance = Compliance { cross: real(0.05), bend: real(0.2), ..Compliance::from_stiffness(real(1500.0), real(2100.0)) };
            let compliance = motion.compliance(compliance);
            let coefficients = Coefficients { kte: real(12.0), kre: real(16.0), ..coefficients() };
            let machine = Loop { path: &path, table: &table, coefficients, compliance, undersize: Offset::ZERO };
            let grid = ImmersionGrid::new();
            let mut bench = Bench::new(machine, &grid, Slices::new(8));
            let order = Order { first: 0, reversed: false, feed: Real::ONE };
            let (first, _) = bench.aimed(&order, Aim::Least(Offset::from_um(10)));
            let (last, _) = bench.aimed(&Order { reversed: true, ..order }, Aim::Middle);
            first.iter().chain(&last).map(Node::total).collect()
        };
        let (there, here) = (planned(motion), planned(Motion::REST));
        for (there, here) in there.iter().zip(&here) {
            prop_assert_eq!(*there, motion.vector(*here));
        }
    }
}
