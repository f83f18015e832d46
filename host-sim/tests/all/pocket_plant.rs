//! What matters: an independent machine (the plant, no shared physics) with a cutter of the same compliance cuts the
//! compensated pockets of the examples with their walls inside the band; and what wrong coefficients make of it.

use std::path::Path;
use std::process::Command;

use truepath_job::job::JobFile;
use truepath_job::pass::Pass;
use truepath_plant as plant;
use truepath_plant::{Cut, Machine, Point, Segment, Side, Spindle, WallLaw};
use truepath_pocket as pocket;
use truepath_trial::virtual_mill;

struct Example {
    pass: Pass,
    corrected: Vec<u8>,
}

fn example(name: &str) -> Example {
    let job = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples/pocket").join(name).join("job.toml");
    let out = tempfile::tempdir().expect("a folder");
    let folder = out.path().join("out");
    let done = Command::new(env!("CARGO_BIN_EXE_truepath"))
        .args(["pocket", job.to_str().expect("UTF-8"), "-o", folder.to_str().expect("UTF-8")])
        .output()
        .expect("the program runs");
    assert_eq!(done.status.code(), Some(0), "{}", String::from_utf8_lossy(&done.stderr));
    let corrected = std::fs::read(folder.join("corrected.nc")).expect("a program");
    Example { pass: Pass::read(JobFile::read(&job).expect("a job")).expect("a pass"), corrected }
}

impl Example {
    /// A machine with the cutter of the job, `force` times its coefficients.
    fn machine(&self, force: f64) -> Machine {
        let job = &self.pass.job;
        let machine = pocket::Machine::of(job).expect("a cutter");
        let [top, tip] = [machine.at(1.0), machine.at(0.0)];
        let number = |v: truepath_core::units::Real| force * v.bits() as f64 / 4_294_967_296.0;
        let k = &job.numbers.force;
        Machine {
            ktc_n_per_mm2: number(k.ktc),
            krc_n_per_mm2: number(k.krc),
            kte_n_per_mm: number(k.kte),
            kre_n_per_mm: number(k.kre),
            compliance_mm_per_n: [[top[0], 0.0], [0.0, top[1]]],
            bend: (tip[0] - top[0]) / top[0],
            law: WallLaw::Helical,
            ..Machine::rigid()
        }
    }
}

/// Near the edge of a wall that the other leg of a corner cuts away, the end of the other wall is seen along its own
/// normal and looks like a deep cut: this much is left out, mm.
const EDGE_MM: f64 = 1.0;

/// The largest of errors along a contour, between two places.
fn largest(errors: &[(f64, f64)], from: f64, to: f64) -> f64 {
    let edges: Vec<f64> = errors.windows(2).filter(|w| w[0].1.is_nan() != w[1].1.is_nan()).map(|w| w[0].0).collect();
    let stands = |s: f64| edges.iter().all(|edge| (edge - s).abs() > EDGE_MM);
    let judged = errors.iter().filter(|(s, e)| *s >= from && *s <= to && e.is_finite() && stands(*s));
    let seen: Vec<f64> = judged.map(|p| p.1).collect();
    assert!(seen.len() > 100);
    seen.iter().fold(0.0, |m, e| m.max(e.abs()))
}

#[test]
fn an_independent_machine_cuts_the_compensated_finishing_pass_within_the_band() {
    let example = example("finish");
    let walls = |force: f64| {
        let machine = example.machine(force);
        let before = virtual_mill::mill(&example.pass, &machine, None).expect("milled");
        let after = virtual_mill::mill_program(&example.pass, &machine, &example.corrected).expect("milled");
        [before, after].map(|milled| {
            let errors = milled.mean_errors();
            let along: Vec<(f64, f64)> = milled.path.s_mm.iter().copied().zip(errors).collect();
            largest(&along, 0.0, f64::MAX)
        })
    };
    let [before, after] = walls(1.0);
    println!("finishing pass on the independent machine: {before:.4} -> {after:.4} mm");
    assert!((before - 0.031).abs() < 0.001, "{before}");
    assert!(after <= 0.02, "{after}");
    // Without a probe the result is as good as the coefficients: 20 % stay, of the error before.
    for force in [0.8, 1.2] {
        let [b, a] = walls(force);
        println!("coefficients {force}: {b:.4} -> {a:.4} mm");
        assert!(a < after + 0.35 * before && a < b, "{force}: {b} -> {a}");
    }
}

