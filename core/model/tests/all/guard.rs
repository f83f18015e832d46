//! The gouge guard on the papers' corner, cut by a helical cutter: its wall varies by tenths of a millimetre over height.
use crate::corner;
use corner::*;
use truepath_model::correct::{
    Band, Damped, Design, DesignWorkspace, Guarded, InOrder, Law, Node, Predicted, Profile, Scratch, Target, Update,
    commanded, design, guarded_design, guarded_given, profile,
};
use truepath_model::cut::*;
use truepath_model::identify::{self, Cut, Fit, Observation, Parameters, PredictionWorkspace, Prior};
use truepath_units::geometry::Vector;
use truepath_units::{Offset, Real};

/// A corner, a machine identified on it, and buffers.
struct Case {
    path: Path<'static>,
    prior: Prior,
    fit: Fit,
    /// Standard deviation of what is beside the model; empty for nothing.
    beside_sigma: Vec<Offset>,
}

/// What a design gave.
struct Made {
    nodes: Vec<Node>,
    unguarded: Vec<Node>,
    predicted: Vec<Predicted>,
    damped: Option<Damped>,
    sigma: Vec<Offset>,
}

fn case() -> Case {
    probed(&[20, 60, 85])
}

/// Probed at three heights of these places, mm along the contour.
fn probed(places: &[i32]) -> Case {
    let path = path(&corner(), &setup(WallLaw::Helical), 250);
    let compliance = Compliance::from_stiffness(real(3000.0), real(3000.0));
    let stated = Coefficients { kte: real(10.0), kre: real(10.0), ..coefficients() };
    let prior = Prior::around(stated, compliance, WallLaw::Helical);
    let mut observations = Vec::new();
    for (s, height) in places.iter().flat_map(|s| [10, 50, 90].map(|h| (*s, h))) {
        let s = Offset::from_mm(Real::from_int(s));
        let normal = path.samples()[path.index_at(s)].normal;
        observations.push(Observation::new(s, Real::ratio(height, 100), Offset::ZERO, Offset::from_um(3), normal));
    }
    let count = path.working().len() + 1;
    let (mut states, mut displacements) = (vec![State::REST; count], vec![Vector::ZERO; count]);
    let mut workspace = PredictionWorkspace { states: &mut states, displacements: &mut displacements };
    let table = ForceTable::new(prior.mean.coefficients.size_exponent);
    identify::predict(&path, &table, &prior.mean, |_| Vector::ZERO, &mut observations, &mut workspace);
    observations.iter_mut().for_each(|o| o.error = o.predicted);
    let cuts = [Cut { path, points: observations.len(), part: 0 }];
    let fit = identify::identify(
        &cuts,
        (&prior, None),
        &mut [],
        &mut observations,
        |_, _| Vector::ZERO,
        &mut workspace,
        &mut |_| (),
    );
    Case { path, prior, fit, beside_sigma: Vec::new() }
}

impl Case {
    fn wanted(max_gouge_um: Option<i64>) -> Design {
        let max_gouge = max_gouge_um.map(Offset::from_um);
        Design { law: Law::Model, target: Target::Mean, band: Band::WHOLE, max_gouge }
    }

    /// Designed under the guard.
    fn made(&self, wanted: &Design) -> Made {
        self.run(|machine, made, workspace| {
            guarded_design(machine, (&self.prior, &self.fit), wanted, made, workspace, &mut |_| ());
        })
    }

    /// Designed without guard and shrinkage.
    fn plain(&self, wanted: &Design) -> Made {
        self.run(|machine, made, workspace| {
            design(machine, wanted, made.nodes, made.predicted, workspace, &mut |_| ());
        })
    }

    /// Given, and held under the guard.
    fn given(&self, wanted: &Design, nodes: &[Node]) -> Made {
        self.run(|machine, made, workspace| {
            guarded_given(machine, (&self.prior, &self.fit), wanted, nodes, made, workspace);
        })
    }

