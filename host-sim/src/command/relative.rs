//! How a job names the files it needs.

use std::path::{Component, Path};

use truepath_ground::diagnostics::InputError;
use truepath_ground::files::canonical;

/// How a file in the folder of `job` names `program`.
///
/// # Errors
/// A folder or a file that is not there.
pub(super) fn relative(job: &Path, program: &Path) -> Result<String, InputError> {
    let whole = |path: &Path| canonical(path).map_err(|e| InputError::unreadable(path, &e));
    let folder = match job.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => whole(folder)?,
        _ => whole(Path::new("."))?,
    };
    let program = whole(program)?;
    let (from, to): (Vec<Component>, Vec<Component>) = (folder.components().collect(), program.components().collect());
    let same = from.iter().zip(&to).take_while(|(a, b)| a == b).count();
    if same == 0 {
        return Ok(program.display().to_string());
    }
    let up = from.iter().skip(same).map(|_| "..".to_owned());
    let down = to.iter().skip(same).map(|c| c.as_os_str().to_string_lossy().into_owned());
    Ok(up.chain(down).collect::<Vec<_>>().join("/"))
}
