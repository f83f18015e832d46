//! The corner of P18 and P23 and the machine of the reference numbers, for tests.

use truepath_model::correct::{
    Band, Design, DesignWorkspace, InOrder, Law, Node, Predicted, Profile, Scratch, Target, Update, WallReader, design,
};
use truepath_model::cut::{
    Coefficients, Compliance, CutSetup, Envelope, ForceTable, Loop, Milling, Path, Runout, Sample, State, WallLaw,
};
use truepath_units::geometry::{Block, Contour, Curve, Point, Side, Vector};
use truepath_units::{Offset, Real};

pub fn mm(v: f64) -> i64 {
    (v * 1e6).round() as i64
}
pub fn real(v: f64) -> Real {
    Real::from_bits((v * 4_294_967_296.0).round() as i64)
}
pub fn float(v: Real) -> f64 {
    v.bits() as f64 / 4_294_967_296.0
}
pub fn point(x: f64, y: f64) -> Point {
    Point::from_nm(mm(x), mm(y))
}
pub fn chain(curves: &[Curve], feed: f64) -> Vec<Block> {
    let mut s = Offset::ZERO;
    let mut out = Vec::new();
    for (i, curve) in curves.iter().enumerate() {
        out.push(Block { curve: *curve, s, feed: real(feed), line: i as u32 + 1 });
        s += curve.length();
    }
    out
}
/// P23's corner, F = 400 mm/min throughout.
pub fn corner() -> Vec<Block> {
    chain(
        &[
            Curve::line(point(34.0, 80.0), point(34.0, 35.0)).unwrap(),
            Curve::arc(point(34.0, 35.0), point(39.0, 30.0), point(39.0, 35.0), true).unwrap(),
            Curve::line(point(39.0, 30.0), point(90.0, 30.0)).unwrap(),
        ],
        400.0,
    )
}
pub fn setup(law: WallLaw) -> CutSetup {
    CutSetup {
        radius: Offset::from_um(10_000),
        teeth: 6,
        helix_deg: real(30.0),
        axial_depth: real(10.0),
        allowance: Offset::from_um(3_000),
        spindle_rpm: real(1500.0),
        wall: Side::Right,
        milling: Milling::Climb,
        law,
        runout: Runout::NONE,
    }
}
pub fn coefficients() -> Coefficients {
    Coefficients { ktc: real(1147.7), krc: real(344.31), kte: Real::ZERO, kre: Real::ZERO, size_exponent: Real::ZERO }
}
/// Samples a contour into a leaked buffer, as tests may.
pub fn path(blocks: &[Block], setup: &CutSetup, step_um: i64) -> Path<'static> {
    let contour = Contour::new(blocks).unwrap();
    let step = Offset::from_um(step_um);
    let buffer = vec![Sample::BLANK; Path::samples_needed(&contour, setup, step)].leak();
    Path::sample(&contour, setup, step, buffer, |_| ()).unwrap()
}
/// Wall error beside each sample of the contour, mean over `heights` even heights, mm.
pub fn wall_errors(machine: &Loop, states: &[State], heights: i64) -> Vec<f64> {
    let path = machine.path;
    let mut sums = vec![0.0; path.count()];
    let mut displacements = vec![Vector::ZERO; states.len()];
    for k in 0..heights {
        let z = Real::ratio(2 * k + 1, 2 * heights);
        Envelope::displace(machine, states, z, &mut displacements);
        let envelope = Envelope::new(path, path.working().start, &displacements);
        let mut guess = path.first();
        for (i, sum) in sums.iter_mut().enumerate() {
            let e = envelope.error(path.first() + i, guess).unwrap();
            guess = e.made_by + 1;
            *sum += e.error.nm() as f64 / 1e6 / heights as f64;
        }
    }
    sums
}
pub fn machine<'a>(path: &'a Path<'a>, table: &'a ForceTable, compliance: Compliance) -> Loop<'a> {
    Loop { path, table, coefficients: coefficients(), compliance, undersize: Offset::ZERO }
}
/// The correction that a law designs for a machine, and what is expected of it, beside every sample.
pub fn designed(machine: &Loop, law: Law) -> (Vec<Node>, Vec<Predicted>) {
    designed_by(machine, law, InOrder)
}
/// The same by who runs the cutter and reads the walls.
pub fn designed_by(machine: &Loop, law: Law, reader: impl WallReader) -> (Vec<Node>, Vec<Predicted>) {
    let (n, w) = (machine.path.count(), machine.path.working().len());
    let (mut nodes, mut predicted) = (vec![Node::default(); n], vec![Predicted::default(); n]);
    let mut workspace = DesignWorkspace {
        states: &mut vec![State::REST; w],
        displacements: &mut vec![Vector::ZERO; w],
        profiles: &mut vec![Profile::default(); n],
        updates: &mut vec![Update::default(); n],
        scratch: &mut vec![Scratch::default(); n],
        residual: &[],
        beside_sigma: &[],
        reader,
    };
    let wanted = Design { law, target: Target::Mean, band: Band::WHOLE, max_gouge: None };
    design(machine, &wanted, &mut nodes, &mut predicted, &mut workspace, &mut |_| ());
    (nodes, predicted)
}
