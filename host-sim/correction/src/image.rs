//! The correction image of a pass.

use truepath_core::cut::Path;
use truepath_core::image::{DEVICE_NODES, image_bytes};
use truepath_core::job;
use truepath_ground::diagnostics::Failure;
use truepath_job::pass::Pass;

use crate::correction::{Correction, Identification};

/// Makes the image of a correction.
///
/// # Errors
/// A correction beyond the clamp somewhere in the feed window, or a contour too large for the coprocessor.
pub fn build(
    pass: &Pass,
    identified: &Identification,
    path: &Path,
    correction: &Correction,
) -> Result<Vec<u8>, Failure> {
    let mut nodes = correction.nodes.clone();
    let mut bytes = vec![0; image_bytes(DEVICE_NODES)];
    let (core, found, blocks) = (&pass.core, &identified.core, &pass.blocks);
    let written = job::to_nominal_feed(core, found, path, blocks, &mut nodes)
        .and_then(|()| job::write_image(core, found, path, blocks, &nodes, &mut bytes))
        .map_err(|error| pass.refused(&error))?;
    bytes.truncate(written.bytes);
    Ok(bytes)
}