    fn run(&self, make: impl FnOnce(&Loop, &mut Guarded<'_>, &mut DesignWorkspace)) -> Made {
        let table = ForceTable::new(self.fit.parameters.coefficients.size_exponent);
        let machine = self.fit.parameters.machine(&self.path, &table);
        let (n, w) = (self.path.count(), self.path.working().len());
        let mut workspace = DesignWorkspace {
            states: &mut vec![State::REST; w],
            displacements: &mut vec![Vector::ZERO; w],
            profiles: &mut vec![Profile::default(); n],
            updates: &mut vec![Update::default(); n],
            scratch: &mut vec![Scratch::default(); n],
            residual: &[],
            beside_sigma: &self.beside_sigma,
            reader: InOrder,
        };
        let mut nodes = vec![Node::default(); n];
        let (mut unguarded, mut predicted) = (nodes.clone(), vec![Predicted::default(); n]);
        let mut sigma = vec![Offset::ZERO; n];
        let mut made = Guarded {
            nodes: &mut nodes,
            unguarded: &mut unguarded,
            predicted: &mut predicted,
            sigma: &mut sigma,
            damped: None,
        };
        make(&machine, &mut made, &mut workspace);
        let damped = made.damped;
        Made { nodes, unguarded, predicted, damped, sigma }
    }

    /// The wall of a machine of these parameters, with a correction.
    fn walls(&self, parameters: &Parameters, nodes: &[Node]) -> Vec<Profile> {
        let table = ForceTable::new(parameters.coefficients.size_exponent);
        let machine = parameters.machine(&self.path, &table);
        let mut states = vec![State::REST; self.path.working().len()];
        machine.run(self.path.working().start, &mut states, |i| commanded(&self.path, nodes, i));
        let mut walls = vec![Profile::default(); self.path.count()];
        profile(&machine, &states, Band::WHOLE, &mut vec![Vector::ZERO; states.len()], &mut walls);
        walls
    }

    /// The standard deviation of the mean error, nm, by cutting again on every displaced machine.
    fn deviations(&self, nodes: &[Node]) -> Vec<f64> {
        let base = self.walls(&self.fit.parameters, nodes);
        let mut squares = vec![0.0; base.len()];
        for (k, column) in identify::square_root(&self.fit.covariance).iter().enumerate() {
            // Difference and cross term of the compliance: both ways, each counts half.
            let ways: &[i32] = if matches!(k, 1 | 2) { &[1, -1] } else { &[1] };
            for way in ways {
                let mut theta = self.fit.theta;
                theta.iter_mut().zip(column).for_each(|(t, c)| *t += *c * Real::from_int(*way));
                let moved = self.walls(&self.prior.at(&theta), nodes);
                for ((square, moved), base) in squares.iter_mut().zip(&moved).zip(&base) {
                    *square += ((moved.mean - base.mean).nm() as f64).powi(2) / ways.len() as f64;
                }
            }
        }
        squares.into_iter().map(f64::sqrt).collect()
    }
}

fn deepest(made: &Made) -> Offset {
    made.predicted.iter().map(|p| -p.after.deepest()).max().unwrap()
}

#[test]
fn without_a_guard_nothing_is_computed_otherwise() {
    let case = case();
    let (free, plain) = (case.made(&Case::wanted(None)), case.plain(&Case::wanted(None)));
    assert_eq!(free.nodes, plain.nodes);
    assert_eq!(free.unguarded, plain.nodes);
    assert_eq!(free.predicted, plain.predicted);
}

#[test]
fn a_guard_that_is_never_reached_leaves_the_correction_to_the_last_bit() {
    let case = case();
    let (wide, plain) = (case.made(&Case::wanted(Some(1_000))), case.plain(&Case::wanted(None)));
    assert_eq!(wide.nodes, plain.nodes);
}

#[test]
fn the_guard_holds_at_every_height_with_two_standard_deviations_to_spare() {
    let case = case();
    let plain = case.plain(&Case::wanted(None));
    let limit = Offset::from_um(20);
    assert!(deepest(&plain) > limit + limit, "the target alone cuts {} nm deep", deepest(&plain).nm());
    let guarded = case.made(&Case::wanted(Some(20)));
    for (p, sigma) in guarded.predicted.iter().zip(&guarded.sigma) {
        assert!(p.after.margin() >= *sigma, "{} {}", p.after.margin().nm(), sigma.nm());
        let spare = p.after.deepest() - p.after.margin() + limit;
        assert!(spare > -Offset::from_um(1), "{} nm deep, margin {}", p.after.deepest().nm(), p.after.margin().nm());
    }
    assert_eq!(guarded.unguarded, plain.nodes);
    // It wins over the target, which then leaves material; where the target does not gouge it is still met.
    assert!(guarded.predicted.iter().all(|p| p.after.mean > -Offset::from_um(1)));
    assert!(guarded.predicted.iter().any(|p| p.after.mean > Offset::from_um(10)));
}

#[test]
fn the_guard_looks_beyond_the_band_of_the_target() {
    let case = case();
    let upper = Band { from: Real::ratio(6, 10), to: Real::ratio(9, 10) };
    let wanted = Design { band: upper, ..Case::wanted(Some(20)) };
    let (free, guarded) = (case.plain(&Design { max_gouge: None, ..wanted }), case.made(&wanted));
    let below = |made: &Made| made.predicted.iter().map(|p| p.after.lowest - p.after.deepest()).max().unwrap();
    assert!(below(&free) > Offset::from_um(20), "{}", below(&free).nm());
    assert!(deepest(&free) > Offset::from_um(40), "{}", deepest(&free).nm());
    assert!(deepest(&guarded) < Offset::from_um(21), "{}", deepest(&guarded).nm());
}

#[test]
fn a_wall_that_is_known_is_corrected_by_the_whole_and_one_that_is_not_by_a_share() {
    let known = case().made(&Case::wanted(None));
    assert_eq!(known.damped, None);
    // Both on one wall: across the other anything may be.
    let case = probed(&[85, 88]);
    let (made, whole) = (case.made(&Case::wanted(None)), case.plain(&Case::wanted(None)));
    let damped = made.damped.expect("the first wall is hardly known");
    assert!(damped.least < Real::ratio(9, 10), "{:?}", damped);
    let first = (made.nodes[100].total().x.nm(), whole.nodes[100].total().x.nm());
    assert!(first.0.abs() * 10 < first.1.abs() * 9, "{first:?}");
    // More is applied to the wall that was probed, and no step lies between.
    let last = made.nodes.len() - 20;
    let second = (made.nodes[last].total().y.nm(), whole.nodes[last].total().y.nm());
    assert!((second.0 * first.1).abs() > (second.1 * first.0).abs(), "{first:?} {second:?}");
    for (pair, plain) in made.nodes.windows(2).zip(whole.nodes.windows(2)) {
        let change = |pair: &[Node]| (pair[1].total() - pair[0].total()).x.nm().abs();
        assert!(change(pair) <= change(plain) + 1_000, "{} {}", change(pair), change(plain));
    }
    // What is reported is the wall of what is commanded.
    assert!(made.predicted[100].after.mean.abs() > Offset::from_um(2));
}

#[test]
fn a_wall_beside_which_the_model_is_not_trusted_is_corrected_by_a_share() {
    let mut case = case();
    let whole = case.made(&Case::wanted(None));
    let worst = whole.predicted.iter().map(|p| p.before.mean.abs()).max().unwrap();
    // Behind the corner uneven stock, say: known to half of the largest error.
    let from = whole.nodes.len() * 3 / 4;
    let sigma = |at: usize| if at < from { Offset::ZERO } else { worst.scaled(Real::HALF) };
    case.beside_sigma = (0..whole.nodes.len()).map(sigma).collect();
    let made = case.made(&Case::wanted(None));
    let damped = made.damped.expect("its σ is large");
    assert!((damped.least - Real::HALF).abs() < Real::ratio(1, 50) && damped.to + 1 == made.nodes.len(), "{damped:?}");
    let last = made.nodes.len() - 40;
    let (share, all) = (made.nodes[last].total().y.nm(), whole.nodes[last].total().y.nm());
    assert!((share * 2 - all).abs() * 20 < all.abs(), "{share} of {all}");
    // Where it no longer reaches, all stays as it was, to the last bit.
    assert!((50..from).contains(&damped.from), "{damped:?}");
    assert_eq!(made.nodes[..damped.from], whole.nodes[..damped.from]);
    // What is handed out is that of the fit: the caller knows the other.
    assert!(made.sigma.iter().max() < Some(&worst.scaled(Real::HALF)));
}

#[test]
fn the_deviation_handed_out_is_that_of_the_correction_itself_damped_guarded_or_given() {
    let (known, unknown) = (case(), probed(&[85, 88]));
    let free = known.made(&Case::wanted(None));
    let given = known.given(&Case::wanted(None), &free.nodes);
    assert_eq!((&given.nodes, &given.predicted, &given.sigma), (&free.nodes, &free.predicted, &free.sigma));
    let damped = unknown.made(&Case::wanted(None));
    assert!(damped.damped.is_some());
    let guarded = known.made(&Case::wanted(Some(20)));
    for (case, made) in [(&known, &free), (&unknown, &damped), (&known, &guarded)] {
        let expected = case.deviations(&made.nodes);
        assert!(expected.iter().any(|sigma| *sigma > 100.0));
        // Columns that matter by less than a thousandth are left out, and every root is rounded; where the load changes fast, what lies
        // between two places that are computed is found between them.
        let off = |(found, expected): (&Offset, &f64)| {
            let beyond = (found.nm() as f64 - expected).abs() - 25.0;
            assert!(beyond < 0.08 * expected, "{} {expected}", found.nm());
            beyond > 0.01 * expected
        };
        let between = made.sigma.iter().zip(&expected).map(off).filter(|off| *off).count();
        assert!(between * 10 < expected.len(), "{between} of {}", expected.len());
    }
}

#[test]
fn a_correction_that_is_given_is_taken_back_where_the_guard_forbids_it_and_nowhere_else() {
    let case = case();
    let free = case.made(&Case::wanted(None));
    let wide = case.given(&Case::wanted(Some(1_000)), &free.nodes);
    assert_eq!(wide.nodes, free.nodes);
    let limit = Offset::from_um(20);
    let held = case.given(&Case::wanted(Some(20)), &free.nodes);
    assert_eq!(held.unguarded, free.nodes);
    assert_eq!(held.damped, None);
    assert!(free.predicted.iter().any(|p| p.after.deepest() + limit < Offset::ZERO));
    for p in &held.predicted {
        let spare = p.after.deepest() - p.after.margin() + limit;
        assert!(spare > -Offset::from_um(1), "{} nm deep, margin {}", p.after.deepest().nm(), p.after.margin().nm());
    }
    assert!(held.predicted.iter().any(|p| p.after.margin() > Offset::from_um(1)));
    // No correction at all gouges nowhere here: nothing is to be taken back.
    let none = vec![Node::default(); free.nodes.len()];
    assert_eq!(case.given(&Case::wanted(Some(20)), &none).nodes, none);
}
