//! Programs of CAM systems and of machinists, as `tests/data/shop` has them.

use std::path::Path as FilePath;

use truepath_core::cut::Path;
use truepath_core::units::Real;
use truepath_correction::planned::{PlannedPass, PlannedWall, can_repeat_pass, can_reverse, write_every};
use truepath_ground::diagnostics::{Failure, Form, Source};
use truepath_job::job::JobFile;
use truepath_job::pass::{Pass, PathBuffer};

use super::parts::{Wall, cut_as_planned, pass, shown};

/// The passes of a program of the folder, by its row of `programs.csv`; `None` for those that say too little.
fn passes(row: &str) -> Option<(String, Vec<Pass>)> {
    let cells: Vec<&str> = row.split(',').collect();
    let [file, _, dialect, wall, allowance, diameter, teeth, helix, depth, keys, ..] = cells[..] else { return None };
    let folder = FilePath::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/data/shop");
    let line = |key: &str, value: &str| if value.is_empty() { String::new() } else { format!("{key} = \"{value}\"\n") };
    let keys = || keys.split(';').map(|key| key.trim().trim_start_matches('!')).filter(|key| !key.is_empty());
    let of_tool: String = keys().filter_map(|key| key.strip_prefix("tool.")).map(|key| format!("{key}\n")).collect();
    let top: String = keys().filter(|key| !key.contains('.')).map(|key| format!("{key}\n")).collect();
    let text = format!(
        "version = 1\nprogram = \"{file}\"\n{}{}{top}[stock]\nallowance_mm = {allowance}\n[tool]\ndiameter_mm = {diameter}\nteeth = {teeth}\n\
         helix_deg = {helix}\n{of_tool}[cut]\naxial_depth_mm = {depth}\n[force]\nmaterial = \"al-7075-t6\"\n[machine]\n\
         stiffness_x_n_per_mm = 1900\nstiffness_y_n_per_mm = 1900\n[probe]\nball_diameter_mm = 2.0\nformat = \"linuxcnc\"\nz_reference = \"centre\"\n",
        line("dialect", dialect),
        line("wall", wall),
    );
    let job = JobFile::parse(Source::new("job.toml", text.into_bytes()), &folder).expect("a job");
    Some((file.to_owned(), Pass::every(job).ok()?))
}

fn contour(path: &Path<'_>) -> Vec<[i64; 2]> {
    let samples = path.samples()[path.first()..path.first() + path.count()].iter();
    samples.map(|sample| [sample.point.x.nm(), sample.point.y.nm()]).collect()
}

/// A pass out of reach of the final wall, and the last one the other way, faster.
fn plan(path: &Path<'_>) -> Vec<PlannedPass> {
    vec![pass(path, 0.1, 0.0, false, 1.0), pass(path, 0.0, 0.0, true, 1.5)]
}

/// Programs whose last pass cannot be reversed: behind the contour they go on at its depth.
const GO_ON: [&str; 1] = ["kirimoto-outline.nc"];

#[test]
fn programs_of_the_shop_cut_a_plan_on_every_wall_and_depth() {
    let table = include_str!("../../../../tests/data/shop/programs.csv");
    let mut written = 0;
    for row in table.lines().skip(2) {
        let Some((file, passes)) = passes(row) else { continue };
        let mut buffers: Vec<PathBuffer> = passes.iter().map(|_| PathBuffer::default()).collect();
        let paths: Vec<_> = passes.iter().zip(&mut buffers).map(|(pass, b)| shown(pass.sample(b))).collect();
        let plans: Vec<_> = paths.iter().map(plan).collect();
        let walls = passes.iter().zip(&paths).zip(&plans);
        let walls: Vec<_> =
            walls.map(|((pass, path), passes)| PlannedWall { pass, path, passes, cutter: None }).collect();
        let answers = passes.iter().map(can_reverse).collect::<Result<Vec<()>, _>>();
        if file.ends_with(".h") {
            // A conversational program is corrected, but not cut in several passes.
            let refused = passes
                .iter()
                .map(can_repeat_pass)
                .all(|answer| matches!(answer, Err(Failure::Input(e)) if e.code() == "P009"));
            assert!(refused && answers.is_err(), "{file}");
            continue;
        }
        assert!(passes.iter().all(|pass| can_repeat_pass(pass).is_ok()), "{file}");
        let program = match write_every(&walls, None) {
            Ok(program) => program,
            Err(Failure::Input(error)) if GO_ON.contains(&file.as_str()) => {
                assert!(error.code() == "P010" && answers.is_err(), "{error}");
                continue;
            }
            Err(error) => panic!("{file}: {}", error.render(Form::Plain)),
        };
        assert!(answers.is_ok(), "{file}");
        let points: Vec<Vec<[i64; 2]>> = paths.iter().map(contour).collect();
        let feeds: Vec<Vec<Real>> = passes.iter().map(|pass| pass.blocks.iter().map(|b| b.feed).collect()).collect();
        let asked = plans.iter().zip(&points).zip(&feeds);
        let asked: Vec<_> = asked.map(|((passes, points), feeds)| Wall { passes, points, feeds }).collect();
        let off = cut_as_planned(&file, &program, &passes[0].job, &asked);
        println!("{file}: {} depths, {off:.5} mm from the plan", program.depths.len());
        assert!(off <= 0.0011, "{file}: {off} mm");
        written += 1;
    }
    assert!(written >= 60, "{written} programs");
}
