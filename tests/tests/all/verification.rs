//! Are the chosen places good ones? A part is milled by the plant, touched where the plan says, corrected, milled again.

use std::path::Path;

use truepath_correction::correct::correct_pass;
use truepath_correction::verification::{Settings, plan};
use truepath_ground::diagnostics::Source;
use truepath_job::job::{JobFile, Route};
use truepath_job::measurement::Measurement;
use truepath_job::pass::Pass;
use truepath_trial::virtual_mill;

fn demo(name: &str, file: &str) -> Vec<u8> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../host-sim/demo").join(name);
    std::fs::read(folder.join(file)).unwrap()
}

/// Largest wall error of the part cut before and after a correction from touches at these places and levels.
fn corrected(name: &str, places: &[f64], levels: &[f64]) -> (f64, f64) {
    let job = JobFile::parse(Source::new("job.toml", demo(name, "job.toml")), Path::new("")).unwrap();
    let pass = Pass::new(job, Source::new("program.nc", demo(name, "program.nc"))).unwrap();
    let plant = toml::from_str(std::str::from_utf8(&demo(name, "plant.toml")).unwrap()).unwrap();
    let first = virtual_mill::mill(&pass, &plant, None).unwrap();
    let ball = pass.job.require_probe().unwrap().ball_diameter.nm() as f64 / 1e6;
    let text = virtual_mill::probe(&pass, &first, places, levels, ball).unwrap();
    let measurement = Measurement::read(&pass, &Source::new("probe.txt", text.into_bytes())).unwrap();
    let done = correct_pass(&pass, &measurement, &[], &[Route::Program], &mut |_| ()).unwrap();
    let program = done.program.unwrap();
    let second = virtual_mill::mill(&pass, &plant, Some(&virtual_mill::commanded(&pass, &program).unwrap())).unwrap();
    (first.score().max_error_mm, second.score().max_error_mm)
}

#[test]
fn a_part_probed_at_the_chosen_places_comes_out_ten_times_better() {
    for name in ["corner-helix", "pocket"] {
        let job = JobFile::parse(Source::new("job.toml", demo(name, "job.toml")), Path::new("")).unwrap();
        let pass = Pass::new(job, Source::new("program.nc", demo(name, "program.nc"))).unwrap();
        let plan = plan(&pass, &Settings::default(), &mut |_| ()).unwrap();
        let places: Vec<f64> = plan.places.iter().map(|p| p.s_mm).collect();
        let levels: Vec<f64> = plan.places[0].heights.iter().map(|h| h.fraction).collect();
        let (before, after) = corrected(name, &places, &levels);
        println!("{name}: {before:.4} -> {after:.4} mm, at {places:.1?}");
        assert!(after < before / 10.0, "{name}: {before} -> {after}");
    }
}
