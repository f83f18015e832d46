//! Whether the way to a server is encrypted, and whose word the server's name is taken on.
//!
//! `sslmode` and `sslrootcert` of the URL, else `PGSSLMODE` and `PGSSLROOTCERT`, as every program of PostgreSQL takes them. Stricter than
//! those in one thing: what is encrypted is checked, certificate and name.

use std::fmt::Display;
use std::path::PathBuf;

use postgres::config::{Host, SslMode};
use postgres::{Config, NoTls};
use rustls::ClientConfig;
use tokio_postgres_rustls::MakeRustlsConnect;
use truepath_tls::trusting;

/// What is asked of the way to a server.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Encryption {
    mode: Option<SslMode>,
    /// The file with those who may vouch for the server; without it those whom the system trusts.
    roots: Option<PathBuf>,
}

/// The modes, in the words of an error.
const MODES: &str = "sslmode is disable, prefer, require or verify-full";

impl Encryption {
    /// Takes what is of encryption out of a URL. Returns the rest.
    ///
    /// # Errors
    /// What is wrong, in words.
    pub(super) fn of(url: &str) -> Result<(String, Self), String> {
        let environment = |name| std::env::var(name).ok().filter(|value: &String| !value.is_empty());
        Self::with(url, environment("PGSSLMODE").as_deref(), environment("PGSSLROOTCERT").as_deref())
    }

    fn with(url: &str, mode: Option<&str>, roots: Option<&str>) -> Result<(String, Self), String> {
        let (before, query) = url.split_once('?').unwrap_or((url, ""));
        let value = |text: &str| percent_encoding::percent_decode_str(text).decode_utf8_lossy().into_owned();
        let (mut mode, mut roots) = (mode.map(str::to_owned), roots.map(str::to_owned));
        let mut rest = Vec::new();
        for pair in query.split('&').filter(|pair| !pair.is_empty()) {
            match pair.split_once('=') {
                Some(("sslmode", text)) => mode = Some(value(text)),
                Some(("sslrootcert", text)) => roots = Some(value(text)),
                Some((key @ ("sslcert" | "sslkey" | "sslcrl"), _)) => {
                    return Err(format!("{key} is not supported: users show who they are by a password"));
                }
                _ => rest.push(pair),
            }
        }
        let mode = match mode.as_deref() {
            None => None,
            Some("disable") => Some(SslMode::Disable),
            Some("prefer") => Some(SslMode::Prefer),
            Some("require" | "verify-full") => Some(SslMode::Require),
            Some(other) => return Err(format!("sslmode is {other}, and {MODES}")),
        };
        let roots = roots.filter(|name| name != "system").map(PathBuf::from);
        let url = if rest.is_empty() { before.to_owned() } else { format!("{before}?{}", rest.join("&")) };
        Ok((url, Self { mode, roots }))
    }

    /// Connects, encrypted where that is asked for, and, where nothing is asked, where the server offers it and is another computer.
    pub(super) fn connect(&self, config: &mut Config) -> Result<postgres::Client, Failed> {
        // Nobody listens between two programs of one computer.
        let default = if config.get_hosts().iter().all(is_here) { SslMode::Disable } else { SslMode::Prefer };
        let mode = self.mode.unwrap_or(default);
        config.ssl_mode(mode);
        if mode == SslMode::Disable {
            return Ok(config.connect(NoTls)?);
        }
        let tls = self.trusting().map_err(Failed::Roots)?;
        Ok(config.connect(MakeRustlsConnect::new(tls))?)
    }

    /// Who may vouch for a server.
    fn trusting(&self) -> Result<ClientConfig, String> {
        let Some(file) = &self.roots else { return trusting(None) };
        let named = |why: &dyn Display| format!("sslrootcert {}: {why}", file.display());
        let authorities = std::fs::read(file).map_err(|e| named(&e))?;
        trusting(Some(&authorities)).map_err(|why| named(&why))
    }
}

/// Why there is no connection.
pub(super) enum Failed {
    /// Those who may vouch cannot be read.
    Roots(String),
    /// The server, or the way to it.
    Server(postgres::Error),
}

impl From<postgres::Error> for Failed {
    fn from(error: postgres::Error) -> Self {
        Self::Server(error)
    }
}

fn is_here(host: &Host) -> bool {
    match host {
        Host::Tcp(name) => {
            name == "localhost" || name.parse::<std::net::IpAddr>().is_ok_and(|address| address.is_loopback())
        }
        #[cfg(unix)]
        Host::Unix(_) => true,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_of_encryption_is_taken_out_and_the_url_comes_before_the_environment() {
        let of = |url, mode, roots| Encryption::with(url, mode, roots).expect("a mode");
        let plain = "postgres://ann@db/shop";
        assert_eq!(of(plain, None, None), (plain.to_owned(), Encryption::default()));
        let (url, found) = of(
            "postgres://ann@db/shop?sslmode=verify-full&connect_timeout=3&sslrootcert=%2Fetc%2Fca.pem",
            Some("disable"),
            Some("other"),
        );
        assert_eq!(url, "postgres://ann@db/shop?connect_timeout=3");
        assert_eq!(found, Encryption { mode: Some(SslMode::Require), roots: Some("/etc/ca.pem".into()) });
        assert_eq!(
            of(plain, Some("disable"), Some("system")).1,
            Encryption { mode: Some(SslMode::Disable), roots: None }
        );
        for wrong in ["sslmode=verify-ca", "sslmode=allow", "sslmode=", "sslkey=a.pem"] {
            assert!(Encryption::with(&format!("{plain}?{wrong}"), None, None).is_err(), "{wrong}");
        }
        assert!(Encryption::with(plain, Some("odd"), None).is_err());
    }

    #[test]
    fn only_this_computer_is_here() {
        let config = |url: &str| url.parse::<Config>().expect("a URL");
        let all_here = |url| config(url).get_hosts().iter().all(is_here);
        assert!(
            ["postgres://a@127.0.0.1/s", "postgres://a@[::1]/s", "postgres://a@localhost/s"].into_iter().all(all_here)
        );
        assert!(!["postgres://a@10.0.0.1/s", "postgres://a@localhost.shop/s"].into_iter().any(all_here));
    }
}
