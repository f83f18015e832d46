//! Whose certificates are believed.

use std::path::Path;
use std::sync::Arc;

use rustls::pki_types::CertificateDer;
use rustls::pki_types::pem::PemObject;
use rustls::{ClientConfig, RootCertStore};
use truepath_ground::diagnostics::{InputError, Source};

use crate::codes::Q018;

/// Those of the authorities in a file, or those that this computer believes.
///
/// # Errors
/// `F001` and `Q018`: no certificate is there.
pub fn trust(authorities: Option<&Path>) -> Result<Arc<ClientConfig>, InputError> {
    let mut roots = RootCertStore::empty();
    let found = match authorities {
        Some(file) => {
            let source = Source::read(file)?;
            let all: Result<Vec<_>, _> = CertificateDer::pem_slice_iter(source.bytes()).collect();
            let wrong = |e: &dyn std::fmt::Display| Q018.error(format!("{}: {e}", file.display()), "PEM").in_file(file);
            roots.add_parsable_certificates(all.map_err(|e| wrong(&e))?);
            file.display().to_string()
        }
        None => {
            roots.add_parsable_certificates(rustls_native_certs::load_native_certs().certs);
            "this computer".to_owned()
        }
    };
    if roots.is_empty() {
        return Err(Q018.error(format!("{found} has no certificate of an authority"), "at least one"));
    }
    let provider = Arc::new(rustls::crypto::ring::default_provider());
    let config = ClientConfig::builder_with_provider(provider).with_safe_default_protocol_versions();
    let config = config.map_err(|e| Q018.error(e.to_string(), ""))?;
    Ok(Arc::new(config.with_root_certificates(roots).with_no_client_auth()))
}
