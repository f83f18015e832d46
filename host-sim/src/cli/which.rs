//! `--feature` and `--pass`: which cut of a program with several.

use clap::Args;
use truepath_job::job::Which;

#[derive(Debug, Args)]
pub(super) struct WhichArguments {
    /// The feature of the job, or of the markers in the program; needed when there are several to correct.
    #[arg(long, value_name = "ID")]
    feature: Option<String>,
    /// The depth of the feature, 1 for the first; otherwise the one the probe points lie on, or the first.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=99_999))]
    pass: Option<u32>,
}

impl WhichArguments {
    pub(super) fn which(&self) -> Which {
        Which { feature: self.feature.clone(), pass: self.pass }
    }
}
