//! Which store is meant.

use truepath_ground::diagnostics::InputError;
use truepath_job::job::JobFile;
use truepath_store::Place;
use truepath_store::codes::O007;

/// The store that is meant: of the command line, of the environment, of the job.
///
/// # Errors
/// `O007` where none is named.
pub(super) fn place(given: Option<&str>, job: Option<&JobFile>) -> Result<Place, InputError> {
    let place = given.map(Place::of).or_else(Place::of_environment);
    let place = place.or_else(|| job.and_then(|job| job.store.place.as_ref()).map(Place::of_job));
    place.ok_or_else(|| O007.error("no store is named", "a file, or a database of a server"))
}
