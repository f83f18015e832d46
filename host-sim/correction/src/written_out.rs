//! The passes of a program whose subprograms and loops are written out, because a line is to become something else each time it is
//! executed.

use truepath_ground::diagnostics::{Failure, Source};
use truepath_job::feature::Plan;
use truepath_job::pass::Pass;
use truepath_program::codes::P004;
use truepath_program::unrolled;

/// The same passes of the program with its subprograms and loops written out, and what is said about it, where a line of
/// a contour is executed several times; `None` where that is not what failed, or the cuts would be others.
pub(crate) fn written_out(passes: &[&Pass], failure: &Failure) -> Option<(Vec<Pass>, String)> {
    let Failure::Input(error) = failure else { return None };
    let first = passes.first()?;
    if error.code() != P004.code || !first.job.features.is_empty() {
        return None;
    }
    let text = unrolled(first.program.bytes(), first.job.numbers.program_options())?;
    let curves = |pass: &Pass| pass.blocks.iter().map(|b| (b.curve, b.feed)).collect::<Vec<_>>();
    let levels = |pass: &Pass| pass.plan.as_ref().map(Plan::levels);
    let mut all = Vec::new();
    for pass in passes {
        let mut job = pass.job.clone();
        job.which.pass = pass.plan.as_ref().map(|_| pass.level());
        let flat = pass.of_text(job, Source::new(pass.program.name(), text.clone())).ok()?;
        if curves(&flat) != curves(pass) || levels(&flat) != levels(pass) {
            return None;
        }
        all.push(flat);
    }
    let said = "lines of the contour are executed several times, each with a correction of its own: the corrected program has its subprograms and loops written out";
    Some((all, format!("{}: {said}", first.program.name())))
}
