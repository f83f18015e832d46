//! Corners that are not arcs, and contours without a seam, milled by the plant.

use std::path::Path;

use truepath_correction::correct::{CorrectedPass, correct_pass};
use truepath_ground::diagnostics::{Failure, Source};
use truepath_job::job::{JobFile, Route};
use truepath_job::measurement::Measurement;
use truepath_job::pass::Pass;
use truepath_plant::{Machine, Milled};
use truepath_report::correction_csv;
use truepath_trial::virtual_mill;

const PLANT: &str = "ktc_n_per_mm2 = 1147.7\nkrc_n_per_mm2 = 344.3\nstiffness_x_n_per_mm = 1150\nstiffness_y_n_per_mm = 1150\nlaw = \"mean\"\n";

fn pass(moves: &str, wall: &str, allowance: f64) -> Pass {
    let program = format!("%\nG21 G90 G17 G40\nS1500 M3\nG0 Z10\n{moves}G0 Z50\nM30\n%\n");
    let job = format!(
        "version = 1\nprogram = \"p.nc\"\nwall = \"{wall}\"\n[stock]\nallowance_mm = {allowance}\n[tool]\ndiameter_mm = 20.0\n\
         teeth = 6\nhelix_deg = 30.0\n[cut]\naxial_depth_mm = 10.0\n[force]\nktc_n_per_mm2 = 1147.7\nkrc_n_per_mm2 = 344.3\n\
         kte_n_per_mm = 0\nkre_n_per_mm = 0\nmodel = \"mean\"\n[machine]\nstiffness_x_n_per_mm = 1000\n\
         stiffness_y_n_per_mm = 1300\n[probe]\nball_diameter_mm = 6.0\nformat = \"linuxcnc\"\nz_reference = \"centre\"\n"
    );
    let job = JobFile::parse(Source::new("job.toml", job.into_bytes()), Path::new("")).unwrap();
    Pass::new(job, Source::new("p.nc", program.into_bytes())).unwrap()
}

struct Told {
    pass: Pass,
    first: Milled,
    corrected: CorrectedPass,
    second: Milled,
}

fn told(pass: Pass, places: &[f64]) -> Told {
    let machine: Machine = toml::from_str(PLANT).unwrap();
    let first = virtual_mill::mill(&pass, &machine, None).unwrap();
    let probe = virtual_mill::probe(&pass, &first, places, &[0.5], 6.0).unwrap();
    let measurement = Measurement::read(&pass, &Source::new("probe.txt", probe.into_bytes())).unwrap();
    let corrected = correct_pass(&pass, &measurement, &[], &[Route::Program], &mut |_| ())
        .unwrap_or_else(|e: Failure| panic!("{}", e.render(truepath_ground::diagnostics::Form::Plain)));
    let commanded = virtual_mill::commanded(&pass, corrected.program.as_deref().unwrap()).unwrap();
    let second = virtual_mill::mill(&pass, &machine, Some(&commanded)).unwrap();
    Told { pass, first, corrected, second }
}

/// Largest wall error between two arc lengths.
fn worst(milled: &Milled, from: f64, to: f64) -> f64 {
    let errors = milled.mean_errors();
    let within = milled.path.s_mm.iter().zip(errors).filter(|(s, e)| **s > from && **s < to && e.is_finite());
    within.map(|(_, e)| e.abs()).fold(0.0, f64::max)
}

#[test]
fn an_outside_corner_cut_with_two_lines_is_corrected_up_to_its_edge() {
    let told = told(pass("G0 X0 Y50\nG1 Z-10 F400\nG1 X0 Y0\nG1 X-30 Y-40\n", "right", 3.0), &[20.0, 75.0]);
    // 53° of turn: the walls end 5 mm before the corner of the path.
    let legs = |m: &Milled| worst(m, 8.0, 43.0).max(worst(m, 58.0, 92.0));
    assert!(legs(&told.first) > 0.08 && legs(&told.second) < 0.01, "{} -> {}", legs(&told.first), legs(&told.second));
    assert!(told.corrected.summary.max_correction_mm < 0.3, "{}", told.corrected.summary.max_correction_mm);
    let table = String::from_utf8(correction_csv(&told.corrected.rows).unwrap()).unwrap();
    assert!(table.lines().any(|line| line.ends_with(",,,")), "places without a wall are empty in the table");
}

#[test]
fn at_a_sharp_inside_corner_the_wall_never_gets_worse_and_the_user_is_told() {
    let told = told(pass("G0 X0 Y50\nG1 Z-10 F400\nG1 X0 Y0\nG1 X50 Y0\n", "right", 3.0), &[20.0, 80.0]);
    let (before, after) = (worst(&told.first, 8.0, 92.0), worst(&told.second, 8.0, 92.0));
    assert!(after <= before, "{before} -> {after}");
    let straight = worst(&told.second, 8.0, 36.0).max(worst(&told.second, 64.0, 92.0));
    assert!(straight < 0.01, "{straight}");
    assert!(told.corrected.summary.warnings.iter().any(|w| w.contains("sharp inside corner at line")));
}

#[test]
fn a_closed_contour_has_no_seam() {
    let told = told(pass("G0 X20 Y0\nG1 Z-10 F400\nG3 X20 Y0 I-20 J0\n", "right", 1.0), &[15.0, 46.0, 78.0, 109.0]);
    let nodes = &told.corrected.correction.nodes;
    assert_eq!(nodes.first(), nodes.last());
    // Around the circle the correction turns with the wall: its size is the same everywhere, the seam included.
    let size = |n: &truepath_core::correct::Node| n.total().length().nm() as f64 / 1e6;
    let (low, high) = nodes.iter().map(size).fold((f64::MAX, 0.0f64), |(l, h), v| (l.min(v), h.max(v)));
    assert!(high - low < 0.02 * high, "{low} … {high}");
    let text = String::from_utf8(told.corrected.program.unwrap()).unwrap();
    assert!(text.contains("G3"), "{text}");
    let length = told.pass.core.contour.length.nm() as f64 / 1e6;
    assert!(worst(&told.second, 8.0, length - 8.0) < 0.01);
}

#[test]
fn a_program_without_a_spindle_code_is_warned_of() {
    let mut pass = pass("G0 X0 Y50\nG1 Z-10 F400\nG1 X0 Y0\n", "right", 1.0);
    assert!(pass.warnings.iter().all(|w| !w.contains("M3")));
    let text = String::from_utf8(pass.program.bytes().to_vec()).unwrap().replace("S1500 M3", "S1500");
    pass = Pass::new(pass.job.clone(), Source::new("p.nc", text.into_bytes())).unwrap();
    assert!(pass.warnings.iter().any(|w| w.contains("neither M3 nor M4")));
}
