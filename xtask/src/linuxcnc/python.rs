//! The tests of the operator's component, which need no LinuxCNC: Python's own `unittest`.

use crate::repository::{program, root, run};
use crate::step::Failure;

/// Runs them.
///
/// # Errors
/// One fails, or there is no Python 3.
pub fn check() -> Result<(), Failure> {
    let folder = root().join("linuxcnc/tests");
    // Without the folders of compiled files, which would lie among the sources.
    run(program("python3").args(["-B", "-m", "unittest", "discover", "--quiet", "-s"]).arg(folder))
}
