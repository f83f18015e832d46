//! Where the fit to the points of a part begins: the store of a shop, and what it says where the job wants that.

use clap::Args;
use truepath_core::cut::WallLaw;
use truepath_correction::shop::Belief;
use truepath_job::pass::Pass;

#[cfg(not(target_family = "wasm"))]
use super::store::believe::believing;

/// Where fits begin.
#[derive(Clone, Debug, Default, Args)]
pub struct BeginFlags {
    /// The shop store: it says what other jobs know of machine, cutter and material where the job wants that, and parts go into it. A
    /// file, or postgres://user@host/database; otherwise TRUEPATH_STORE, then the one that the job names.
    #[cfg(not(target_family = "wasm"))]
    #[arg(long, value_name = "PATH|URL")]
    pub store: Option<String>,
    /// Whether the store is asked.
    #[arg(skip)]
    pub begin: Begin,
}

/// Where a fit begins.
#[derive(Clone, Copy, Debug, Default)]
pub enum Begin {
    /// Where the job wants it: at its statement, or at what the store says.
    #[default]
    AsJobSays,
    /// Where it began once, whatever a store says today; `None` for the statement of the job.
    At(Option<Belief>),
}

impl BeginFlags {
    /// Passes of one job that begin there. What no shop says is not begun at.
    pub(super) fn passes(&self, passes: Vec<Pass>) -> Vec<Pass> {
        match self.begin {
            #[cfg(not(target_family = "wasm"))]
            Begin::AsJobSays => believing(passes, self.store.as_deref()),
            #[cfg(target_family = "wasm")]
            Begin::AsJobSays => passes,
            Begin::At(belief) => {
                let begun = |mut pass: Pass| {
                    let stated = pass.core.stated_prior(WallLaw::Helical);
                    pass.core.believed = belief.and_then(|belief| belief.prior(&stated));
                    pass
                };
                passes.into_iter().map(begun).collect()
            }
        }
    }

    /// The same of one.
    pub(super) fn pass(&self, pass: Pass) -> Pass {
        self.passes(vec![pass]).swap_remove(0)
    }
}
