//! What the laws of correction leave on the papers' corner, on a machine that obeys the mean law exactly.
use crate::corner;
use corner::*;
use truepath_model::correct::{
    Band, Design, DesignWorkspace, InOrder, Law, Node, PaperRatio, PaperTransfer, Predicted, Profile, Scratch, Target,
    Update, design,
};
use truepath_model::cut::*;
use truepath_units::geometry::{Block, Curve, Vector};
use truepath_units::{Offset, Position, Real};

/// Largest wall error before and after a correction by a law, mm. The paper's law takes one probe on each leg.
fn left_by(law: &str, blocks: &[Block]) -> (f64, f64) {
    let path = path(blocks, &setup(WallLaw::Mean), 100);
    let table = ForceTable::new(Real::ZERO);
    let machine = machine(&path, &table, Compliance::from_stiffness(real(1150.0), real(1150.0)));
    let (n, w) = (path.count(), path.working().len());
    let mut states = vec![State::REST; w];
    machine.run(path.working().start, &mut states, |_| Vector::ZERO);
    let errors = wall_errors(&machine, &states, 1);
    let probed = |s_mm: f64| {
        let index = path.index_at(Offset::from_nm(mm(s_mm)));
        let error = Offset::from_nm(mm(errors[index - path.first()]));
        (path.samples()[index], error, states[index - path.working().start].engaged)
    };
    let law = match law {
        "model" => Law::Model,
        "mirror" => Law::Mirror,
        _ => {
            let ((a, ea, phi_a), (b, eb, phi_b)) = (probed(20.0), probed(85.0));
            Law::Paper(PaperTransfer {
                x: PaperRatio::new(a.point.x - Position::ZERO, -ea.scaled(a.normal.x), phi_a),
                y: PaperRatio::new(b.point.y - Position::ZERO, -eb.scaled(b.normal.y), phi_b),
            })
        }
    };
    let mut nodes = vec![Node::default(); n];
    let mut predicted = vec![Predicted::default(); n];
    let mut workspace = DesignWorkspace {
        states: &mut states,
        displacements: &mut vec![Vector::ZERO; w],
        profiles: &mut vec![Profile::default(); n],
        updates: &mut vec![Update::default(); n],
        scratch: &mut vec![Scratch::default(); n],
        residual: &[],
        beside_sigma: &[],
        reader: InOrder,
    };
    let wanted = Design { law, target: Target::Mean, band: Band::WHOLE, max_gouge: None };
    design(&machine, &wanted, &mut nodes, &mut predicted, &mut workspace, &mut |_| ());
    // Away from the ends, where no wall is judged.
    let judged = || {
        predicted
            .iter()
            .zip(&path.samples()[path.first()..])
            .filter(|(_, s)| s.s > Offset::from_um(8_000) && s.s < Offset::from_um(95_000))
    };
    let most = |f: fn(&Predicted) -> Profile| judged().map(|(p, _)| f(p).mean.abs().nm()).max().unwrap() as f64 / 1e6;
    (most(|p| p.before), most(|p| p.after))
}

fn shifted(x: f64, y: f64) -> Vec<Block> {
    let at = |px: f64, py: f64| point(px + x, py + y);
    chain(
        &[
            Curve::line(at(34.0, 80.0), at(34.0, 35.0)).unwrap(),
            Curve::arc(at(34.0, 35.0), at(39.0, 30.0), at(39.0, 35.0), true).unwrap(),
            Curve::line(at(39.0, 30.0), at(90.0, 30.0)).unwrap(),
        ],
        400.0,
    )
}

#[test]
fn the_model_law_leaves_less_than_a_micrometre_of_the_mean_law() {
    let (before, after) = left_by("model", &corner());
    assert!((before - 0.297).abs() < 0.004, "{before}");
    assert!(after < 0.001, "{after}");
}

#[test]
fn the_papers_law_leaves_what_the_paper_reports() {
    let (_, after) = left_by("paper", &corner());
    assert!((after - 0.085).abs() < 0.01, "{after}");
}

#[test]
fn the_papers_law_depends_on_the_origin_of_the_program_and_ours_does_not() {
    // The second leg on y = 0: the ratio to the absolute coordinate has nothing to divide by.
    let (_, paper) = left_by("paper", &shifted(-30.0, -30.0));
    assert!(paper > 1.0, "{paper}");
    assert_eq!(left_by("model", &shifted(-30.0, -30.0)), left_by("model", &corner()));
}

#[test]
fn the_mirror_law_is_of_first_order_only() {
    let (_, mirror) = left_by("mirror", &corner());
    let (_, model) = left_by("model", &corner());
    assert!(mirror > 10.0 * model && mirror < 0.06, "{mirror}");
}
