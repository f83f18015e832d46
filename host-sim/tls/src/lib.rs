//! Whose certificates are believed on the way to a server: of the shop's store, or of its messages.
//!
//! What is encrypted is always checked, certificate and name, because encryption towards anybody who answers protects from nobody who
//! can.

use std::sync::Arc;

use rustls::pki_types::CertificateDer;
use rustls::pki_types::pem::PemObject;
use rustls::{ClientConfig, RootCertStore};

/// How to encrypt towards servers that some authorities, certificates in PEM, vouch for, or those that this computer believes.
///
/// # Errors
/// In words: what is no certificate, or nobody to believe.
pub fn trusting(authorities: Option<&[u8]>) -> Result<ClientConfig, String> {
    let mut roots = RootCertStore::empty();
    match authorities {
        Some(pem) => {
            for certificate in CertificateDer::pem_slice_iter(pem) {
                let certificate = certificate.map_err(|e| e.to_string())?;
                roots.add(certificate).map_err(|e| e.to_string())?;
            }
        }
        // Of many some may be in an odd form: they vouch for nobody then.
        None => drop(roots.add_parsable_certificates(rustls_native_certs::load_native_certs().certs)),
    }
    if roots.is_empty() {
        return Err(match authorities {
            Some(_) => "there is no certificate in PEM".to_owned(),
            None => "this computer has no certificate of an authority".to_owned(),
        });
    }
    let provider = Arc::new(rustls::crypto::ring::default_provider());
    let config = ClientConfig::builder_with_provider(provider).with_safe_default_protocol_versions();
    Ok(config.map_err(|e| e.to_string())?.with_root_certificates(roots).with_no_client_auth())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn authorities_are_certificates_and_nothing_else() {
        let read = |text: &str| trusting(Some(text.as_bytes())).map(|_| ());
        let good = rcgen::generate_simple_self_signed(["shop".to_owned()]).expect("a certificate").cert.pem();
        assert_eq!(read(&good), Ok(()));
        assert_eq!(read(""), Err("there is no certificate in PEM".to_owned()));
        let damaged = "-----BEGIN CERTIFICATE-----\nAAAA\n-----END CERTIFICATE-----\n";
        assert!(read(&format!("{good}{damaged}")).is_err());
    }
}
