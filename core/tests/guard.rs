//! The gouge guard on the papers' corner, cut by a helical cutter: its wall varies by tenths of a millimetre over height.
mod corner;
use corner::*;
use truepath_core::correct::{
    Band, Design, DesignWorkspace, Guarded, Law, Node, Predicted, Profile, Target, Update, design, guarded_design,
    uncertainty,
};
use truepath_core::cut::*;
use truepath_core::geometry::Vector;
use truepath_core::identify::{self, Fit, Observation, PredictionWorkspace, Prior};
use truepath_core::units::{Offset, Real};

/// A corner, a machine identified on it, and buffers.
struct Case {
    path: Path<'static>,
    prior: Prior,
    fit: Fit,
}

/// What a design gave.
struct Made {
    nodes: Vec<Node>,
    unguarded: Vec<Node>,
    predicted: Vec<Predicted>,
    sigma: Vec<Offset>,
}

fn case() -> Case {
    let path = path(&corner(), &setup(WallLaw::Helical), 250);
    let compliance = Compliance::from_stiffness(real(3000.0), real(3000.0));
    let stated = Coefficients { kte: real(10.0), kre: real(10.0), ..coefficients() };
    let prior = Prior::around(stated, compliance, WallLaw::Helical);
    let mut observations = Vec::new();
    for (s, height) in [20, 60, 85].into_iter().flat_map(|s| [10, 50, 90].map(|h| (s, h))) {
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
    let fit = identify::identify(&path, &prior, &mut observations, |_| Vector::ZERO, &mut workspace);
    Case { path, prior, fit }
}

impl Case {
    fn wanted(max_gouge_um: Option<i64>) -> Design {
        let max_gouge = max_gouge_um.map(Offset::from_um);
        Design { law: Law::Model, target: Target::Mean, band: Band::WHOLE, max_gouge }
    }

    fn made(&self, wanted: &Design, guarded: bool) -> Made {
        let parameters = &self.fit.parameters;
        let table = ForceTable::new(parameters.coefficients.size_exponent);
        let (coefficients, compliance) = (parameters.coefficients, parameters.compliance);
        let machine = Loop { path: &self.path, table: &table, coefficients, compliance, undersize: Offset::ZERO };
        let (n, w) = (self.path.count(), self.path.working().len());
        let mut workspace = DesignWorkspace {
            states: &mut vec![State::REST; w],
            displacements: &mut vec![Vector::ZERO; w],
            profiles: &mut vec![Profile::default(); n],
            updates: &mut vec![Update::default(); n],
            best: &mut vec![Node::default(); n],
            residual: &[],
        };
        let mut nodes = vec![Node::default(); n];
        let (mut unguarded, mut predicted) = (nodes.clone(), vec![Predicted::default(); n]);
        let mut sigma = vec![Offset::ZERO; n];
        let belief = (&self.prior, &self.fit);
        if guarded {
            let mut made = Guarded { nodes: &mut nodes, unguarded: &mut unguarded, predicted: &mut predicted };
            guarded_design(&machine, belief, wanted, &mut made, &mut workspace, &mut |_| ());
        } else {
            design(&machine, wanted, &mut nodes, &mut predicted, &mut workspace);
        }
        uncertainty(&machine, belief, wanted, &nodes, &predicted, &mut sigma, &mut workspace);
        Made { nodes, unguarded, predicted, sigma }
    }
}

fn deepest(made: &Made) -> Offset {
    made.predicted.iter().map(|p| -p.after.deepest()).max().unwrap()
}

#[test]
fn without_a_guard_nothing_is_computed_otherwise() {
    let case = case();
    let (free, plain) = (case.made(&Case::wanted(None), true), case.made(&Case::wanted(None), false));
    assert_eq!(free.nodes, plain.nodes);
    assert_eq!(free.unguarded, plain.nodes);
    assert_eq!(free.predicted, plain.predicted);
}

#[test]
fn a_guard_that_is_never_reached_leaves_the_correction_to_the_last_bit() {
    let case = case();
    let (wide, plain) = (case.made(&Case::wanted(Some(1_000)), true), case.made(&Case::wanted(None), false));
    assert_eq!(wide.nodes, plain.nodes);
}

#[test]
fn the_guard_holds_at_every_height_with_two_standard_deviations_to_spare() {
    let case = case();
    let plain = case.made(&Case::wanted(None), false);
    let limit = Offset::from_um(20);
    assert!(deepest(&plain) > limit + limit, "the target alone cuts {} nm deep", deepest(&plain).nm());
    let guarded = case.made(&Case::wanted(Some(20)), true);
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
    let (free, guarded) = (case.made(&Design { max_gouge: None, ..wanted }, false), case.made(&wanted, true));
    let below = |made: &Made| made.predicted.iter().map(|p| p.after.lowest - p.after.deepest()).max().unwrap();
    assert!(below(&free) > Offset::from_um(20), "{}", below(&free).nm());
    assert!(deepest(&free) > Offset::from_um(40), "{}", deepest(&free).nm());
    assert!(deepest(&guarded) < Offset::from_um(21), "{}", deepest(&guarded).nm());
}