/// Segments of the path of the example, from its blocks.
fn segments(pass: &Pass) -> Vec<Segment> {
    let place = |p: truepath_core::geometry::Point| [p.x.nm() as f64 / 1e6, p.y.nm() as f64 / 1e6];
    pass.blocks
        .iter()
        .map(|block| {
            let (from, to) = (place(block.curve.start()), place(block.curve.end()));
            match block.curve.shape() {
                truepath_core::geometry::Shape::Line => Segment::Line { from, to },
                truepath_core::geometry::Shape::Arc { centre, sweep } => {
                    Segment::Arc { from, to, centre: place(centre), ccw: sweep.bits() > 0 }
                }
            }
        })
        .collect()
}

/// Material on the wall's side of a rectangle that no circle of the cutter reaches: full immersion.
fn solid(half: [f64; 2], beyond: f64) -> Vec<Point> {
    let [x, y] = half.map(|h| h + beyond);
    // It begins and ends on the straight leg that the program begins on, so that its run-out lies on itself.
    vec![[20.0, -y], [x, -y], [x, y], [-x, y], [-x, -y], [-20.0, -y]]
}

#[test]
fn an_independent_machine_cuts_both_walls_of_the_compensated_slot_within_the_band() {
    let example = example("slot");
    let commanded = virtual_mill::commanded(&example.pass, &example.corrected).expect("a path");
    // Both walls of the slot, each in its own cut: the side decides which wall is looked at.
    let walls = |force: f64| {
        let machine = example.machine(force);
        let one = |side: Side, beyond: f64, commanded: Option<&[Point]>| {
            let path = plant::Path::new(&segments(&example.pass), side, 0.1).expect("a path");
            let cut = Cut {
                radius_mm: 6.0,
                teeth: 4,
                helix_deg: 30.0,
                axial_depth_mm: 6.0,
                feed_mm_per_min: 400.0,
                feed_changes: Vec::new(),
                spindle_rpm: 2000.0,
                spindle: Spindle::Clockwise,
                allowance_mm: 12.0,
                surface: Some(solid([40.0, 25.0], beyond)),
                memory_mm: None,
            };
            let milled = plant::mill(&path, &cut, &machine, commanded).expect("milled");
            let errors = milled.mean_errors();
            let along: Vec<(f64, f64)> = milled.path.s_mm.iter().copied().zip(errors).collect();
            // The last 14 mm run into the beginning of the slot.
            let end = milled.path.length_mm - 14.0;
            largest(&along, 0.0, end)
        };
        let both = |commanded: Option<&[Point]>| [one(Side::Right, -6.4, commanded), one(Side::Left, 6.4, commanded)];
        [both(None), both(Some(&commanded))]
    };
    let [before, after] = walls(1.0);
    println!("slot on the independent machine: near, far {before:.4?} -> {after:.4?} mm");
    assert!(before.iter().all(|e| (*e - 0.045).abs() < 0.004), "{before:?}");
    assert!(after.iter().all(|e| *e <= 0.02), "{after:?}");
    for force in [0.8, 1.2] {
        let [b, a] = walls(force);
        println!("coefficients {force}: near, far {b:.4?} -> {a:.4?} mm");
        assert!(a.iter().all(|e| *e < 0.02), "20 % of 0.045 mm and what is left stay within 0.02 mm: {a:?}");
    }
}
