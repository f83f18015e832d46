//! The jobs of a shop: each corrected by itself, then with what the others say.

use truepath_core::cut::WallLaw;
use truepath_correction::shop::{CONTRADICTED, Member, Said, Setting, Shop};
use truepath_ground::diagnostics::Failure;

use super::case::{JOBS, ShopCase, name};
use super::outcome::ShopOutcome;
use crate::id::Touches;
use crate::outcome::{Outcome, one_line};
use crate::parallel;
use crate::workflow::first;

/// A shop to be studied.
#[derive(Clone, Copy, Debug)]
pub struct ShopStudy {
    /// Which shop: another number is another one.
    pub seed: u64,
    /// Machines.
    pub machines: u64,
    /// Jobs at a time.
    pub threads: usize,
    /// Where parts are touched.
    pub touches: Touches,
}

/// A job that was corrected by itself.
struct Alone {
    drawn: ShopCase,
    said: Option<Said>,
}

/// A correction, cut and judged.
struct Corrected {
    after_mm: Option<f64>,
    coverage: Option<f64>,
    said: Option<Said>,
    is_kept: bool,
    contradicted: String,
}

impl ShopStudy {
    /// Carries all jobs through, in the order of machines and jobs. `progress` is told (finished, of) corrections of jobs, without and
    /// with the others.
    pub fn run(&self, progress: &mut dyn FnMut(u64, u64)) -> Vec<ShopOutcome> {
        let jobs: Vec<[u64; 2]> = (0..self.machines).flat_map(|m| (0..JOBS).map(move |j| [m, j])).collect();
        let all = 2 * jobs.len() as u64;
        let mut finished = 0;
        let mut outcomes = vec![ShopOutcome::default(); jobs.len()];
        let mut alone: Vec<Option<Alone>> = jobs.iter().map(|_| None).collect();
        let numbered: Vec<(usize, [u64; 2])> = jobs.iter().copied().enumerate().collect();
        let carried = |&(k, [machine, job]): &(usize, [u64; 2])| (k, carried(|| self.alone(machine, job)));
        let _ = parallel::for_each(&numbered, self.threads, carried, |(k, done)| -> Result<(), ()> {
            finished += 1;
            progress(finished, all);
            let [machine, job] = jobs[k];
            match done {
                Ok((outcome, one)) => (outcomes[k], alone[k]) = (outcome, Some(one)),
                Err(failure) => outcomes[k].failure = failure,
            }
            outcomes[k].case = name(machine, job);
            Ok(())
        });
        let known: Vec<usize> = (0..jobs.len()).filter(|k| alone[*k].is_some()).collect();
        let alone = &alone;
        let others = |&k: &usize| {
            let one = alone[k].as_ref();
            let shop = |is_other: &dyn Fn(&Setting) -> bool| {
                let others = alone.iter().enumerate().filter(|(i, _)| *i != k).filter_map(|(_, other)| other.as_ref());
                let member = |other: &Alone| Some(Member { setting: other.drawn.setting.clone(), said: other.said? });
                Shop { members: others.filter(|o| is_other(&o.drawn.setting)).filter_map(member).collect() }
            };
            let each = |shop: &Shop| one.map(|one| carried_with(&one.drawn, shop));
            let machine = one.map(|one| one.drawn.setting.machine.clone()).unwrap_or_default();
            (k, each(&shop(&|setting| setting.machine != machine)), each(&shop(&|_| true)))
        };
        let _ = parallel::for_each(&known, self.threads, others, |(k, others, all_others)| -> Result<(), ()> {
            finished += 1;
            progress(finished, all);
            let outcome = &mut outcomes[k];
            match (others, all_others) {
                (Some(Ok(others)), Some(Ok(all))) => {
                    (outcome.others_mm, outcome.others_coverage) = (others.after_mm, others.coverage);
                    (outcome.all_mm, outcome.all_coverage) = (all.after_mm, all.coverage);
                    (outcome.others_kept, outcome.all_kept) = (Some(others.is_kept), Some(all.is_kept));
                    (outcome.others_contradicted, outcome.all_contradicted) = (others.contradicted, all.contradicted);
                }
                (Some(Err(failure)), _) | (_, Some(Err(failure))) => outcome.failure = failure,
                (None, _) | (_, None) => {}
            }
            Ok(())
        });
        outcomes
    }

    fn alone(&self, machine: u64, job: u64) -> Result<(ShopOutcome, Alone), Failure> {
        let drawn = ShopCase::draw(self.seed, [machine, job], self.touches)?;
        let corrected = corrected(&drawn, &Shop::default())?;
        let outcome = ShopOutcome {
            family: drawn.case.id.family.clone(),
            material: drawn.setting.material.clone(),
            points: Some((drawn.case.places_mm.len() * drawn.case.levels.len()) as u64),
            before_mm: Some(drawn.case.before.score.max_error_mm),
            alone_mm: corrected.after_mm,
            alone_coverage: corrected.coverage,
            ..ShopOutcome::default()
        };
        Ok((outcome, Alone { drawn, said: corrected.said }))
    }
}

fn carried_with(drawn: &ShopCase, shop: &Shop) -> Result<Corrected, String> {
    carried(|| corrected(drawn, shop))
}

/// What comes of some work, whatever happens in it.
fn carried<T>(work: impl FnOnce() -> Result<T, Failure>) -> Result<T, String> {
    match std::panic::catch_unwind(std::panic::AssertUnwindSafe(work)) {
        Ok(Ok(done)) => Ok(done),
        Ok(Err(failure)) => Err(one_line(&failure.to_string())),
        Err(_) => Err("panicked".to_owned()),
    }
}

/// Corrects a job with what a shop says, and cuts it again.
fn corrected(drawn: &ShopCase, shop: &Shop) -> Result<Corrected, Failure> {
    let mut case = drawn.case.clone();
    let stated = case.pass.core.stated_prior(WallLaw::Helical);
    case.pass.core.believed = shop.believed(&drawn.setting, &stated).map(|(prior, _)| prior);
    let mut outcome = Outcome::default();
    let part = first(&case, &mut outcome)?;
    let core = &part.corrected.identified.core;
    Ok(Corrected {
        after_mm: outcome.after_mm,
        coverage: outcome.coverage,
        said: Said::of(core, &stated),
        contradicted: part
            .corrected
            .summary
            .warnings
            .iter()
            .find(|w| w.contains(CONTRADICTED))
            .map(ToString::to_string)
            .unwrap_or_default(),
        is_kept: core.prior != stated && core.law == WallLaw::Helical,
    })
}
