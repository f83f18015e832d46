//! The fit to the points of a part begins at what other jobs of the store say, where its job wants that.

use truepath_core::cut::WallLaw;
use truepath_correction::learning::Facts;
use truepath_ground::diagnostics::Failure;
use truepath_job::job::{JobFile, PriorOf};
use truepath_job::pass::Pass;
use truepath_store::{Place, Setup, Store, setting};

use super::chosen::place;
use super::keep::setup;

/// Passes of one job with what the store that is named says of machine, cutter and material. Without an answer of the store they stay as
/// they are and say so: a part is not kept waiting for a server.
pub(in crate::command) fn believing(mut passes: Vec<Pass>, given: Option<&str>) -> Vec<Pass> {
    let Some(job) = passes.first().map(|pass| pass.job.clone()).filter(|job| job.store.prior == PriorOf::Shop) else {
        return passes;
    };
    let told = place(given, Some(&job)).map_err(Failure::from).and_then(|place| {
        let mut store = Store::open(&place)?;
        passes.iter_mut().try_for_each(|pass| believe(pass, &job, &place, &mut store))
    });
    if let Err(failure) = told {
        for pass in &mut passes {
            pass.core.believed = None;
            let said = format!(
                "[store] prior = \"shop\", and the store does not answer: {failure}. The fit begins at what the job states"
            );
            pass.warnings.push(said.into());
        }
    }
    passes
}

fn believe(pass: &mut Pass, job: &JobFile, place: &Place, store: &mut Store) -> Result<(), Failure> {
    let Setup { names, stickout_nm, .. } = setup(Some(job), "correct");
    let facts = Facts::of(pass);
    let setting = setting(&names, stickout_nm, &facts)?;
    let (shop, newest) = store.shop(&facts, &setting)?;
    let believed = shop.believed(&setting, &pass.core.stated_prior(WallLaw::Helical));
    let said = match (&believed, newest) {
        (Some((_, jobs)), Some(newest)) => format!(
            "the fit begins at what {jobs} other parts of the store {place} say of machine, cutter and material (estimates up to {newest})"
        ),
        _ => format!("the store {place} knows nothing of this machine, cutter or material that the job does not"),
    };
    pass.warnings.push(said.into());
    pass.core.believed = believed.map(|(prior, _)| prior);
    Ok(())
}
