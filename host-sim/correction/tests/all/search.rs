//! What the search for the finishing contour makes of a program with planned passes, when its mark is taken off: the
//! same wall is cut several times, and the last pass finishes it.

use truepath_core::geometry::Side;
use truepath_ground::diagnostics::{Failure, Source};
use truepath_job::job::JobFile;
use truepath_job::pass::Pass;

use super::parts::*;
use super::planned::{Plan, radial};

/// The written program without its mark.
fn unmarked(written: &Written) -> Source {
    Source::new("part.nc", written.text().replace("(TRUEPATH CORRECTED)", "(PART)").into_bytes())
}

#[test]
fn the_last_of_radial_passes_is_the_finishing_one_and_the_others_are_roughing() {
    for part in [CORNER, POCKET, HAAS, G64, INCH] {
        let plan: Plan = |path| [0.3, 0.15, 0.0].map(|away| pass(path, away, 0.0, false, 1.0)).to_vec();
        let written = shown(part.written(plan));
        let mut job: JobFile = part.job();
        job.numbers.wall = Some(part.pass().core.setup.wall);
        let read = shown(Pass::new(job, unmarked(&written)));
        let last = written.program.depths[0].passes[2];
        let lines = read.core.contour.lines;
        assert!(last[0] <= lines.first && lines.last <= last[1], "{}: {lines:?} of {last:?}", part.name);
        let plan = read.plan.expect("a choice");
        let roles: Vec<&str> = plan.rows.iter().map(|row| row.role).collect();
        assert_eq!(roles, ["semi", "semi", "finish"], "{}", part.name);
    }
}

#[test]
fn a_last_pass_that_runs_the_other_way_is_asked_for_and_named_by_its_lines() {
    let written = shown(POCKET.written(radial));
    let Err(Failure::Input(error)) = Pass::new(POCKET.job(), unmarked(&written)).map(|_| ()) else { panic!("chosen") };
    assert!(error.code() == "G071" && error.found().contains("2 finishing contours"), "{}", error.found());
    let last = written.program.depths[0].passes[1];
    let feature = format!("[[feature]]\nid = \"wall\"\nlines = [{}, {}]\nwall = \"right\"\n", last[0], last[1]);
    let read = shown(Pass::new(POCKET.job_and(&feature), unmarked(&written)));
    let lines = read.core.contour.lines;
    assert!(last[0] <= lines.first && lines.last <= last[1], "{lines:?}");
    assert_eq!((read.core.setup.wall, read.blocks.len()), (Side::Right, read.core.contour.blocks));
}

#[test]
fn the_written_program_is_no_original_and_the_points_are_those_of_the_job() {
    let written = shown(CORNER.written(radial));
    let source = Source::new("part.nc", written.program.text.clone());
    let Err(Failure::Input(error)) = Pass::new(CORNER.job(), source).map(|_| ()) else { panic!("read") };
    assert_eq!(error.code(), "J011");
}
