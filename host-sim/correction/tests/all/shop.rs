//! Programs of CAM systems and of machinists, as `tests/data/shop` has them.

use std::path::Path as FilePath;

use truepath_core::units::Offset;
use truepath_correction::planned::{PlannedWall, can_repeat_pass, can_reverse, write_every};
use truepath_ground::diagnostics::{Failure, Source};
use truepath_job::feature::Survey;
use truepath_job::job::JobFile;
use truepath_job::pass::{Pass, PathBuffer};

use super::parts::pass;

/// The passes of a program of the folder, with its row of `programs.csv`.
fn passes(row: &str) -> Option<(String, JobFile, Vec<Pass>)> {
    let cells: Vec<&str> = row.split(',').collect();
    let [file, _, dialect, wall, allowance, diameter, teeth, helix, depth, keys, ..] = cells[..] else { return None };
    let folder = FilePath::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/data/shop");
    let source = Source::read(&folder.join(file)).ok()?;
    let line = |key: &str, value: &str| if value.is_empty() { String::new() } else { format!("{key} = \"{value}\"\n") };
    let of_tool: String = keys
        .split(';')
        .filter_map(|k| k.trim().trim_start_matches('!').strip_prefix("tool."))
        .map(|k| format!("{k}\n"))
        .collect();
    let top: String = keys
        .split(';')
        .map(|k| k.trim().trim_start_matches('!'))
        .filter(|k| !k.is_empty() && !k.starts_with("tool.") && !k.contains('.'))
        .map(|k| format!("{k}\n"))
        .collect();
    let text = format!(
        "version = 1\nprogram = \"{file}\"\n{}{}{top}[stock]\nallowance_mm = {allowance}\n[tool]\ndiameter_mm = {diameter}\nteeth = {teeth}\n\
         helix_deg = {helix}\n{of_tool}[cut]\naxial_depth_mm = {depth}\n[force]\nmaterial = \"al-7075-t6\"\n[machine]\n\
         stiffness_x_n_per_mm = 1900\nstiffness_y_n_per_mm = 1900\n[probe]\nball_diameter_mm = 2.0\nformat = \"linuxcnc\"\nz_reference = \"centre\"\n",
        line("dialect", dialect),
        line("wall", wall),
    );
    let job = JobFile::parse(Source::new("job.toml", text.into_bytes()), &folder)
        .map_err(|e| println!("{file}: JOB {e}"))
        .ok()?;
    let _ = source;
    let passes = Pass::every(job.clone())
        .map_err(|e| {
            if let Failure::Input(e) = e {
                println!("{file}: {} {}", e.code(), e.found())
            }
        })
        .ok()?;
    Some((file.to_owned(), job, passes))
}

#[test]
fn explore() {
    let table = include_str!("../../../../tests/data/shop/programs.csv");
    for row in table.lines().skip(2) {
        let Some((file, job, passes)) = passes(row) else { continue };
        let code = |answer: Result<(), Failure>| match answer {
            Ok(()) => "ok".to_owned(),
            Err(Failure::Input(e)) => format!("{} line {:?} {}", e.code(), e.line_column(), e.found()),
            Err(e) => format!("{e:?}"),
        };
        let first: Vec<String> = passes.iter().map(|p| code(can_repeat_pass(p))).collect();
        let back: Vec<String> = passes.iter().map(|p| code(can_reverse(p))).collect();
        let mut buffers: Vec<PathBuffer> = passes.iter().map(|_| PathBuffer::default()).collect();
        let paths: Vec<_> = passes.iter().zip(&mut buffers).map(|(p, b)| p.sample(b).ok().unwrap()).collect();
        let plans: Vec<_> =
            paths.iter().map(|path| vec![pass(path, 0.1, 0.0, false, 1.0), pass(path, 0.0, 0.0, true, 0.5)]).collect();
        let walls: Vec<_> = passes
            .iter()
            .zip(&paths)
            .zip(&plans)
            .map(|((pass, path), passes)| PlannedWall { pass, path, passes })
            .collect();
        let written = write_every(&walls, None);
        let told = match &written {
            Ok(p) => format!(
                "written {} depths, dev {:.5}, warnings {:?}",
                p.depths.len(),
                p.difference.largest_deviation_mm,
                p.warnings
            ),
            Err(Failure::Input(e)) => format!("{} line {:?} {}", e.code(), e.line_column(), e.found()),
            Err(e) => format!("{e:?}"),
        };
        println!("{file}: {first:?} {back:?} => {told}");
        let _ = (&job, Offset::ZERO);
        if let Ok(p) = written {
            std::fs::write(format!("/tmp/t/shop-{file}"), &p.text).unwrap();
            assert!(Survey::read(&job, &Source::new("w.nc", p.text.clone())).is_ok());
        }
    }
}
