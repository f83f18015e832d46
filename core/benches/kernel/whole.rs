//! Identification and design of a whole part, as `truepath correct` does them, and all that a device does by itself.

use super::Work;
use super::corner::{coefficients, corner as papers_corner, path, real, setup};
use super::job_support::{self, Room};
use super::part;
use std::hint::black_box;
use truepath_core::correct::{
    self, Band, Design, DesignWorkspace, InOrder, Law, Node, Predicted, Profile, Scratch, Target, Update,
};
use truepath_core::cut::{Coefficients, Compliance, ForceTable, Path, State, WallLaw};
use truepath_core::geometry::Vector;
use truepath_core::identify::{self as fit, Observation, PredictionWorkspace, Prior};
use truepath_core::image::{DEVICE_NODES, image_bytes};
use truepath_core::job;
use truepath_core::units::{Offset, Real};

/// Distance of the samples, as the command line takes it.
const STEP_UM: i64 = 100;
/// Heights of the probe points, fractions of the engaged depth.
const HEIGHTS: [i64; 3] = [10, 50, 90];

/// A part, what is believed about the machine, and what was probed.
pub struct Part {
    path: Path<'static>,
    prior: Prior,
    observations: Vec<Observation>,
}

/// The papers' corner, probed at five places.
pub fn corner() -> Part {
    let stated = Coefficients { kte: real(10.0), kre: real(10.0), ..coefficients() };
    probed(path(&papers_corner(), &setup(WallLaw::Helical), STEP_UM), &stated, [12, 30, 48, 51, 80])
}

/// The pocket, probed at five places.
pub fn pocket() -> Part {
    let stated =
        Coefficients { ktc: real(800.0), krc: real(200.0), kte: real(10.0), kre: real(10.0), ..coefficients() };
    probed(path(&part::pocket(), &part::pocket_setup(), STEP_UM), &stated, [20, 60, 110, 160, 210])
}

/// Probes the part at places (mm along the contour) as a machine that differs from the stated one would leave it.
fn probed(path: Path<'static>, stated: &Coefficients, places_mm: [i32; 5]) -> Part {
    let prior = Prior::around(*stated, Compliance::from_stiffness(real(1500.0), real(1500.0)), WallLaw::Helical);
    let mut observations: Vec<Observation> = places_mm
        .into_iter()
        .flat_map(|mm| HEIGHTS.map(|h| (Offset::from_mm(Real::from_int(mm)), Real::ratio(h, 100))))
        .map(|(s, height)| {
            let sample = path.samples()[path.index_at(s)];
            Observation::new(s, height, Offset::ZERO, Offset::from_um(2), sample.normal)
        })
        .collect();
    // Half a standard deviation from what is believed, in one direction and the other.
    let mut theta = [Real::HALF; fit::COUNT];
    theta.iter_mut().step_by(2).for_each(|t| *t = -Real::HALF);
    let truth = prior.at(&theta);
    let table = ForceTable::new(truth.coefficients.size_exponent);
    let mut lent = Lent::for_points(&path);
    fit::predict(&path, &table, &truth, |_| Vector::ZERO, &mut observations, &mut lent.points());
    for o in &mut observations {
        *o = Observation::new(o.s, o.height, o.predicted, o.noise, o.normal);
    }
    Part { path, prior, observations }
}

/// Buffers.
struct Lent {
    states: Vec<State>,
    displacements: Vec<Vector>,
    profiles: Vec<Profile>,
    updates: Vec<Update>,
    scratch: Vec<Scratch>,
}

impl Lent {
    fn for_points(path: &Path) -> Self {
        Self::of(PredictionWorkspace::needed(path), 0)
    }
    fn for_design(path: &Path) -> Self {
        Self::of(path.working().len(), path.count())
    }
    fn of(working: usize, contour: usize) -> Self {
        Self {
            states: vec![State::REST; working],
            displacements: vec![Vector::ZERO; working],
            profiles: vec![Profile::default(); contour],
            updates: vec![Update::default(); contour],
            scratch: vec![Scratch::default(); contour],
        }
    }
    fn points(&mut self) -> PredictionWorkspace<'_> {
        PredictionWorkspace { states: &mut self.states, displacements: &mut self.displacements }
    }
    fn design(&mut self) -> DesignWorkspace<'_> {
        DesignWorkspace {
            states: &mut self.states,
            displacements: &mut self.displacements,
            profiles: &mut self.profiles,
            updates: &mut self.updates,
            scratch: &mut self.scratch,
            residual: &[],
            beside_sigma: &[],
            reader: InOrder,
        }
    }
}

/// Identification of the machine from the probe points.
pub fn identify(part: Part) -> Work {
    let mut lent = Lent::for_points(&part.path);
    Box::new(move || {
        let mut observations = part.observations.clone();
        let cuts = [fit::Cut { path: part.path, points: observations.len(), part: 0 }];
        black_box(fit::identify(
            &cuts,
            (&part.prior, None),
            &mut [],
            &mut observations,
            |_, _| Vector::ZERO,
            &mut lent.points(),
            &mut |_| (),
        ));
    })
}

/// Design of the correction on the stated machine, refinements included.
pub fn design(part: Part) -> Work {
    let parameters = part.prior.mean;
    let table = ForceTable::new(parameters.coefficients.size_exponent);
    let wanted = Design { law: Law::Model, target: Target::Mean, band: Band::WHOLE, max_gouge: None };
    let mut lent = Lent::for_design(&part.path);
    let mut nodes = vec![Node::default(); part.path.count()];
    let mut predicted = vec![Predicted::default(); part.path.count()];
    Box::new(move || {
        let machine = parameters.machine(&part.path, &table);
        black_box(correct::design(&machine, &wanted, &mut nodes, &mut predicted, &mut lent.design(), &mut |_| ()));
    })
}

/// From program and measurement to the image, in the memory of a device.
pub fn image(part: job_support::Part) -> Work {
    let mut room: Box<Room> = Box::default();
    let mut out = vec![0; image_bytes(DEVICE_NODES)];
    Box::new(move || {
        let made = job::image(&part.job, part.program, part.probe, &mut room.workspace(), &mut out, &mut |_, _| ());
        assert!(black_box(made).is_ok());
    })
}
