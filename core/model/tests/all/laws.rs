//! What the laws of correction leave on the papers' corner, on a machine that obeys the mean law exactly.
use crate::corner;
use corner::*;
use truepath_model::correct::{Law, PaperRatio, PaperTransfer, Predicted, Profile};
use truepath_model::cut::*;
use truepath_units::geometry::{Block, Curve, Vector};
use truepath_units::{Offset, Position, Real};

/// Largest wall error before and after a correction by a law, mm. The paper's law takes one probe on each leg.
fn left_by(law: &str, blocks: &[Block]) -> (f64, f64) {
    let path = path(blocks, &setup(WallLaw::Mean), 100);
    let table = ForceTable::new(Real::ZERO);
    let machine = machine(&path, &table, Compliance::from_stiffness(real(1150.0), real(1150.0)));
    let mut states = vec![State::REST; path.working().len()];
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
    let (_, predicted) = designed(&machine, law);
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

/// Where a 12 mm cutter goes round an inside corner on an arc of its centre of `radius_mm`, on a helical wall: how far the turn
/// that the correction adds at a sample is from that of its neighbours, at most, degrees, and what is left of the wall's error, mm.
fn zigzag(radius_mm: f64, stiffness: f64) -> (f64, f64) {
    let r = radius_mm;
    let blocks = chain(
        &[
            Curve::line(point(0.0, 30.0), point(0.0, r)).unwrap(),
            Curve::arc(point(0.0, r), point(r, 0.0), point(r, r), true).unwrap(),
            Curve::line(point(r, 0.0), point(30.0, 0.0)).unwrap(),
        ],
        400.0,
    );
    let setup = setup(WallLaw::Helical);
    let setup = CutSetup { radius: Offset::from_um(6_000), teeth: 4, allowance: Offset::from_um(500), ..setup };
    let path = path(&blocks, &setup, 25);
    let table = ForceTable::new(Real::ZERO);
    let machine = machine(&path, &table, Compliance::from_stiffness(real(stiffness), real(stiffness)));
    let (nodes, predicted) = designed(&machine, Law::Model);
    let samples = &path.samples()[path.first()..];
    let turn = |at: usize, share: f64| {
        let place = |i: usize| {
            let (on, by) = (samples[i].point, nodes[i].chip + nodes[i].edge);
            [(on.x, by.x), (on.y, by.y)].map(|(on, by)| (on - Position::ZERO).nm() as f64 + share * by.nm() as f64)
        };
        let [a, b, c] = [place(at - 1), place(at), place(at + 1)];
        let (u, v) = ([b[0] - a[0], b[1] - a[1]], [c[0] - b[0], c[1] - b[1]]);
        (u[0] * v[1] - u[1] * v[0]).atan2(u[0] * v[0] + u[1] * v[1]).to_degrees()
    };
    let added: Vec<f64> = (1..nodes.len() - 1).map(|i| turn(i, 1.0) - turn(i, 0.0)).collect();
    let zigzag = added.windows(3).map(|t| (t[1] - (t[0] + t[2]) / 2.0).abs()).fold(0.0, f64::max);
    let judged = |s: Offset| s > Offset::from_um(10_000) && s < Offset::from_um(50_000);
    let left = predicted.iter().zip(samples).filter(|(_, s)| judged(s.s)).map(|(p, _)| p.after.mean.abs().nm());
    (zigzag, left.max().unwrap() as f64 / 1e6)
}

#[test]
fn beside_a_tight_inside_corner_the_corrected_path_does_not_zigzag() {
    // Unsmoothed: 54 and 37 degrees.
    for (radius_mm, stiffness, most) in [(1.0, 3000.0, 20.0), (2.0, 1150.0, 12.0)] {
        let (zigzag, left) = zigzag(radius_mm, stiffness);
        assert!(zigzag < most, "{zigzag} degrees");
        assert!(left < 0.004, "{left} mm");
    }
}
