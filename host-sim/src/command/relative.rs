//! How a job names the files it needs.

use std::path::{Component, Path, PathBuf};

use truepath_ground::diagnostics::InputError;
use truepath_ground::files::canonical;

/// How a file in the folder of `job` names `program`.
///
/// # Errors
/// A file that is not there.
pub(super) fn relative(job: &Path, program: &Path) -> Result<String, InputError> {
    let whole = |path: &Path| canonical(path).map_err(|e| InputError::unreadable(path, &e));
    let folder = settled(job.parent().unwrap_or(Path::new(""))).map_err(|e| InputError::unreadable(job, &e))?;
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

/// The whole name of a folder, which need not be there yet.
fn settled(folder: &Path) -> std::io::Result<PathBuf> {
    if folder.as_os_str().is_empty() {
        return canonical(Path::new("."));
    }
    match (canonical(folder), folder.parent(), folder.file_name()) {
        (Err(_), Some(parent), Some(name)) => Ok(settled(parent)?.join(name)),
        (result, ..) => result,
    }
}
