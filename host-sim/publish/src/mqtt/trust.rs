//! Whose certificates are believed.

use std::path::Path;
use std::sync::Arc;

use rustls::ClientConfig;
use truepath_ground::diagnostics::{InputError, Source};
use truepath_tls::trusting;

use crate::codes::Q018;

/// Those of the authorities in a file, or those that this computer believes.
///
/// # Errors
/// `F001` and `Q018`: no certificate is there.
pub fn trust(authorities: Option<&Path>) -> Result<Arc<ClientConfig>, InputError> {
    let file = authorities.map(Source::read).transpose()?;
    trusting(file.as_ref().map(Source::bytes)).map(Arc::new).map_err(|why| {
        let error = Q018.error(why, "certificates in PEM");
        match authorities {
            Some(path) => error.in_file(path),
            None => error,
        }
    })
}
