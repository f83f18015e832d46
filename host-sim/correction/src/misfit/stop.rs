//! Why points stop.

use super::look::{Look, Reason};
use super::trial::Trial;

/// Points that must not be used, and why.
#[derive(Clone, Debug)]
pub struct Misfit {
    /// What the fit of the job as stated shows.
    pub look: Look,
    /// What forbids to go on by itself; `None` where a cause explains so much more that it must be believed.
    pub reason: Option<Reason>,
    /// The fit of the job as stated.
    pub stated: Trial,
    /// Causes that explain the points, the best first; none where nothing does.
    pub causes: Vec<Trial>,
}
